"""Experiment files (lumibench_configs/experiments/*.toml): which runs a figure or sweep needs.

A key that nothing reads is an error that names file and line, so that a misspelt one costs seconds.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from a2rt_cli import console
from a2rt_cli.comparison import Item
from a2rt_cli.engine import scenes
from a2rt_cli.engine.renderer import RenderOptions
from a2rt_cli.engine.runs import DEFAULT_AUDIT, RunSpec
from a2rt_cli.errors import UserError
from a2rt_cli.paths import CONFIGS

FOLDER = CONFIGS / "experiments"


@dataclass(frozen=True)
class Knob:
    """One parameter of a unit and the values it takes; the unit's own value among them."""

    unit: str
    key: str
    values: tuple[Any, ...]
    default: Any
    title: str


@dataclass(frozen=True)
class Search:
    unit: str
    space: dict[str, tuple[Any, ...]]
    most_lost_hits: int
    most_extra_redundant: float  # relative to the unit's default configuration
    minimise: str  # dotted path of a result


@dataclass(frozen=True)
class Experiment:
    file: Path
    title: str
    scenes: tuple[str, ...]
    workloads: tuple[str, ...]
    size: tuple[int, int]
    spp: int | None
    units: tuple[str, ...]
    gpu: str | None
    audit: int
    pictures: bool
    knobs: tuple[Knob, ...] = ()
    factorial: dict[str, tuple[Any, ...]] | None = None
    factorial_unit: str = "a2rt"
    search: Search | None = None

    @property
    def name(self) -> str:
        return self.file.stem

    def items(self) -> list[Item]:
        """Scenes × workloads; a real scene that is not on this machine is left out, and said so."""
        out = []
        for text in self.scenes:
            try:
                scene = scenes.find(text)
            except UserError:
                console.note(f"  {text}: not on this machine, left out (see A2RT_SCENES)")
                continue
            for workload in self.workloads:
                options = RenderOptions(workload, self.size[0], self.size[1], self.spp)
                name = scene.name if len(self.workloads) == 1 else f"{scene.name}-{workload}"
                out.append(Item(text, options, name))
        if not out:
            raise UserError(f"{self.file}: none of its scenes is on this machine")
        return out

    def specs(self) -> list[RunSpec]:
        """The units as configured, without knobs."""
        return [
            RunSpec(unit, self.gpu, audit=self.audit, picture=self.pictures) for unit in self.units
        ]


class _Table:
    """A TOML table that knows which of its keys were read."""

    def __init__(self, values: dict[str, Any], file: Path, text: str, prefix: str = ""):
        self._values, self._file, self._text, self._prefix = values, file, text, prefix
        self._read: set[str] = set()

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

    def table(self, key: str) -> _Table | None:
        values = self.get(key, dict, None)
        return None if values is None else _Table(values, self._file, self._text, f"{key}.")

    def tables(self, key: str) -> list[_Table]:
        found = self.get(key, list, [])
        return [_Table(values, self._file, self._text, f"{key}.") for values in found]

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


def find(text: str) -> Path:
    path = Path(text) if text.endswith(".toml") else FOLDER / f"{text}.toml"
    if not path.is_file():
        names = ", ".join(sorted(file.stem for file in FOLDER.glob("*.toml")))
        raise UserError(f"{text}: no such experiment", f"name a .toml file or one of: {names}")
    return path


def load(path: Path, only_scenes: Sequence[str] | None = None) -> Experiment:
    try:
        text = path.read_text(encoding="utf-8")
        values = tomllib.loads(text)
    except OSError as error:
        raise UserError(f"{path}: {error.strerror}", "name an experiment file") from error
    except tomllib.TOMLDecodeError as error:
        raise UserError(f"{path}: {error}", "mend the TOML syntax") from error
    top = _Table(values, path, text)
    size = top.get("size", list, [128, 128])
    if len(size) != 2 or not all(isinstance(n, int) and n > 0 for n in size):
        raise UserError(f"{top.where('size')}: size is [width, height]")
    factorial = top.table("factorial")
    experiment = Experiment(
        file=path,
        title=top.get("title", str),
        scenes=tuple(only_scenes or top.get("scenes", list)),
        workloads=tuple(top.get("workloads", list, ["auto"])),
        size=(size[0], size[1]),
        spp=top.get("spp", int, None),
        units=tuple(top.get("units", list, ["baseline", "aqb8", "a2rt"])),
        gpu=top.get("gpu", str, None),
        audit=top.get("audit", int, DEFAULT_AUDIT),
        pictures=top.get("pictures", bool, False),
        knobs=tuple(_knob(table) for table in top.tables("knob")),
        factorial_unit=factorial.get("unit", str, "a2rt") if factorial else "a2rt",
        factorial=_space(factorial) if factorial else None,
        search=_search(top.table("search")),
    )
    if only_scenes:
        top.get("scenes", list, [])
    top.reject_unknown()
    return experiment


def _knob(table: _Table) -> Knob:
    knob = Knob(
        table.get("unit", str, "a2rt"),
        table.get("key", str),
        tuple(table.get("values", list)),
        table.get("default", (int, float, str, bool)),
        table.get("title", str),
    )
    table.reject_unknown()
    if knob.default not in knob.values:
        raise UserError(f"{table.where('default')}: {knob.key}: the default is not in values")
    return knob


def _space(table: _Table) -> dict[str, tuple[Any, ...]]:
    """Parameter -> values; dotted keys are quoted in the file."""
    out = {}
    for key, values in table.rest().items():
        if not isinstance(values, list) or not values:
            raise UserError(f"{table.where(key)}: {key} needs a list of values")
        out[key] = tuple(values)
    return out


def _search(table: _Table | None) -> Search | None:
    if table is None:
        return None
    space = table.table("space")
    if space is None:
        raise UserError("search.space is missing", "add [search.space] with lists of values")
    found = Search(
        table.get("unit", str, "a2rt"),
        _space(space),
        table.get("most_lost_hits", int, 0),
        table.get("most_extra_redundant", (int, float), 0.01),
        table.get("minimise", str),
    )
    table.reject_unknown()
    return found
