"""What `a2rt bench` measures: ratios of two things timed in the same run, and simulated rays/s."""

from __future__ import annotations

import os
import platform
import statistics
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from a2rt_cli import console, formats
from a2rt_cli.engine import capture, core, renderer
from a2rt_cli.engine.renderer import RenderOptions
from a2rt_cli.engine.scenes import Scene
from a2rt_cli.files import read_json

# Simulations of each unit; the fastest counts, as the others were disturbed.
REPEATS = 3
# What the project asks of itself on a machine of two cores.
LIMITS: dict[str, Any] = {
    "overhead": 2.5,
    "units": {"baseline": 0.35, "a2rt": 0.2},
    "build_percent": 25.0,
    "build_bytes": 400.0,
    "simulation": 150_000.0,
}
# LumiBench's standard run; the size of all but the overhead's measurements.
PATH_TRACING = RenderOptions("pt", 128, 128, 2)


def machine() -> dict[str, Any]:
    text = Path("/proc/cpuinfo").read_text(encoding="utf-8")
    model = next((line for line in text.splitlines() if line.startswith("model name")), ":?")
    return {
        "cpu": model.split(":", 1)[1].strip(),
        "cores": os.cpu_count(),
        "load": os.getloadavg()[0],
        "kernel": platform.release(),
    }


def _frame_seconds(
    scene: Scene, options: RenderOptions, scratch: Path, frames: int, captured: bool
) -> float:
    """Median frame time of one run of the program, as the program itself reports it."""
    raw, numbers = scratch / "raw", scratch / "statistics.json"
    raw.mkdir(exist_ok=True)
    renderer.render(
        scene,
        options,
        scratch / "picture.png",
        capture=raw if captured else None,
        extra=["--timing", str(frames), "--json", str(numbers)],
    )
    for file in raw.glob("*"):
        file.unlink()
    return float(read_json(numbers)["seconds"]["median_frame"])


def layer_overhead(
    scenes: Sequence[Scene], size: tuple[int, int], pairs: int, frames: int, beside: Path
) -> list[dict[str, Any]]:
    """The layer with full capture against the same layer without; alternating, so that a busy
    machine slows both. The median of `frames` frames is one measurement."""
    rows = []
    for scene in scenes:
        options = RenderOptions(width=size[0], height=size[1], spp=1)
        ratios, plain, full = [], [], []
        with (
            console.step(f"Layer overhead on {scene.name}") as shown,
            renderer.scratch(beside) as scratch,
        ):
            for index in range(pairs):
                plain.append(_frame_seconds(scene, options, scratch, frames, captured=False))
                full.append(_frame_seconds(scene, options, scratch, frames, captured=True))
                ratios.append(full[-1] / plain[-1])
                shown.update((index + 1) / pairs)
        rows.append(
            {
                "scene": scene.name,
                "size": list(size),
                "pairs": pairs,
                "frames": frames,
                "seconds_without_capture": statistics.median(plain),
                "seconds_with_capture": statistics.median(full),
                "ratio": statistics.median(ratios),
                "ratio_low": min(ratios),
                "ratio_high": max(ratios),
            }
        )
    return rows


def unit_rates(scenes: Sequence[Scene], cache: Path) -> list[dict[str, Any]]:
    """Rays a second of every unit and of Embree, one thread, same rays."""
    rows = []
    for scene in scenes:
        with console.step(f"Unit rates on {scene.name}") as shown:
            captured = capture.from_scene(scene, PATH_TRACING, cache, shown=shown)
            with renderer.scratch(cache) as scratch:
                found = core.bench_units(captured.file, scratch / "bench.json", shown=shown)
        rows.append({"scene": scene.name, **found})
    return rows


def build_cost(scenes: Sequence[Scene], cache: Path) -> list[dict[str, Any]]:
    """What A²RT's classification and encoding add to Embree's build, in time and memory.

    The memory is what the process grows by while the tree is built, Embree's own included.
    """
    rows = []
    for scene in scenes:
        with console.step(f"Build of {scene.name}") as shown:
            captured = capture.from_scene(scene, PATH_TRACING, cache, shown=shown)
            with renderer.scratch(cache) as scratch:
                target = scratch / "bench.json"
                found = core.bench_units(captured.file, target, units=["a2rt"], shown=shown)
        (unit,) = found["units"]
        added = unit["classify_seconds"] + unit["encode_seconds"]
        rows.append(
            {
                "scene": scene.name,
                "primitives": found["primitives"],
                "embree_seconds": unit["build_seconds"],
                "added_seconds": added,
                "added_share": added / unit["build_seconds"],
                "peak_bytes": unit["build_peak_bytes"],
                "bytes_per_primitive": unit["build_peak_bytes_per_primitive"],
            }
        )
    return rows


def simulation_rates(
    scenes: Sequence[Scene], units: Sequence[str], repeats: int, cache: Path
) -> list[dict[str, Any]]:
    """Simulated rays a second of every unit: one thread, its processor time."""
    rows = []
    for scene in scenes:
        with console.step(f"Simulated rays on {scene.name}") as shown:
            captured = capture.from_scene(scene, PATH_TRACING, cache, shown=shown)
            with renderer.scratch(cache) as scratch:
                target = scratch / "bench.json"
                found = core.bench_simulate(
                    captured.file, target, units=units, repeats=repeats, shown=shown
                )
        rows += [{"scene": scene.name, **unit} for unit in found]
    return rows


def _verdict(value: float, limit: float | None, at_most: bool) -> tuple[str, str]:
    """The limit as text, and whether the value keeps it. A limit is shown, never asserted."""
    if limit is None:
        return formats.NOTHING, ""
    kept = value <= limit if at_most else value >= limit
    text = f"{limit:,.0f}" if limit >= 100 else f"{limit:g}"
    return f"{'≤' if at_most else '≥'} {text}", "kept" if kept else "NOT kept"


def print_overhead(rows: Sequence[dict[str, Any]]) -> None:
    console.heading("Layer with full capture against the layer without (median of pairs)")
    columns = ("scene", "without", "with", "ratio", "lowest", "highest", "limit", "")
    cells = [
        (
            row["scene"],
            f"{row['seconds_without_capture'] * 1000:.0f} ms",
            f"{row['seconds_with_capture'] * 1000:.0f} ms",
            formats.factor(row["ratio"]),
            formats.factor(row["ratio_low"]),
            formats.factor(row["ratio_high"]),
            *_verdict(row["ratio"], LIMITS["overhead"], True),
        )
        for row in rows
    ]
    print(console.table(columns, cells))


def print_units(rows: Sequence[dict[str, Any]]) -> None:
    console.heading("Functional rays a second against Embree (rtcIntersect1, robust), one thread")
    cells = []
    for row in rows:
        embree = formats.count(row.get("embree_rays_per_second"))
        cells.append((row["scene"], "Embree", embree, formats.factor(1.0), formats.NOTHING, ""))
        for unit in row.get("units", []):
            share = unit["ratio_to_embree"]
            cells.append(
                (
                    row["scene"],
                    unit["unit"],
                    formats.count(unit["rays_per_second"]),
                    formats.factor(share),
                    *_verdict(share, LIMITS["units"].get(unit["unit"]), False),
                )
            )
    columns = ("scene", "unit", "rays/s", "of Embree", "limit", "")
    print(console.table(columns, cells, left=2))


def print_build(rows: Sequence[dict[str, Any]]) -> None:
    console.heading("A²RT's classification and encoding on top of Embree's build")
    columns = ("scene", "primitives", "Embree", "added", "share", "limit", "", "bytes each")
    cells = []
    for row in rows:
        share = _verdict(row["added_share"] * 100, LIMITS["build_percent"], True)
        each = _verdict(row["bytes_per_primitive"], LIMITS["build_bytes"], True)
        cells.append(
            (
                row["scene"],
                formats.count(row["primitives"]),
                f"{row['embree_seconds']:.2f} s",
                f"{row['added_seconds']:.2f} s",
                formats.percent(row["added_share"]),
                f"{share[0]} %",
                share[1],
                f"{row['bytes_per_primitive']:.0f}",
                *each,
            )
        )
    print(console.table((*columns, "limit", ""), cells))


def print_simulation(rows: Sequence[dict[str, Any]]) -> None:
    console.heading("Simulated rays a second of processor time, one thread (machine table1)")
    cells = []
    for row in rows:
        for rate in row["runs"]:
            share = row["walk_seconds"] / rate["seconds"]
            cells.append(
                (
                    row["scene"],
                    row["unit"],
                    rate["model"],
                    formats.count(row["rays"]),
                    f"{rate['seconds']:.2f} s",
                    formats.percent(share, 0) if rate["traversed"] else "known",
                    formats.count(rate["cycles"]),
                    f"{rate['error']:+.1%}" if rate["error"] else formats.NOTHING,
                    formats.count(rate["rays_per_second"]),
                    *_verdict(rate["rays_per_second"], LIMITS["simulation"], False),
                )
            )
    columns = ("scene", "unit", "model", "rays", "time", "traversal", "cycles", "off", "rays/s")
    print(console.table((*columns, "limit", ""), cells, left=3))
    print(
        "traversal: its share of the time, once a run; known: traversed by another run, as of "
        "`a2rt vary` for all machines but the first"
    )
