"""What a scene saves by not needing every effect: the same picture with --effects auto and all.

Both are drawn from a cold shader cache, captured and simulated. Seconds are processor seconds of
the programs, which other work on the machine does not lengthen.
"""

from __future__ import annotations

import filecmp
import resource
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

from a2rt_cli import console
from a2rt_cli.engine import core, renderer
from a2rt_cli.engine.renderer import RenderOptions
from a2rt_cli.engine.scenes import Scene
from a2rt_cli.files import read_json

MODES = ("auto", "all")
# The first frame of a cold program compiles its shaders, the second does not.
_FRAMES = 2
_COLD = {"MESA_SHADER_CACHE_DISABLE": "true"}
# Simulations of a small workload take a fraction of a second: the least of a few is kept.
_SIMULATIONS = 3
# What a workload file says about the pipeline and the machine, not about rays.
_NOT_RAYS = ("shaders", "driver_nodes")
# Parts of a simulation's result that must not depend on the parts instantiated.
_RESULT = ("time", "memory", "events", "energy")


def measure(
    scene: Scene, options: RenderOptions, unit: str, gpu: str, beside: Path
) -> dict[str, Any]:
    """One row of the table; `beside` is where the scratch folder goes."""
    core.check_unit(unit)
    core.check_gpu(gpu)
    with renderer.scratch(beside) as scratch, console.step(f"{scene.name}: auto and all") as shown:
        sides = {}
        for count, mode in enumerate(MODES):
            shown.update(count / 2, f"capturing with --effects {mode}")
            sides[mode] = _capture(scene, replace(options, effects=mode), scratch / mode)
        shown.update(0.8, "simulating")
        simulated = _simulate(scratch, unit, gpu)
        for mode in MODES:
            sides[mode] |= simulated[mode]
        return {
            "scene": scene.name,
            "workload": sides["auto"].pop("workload"),
            "size": [options.width, options.height],
            "frames": _FRAMES,
            "unit": unit,
            "gpu": gpu,
            "not_needed": sides["auto"].pop("not_needed"),
            "left_out_parts": sides["auto"].pop("left_out_parts"),
            "pictures_identical": filecmp.cmp(
                scratch / "auto" / "picture.png", scratch / "all" / "picture.png", shallow=False
            ),
            "rays_differ_in": _differences(scratch / "auto" / "w.h5", scratch / "all" / "w.h5"),
            "results_differ_in": _result_differences(scratch),
            **{mode: _plain(sides[mode]) for mode in MODES},
        }


def _plain(side: dict[str, Any]) -> dict[str, Any]:
    return {k: v for k, v in side.items() if k not in ("workload", "not_needed", "left_out_parts")}


def _cpu_seconds() -> float:
    """Of the programs that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _capture(scene: Scene, options: RenderOptions, folder: Path) -> dict[str, Any]:
    raw, numbers = folder / "raw", folder / "statistics.json"
    raw.mkdir(parents=True)
    extra = ["--frames", str(_FRAMES), "--json", str(numbers)]
    before = _cpu_seconds()
    renderer.render(
        scene, options, folder / "picture.png", capture=raw, extra=extra, environment=_COLD
    )
    seconds = _cpu_seconds() - before
    captured = sum(file.stat().st_size for file in raw.rglob("*") if file.is_file())
    said = read_json(numbers)
    core.import_capture(raw, folder / "w.h5", scene=scene.name, workload=said["workload"]["name"])
    shutil.rmtree(raw)
    first, second = said["seconds"]["frames_cpu"][:2]
    return {
        "workload": said["workload"]["name"],
        "not_needed": [name for name, e in said["effects"].items() if not e["needed"]],
        "stages": said["pipeline"]["stages"],
        "compile_seconds": said["seconds"]["pipeline_cpu"] + max(0.0, first - second),
        "capture_seconds": seconds,
        "capture_bytes": captured,
    }


def _simulate(scratch: Path, unit: str, gpu: str) -> dict[str, dict[str, Any]]:
    """Simulations of both sides in turn, so that a busy moment of the machine meets both."""
    seconds: dict[str, list[float]] = {mode: [] for mode in MODES}
    out: dict[str, dict[str, Any]] = {}
    for _ in range(_SIMULATIONS):
        for mode in MODES:
            target = scratch / f"{mode}.json"
            before = _cpu_seconds()
            result = core.simulate(
                scratch / mode / "w.h5", unit, gpu, target, extra=["--parts", mode]
            )
            seconds[mode].append(_cpu_seconds() - before)
            parts = result["parts"]
            out[mode] = {
                "rays": result["workload"]["rays"],
                "cycles": result["time"]["cycles"],
                "parts": [p["part"] for p in parts if p["instantiated"]],
                "left_out_parts": [p["part"] for p in parts if not p["instantiated"]],
            }
    for mode in MODES:
        out[mode]["simulate_seconds"] = min(seconds[mode])
    return out


def _differences(one: Path, other: Path) -> list[str]:
    """Datasets of two workload files that differ, but for the stages and the driver's pointers."""
    import h5py
    import numpy as np

    def datasets(file: Any) -> dict[str, Any]:
        found: dict[str, Any] = {}
        file.visititems(
            lambda name, item: found.update({name: item}) if isinstance(item, h5py.Dataset) else 0
        )
        return {k: v for k, v in found.items() if not k.endswith(_NOT_RAYS)}

    with h5py.File(one) as a, h5py.File(other) as b:
        left, right = datasets(a), datasets(b)
        differ = set(left) ^ set(right)
        for name in set(left) & set(right):
            if not np.array_equal(left[name][()], right[name][()]):
                differ.add(name)
    return sorted(differ)


def _result_differences(scratch: Path) -> list[str]:
    from a2rt_cli.results import flatten

    sides = [read_json(scratch / f"{mode}.json") for mode in MODES]
    left, right = ({k: s.get(k) for k in _RESULT} for s in sides)
    if left == right:
        return []
    a, b = flatten(left), flatten(right)
    return sorted(k for k in {**a, **b} if a.get(k) != b.get(k)) or ["a list of numbers"]
