"""Runs other programs: output to a log, progress to the console, failure to a clear error."""

from __future__ import annotations

import os
import re
import shlex
import shutil
import signal
import subprocess
import threading
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from a2rt_cli.errors import UserError

_TAIL_LINES = 12

_RUNNING: set[subprocess.Popen] = set()
_RUNNING_LOCK = threading.Lock()

# Called with every output line.
LineSink = Callable[[str], None]


class ProgramFailed(UserError):
    """A program ended with a failure; `status` is its exit status, `tail` its last lines."""

    def __init__(
        self, message: str, status: int, tail: Sequence[str], remedy: str, log: Path | None
    ):
        super().__init__(message, remedy, log)
        self.status = status
        self.tail = list(tail)

    def lines(self) -> list[str]:
        out = super().lines()
        if self.tail:
            out[1:1] = [f"  | {line}" for line in self.tail]
        return out


def describe_status(status: int) -> str:
    if status < 0:
        try:
            return f"was ended by {signal.Signals(-status).name}"
        except ValueError:
            return f"was ended by signal {-status}"
    return f"ended with status {status}"


def run_logged(
    command: Sequence[str],
    log: Path,
    *,
    what: str,
    remedy: str = "",
    env: Mapping[str, str] | None = None,
    cwd: Path | None = None,
    on_line: LineSink | None = None,
) -> None:
    """Runs `command` with its output appended to `log`; raises ProgramFailed if it fails.

    The child runs in its own process group, and the whole group is ended if we are interrupted.
    """
    log.parent.mkdir(parents=True, exist_ok=True)
    tail: deque[str] = deque(maxlen=_TAIL_LINES)
    errors: list[str] = []
    with log.open("a", encoding="utf-8", errors="replace", buffering=1) as out:
        out.write(f"$ {shlex.join(command)}\n")
        out.flush()
        try:
            child = subprocess.Popen(
                _ends_with_us(command),
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                env=None if env is None else dict(env),
                cwd=cwd,
                text=True,
                errors="replace",
                start_new_session=True,
            )
        except OSError as error:
            raise UserError(f"{what}: {command[0]}: {error.strerror}", remedy, log) from error
        with _RUNNING_LOCK:
            _RUNNING.add(child)
        try:
            assert child.stdout is not None
            for line in child.stdout:
                text = line.rstrip("\n")
                out.write(line)
                if not text.startswith("@progress"):
                    tail.append(text)
                    if "error:" in text and len(errors) < _TAIL_LINES:
                        errors.append(text)
                if on_line is not None:
                    on_line(text)
            status = child.wait()
        except BaseException:
            end_group(child)
            raise
        finally:
            with _RUNNING_LOCK:
                _RUNNING.discard(child)
    if status != 0:
        # A program that names its error is quoted; of others the end is the best guess.
        shown = errors or [line for line in tail if line.strip()]
        raise ProgramFailed(f"{what} {describe_status(status)}", status, shown, remedy, log)


# Run by sh: $0 is our process. Killed before the child could ask to end with us, we are its parent
# no longer. (A shell drops variables whose names it could not write; nothing of ours has such.)
_UNLESS_ORPHANED = '[ "$PPID" = "$0" ] && exec "$@"'


def _ends_with_us(command: Sequence[str]) -> list[str]:
    """The kernel ends the child if we are killed outright, so that it writes into no later run."""
    setpriv = shutil.which("setpriv")
    found = shutil.which(command[0])
    if setpriv is None or found is None:
        return list(command)
    check = ["sh", "-c", _UNLESS_ORPHANED, str(os.getpid())]
    return [setpriv, "--pdeathsig", "KILL", "--", *check, *command]


def end_group(child: subprocess.Popen) -> None:
    """Ends a child started with start_new_session and everything it started."""
    try:
        os.killpg(child.pid, signal.SIGTERM)
        child.wait(timeout=5)
    except ProcessLookupError:
        pass
    except subprocess.TimeoutExpired:
        os.killpg(child.pid, signal.SIGKILL)
        child.wait()


def end_all() -> None:
    """Ends the children of every thread; an interrupt reaches only the main thread."""
    with _RUNNING_LOCK:
        children = list(_RUNNING)
    for child in children:
        end_group(child)


_PROGRESS = re.compile(r"^@progress\s+([0-9.]+)\s*(.*)$")


def progress_line(line: str) -> tuple[float, str] | None:
    """The engines report progress as `@progress FRACTION words`."""
    match = _PROGRESS.match(line)
    if match is None:
        return None
    return min(1.0, float(match[1])), match[2]
