"""The section "What the scenes did not need, and what that saved"."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from a2rt_cli import formats, results, savings_table
from a2rt_cli.engine import effects as analysis
from a2rt_cli.paths import shown
from a2rt_cli.report.table import Table
from a2rt_cli.report.template import fill
from a2rt_cli.results import Result

NEEDS_NOTE = (
    "Not needed: nothing in the scene calls for it, so its rays, shader code and stages do not "
    "exist in this run. Left out: parts of the machine that no ray, instance or triangle of the "
    "capture can put to work. Lacking: called for, but excluded by --effects; the picture is "
    "without it."
)


def section(found: Sequence[Result], folder: Path, effects: dict[str, Any]) -> str:
    """Safe HTML; empty if the results say nothing about effects."""
    if not effects:
        return ""
    measured = savings_table.load(folder)
    first = next(iter(effects))
    return fill(
        "savings.html.j2",
        needs=_needs(found, effects),
        measured=_measured(measured),
        command=f"scripts/a2rt inspect {first} --compare-effects -o {shown(folder)}",
        folder=shown(folder),
    )


def _measured(rows: Sequence[dict[str, Any]]) -> Table | None:
    if not rows:
        return None
    return Table(
        savings_table.COLUMNS, [savings_table.cells(row) for row in rows], savings_table.NOTE
    )


def _needs(found: Sequence[Result], effects: dict[str, Any]) -> Table:
    groups = results.by_workload(found)
    rows = []
    for name, table in effects.items():
        entries = table.get("effects", [])
        not_needed = [e["name"] for e in entries if not e.get("needed")]
        used = [e["name"] for e in entries if e.get("built")]
        rows.append(
            [
                name,
                ", ".join(used) or formats.NOTHING,
                ", ".join(not_needed) or formats.NOTHING,
                _left_out(groups.get(name, [])),
                ", ".join(analysis.lacking(table)) or formats.NOTHING,
            ]
        )
    columns = ["workload", "effects in use", "not needed", "parts left out", "lacking"]
    return Table(columns, rows, NEEDS_NOTE)


def _left_out(group: Sequence[Result]) -> str:
    for one in group:
        parts = one.get("parts")
        if parts:
            return ", ".join(p["part"] for p in parts if not p["instantiated"]) or formats.NOTHING
    return "not simulated"
