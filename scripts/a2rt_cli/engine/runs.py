"""One unit on one workload: computed once, found again by the hash of all that decides it."""

from __future__ import annotations

import json
import shutil
import tempfile
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from a2rt_cli.engine import core, pictures, programs, verdict_loop
from a2rt_cli.engine.capture import Captured
from a2rt_cli.files import hash_file, hash_values, replacing, write_json
from a2rt_cli.process import ProgramFailed

SCHEMA_VERSION = 1
# Rays compared with exact arithmetic per run unless asked otherwise; spread over the whole frame.
DEFAULT_AUDIT = 20_000


@dataclass(frozen=True)
class RunSpec:
    """All that decides a result, besides the workload."""

    unit: str
    gpu: str | None = None  # None: no timing
    overrides: tuple[str, ...] = ()
    audit: int = DEFAULT_AUDIT
    picture: bool = True
    max_passes: int = verdict_loop.DEFAULT_PASSES
    extra: tuple[str, ...] = field(default=())
    # True: a unit that the machine cannot time keeps its other results, and the report says so.
    time_optional: bool = False

    def label(self) -> str:
        unit = Path(self.unit).stem if self.unit.endswith(".toml") else self.unit
        return unit + "".join(f" {override}" for override in self.overrides)


def run_key(captured: Captured, spec: RunSpec) -> str:
    """Names the inputs, not the file they came from: equal inputs share one result."""
    unit = hash_values(
        [hash_file(path) for path in _with_parents(core.config_file("units", spec.unit))]
    )
    gpu = None
    if spec.gpu is not None:
        paths = _with_parents(core.config_file("gpus", spec.gpu))
        gpu = hash_values([hash_file(path) for path in paths])
    rest = [list(spec.overrides), spec.audit, spec.picture, spec.max_passes, list(spec.extra)]
    rest.append(spec.time_optional)
    return hash_values(captured.key, unit, gpu, rest, programs.core_key())


def _with_parents(path: Path) -> list[Path]:
    """A configuration and those it inherits from: an edit of a parent is an edit of it."""
    import tomllib

    chain = [path]
    while True:
        try:
            inherits = tomllib.loads(chain[-1].read_text(encoding="utf-8")).get("inherits")
        except tomllib.TOMLDecodeError:
            return chain  # a2rt-core reports it with its place
        if not isinstance(inherits, str):
            return chain
        parent = chain[-1].parent / (inherits if inherits.endswith(".toml") else f"{inherits}.toml")
        if not parent.is_file() or parent in chain:
            return chain
        chain.append(parent)


def load_finished(target: Path) -> dict[str, Any] | None:
    try:
        return json.loads(target.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None


def merge(functional: dict[str, Any], timed: dict[str, Any] | None) -> dict[str, Any]:
    """One result object out of a trace and, if there is one, a simulation of the same run."""
    merged = dict(functional)
    merged.setdefault("gpu", None)
    if timed is not None:
        for key in ("gpu", "time", "energy"):
            merged[key] = timed.get(key)
        memory = dict(merged.get("memory") or {})
        memory.update(timed.get("memory") or {})
        # What the unit asks for is counted by the functional run; the model may add its own kinds.
        by_kind = dict((timed.get("memory") or {}).get("by_kind") or {})
        by_kind.update((functional.get("memory") or {}).get("by_kind") or {})
        memory["by_kind"] = by_kind
        merged["memory"] = memory
        merged["config"] = {**(timed.get("config") or {}), **(functional.get("config") or {})}
        for key, value in timed.items():
            merged.setdefault(key, value)
    merged["schema"] = SCHEMA_VERSION
    return merged


def execute(captured: Captured, spec: RunSpec, target: Path, pictures_to: Path) -> dict[str, Any]:
    """Runs `spec` and writes its result to `target`, whole or not at all."""
    drawn = spec.picture and captured.picture is not None
    target.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=".run-", dir=target.parent) as folder:
        scratch = Path(folder)
        verdicts = scratch / "first.a2rv" if drawn else None
        functional = core.trace(
            captured.file,
            spec.unit,
            scratch / "trace.json",
            overrides=spec.overrides,
            audit=spec.audit,
            verdicts=verdicts,
        )
        timed, untimed = _simulate(captured, spec, scratch)
        result = merge(functional, timed)
        if untimed:
            result["time_missing"] = untimed
        if verdicts is not None:
            first = verdict_loop.of_trace(functional, verdicts)
            stem = f"{captured.name}.{target.stem}"
            result["picture"] = _draw(captured, spec, first, pictures_to, stem)
    workload = result.setdefault("workload", {})
    workload["name"] = captured.name
    if captured.options is not None:
        workload["options"] = captured.options.as_dict()
    result.setdefault("provenance", {})["workload_key"] = captured.key
    result["label"] = spec.label()
    write_json(target, result)
    return result


def _simulate(
    captured: Captured, spec: RunSpec, scratch: Path
) -> tuple[dict[str, Any] | None, str]:
    """The timed result, or None and why there is none."""
    if spec.gpu is None:
        return None, ""
    try:
        timed = core.simulate(
            captured.file,
            spec.unit,
            spec.gpu,
            scratch / "time.json",
            overrides=spec.overrides,
            extra=spec.extra,
        )
    except ProgramFailed as error:
        if not spec.time_optional:
            raise
        return None, " ".join([str(error), *error.tail])
    return timed, ""


def driver_picture(captured: Captured, folder: Path) -> Path:
    """The driver's picture among the results; its name is known to the report."""
    target = folder / f"{captured.name}.driver.png"
    assert captured.picture is not None
    with replacing(target) as temporary:
        shutil.copyfile(captured.picture, temporary)
    return target


def _draw(
    captured: Captured, spec: RunSpec, first: verdict_loop.Verdicts, folder: Path, stem: str
) -> dict[str, Any]:
    """What the unit would draw. A unit that changes no ray draws the driver's picture."""
    driver = driver_picture(captured, folder)
    if first.entries == 0:
        same = pictures.compare(driver, driver)
        outcome = verdict_loop.Outcome(1, True, 0)
        return {"file": f"{folder.name}/{driver.name}", **asdict(outcome), **same.as_dict()}
    target, difference = folder / f"{stem}.png", folder / f"{stem}.difference.png"
    outcome = verdict_loop.draw(
        captured,
        spec.unit,
        target,
        first=first,
        overrides=spec.overrides,
        max_passes=spec.max_passes,
    )
    measured = pictures.compare(driver, target)
    pictures.draw_difference(driver, target, difference)
    return {
        "file": f"{folder.name}/{target.name}",
        "difference": f"{folder.name}/{difference.name}",
        **asdict(outcome),
        **measured.as_dict(),
    }
