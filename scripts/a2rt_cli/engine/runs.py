"""One unit on one workload: computed once, found again by the hash of all that decides it."""

from __future__ import annotations

import json
import shutil
import tempfile
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

from a2rt_cli.engine import core, keys, pictures, programs, verdict_loop
from a2rt_cli.engine.capture import Captured
from a2rt_cli.files import hash_values, replacing, write_json
from a2rt_cli.process import ProgramFailed
from a2rt_cli.results import AREA_MARK, SAME_AREA, SAME_COUNT

SCHEMA_VERSION = 1
# Rays compared with exact arithmetic per run unless asked otherwise; spread over the whole frame.
DEFAULT_AUDIT = 20_000
HEATMAP = "heatmap.npy"
# Parameters of the machine; all others are the unit's. As a2rt_core/tools/gpu_option.cpp has them.
MACHINE_KEYS = ("sm.", "l1.", "l2.", "dram.", "rt.")
MACHINE_KEYS += ("core_mhz=", "model=", "shader_memory=", "watchdog_cycles=")


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
    # Testers of the simulated unit: as many as A2RT's engine has, or as many as fit its area.
    comparison: str = SAME_COUNT
    sample: float | None = None  # share of the warps to simulate; None: all
    check_sample: bool = False  # also simulate all warps and report the sample's error
    heatmap: bool = False  # keep the cycles of every pixel
    functional: bool = True  # False: time and energy only, accuracy is another run's

    def label(self) -> str:
        unit = Path(self.unit).stem if self.unit.endswith(".toml") else self.unit
        words = unit + "".join(f" {override}" for override in self.unit_overrides())
        return words + (AREA_MARK if self.comparison == SAME_AREA else "")

    def unit_overrides(self) -> tuple[str, ...]:
        return tuple(one for one in self.overrides if not one.startswith(MACHINE_KEYS))

    def machine_overrides(self) -> tuple[str, ...]:
        return tuple(one for one in self.overrides if one.startswith(MACHINE_KEYS))

    def is_yardstick(self) -> bool:
        """Whether this is the unit a2rt as configured, whose area the same-area runs fill."""
        return self.unit == "a2rt" and self.overrides == self.machine_overrides()

    def timing_words(self) -> list[str]:
        """Options of `a2rt-core simulate`."""
        words = ["--compare-counts", self.comparison, *self.extra]
        if self.sample is not None:
            words += ["--sample", str(self.sample)]
            words += ["--sample-check"] if self.check_sample else []
        return words


def with_same_area(specs: Sequence[RunSpec]) -> list[RunSpec]:
    """`specs`, and each timed one once more with the testers that fit into A2RT's area.

    The unit a2rt as configured is the yardstick of that area: its run counts in both comparisons.
    """
    second = [
        replace(spec, comparison=SAME_AREA, functional=False, picture=False, audit=0)
        for spec in specs
        if spec.gpu is not None and not spec.is_yardstick()
    ]
    return [*specs, *second]


def run_key(captured: Captured, spec: RunSpec) -> str:
    """Names the inputs, not the file they came from: equal inputs share one result."""
    unit = keys.of_unit(spec.unit)
    gpu = None if spec.gpu is None else keys.of_gpu(spec.gpu)
    rest = [list(spec.overrides), spec.audit, spec.picture, spec.max_passes, list(spec.extra)]
    rest += [spec.time_optional, spec.functional, spec.heatmap, spec.timing_words()]
    return hash_values(captured.key, unit, gpu, rest, programs.core_key())


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
    drawn = spec.picture and spec.functional and captured.picture is not None
    target.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=".run-", dir=target.parent) as folder:
        scratch = Path(folder)
        verdicts = scratch / "first.a2rv" if drawn else None
        functional: dict[str, Any] = {}
        if spec.functional:
            functional = core.trace(
                captured.file,
                spec.unit,
                scratch / "trace.json",
                overrides=spec.unit_overrides(),
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
        if spec.heatmap and (scratch / HEATMAP).is_file():
            (scratch / HEATMAP).replace(heatmap_file(target))
    _describe(result, captured, spec)
    write_json(target, result)
    return result


def _describe(result: dict[str, Any], captured: Captured, spec: RunSpec) -> None:
    """What the engines do not know: the workload's name, what stands in, the key of the inputs."""
    workload = result.setdefault("workload", {})
    workload["name"] = captured.name
    if captured.options is not None:
        workload["options"] = captured.options.as_dict()
    if captured.scene is not None and captured.scene.note:
        workload["note"] = captured.scene.note
    result.setdefault("provenance", {})["workload_key"] = captured.key
    result.pop("heatmap", None)  # the engine's temporary name of it
    result["label"] = spec.label()
    if isinstance(result.get("gpu"), dict):
        result["gpu"]["changes"] = list(spec.machine_overrides())
    result["functional"] = spec.functional


def heatmap_file(target: Path) -> Path:
    """Cycles per pixel of the run whose result is `target`: a NumPy array (height, width)."""
    return target.with_suffix(".npy")


def _simulate(
    captured: Captured, spec: RunSpec, scratch: Path
) -> tuple[dict[str, Any] | None, str]:
    """The timed result, or None and why there is none."""
    if spec.gpu is None:
        return None, ""
    words = spec.timing_words()
    if spec.heatmap:
        words += ["--heatmap", str(scratch / HEATMAP)]
    try:
        timed = core.simulate(
            captured.file,
            spec.unit,
            spec.gpu,
            scratch / "time.json",
            overrides=spec.overrides,
            extra=words,
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
        overrides=spec.unit_overrides(),
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
