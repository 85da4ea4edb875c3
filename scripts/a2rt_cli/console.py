"""What a command prints: steps with progress, notes, tables.

Progress goes to standard error, results to standard output, so that output can be piped. On a
terminal a step rewrites its own line; elsewhere (a log, CI) it prints a line when it starts, at
every quarter, and when it ends.
"""

from __future__ import annotations

import contextlib
import os
import shutil
import sys
import threading
import time
from collections.abc import Iterator, Sequence
from typing import TextIO

_LOCK = threading.Lock()


def _plain(stream: TextIO) -> bool:
    return not stream.isatty() or "NO_COLOR" in os.environ or os.environ.get("TERM") == "dumb"


def _clock(seconds: float) -> str:
    return f"{int(seconds) // 60}:{int(seconds) % 60:02d}"


class Step:
    """One piece of work with a name, a fraction done and a time."""

    def __init__(self, title: str, stream: TextIO):
        self.title = title
        self._stream = stream
        self._live = stream.isatty() and os.environ.get("TERM") != "dumb"
        self._start = time.monotonic()
        self._quarter = 0
        self._drawn = 0.0
        self._detail = ""
        self._fraction: float | None = None
        self._live_draw(force=True) if self._live else self._line("...")

    def elapsed(self) -> float:
        return time.monotonic() - self._start

    def update(self, fraction: float | None = None, detail: str = "") -> None:
        """`fraction` is in [0, 1]; None means unknown."""
        self._fraction = fraction
        self._detail = detail
        if self._live:
            self._live_draw()
        elif fraction is not None and int(fraction * 4) > self._quarter:
            self._quarter = int(fraction * 4)
            if fraction < 1:
                self._line(f"{fraction:4.0%}  {_clock(self.elapsed())}")

    def finish(self, verdict: str = "done") -> None:
        if self._live:
            with _LOCK:
                self._stream.write("\r\x1b[K")
        self._line(f"{verdict} ({self.elapsed():.1f} s)")

    def _line(self, tail: str) -> None:
        with _LOCK:
            self._stream.write(f"  {self.title}: {tail}\n")
            self._stream.flush()

    def _live_draw(self, force: bool = False) -> None:
        now = time.monotonic()
        if not force and now - self._drawn < 0.1:
            return
        self._drawn = now
        percent = "" if self._fraction is None else f" {self._fraction:4.0%}"
        width = shutil.get_terminal_size().columns
        text = f"  {self.title}:{percent}  {_clock(self.elapsed())}  {self._detail}"
        with _LOCK:
            self._stream.write("\r\x1b[K" + text[: max(20, width - 1)])
            self._stream.flush()


@contextlib.contextmanager
def step(title: str) -> Iterator[Step]:
    """Shows `title` while the block runs; says whether it ended well."""
    current = Step(title, sys.stderr)
    try:
        yield current
    except BaseException as error:
        current.finish("interrupted" if isinstance(error, KeyboardInterrupt) else "FAILED")
        raise
    current.finish()


def note(text: str) -> None:
    with _LOCK:
        print(text, file=sys.stderr, flush=True)


def heading(text: str) -> None:
    bold, end = ("", "") if _plain(sys.stdout) else ("\x1b[1m", "\x1b[0m")
    print(f"\n{bold}{text}{end}")


def table(columns: Sequence[str], rows: Sequence[Sequence[str]], left: int = 1) -> str:
    """Aligned text: the first `left` columns to the left, the others (numbers) to the right."""
    cells = [list(columns), *[list(row) for row in rows]]
    widths = [max(len(row[i]) for row in cells) for i in range(len(columns))]
    lines = []
    for index, row in enumerate(cells):
        parts = [
            cell.ljust(width) if i < left else cell.rjust(width)
            for i, (cell, width) in enumerate(zip(row, widths, strict=True))
        ]
        lines.append("  ".join(parts).rstrip())
        if index == 0:
            lines.append("  ".join("-" * width for width in widths))
    return "\n".join(lines)
