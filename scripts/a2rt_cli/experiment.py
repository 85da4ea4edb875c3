"""Experiment files (lumibench_configs/experiments/*.toml): which runs a figure or sweep needs.

A key that nothing reads is an error that names file and line, so that a misspelt one costs seconds.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from a2rt_cli import console
from a2rt_cli.comparison import Item
from a2rt_cli.config_table import Table
from a2rt_cli.engine import scenes
from a2rt_cli.engine.renderer import RenderOptions
from a2rt_cli.engine.runs import DEFAULT_AUDIT, RunSpec, with_same_area
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
    labels: tuple[str, ...] = ()  # of the values, where they do not speak for themselves
    order: str = ""  # "finer" or "coarser": where precision goes along the values; "": nowhere

    def label(self, value: Any) -> str:
        return self.labels[self.values.index(value)] if self.labels else str(value)


@dataclass(frozen=True)
class Factorial:
    """Every combination of a few values, for Pareto fronts and for optima in two parameters."""

    title: str
    unit: str
    space: dict[str, tuple[Any, ...]]


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
    same_area: bool = False  # also with the testers that fit into A2RT's area
    sample: float | None = None  # share of the warps to simulate, checked against all of them
    knobs: tuple[Knob, ...] = ()
    factorials: tuple[Factorial, ...] = ()
    search: Search | None = None

    @property
    def name(self) -> str:
        return self.file.stem

    def items(self) -> list[Item]:
        """Scenes × workloads. A stand-in that would be drawn anyway is left out, and said so."""
        out = []
        for text in self.scenes:
            scene = scenes.find(text)
            if scene.features is not None and scene.argument in self.scenes:
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
        specs = [
            RunSpec(
                unit,
                self.gpu,
                audit=self.audit,
                picture=self.pictures,
                sample=self.sample,
                check_sample=self.sample is not None,
            )
            for unit in self.units
        ]
        return with_same_area(specs) if self.same_area else specs


def find(text: str) -> Path:
    path = Path(text) if text.endswith(".toml") else FOLDER / f"{text}.toml"
    if not path.is_file():
        names = ", ".join(sorted(file.stem for file in FOLDER.glob("*.toml")))
        raise UserError(f"{text}: no such experiment", f"name a .toml file or one of: {names}")
    return path


def load(path: Path, only_scenes: Sequence[str] | None = None) -> Experiment:
    top = Table.read(path)
    size = top.get("size", list, [128, 128])
    if len(size) != 2 or not all(isinstance(n, int) and n > 0 for n in size):
        raise UserError(f"{top.where('size')}: size is [width, height]")
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
        same_area=top.get("same_area", bool, False),
        sample=top.get("sample", float, None),
        knobs=tuple(_knob(table) for table in top.tables("knob")),
        factorials=tuple(_factorial(table) for table in top.tables("factorial")),
        search=_search(top.table("search")),
    )
    if only_scenes:
        top.get("scenes", list, [])
    top.reject_unknown()
    return experiment


def _knob(table: Table) -> Knob:
    knob = Knob(
        table.get("unit", str, "a2rt"),
        table.get("key", str),
        tuple(table.get("values", list)),
        table.get("default", (int, float, str, bool)),
        table.get("title", str),
        tuple(table.get("labels", list, [])),
        table.get("order", str, ""),
    )
    table.reject_unknown()
    if knob.order not in ("", "finer", "coarser"):
        raise UserError(f"{table.where('order')}: {knob.key}: order is finer or coarser")
    if knob.labels and len(knob.labels) != len(knob.values):
        raise UserError(f"{table.where('labels')}: {knob.key}: one label for each value")
    if knob.default not in knob.values:
        raise UserError(f"{table.where('default')}: {knob.key}: the default is not in values")
    return knob


def _factorial(table: Table) -> Factorial:
    title, unit = table.get("title", str), table.get("unit", str, "a2rt")
    return Factorial(title, unit, _space(table))


def _space(table: Table) -> dict[str, tuple[Any, ...]]:
    """Parameter -> values; dotted keys are quoted in the file."""
    out = {}
    for key, values in table.rest().items():
        if not isinstance(values, list) or not values:
            raise UserError(f"{table.where(key)}: {key} needs a list of values")
        out[key] = tuple(values)
    return out


def _search(table: Table | None) -> Search | None:
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
