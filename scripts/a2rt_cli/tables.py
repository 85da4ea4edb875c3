"""The tables that a comparison prints on the terminal, and shows on its page."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from typing import Any

from a2rt_cli import console, formats, results
from a2rt_cli.report import measures, stalls, words
from a2rt_cli.results import Result

ACCURACY_COLUMNS = [
    "unit",
    "lost hits",
    "missed boxes",
    "redundant",
    "node bytes",
    "of baseline",
    "of AQB8",
    "changed pixels",
]
COMPARISON_WORDS = {
    results.SAME_COUNT: "same number of box testers",
    results.SAME_AREA: "same area of box testers",
}
LOST_NOTE = (
    "lost hits: rays whose hit in the driver the unit loses, or takes a farther one for. Ties, "
    "self-hits at tmin, hits within rounding of an edge, hits that the driver's own box test skips "
    "and hits that the program never looks at are counted apart."
)
BOXES_NOTE = (
    "missed boxes, redundant: box decisions of the audited rays that say miss (hit) where the "
    "exact box is hit (missed)."
)
_WIDTH = 88


def accuracy_rows(group: Sequence[Result]) -> list[list[str]]:
    """One row a unit; ratios are against the baseline of the same workload."""
    group = results.primary(group)
    base = results.baseline_of(group)
    against = results.node_bytes(base) if base else None
    aqb8 = measures.pick(group, "aqb8")
    other = results.node_bytes(aqb8) if aqb8 else None
    return [
        [
            results.label(one),
            formats.count(results.lost_hits(one)),
            formats.count(results.get(one, "accuracy.missed_hits")),
            formats.percent(results.redundant_share(one), 2),
            formats.size(results.node_bytes(one)),
            formats.percent(results.ratio(results.node_bytes(one), against)),
            formats.percent(results.ratio(results.node_bytes(one), other)),
            formats.count(results.get(one, "picture.changed_pixels")),
        ]
        for one in group
    ]


def comparisons_of(group: Sequence[Result]) -> list[str]:
    """The comparisons that this workload was simulated for."""
    made = {results.get(one, "gpu.comparison") for one in group if results.is_timed(one)}
    return [name for name in COMPARISON_WORDS if name in made]


def time_columns(group: Sequence[Result]) -> list[str]:
    """Headings of `time_rows`: what a sample gives is marked."""
    mark = ", extrapolated" if any(measures.is_sampled(one) for one in group) else ""
    return ["unit", f"cycles{mark}", f"speedup{mark}", "energy", "of baseline", "RT units mostly"]


def time_rows(group: Sequence[Result], comparison: str) -> list[list[str]]:
    order = list(dict.fromkeys(results.plain_label(one) for one in group))
    group = [one for one in results.of_comparison(group, comparison) if results.is_timed(one)]
    group.sort(key=lambda one: order.index(results.plain_label(one)))
    base = results.baseline_of(group)
    rows = []
    for one in group:
        cycles, energy = measures.cycles(one), measures.energy(one)
        speed = results.ratio(measures.cycles(base) if base else None, cycles)
        share = results.ratio(energy, measures.energy(base) if base else None)
        rows.append(
            [
                results.plain_label(one),
                formats.count(cycles),
                formats.factor(speed),
                formats.energy(energy),
                formats.percent(share),
                stalls.bound_words(one),
            ]
        )
    return rows


def print_comparison(found: Sequence[Result]) -> None:
    accurate = False
    for name, group in results.by_workload(found).items():
        workload = group[0]["workload"]
        console.heading(
            f"{name}: {formats.count(workload.get('rays'))} rays, "
            f"{formats.count(workload.get('triangles'))} triangles"
        )
        if workload.get("note"):
            print(workload["note"])
        rows = accuracy_rows(group)
        if any(results.get(one, "driver_match") for one in group):
            accurate = True
            print(console.table(ACCURACY_COLUMNS, rows))
        for comparison in comparisons_of(group):
            print(f"\n{COMPARISON_WORDS[comparison]}:")
            print(console.table(time_columns(group), time_rows(group, comparison)))
        for one in group:
            if one.get("time_missing"):
                print(f"cycles of {results.label(one)} are missing: {one['time_missing']}")
    if accurate:
        print("\n" + textwrap.fill(f"{LOST_NOTE} {BOXES_NOTE}", _WIDTH))


MATCH_COLUMNS = {
    "equal": "equal",
    "tie": "tie",
    "tmin_self_hit": "tmin self-hit",
    "edge": "edge",
    "driver_box_loss": "driver's box loss",
    "unknown": "unknown",
    "lost": "lost",
    "other": "other",
}


def match_keys(found: Sequence[Result]) -> list[str]:
    """Categories of driver_match that are counted, the known ones first."""
    counted = {key for one in found for key in one.get("driver_match") or {}}
    return [key for key in MATCH_COLUMNS if key in counted] + sorted(counted - set(MATCH_COLUMNS))


def print_match(found: Sequence[Result]) -> None:
    """Every ray's closest hit against the driver's, by category."""
    found = [one for one in results.primary(found) if one.get("driver_match")]
    if not found:
        return
    keys = match_keys(found)
    columns = ["workload", "unit", *[MATCH_COLUMNS.get(key, key) for key in keys]]
    rows = [
        [
            results.workload_name(one),
            results.label(one),
            *[formats.count(one["driver_match"].get(key)) for key in keys],
        ]
        for one in found
    ]
    console.heading("closest hits against the driver's (rays by category)")
    print(console.table(columns, rows, left=2))


SAMPLE_COLUMNS = [
    "workload",
    "unit",
    "warps simulated",
    "cycles, extrapolated",
    "95 % interval",
    "full run",
    "error",
]
SAMPLE_NOTE = (
    "Blocks of neighbouring warps are drawn evenly over their cost. The error is against a full "
    "run of the same unit, made only with --check-sample."
)


def sample_rows(found: Sequence[Result]) -> list[list[str]]:
    rows = []
    for one in found:
        sample = one.get("sample")
        if not sample:
            continue
        low, high = sample.get("cycles_low"), sample.get("cycles_high")
        error = sample.get("error")
        rows.append(
            [
                results.workload_name(one),
                results.label(one),
                f"{formats.count(sample.get('warps'))} of {formats.count(sample.get('warps_of'))}",
                formats.count(sample.get("cycles")),
                f"{formats.count(low)} to {formats.count(high)}",
                formats.count(sample.get("full_cycles")),
                formats.NOTHING if error is None else f"{error:+.1%}",
            ]
        )
    return rows


def print_samples(found: Sequence[Result]) -> None:
    rows = sample_rows(found)
    if rows:
        console.heading("cycles extrapolated from a sample of the warps")
        print(console.table(SAMPLE_COLUMNS, rows, left=2))
        if any(measures.is_sampled(one) for one in found):
            print("\n" + textwrap.fill(words.SAMPLED, _WIDTH))


def print_time(result: Result) -> None:
    """Where one run's cycles went."""
    parts = {"rt_unit": "RT units", "scheduler": "SM schedulers", "rt_lane": "lanes in RT units"}
    for part, title in parts.items():
        found = stalls.shares(result, part)
        if found:
            rows = [(words, formats.percent(share)) for words, share in found.items() if share > 0]
            console.heading(f"cycles of the {title}")
            print(console.table(("what", "share"), sorted(rows, key=lambda r: -found[r[0]])))


def print_machines(found: dict[str, Any]) -> None:
    """What `a2rt vary` found: a row for each machine, speedups against the first."""
    runs = found["runs"]
    keys = list(runs[0]["set"])
    cells = [
        [
            *(one["set"][key] for key in keys),
            formats.count(one["time"]["cycles"]),
            formats.factor(one["speedup"]),
            formats.energy(one["energy"]["total_pj"]),
            formats.count(one["rays_per_second"]),
        ]
        for one in runs
    ]
    columns = [*keys, "cycles", "speedup", "energy", "rays/s of the host"]
    print(console.table(columns, cells, left=len(keys)))
