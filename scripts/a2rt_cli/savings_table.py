"""The table of what scenes save by not needing every effect, for the terminal and the report."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from a2rt_cli import formats
from a2rt_cli.files import read_json, write_json

FILE = "savings.json"
COLUMNS = [
    "scene",
    "rays",
    "stages",
    "compile s",
    "capture s",
    "capture bytes",
    "simulate s",
    "both s",
    "picture",
    "rays and results",
]
NOTE = (
    "Each cell is --effects auto / all (auto of all in percent). Processor seconds; shader cache "
    "off. Compile: pipeline, and what the first frame costs more than the second. Capture: the "
    "whole program under the layer, compiling included. Simulate: the whole simulation with just "
    "the parts called for, and with all parts; the least of three runs. A part without work costs "
    "the host next to nothing: differences there are noise, and what is saved is saved in the "
    "capture. Both: capture and simulation together. Both captures hold the same rays, so their "
    "size hardly differs."
)


def load(folder: Path) -> list[dict[str, Any]]:
    path = folder / FILE
    return read_json(path) if path.is_file() else []


def save(folder: Path, rows: Sequence[dict[str, Any]]) -> Path:
    """Adds rows to the folder's, replacing those of the same scene and workload."""
    made = {(row["scene"], row["workload"]) for row in rows}
    kept = [row for row in load(folder) if (row["scene"], row["workload"]) not in made]
    write_json(folder / FILE, [*kept, *rows])
    return folder / FILE


def same(row: dict[str, Any]) -> bool:
    """What the effects in use give does not depend on what else is built."""
    return row["pictures_identical"] and not row["rays_differ_in"] and not row["results_differ_in"]


def cells(row: dict[str, Any]) -> list[str]:
    auto, everything = row["auto"], row["all"]

    def both(write: Any, *keys: str) -> str:
        mine, all_of_it = (sum(run[key] for key in keys) for run in (auto, everything))
        share = mine / all_of_it if all_of_it else None
        return f"{write(mine)} / {write(all_of_it)} ({formats.percent(share, 0)})"

    seconds = "{:.2f}".format
    differ = [*row["rays_differ_in"], *row["results_differ_in"]]
    return [
        f"{row['scene']} ({row['workload']})",
        formats.count(auto["rays"]),
        f"{len(auto['stages'])} / {len(everything['stages'])}",
        both(seconds, "compile_seconds"),
        both(seconds, "capture_seconds"),
        both(formats.size, "capture_bytes"),
        both(seconds, "simulate_seconds"),
        both(seconds, "capture_seconds", "simulate_seconds"),
        "identical" if row["pictures_identical"] else "DIFFERS",
        f"differ in {', '.join(differ)}" if differ else f"identical, {auto['cycles']:,} cycles",
    ]


def sentence(row: dict[str, Any]) -> str:
    parts = ", ".join(row["left_out_parts"]) or "none"
    return f"{row['scene']} does not need {', '.join(row['not_needed'])}; parts left out: {parts}."
