"""Quantities that the paper prints, computed from our results. None where the data are missing.

Ratios are taken per workload and averaged by the geometric mean, so that a large scene does not
drown a small one.
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


def pick(group: Sequence[Result], unit: str, comparison: str = results.SAME_COUNT) -> Result | None:
    """The run of `unit` with its parameters as configured, in one of the two comparisons."""
    return next(
        (
            one
            for one in group
            if results.unit_name(one) == unit
            and results.plain_label(one) == unit
            and results.in_comparison(one, comparison)
        ),
        None,
    )


def ratios(
    found: Sequence[Result],
    unit: str,
    against: str,
    value: Callable[[Result], Any],
    comparison: str = results.SAME_COUNT,
) -> dict[str, float]:
    """value(unit) / value(against) per workload that has both."""
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
    comparison: str = results.SAME_COUNT,
) -> float | None:
    shares = ratios(found, unit, against, value, comparison)
    return formats.geometric_mean(list(shares.values()))


def mean_share(found: Sequence[Result], unit: str, dotted: str) -> float | None:
    """Arithmetic mean of a share over the workloads of a unit."""
    values = [
        results.get(one, dotted)
        for group in results.by_workload(found).values()
        if (one := pick(group, unit)) is not None
    ]
    good = [value for value in values if value is not None]
    return sum(good) / len(good) if good else None


def cycles(result: Result) -> float | None:
    return results.get(result, "time.cycles")


def energy(result: Result) -> float | None:
    return results.get(result, "energy.total_pj")


def build_seconds(result: Result) -> float | None:
    built = results.get(result, "structure.build_seconds")
    if built is None:
        return None
    return built + results.get(result, "structure.classify_seconds", 0)


def _inverse(value: float | None) -> float | None:
    return None if not value else 1 / value


def _missed(found: Sequence[Result], unit: str) -> float | None:
    values = [
        results.get(one, "accuracy.missed_hits")
        for one in found
        if results.unit_name(one) == unit and results.label(one) == unit
    ]
    good = [value for value in values if value is not None]
    return sum(good) if good else None


def box_storage_share(found: Sequence[Result]) -> float | None:
    shares = []
    for one in found:
        if results.unit_name(one) != results.BASELINE:
            continue
        nodes = results.get(one, "structure.node_bytes", 0)
        leaves = results.get(one, "structure.triangle_bytes", 0)
        if nodes + leaves > 0:
            shares.append(nodes / (nodes + leaves))
    return sum(shares) / len(shares) if shares else None


# Named in lumibench_configs/paper.toml.
MEASURES: dict[str, Callable[[Sequence[Result]], float | None]] = {
    "rt_instruction_share": lambda f: mean_share(f, "baseline", "time.shares.rt_instructions"),
    "rt_time_share": lambda f: mean_share(f, "baseline", "time.shares.rt_time"),
    "box_time_share": lambda f: mean_share(f, "baseline", "time.shares.box_of_intersection"),
    "bvh_l1_share": lambda f: mean_share(f, "baseline", "memory.shares.bvh_of_l1"),
    "box_storage_share": box_storage_share,
    "redundant_vs_aqb8": lambda f: mean_ratio(f, "a2rt", "aqb8", results.redundant_share),
    "missed_hits_a2rt": lambda f: _missed(f, "a2rt"),
    "build_vs_aqb8": lambda f: mean_ratio(f, "a2rt", "aqb8", build_seconds),
    "bytes_a2rt": lambda f: mean_ratio(f, "a2rt", "baseline", results.tree_bytes),
    "bytes_aqb8": lambda f: mean_ratio(f, "aqb8", "baseline", results.tree_bytes),
    "energy_vs_baseline": lambda f: mean_ratio(f, "a2rt", "baseline", energy),
    "energy_vs_aqb8": lambda f: mean_ratio(f, "a2rt", "aqb8", energy),
    "speedup_over_baseline": lambda f: _inverse(mean_ratio(f, "a2rt", "baseline", cycles)),
    "speedup_over_aqb8": lambda f: _inverse(mean_ratio(f, "a2rt", "aqb8", cycles)),
}


def ours(number: PaperNumber, found: Sequence[Result]) -> float | None:
    return MEASURES[number.ours](found) if number.ours else None
