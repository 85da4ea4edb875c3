"""What `a2rt bench` measures. Every number is a ratio of two things timed in the same run."""

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

# Frames drawn in each run; their median is one measurement.
FRAMES = 3


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
    scenes: Sequence[Scene], size: tuple[int, int], pairs: int
) -> list[dict[str, Any]]:
    """The layer with full capture against the same layer without; alternating, so that a busy
    machine slows both."""
    rows = []
    for scene in scenes:
        options = RenderOptions(width=size[0], height=size[1], spp=1)
        ratios, plain, full = [], [], []
        with (
            console.step(f"Layer overhead on {scene.name}") as shown,
            renderer.scratch(Path.cwd() / "out" / "bench") as scratch,
        ):
            for index in range(pairs):
                plain.append(_frame_seconds(scene, options, scratch, FRAMES, captured=False))
                full.append(_frame_seconds(scene, options, scratch, FRAMES, captured=True))
                ratios.append(full[-1] / plain[-1])
                shown.update((index + 1) / pairs)
        rows.append(
            {
                "scene": scene.name,
                "size": list(size),
                "pairs": pairs,
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
            captured = capture.from_scene(scene, RenderOptions(), cache, shown=shown)
            with renderer.scratch(cache) as scratch:
                found = core.bench_units(captured.file, scratch / "bench.json", shown)
        rows.append({"scene": scene.name, **found})
    return rows


def print_overhead(rows: Sequence[dict[str, Any]]) -> None:
    console.heading("Layer with capture against layer without (median of pairs)")
    columns = ("scene", "without", "with", "ratio", "lowest", "highest")
    print(
        console.table(
            columns,
            [
                (
                    row["scene"],
                    f"{row['seconds_without_capture'] * 1000:.0f} ms",
                    f"{row['seconds_with_capture'] * 1000:.0f} ms",
                    formats.factor(row["ratio"]),
                    formats.factor(row["ratio_low"]),
                    formats.factor(row["ratio_high"]),
                )
                for row in rows
            ],
        )
    )


def print_units(rows: Sequence[dict[str, Any]]) -> None:
    console.heading("Functional rays a second against Embree, one thread, same rays")
    table = []
    for row in rows:
        for unit in row.get("units", []):
            table.append(
                (
                    row["scene"],
                    unit["unit"],
                    formats.count(unit.get("rays_per_second")),
                    formats.factor(unit.get("ratio_to_embree")),
                )
            )
    print(console.table(("scene", "unit", "rays/s", "of Embree"), table, left=2))
