"""The summary in plain words. Every sentence is computed; none is written for a wished result."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from a2rt_cli import formats, results
from a2rt_cli.report import measures
from a2rt_cli.results import Result

PER_MILLION = 1_000_000
SAMPLED = (
    "Cycles and speedups are extrapolated from a sample of the warps; energy is not, and is left "
    "blank: simulate without --sample to get it."
)


def _units(found: Sequence[Result]) -> dict[str, list[Result]]:
    groups: dict[str, list[Result]] = {}
    for one in found:
        groups.setdefault(results.plain_label(one), []).append(one)
    return groups


def titles(found: Sequence[Result]) -> dict[str, str]:
    """Short names for prose: the unit's title up to its first comma or bracket."""
    out = {}
    for label, group in _units(found).items():
        title = group[0]["unit"].get("title") or label
        plain = label == results.unit_name(group[0])
        out[label] = _short(title).replace("A2RT", "A²RT") if plain else label
    return out


def _short(title: str) -> str:
    for mark in (",", " (", ":"):
        title = title.split(mark)[0]
    return title


def accuracy_sentences(found: Sequence[Result]) -> list[str]:
    names = titles(found)
    out = []
    for label, group in _units(results.primary(found)).items():
        lost = [results.lost_hits(one) for one in group]
        if any(value is None for value in lost):
            continue
        rays = sum(measures.compared_rays(one) for one in group)
        pixels = sum(results.get(one, "picture.changed_pixels", 0) for one in group)
        drawn = any(results.get(one, "picture") for one in group)
        total = sum(lost)
        if total == 0:
            text = f"{names[label]} loses none of the driver's hits on {rays:,} rays"
            if drawn:
                text += (
                    " and draws the same pictures as the driver"
                    if pixels == 0
                    else f"; {pixels:,} pixels of its pictures differ from the driver's"
                )
        else:
            rate = total / rays * PER_MILLION
            text = (
                f"{names[label]} loses the driver's hit of {total:,} of {rays:,} rays "
                f"({rate:.3g} in a million)"
            )
            if drawn:
                text += f"; {pixels:,} pixels of its pictures differ from the driver's"
        unknown = sum(int(one["workload"]["rays"]) for one in group) - rays
        if unknown:
            text += (
                f" ({unknown:,} more rays are not counted: the program never looks at their hits)"
            )
        out.append(text + ".")
    return out


def _against_baseline(found: Sequence[Result], label: str) -> list[str]:
    parts = []
    nodes = measures.mean_ratio(found, label, results.BASELINE, results.node_bytes)
    if nodes is not None:
        parts.append(f"reads {formats.percent(nodes)} of the baseline's node bytes")
    return parts + _cost(found, label, measures.main_comparison(found))


def _speed(cycles: float) -> str:
    """In words, from the ratio of the cycles to the baseline's."""
    if cycles <= 1:
        return f"is {1 / cycles:.2f} times as fast"
    return f"takes {cycles:.2f} times as many cycles"


def _cost(found: Sequence[Result], label: str, comparison: str) -> list[str]:
    def mean(among: Sequence[Result], value: Callable[[Result], Any]) -> float | None:
        return measures.mean_ratio(among, label, results.BASELINE, value, comparison)

    parts = []
    cycles, energy = mean(found, measures.cycles), mean(found, measures.energy)
    if cycles is not None:
        parts.append(_speed(cycles))
        faithful = measures.without_losses(found, [label, results.BASELINE])
        if len(faithful) < len(found):
            kept = mean(faithful, measures.cycles)
            where = "where neither loses a hit"
            parts[-1] += f" ({_speed(kept)} {where})" if kept else f" (nowhere {where[6:]})"
    if energy is not None:
        parts.append(f"uses {formats.percent(energy)} of its energy")
    return parts


def cost_sentences(found: Sequence[Result]) -> list[str]:
    names = titles(found)
    comparison = measures.main_comparison(found)
    made = {results.get(one, "gpu.comparison") for one in found}
    second = comparison == results.SAME_COUNT and results.SAME_AREA in made
    with_area = "with testers of the same area it "
    base = {results.plain_label(one) for one in measures.runs_of(found, results.BASELINE)}
    out = []
    for label in _units(found):
        parts = [] if label in base else _against_baseline(found, label)
        if parts:
            joined = ", ".join(parts[:-1]) + (" and " if len(parts) > 1 else "") + parts[-1]
            joined = (with_area if comparison == results.SAME_AREA else "") + joined
            area = _cost(found, label, results.SAME_AREA) if second else []
            also = f"; {with_area}{' and '.join(area)}" if area else ""
            out.append(f"{names[label]} {joined}{also}.")
    return out


def missing_sentences(found: Sequence[Result]) -> list[str]:
    out = []
    if not any(results.get(one, "time.cycles") is not None for one in found):
        out.append("Cycles and energy were not simulated in this run (give --gpu to do so).")
    if any(measures.is_sampled(one) for one in found):
        out.append(SAMPLED)
    out += [
        f"Cycles of {results.label(one)} on {results.workload_name(one)} are missing: "
        f"{one['time_missing']}."
        for one in found
        if one.get("time_missing")
    ]
    unsettled = [
        f"{results.label(one)} on {results.workload_name(one)}"
        for one in found
        if results.get(one, "picture.converged") is False
    ]
    if unsettled:
        out.append(
            "The verdict loop did not settle within its passes for "
            + ", ".join(unsettled)
            + ": those pictures are approximate."
        )
    return out


def summary(found: Sequence[Result]) -> list[str]:
    return [*accuracy_sentences(found), *cost_sentences(found), *missing_sentences(found)]
