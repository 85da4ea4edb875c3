"""TOML tables that know which of their keys were read.

A key that nothing reads is an error that names file, line and column: a misspelt one costs seconds.
"""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

from a2rt_cli.errors import UserError


class Table:
    """A TOML table that knows which of its keys were read."""

    def __init__(self, values: dict[str, Any], file: Path, text: str, prefix: str = ""):
        self._values, self._file, self._text, self._prefix = values, file, text, prefix
        self._read: set[str] = set()

    @staticmethod
    def read(path: Path) -> Table:
        try:
            text = path.read_text(encoding="utf-8")
            return Table(tomllib.loads(text), path, text)
        except OSError as error:
            raise UserError(f"{path}: {error.strerror}", "name a file that is there") from error
        except tomllib.TOMLDecodeError as error:
            raise UserError(f"{path}: {error}", "mend the TOML syntax") from error

    def where(self, key: str) -> str:
        pattern = re.compile(rf"^(\s*\[*)\s*(?:[\w.]+\.)?{re.escape(key)}\b", re.MULTILINE)
        match = pattern.search(self._text)
        if match is None:
            return str(self._file)
        line = self._text.count("\n", 0, match.start()) + 1
        start = match.end(1)
        column = start - self._text.rfind("\n", 0, start)
        return f"{self._file}:{line}:{column}"

    def get(self, key: str, kind: type | tuple[type, ...], fallback: Any = ...) -> Any:
        self._read.add(key)
        if key not in self._values:
            if fallback is ...:
                raise UserError(f"{self._file}: {self._prefix}{key} is missing", "add it")
            return fallback
        value = self._values[key]
        if not isinstance(value, kind) or (isinstance(value, bool) and kind is not bool):
            raise UserError(f"{self.where(key)}: {key} = {value!r} has the wrong type")
        return value

    def table(self, key: str) -> Table | None:
        values = self.get(key, dict, None)
        return None if values is None else Table(values, self._file, self._text, f"{key}.")

    def tables(self, key: str) -> list[Table]:
        found = self.get(key, list, [])
        return [Table(values, self._file, self._text, f"{key}.") for values in found]

    def rest(self) -> dict[str, Any]:
        """All keys not read so far; they count as read."""
        out = {key: value for key, value in self._values.items() if key not in self._read}
        self._read |= set(out)
        return out

    def reject_unknown(self) -> None:
        for key in self._values:
            if key not in self._read:
                raise UserError(
                    f"{self.where(key)}: unknown key {self._prefix}{key}",
                    f"known here: {', '.join(sorted(self._read))}",
                )
