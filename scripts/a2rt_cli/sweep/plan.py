"""An experiment as captures and points; the workflow's jobs and the report read the same plan."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from a2rt_cli import comparison, experiment, results
from a2rt_cli.engine import capture, core, runs, scenes
from a2rt_cli.engine.capture import Captured
from a2rt_cli.engine.renderer import RenderOptions
from a2rt_cli.engine.runs import RunSpec
from a2rt_cli.errors import UserError
from a2rt_cli.experiment import Experiment, Factorial
from a2rt_cli.files import hash_values, read_json, write_json, write_text
from a2rt_cli.process import ProgramFailed

find = experiment.find
load = experiment.load


@dataclass(frozen=True)
class Point:
    """One run of the sweep. `role` says why it is there; a point may serve several knobs.

    The name holds a hash of all that decides the result, so that a finished point is never taken
    for one of another size, scene, configuration or build.
    """

    name: str
    capture: str
    spec: RunSpec
    roles: tuple[str, ...]  # "unit", "knob:UNIT.KEY", "factorial:TITLE"


# Points that one job of the workflow runs one after another: a job costs a second or two by itself,
# much of a point; and a cluster would be flooded by jobs of seconds.
BATCH = 12


@dataclass(frozen=True)
class Plan:
    title: str
    captures: dict[str, dict[str, Any]]  # by a name that holds a hash, as a point's does
    points: list[Point]

    def batches(self) -> dict[str, list[Point]]:
        """Points by the job that runs them. All of a job share a capture; the name says which."""
        out = {}
        for drawn in self.captures:
            members = [point for point in self.points if point.capture == drawn]
            for start in range(0, len(members), BATCH):
                batch = members[start : start + BATCH]
                key = hash_values([point.name for point in batch])[:12]
                out[f"{drawn}.{key}"] = batch
        return out


# Of a sweep's folder: the experiment as it was run, for its page.
EXPERIMENT = "experiment.toml"


def toml_text(value: Any) -> str:
    """A value as `--set` takes it."""
    if isinstance(value, bool):
        return "true" if value else "false"
    return f'"{value}"' if isinstance(value, str) else repr(value)


def override(key: str, value: Any) -> str:
    return f"{key}={toml_text(value)}"


def _specs(one: Experiment) -> dict[RunSpec, list[str]]:
    """Every configuration with the reasons for it; equal ones are run once."""
    found: dict[RunSpec, list[str]] = {}

    def add(spec: RunSpec, role: str) -> None:
        found.setdefault(spec, []).append(role)

    for spec in one.specs():
        add(spec, "unit")
    for knob in one.knobs:
        for value in knob.values:
            # The default is the unit as configured, so that all knobs share that one run.
            changes = () if value == knob.default else (override(knob.key, value),)
            add(_spec(one, knob.unit, changes), f"knob:{knob.unit}.{knob.key}")
    for factorial in one.factorials:
        for changes in combinations(one, factorial):
            add(_spec(one, factorial.unit, changes), f"factorial:{factorial.title}")
    return found


def combinations(one: Experiment, factorial: Factorial) -> dict[tuple[str, ...], dict[str, Any]]:
    """The overrides of every combination -> its values; a unit's own value is not overridden."""
    out = {}
    for values in itertools.product(*factorial.space.values()):
        chosen = dict(zip(factorial.space, values, strict=True))
        changes = [
            override(key, value)
            for key, value in chosen.items()
            if value != _default(one, factorial.unit, key)
        ]
        out[tuple(changes)] = chosen
    return out


def _default(one: Experiment, unit: str, key: str) -> Any:
    """The unit's own value of a key, if a knob of the experiment states it."""
    for knob in one.knobs:
        if knob.unit == unit and knob.key == key:
            return knob.default
    return None


def _spec(one: Experiment, unit: str, overrides: Sequence[str]) -> RunSpec:
    return RunSpec(unit, one.gpu, tuple(overrides), one.audit, one.pictures)


def make(one: Experiment) -> Plan:
    check(one)
    captures, points = {}, []
    for item in one.items():
        key = capture.key_of(scenes.find(item.text), item.options)
        name = f"{item.name}.{key[:12]}"
        captures[name] = {
            "name": item.name,
            "scene": item.text,
            "options": item.options.as_dict(),
        }
        drawn = Captured(item.name, Path(), key)  # by its hash; it need not be there yet
        for spec, roles in _specs(one).items():
            run = runs.run_key(drawn, spec)[:12]
            unit = Path(spec.unit).stem
            points.append(Point(f"{item.name}.{unit}.{run}", name, spec, tuple(roles)))
    return Plan(one.title, captures, points)


def check(one: Experiment) -> None:
    """Refuses a parameter that its unit does not read, or a value that it does not take."""
    for knob in one.knobs:
        for value in knob.values:
            spec = _spec(one, knob.unit, (override(knob.key, value),))
            try:
                core.check_unit(spec.unit, spec.unit_overrides())
                if spec.gpu is not None:
                    core.check_gpu(spec.gpu, spec.machine_overrides())
            except ProgramFailed as error:
                raise UserError(
                    f"{knob.place}: {' '.join(error.tail)}",
                    f"`a2rt-core units {knob.unit}` lists the parameters of the unit",
                ) from error


def write(one: Experiment, out: Path) -> Plan:
    """Writes OUT/plan.json. A changed experiment makes a new plan; finished points stay."""
    planned = make(one)
    batches = {
        name: {"capture": points[0].capture, "points": [point.name for point in points]}
        for name, points in planned.batches().items()
    }
    write_text(out / EXPERIMENT, one.file.read_text(encoding="utf-8"))
    write_json(out / "plan.json", {**asdict(planned), "batches": batches})
    return planned


def is_sweep(folder: Path) -> bool:
    return (folder / "plan.json").is_file()


def kept_experiment(folder: Path) -> Experiment:
    """The experiment whose points are in a sweep's folder."""
    kept = folder / EXPERIMENT
    if not kept.is_file():
        raise UserError(
            f"{folder}: a sweep without its {EXPERIMENT}",
            "run the same sweep again; its finished points are kept",
        )
    return load(kept)


def unfinished(plan: Plan, out: Path) -> list[Point]:
    return [point for point in plan.points if not point_file(out, point).is_file()]


def point_file(out: Path, point: Point) -> Path:
    return out / "points" / f"{point.name}.json"


def read(path: Path) -> Plan:
    value = read_json(path)
    points = [
        Point(
            point["name"],
            point["capture"],
            RunSpec(
                **{
                    **point["spec"],
                    "overrides": tuple(point["spec"]["overrides"]),
                    "extra": tuple(point["spec"]["extra"]),
                }
            ),
            tuple(point["roles"]),
        )
        for point in value["points"]
    ]
    return Plan(value["title"], value["captures"], points)


def capture_item(plan: Plan, name: str) -> tuple[str, scenes.Scene, RenderOptions]:
    """What results call it, and what to draw."""
    entry = plan.captures[name]
    return entry["name"], scenes.find(entry["scene"]), RenderOptions(**entry["options"])


def collect(plan: Plan, out: Path, command: str) -> list[dict[str, Any]]:
    """Writes results.json and results.csv from the finished points."""
    found = []
    for point in plan.points:
        path = point_file(out, point)
        if not path.is_file():
            raise UserError(f"{path}: this point did not finish", "run the sweep again")
        result = read_json(path)
        result["roles"] = list(point.roles)
        result["overrides"] = list(point.spec.overrides)
        result["provenance"]["a2rt"] = command
        found.append(result)
    write_json(out / "results.json", found)
    write_text(out / "results.csv", comparison.to_csv(found))
    return results.load(out)
