"""Quantities that the paper prints, computed from our results. None where the data are missing.

Ratios are taken per workload and averaged by the geometric mean, so that a large scene does not
drown a small one; shares by the arithmetic mean. No run counts by its size.
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from a2rt_cli import formats, results
from a2rt_cli.paths import CONFIGS
from a2rt_cli.results import Result


@dataclass(frozen=True)
class PaperNumber:
    id: str
    figure: str
    what: str
    value: float
    kind: str
    source: str
    ours: str

    def paper_text(self) -> str:
        return formats.of_kind(self.value, self.kind)


def paper_numbers() -> list[PaperNumber]:
    text = (CONFIGS / "paper.toml").read_text(encoding="utf-8")
    return [PaperNumber(**entry) for entry in tomllib.loads(text)["number"]]


def main_comparison(found: Sequence[Result]) -> str:
    """The comparison that stands first: equal numbers of testers, unless no run was made for it."""
    count = any(results.in_comparison(one, results.SAME_COUNT) for one in found)
    return results.SAME_COUNT if count or not found else results.SAME_AREA


def pick(group: Sequence[Result], unit: str, comparison: str = "") -> Result | None:
    """The run of `unit` as configured, in a comparison (`main_comparison` unless one is named).

    Where all runs of the unit are of one other variant (`--set`, a file of the user's own), it is
    that one. A variant's label picks that variant.
    """
    comparison = comparison or main_comparison(group)
    runs = [one for one in group if results.in_comparison(one, comparison)]
    named = [one for one in runs if results.plain_label(one) == unit]
    changed = [one for one in runs if results.unit_name(one) == unit]
    if named or len({results.plain_label(one) for one in changed}) == 1:
        return (named or changed)[0]
    return None


def runs_of(found: Sequence[Result], unit: str, comparison: str = "") -> list[Result]:
    """One run per workload that has `unit`."""
    comparison = comparison or main_comparison(found)
    picked = [pick(group, unit, comparison) for group in results.by_workload(found).values()]
    return [one for one in picked if one is not None]


def variants(found: Sequence[Result], units: Sequence[str]) -> list[str]:
    """Labels of the runs that stand for `units` without being them as configured."""
    labels = [results.plain_label(one) for unit in units for one in runs_of(found, unit)]
    return [label for label in dict.fromkeys(labels) if label not in units]


def without_losses(found: Sequence[Result], units: Sequence[str]) -> list[Result]:
    """Results of the workloads in which none of `units` is known to lose a hit.

    A unit that loses a hit skips work, so that its speed elsewhere is not all earned.
    """
    main = results.primary(found)
    losses = {
        name: [results.lost_hits(one) for unit in units if (one := pick(group, unit)) is not None]
        for name, group in results.by_workload(main).items()
    }
    return [one for one in found if not any(losses.get(results.workload_name(one), []))]


def compared_rays(result: Result) -> int:
    """Rays whose hit the capture knows, so that a unit's can be compared with it."""
    unknown = results.get(result, "driver_match.unknown", 0)
    return int(result["workload"]["rays"]) - int(unknown)


def ratios(
    found: Sequence[Result],
    unit: str,
    against: str,
    value: Callable[[Result], Any],
    comparison: str = "",
) -> dict[str, float]:
    """value(unit) / value(against) per workload that has both."""
    comparison = comparison or main_comparison(found)
    out = {}
    for name, group in results.by_workload(found).items():
        one, other = pick(group, unit, comparison), pick(group, against, comparison)
        if one is None or other is None:
            continue
        share = results.ratio(value(one), value(other))
        if share is not None:
            out[name] = share
    return out


def mean_ratio(
    found: Sequence[Result],
    unit: str,
    against: str,
    value: Callable[[Result], Any],
    comparison: str = "",
) -> float | None:
    shares = ratios(found, unit, against, value, comparison)
    return formats.geometric_mean(list(shares.values()))


def mean_share(found: Sequence[Result], unit: str, dotted: str) -> float | None:
    """Arithmetic mean of a share over the workloads of a unit."""
    values = [results.get(one, dotted) for one in runs_of(found, unit)]
    good = [value for value in values if value is not None]
    return sum(good) / len(good) if good else None


def is_sampled(result: Result) -> bool:
    """Whether only a part of the warps was simulated."""
    return results.get(result, "sample.fraction", 1.0) < 1


def cycles(result: Result) -> float | None:
    """Cycles of all warps: those of a sample are extrapolated."""
    return results.get(result, "sample.cycles" if is_sampled(result) else "time.cycles")


def energy(result: Result) -> float | None:
    """Energy of all warps in pJ; None of a sample, whose energy nobody has extrapolated yet."""
    return None if is_sampled(result) else results.get(result, "energy.total_pj")


def _inverse(value: float | None) -> float | None:
    return None if not value else 1 / value


def box_storage_share(found: Sequence[Result]) -> float | None:
    shares = []
    for one in runs_of(results.primary(found), results.BASELINE):
        nodes = results.get(one, "structure.node_bytes", 0)
        leaves = results.get(one, "structure.triangle_bytes", 0)
        if nodes + leaves > 0:
            shares.append(nodes / (nodes + leaves))
    return sum(shares) / len(shares) if shares else None


@dataclass(frozen=True)
class Measure:
    """One number of all workloads of a page, and how theirs become one."""

    how: str
    of: Callable[[Sequence[Result]], float | None]


ARITHMETIC, GEOMETRIC = "arithmetic mean", "geometric mean"


def _share(dotted: str) -> Measure:
    return Measure(ARITHMETIC, lambda found: mean_share(found, "baseline", dotted))


def _ratio(unit: str, against: str, value: Callable[[Result], Any]) -> Measure:
    return Measure(GEOMETRIC, lambda found: mean_ratio(found, unit, against, value))


def _speedup(against: str) -> Measure:
    return Measure(GEOMETRIC, lambda f: _inverse(mean_ratio(f, "a2rt", against, cycles)))


# Named in lumibench_configs/paper.toml.
MEASURES: dict[str, Measure] = {
    "rt_instruction_share": _share("time.shares.rt_instructions"),
    "rt_time_share": _share("time.shares.rt_time"),
    "box_time_share": _share("time.shares.box_of_intersection"),
    "bvh_l1_share": _share("memory.shares.bvh_of_l1"),
    "box_storage_share": Measure(ARITHMETIC, box_storage_share),
    "bytes_a2rt": _ratio("a2rt", "baseline", results.tree_bytes),
    "bytes_aqb8": _ratio("aqb8", "baseline", results.tree_bytes),
    "energy_vs_baseline": _ratio("a2rt", "baseline", energy),
    "energy_vs_aqb8": _ratio("a2rt", "aqb8", energy),
    "speedup_over_baseline": _speedup("baseline"),
    "speedup_over_aqb8": _speedup("aqb8"),
}


def ours(number: PaperNumber, found: Sequence[Result]) -> float | None:
    return MEASURES[number.ours].of(found) if number.ours else None


def how(number: PaperNumber) -> str:
    return MEASURES[number.ours].how if number.ours else ""
