"""Experiment files (lumibench_configs/experiments/*.toml): which runs a figure or sweep needs.

A key that nothing reads is an error that names file and line, so that a misspelt one costs seconds.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from a2rt_cli import console
from a2rt_cli.comparison import Item
from a2rt_cli.config_table import Table
from a2rt_cli.engine import core, scenes
from a2rt_cli.engine.renderer import RenderOptions
from a2rt_cli.engine.runs import DEFAULT_AUDIT, RunSpec, with_same_area
from a2rt_cli.errors import UserError
from a2rt_cli.paths import CONFIGS, shown

FOLDER = CONFIGS / "experiments"
UNITS = ["baseline", "aqb8", "a2rt"]


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
    place: str = ""  # file:line:column of its key

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
        raise UserError(
            f"{text}: no such experiment",
            f"write {shown(FOLDER)}/{Path(text).stem}.toml, name another file, or one of: {names}",
        )
    return path


def load(path: Path, only_scenes: Sequence[str] | None = None) -> Experiment:
    top = Table.read(path)
    size = top.get("size", list, [128, 128])
    if len(size) != 2 or not all(isinstance(n, int) and n > 0 for n in size):
        raise UserError(f"{top.where('size')}: size is [width, height]", "for example [128, 128]")
    named = top.get("scenes", list, [] if only_scenes else ...)
    for scene in named if only_scenes is None else ():
        _check(top, "scenes", scene, scenes.find)
    workloads = top.get("workloads", list, ["auto"])
    for workload in workloads:
        top.known("workloads", workload, ["auto", *core.config_names("workloads")], "workload")
    experiment = Experiment(
        file=path,
        title=top.get("title", str),
        scenes=tuple(only_scenes or named),
        workloads=tuple(workloads),
        size=(size[0], size[1]),
        spp=top.get("spp", int, None),
        units=tuple(_unit(top, "units", unit) for unit in top.get("units", list, UNITS)),
        gpu=_gpu(top),
        audit=top.get("audit", int, DEFAULT_AUDIT),
        pictures=top.get("pictures", bool, False),
        same_area=top.get("same_area", bool, False),
        sample=top.get("sample", float, None),
        knobs=tuple(_knob(table) for table in top.tables("knob")),
        factorials=tuple(_factorial(table) for table in top.tables("factorial")),
        search=_search(top.table("search")),
    )
    top.reject_unknown()
    return experiment


def _check(table: Table, key: str, name: str, find: Callable[[str], object]) -> str:
    """`name`, which stands under `key`, if `find` knows it; what it says of another, in place."""
    if not isinstance(name, str):
        raise UserError(f"{table.where(key)}: {name!r} is no name", "write names in quotes")
    try:
        find(name)
    except UserError as error:
        raise UserError(f"{table.where(key, name)}: {key}: {error}", error.remedy) from error
    return name


def _unit(table: Table, key: str, name: str) -> str:
    return _check(table, key, name, lambda unit: core.config_file("units", unit))


def _gpu(table: Table) -> str | None:
    name = table.get("gpu", str, None)
    if name is None:
        return None
    return _check(table, "gpu", name, lambda gpu: core.config_file("gpus", gpu))


def _knob(table: Table) -> Knob:
    knob = Knob(
        _unit(table, "unit", table.get("unit", str, "a2rt")),
        table.get("key", str),
        tuple(table.get("values", list)),
        table.get("default", (int, float, str, bool)),
        table.get("title", str),
        tuple(table.get("labels", list, [])),
        table.get("order", str, ""),
        table.where("key"),
    )
    table.reject_unknown()
    if knob.order not in ("", "finer", "coarser"):
        raise UserError(
            f"{table.where('order')}: {knob.key}: order is {knob.order!r}",
            "write finer or coarser, or leave it out",
        )
    if knob.labels and len(knob.labels) != len(knob.values):
        raise UserError(
            f"{table.where('labels')}: {knob.key}: {len(knob.labels)} labels for "
            f"{len(knob.values)} values",
            "give one label for each value",
        )
    if knob.default not in knob.values:
        raise UserError(
            f"{table.where('default')}: {knob.key}: the default is not in values",
            "add the unit's own value to them: steps are counted from it",
        )
    return knob


def _factorial(table: Table) -> Factorial:
    title, unit = table.get("title", str), table.get("unit", str, "a2rt")
    return Factorial(title, _unit(table, "unit", unit), _space(table))


def _space(table: Table) -> dict[str, tuple[Any, ...]]:
    """Parameter -> values; dotted keys are quoted in the file."""
    out = {}
    for key, values in table.rest().items():
        if not isinstance(values, list) or not values:
            raise UserError(
                f"{table.where(key)}: {key} needs a list of values", f'write "{key}" = [1, 2]'
            )
        out[key] = tuple(values)
    return out


def _search(table: Table | None) -> Search | None:
    if table is None:
        return None
    space = table.table("space")
    if space is None:
        raise UserError(
            f"{table.where('minimise')}: search.space is missing",
            "add [search.space] with lists of values",
        )
    found = Search(
        _unit(table, "unit", table.get("unit", str, "a2rt")),
        _space(space),
        table.get("most_lost_hits", int, 0),
        table.get("most_extra_redundant", (int, float), 0.01),
        table.get("minimise", str),
    )
    table.reject_unknown()
    return found
