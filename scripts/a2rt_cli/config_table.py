"""TOML tables that know which of their keys were read, and where each stands in its file.

A key that nothing reads is an error that names file, line and column: a misspelt one costs seconds.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from a2rt_cli.errors import UserError

_HEADER = re.compile(r"\s*\[(\[)?\s*([^\[\],]+?)\s*\]\]?\s*(?:#.*)?$")
_KEY = re.compile(r"""\s*("[^"\n]*"|'[^'\n]*'|[\w-]+(?:\s*\.\s*[\w-]+)*)\s*=""")
_SYNTAX_PLACE = re.compile(r"^(.*) \(at line (\d+), column (\d+)\)$")


class Table:
    """A TOML table that knows which of its keys were read."""

    def __init__(self, values: dict[str, Any], file: Path, text: str, path: str = ""):
        self._values, self._file, self._text, self._path = values, file, text, path
        self._read: set[str] = set()

    @staticmethod
    def read(path: Path) -> Table:
        try:
            text = path.read_text(encoding="utf-8")
            return Table(tomllib.loads(text), path, text)
        except OSError as error:
            raise UserError(f"{path}: {error.strerror}", "name a file that is there") from error
        except UnicodeDecodeError as error:
            raise UserError(f"{path}: not UTF-8 text", "save it as UTF-8") from error
        except tomllib.TOMLDecodeError as error:
            raise UserError(_syntax_error(path, text, error), "mend the TOML syntax") from error

    def where(self, key: str, value: object = None) -> str:
        """file:line:column of a key of this table, or of the string `value` that it names."""
        at = _places(self._text).get(f"{self._path}{key}")
        if at is None:
            return str(self._file)
        if isinstance(value, str):
            found = re.compile(rf"""["']{re.escape(value)}["']""").search(self._text, at)
            at = at if found is None else found.start()
        line = self._text.count("\n", 0, at) + 1
        return f"{self._file}:{line}:{at - self._text.rfind(chr(10), 0, at)}"

    def get(self, key: str, kind: type | tuple[type, ...], fallback: Any = ...) -> Any:
        self._read.add(key)
        if key not in self._values:
            if fallback is ...:
                raise UserError(f"{self._file}: {self._name(key)} is missing", "add it")
            return fallback
        value = self._values[key]
        kinds = kind if isinstance(kind, tuple) else (kind,)
        if not isinstance(value, kinds) or (isinstance(value, bool) and bool not in kinds):
            allowed = " or ".join(_TYPE_NAMES[one] for one in kinds)
            raise UserError(
                f"{self.where(key)}: {self._name(key)} = {value!r} has the wrong type",
                f"it must be {allowed}",
            )
        return value

    def known(self, key: str, name: str, names: Iterable[str], what: str) -> str:
        """`name`, which stands under `key`, if it is one of `names`."""
        names = list(names)
        if name not in names:
            raise UserError(
                f"{self.where(key, name)}: {self._name(key)}: no {what} is called {name!r}",
                f"known: {', '.join(names)}",
            )
        return name

    def table(self, key: str) -> Table | None:
        values = self.get(key, dict, None)
        if values is None:
            return None
        return Table(values, self._file, self._text, f"{self._path}{key}.")

    def tables(self, key: str) -> list[Table]:
        found = self.get(key, list, [])
        if not all(isinstance(values, dict) for values in found):
            raise UserError(
                f"{self.where(key)}: {self._name(key)} has the wrong type",
                f"it must be tables, each headed by [[{self._name(key)}]]",
            )
        return [
            Table(values, self._file, self._text, f"{self._path}{key}[{index}].")
            for index, values in enumerate(found)
        ]

    def rest(self) -> dict[str, Any]:
        """All keys not read so far; they count as read."""
        out = {key: value for key, value in self._values.items() if key not in self._read}
        self._read |= set(out)
        return out

    def reject_unknown(self) -> None:
        for key in self._values:
            if key not in self._read:
                raise UserError(
                    f"{self.where(key)}: unknown key {self._name(key)}",
                    f"known here: {', '.join(sorted(self._read))}",
                )

    def _name(self, key: str) -> str:
        return re.sub(r"\[\d+\]", "", self._path) + key


def _syntax_error(path: Path, text: str, error: tomllib.TOMLDecodeError) -> str:
    if place := _SYNTAX_PLACE.match(str(error)):
        return f"{path}:{place[2]}:{place[3]}: {place[1]}"
    return f"{path}:{max(1, len(text.splitlines()))}:1: {error}"


_TYPE_NAMES = {
    str: "a string",
    int: "a whole number",
    float: "a number with a decimal point",
    bool: "true or false",
    list: "a list",
    dict: "a table",
}


def _places(text: str) -> dict[str, int]:
    """Dotted key -> where it starts; the elements of [[key]] are key[0], key[1], ...

    tomllib keeps no places. One statement a line is how such files are written; a key that is
    written otherwise is reported by its file alone.
    """
    places: dict[str, int] = {}
    count: dict[str, int] = {}
    table, start = "", 0
    for line in text.splitlines(keepends=True):
        if header := _HEADER.match(line):
            name = _plain(header[2])
            if header[1]:
                index = count[name] = count.get(name, -1) + 1
                places.setdefault(name, start + header.start(2))
                name = f"{name}[{index}]"
            table = f"{name}."
            places.setdefault(name, start + header.start(2))
        elif key := _KEY.match(line):
            places.setdefault(f"{table}{_plain(key[1])}", start + key.start(1))
        start += len(line)
    return places


def _plain(key: str) -> str:
    return key.strip("\"'") if key[:1] in "\"'" else re.sub(r"\s*\.\s*", ".", key)
