"""The table that a comparison prints on the terminal."""

from __future__ import annotations

from collections.abc import Sequence

from a2rt_cli import console, formats, results
from a2rt_cli.results import Result


def rows_of(group: Sequence[Result]) -> list[list[str]]:
    """One row a unit; ratios are against the baseline of the same workload."""
    base = results.baseline_of(group)
    timed = any(results.get(one, "time.cycles") is not None for one in group)
    rows = []
    for one in group:
        row = [results.label(one)]
        row.append(formats.count(results.lost_hits(one)))
        row.append(formats.count(results.get(one, "accuracy.missed_hits")))
        row.append(formats.percent(results.redundant_share(one), 2))
        row.append(formats.size(results.node_bytes(one)))
        against = results.node_bytes(base) if base else None
        row.append(formats.percent(results.ratio(results.node_bytes(one), against)))
        row.append(formats.count(results.get(one, "picture.changed_pixels")))
        if timed:
            cycles = results.get(one, "time.cycles")
            base_cycles = results.get(base, "time.cycles") if base else None
            row.append(formats.count(cycles))
            row.append(formats.factor(results.ratio(base_cycles, cycles)))
            row.append(formats.energy(results.get(one, "energy.total_pj")))
        rows.append(row)
    return rows


def columns_of(group: Sequence[Result]) -> list[str]:
    columns = [
        "unit",
        "lost hits",
        "missed boxes",
        "redundant",
        "node bytes",
        "of baseline",
        "changed pixels",
    ]
    if any(results.get(one, "time.cycles") is not None for one in group):
        columns += ["cycles", "speedup", "energy"]
    return columns


def print_comparison(found: Sequence[Result]) -> None:
    for name, group in results.by_workload(found).items():
        workload = group[0]["workload"]
        console.heading(
            f"{name}: {formats.count(workload.get('rays'))} rays, "
            f"{formats.count(workload.get('triangles'))} triangles"
        )
        print(console.table(columns_of(group), rows_of(group)))
        for one in group:
            if one.get("time_missing"):
                print(f"cycles of {results.label(one)} are missing: {one['time_missing']}")
    print(
        "\nlost hits: rays whose closest hit is not the one exact arithmetic gives; missed boxes,"
        "\nredundant: box decisions of the audited rays that say miss (hit) where the exact box is"
        "\nhit (missed)."
    )
