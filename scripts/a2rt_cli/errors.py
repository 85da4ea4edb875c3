"""Errors that end a command with one clear message instead of a traceback."""

from __future__ import annotations

from pathlib import Path

# Exit statuses, the same as a2rt-core's: 1 the checked thing does not hold, 2 bad input, 3 a bug.
EXIT_FALSE = 1
EXIT_USER = 2
EXIT_BUG = 3
EXIT_INTERRUPTED = 130


class UserError(Exception):
    """Something the user can mend. `remedy` is what to do; `log` is where the details are."""

    def __init__(self, message: str, remedy: str = "", log: Path | None = None):
        super().__init__(message)
        self.remedy = remedy
        self.log = log

    def lines(self) -> list[str]:
        out = [f"a2rt: error: {self}"]
        if self.remedy:
            out.append(f"  remedy: {self.remedy}")
        if self.log is not None:
            out.append(f"  log: {self.log}")
        return out
