"""The price list: what each step of each precision knob changes in accuracy, time and energy.

Everything here is data. A price is taken per workload against the unit's own configuration on the
same rays; over several workloads ratios are averaged by the geometric mean, counts are summed.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from a2rt_cli import formats, results
from a2rt_cli.experiment import Experiment, Factorial, Knob
from a2rt_cli.results import Result
from a2rt_cli.sweep.plan import combinations, override

# Stands for the mean over all workloads wherever a workload is named.
ALL = "all"
# Components of the energy table that are quantized box testers.
_TESTERS = ("qbox_a2rt", "qbox_aqb8")


@dataclass(frozen=True)
class Cost:
    """Accuracy as it is; prices as ratios to the unit's own configuration. None: not measured."""

    lost_hits: float | None  # rays, summed
    missed: float | None  # box tests of the audited rays, summed
    redundant: float | None  # per true miss, mean
    rmse: float | None  # against the driver's picture, mean
    flip: float | None
    changed_pixels: float | None  # summed
    cycles: float | None  # ratio
    node_bytes: float | None  # ratio
    energy: float | None  # ratio
    tester_energy: float | None  # ratio, of the quantized box testers alone
    area: float | None  # µm² of one quantized tester
    area_ratio: float | None


class Found:
    """The runs of a sweep by workload, unit and overrides."""

    def __init__(self, found: Iterable[Result]):
        self._runs: dict[tuple[str, tuple[str, ...]], dict[str, Result]] = {}
        for one in found:
            # Written in any order, a set of changes is one configuration.
            key = (results.unit_name(one), tuple(sorted(one.get("overrides", []))))
            self._runs.setdefault(key, {})[results.workload_name(one)] = one

    def of(self, unit: str, overrides: Iterable[str], scope: str) -> dict[str, Result]:
        """Runs by workload; of one workload, or of ALL."""
        runs = self._runs.get((unit, tuple(sorted(overrides))), {})
        return runs if scope == ALL else {k: v for k, v in runs.items() if k == scope}


def scopes(found: Sequence[Result]) -> list[str]:
    names = list(results.by_workload(found))
    return [ALL, *names] if len(names) > 1 else names


Measure = Callable[[Result], float | None]


def _at(dotted: str) -> Measure:
    return lambda one: results.get(one, dotted)


def tester_energy(one: Result) -> float | None:
    parts = results.get(one, "energy.by_component") or {}
    found = [parts[name] for name in _TESTERS if name in parts]
    return sum(found) if found else None


def _ratio(runs: dict[str, Result], base: dict[str, Result], value: Measure) -> float | None:
    shares = [results.ratio(value(runs[name]), value(base[name])) for name in runs if name in base]
    good = [share for share in shares if share is not None]
    return formats.geometric_mean(good) if good and len(good) == len(runs) else None


def _total(runs: dict[str, Result], value: Measure) -> float | None:
    values = [value(one) for one in runs.values()]
    return None if not values or any(v is None for v in values) else float(sum(values))


def _mean(runs: dict[str, Result], value: Measure) -> float | None:
    total = _total(runs, value)
    return None if total is None else total / len(runs)


def cost(found: Found, unit: str, overrides: Iterable[str], scope: str = ALL) -> Cost | None:
    runs, base = found.of(unit, overrides, scope), found.of(unit, (), scope)
    if not runs:
        return None
    area = _at("area.tester.um2")
    return Cost(
        lost_hits=_total(runs, results.lost_hits),
        missed=_total(runs, _at("accuracy.missed_hits")),
        redundant=_mean(runs, results.redundant_share),
        rmse=_mean(runs, _at("picture.rmse")),
        flip=_mean(runs, _at("picture.flip")),
        changed_pixels=_total(runs, _at("picture.changed_pixels")),
        cycles=_ratio(runs, base, _at("time.cycles")),
        node_bytes=_ratio(runs, base, results.node_bytes),
        energy=_ratio(runs, base, _at("energy.total_pj")),
        tester_energy=_ratio(runs, base, tester_energy),
        area=_mean(runs, area),
        area_ratio=_ratio(runs, base, area),
    )


@dataclass(frozen=True)
class Price:
    """One row of the list: a knob at a value."""

    knob: Knob
    value: Any
    cost: Cost

    @property
    def is_default(self) -> bool:
        return self.value == self.knob.default

    @property
    def label(self) -> str:
        return self.knob.label(self.value)


def prices_of(knob: Knob, found: Found, scope: str = ALL) -> list[Price]:
    """The knob's values in order, without those that were not run."""
    rows = []
    for value in knob.values:
        changes = [] if value == knob.default else [override(knob.key, value)]
        paid = cost(found, knob.unit, changes, scope)
        if paid is not None:
            rows.append(Price(knob, value, paid))
    return rows


def price_list(experiment: Experiment, found: Found, scope: str = ALL) -> list[list[Price]]:
    """Per knob, its values in order."""
    return [rows for knob in experiment.knobs if (rows := prices_of(knob, found, scope))]


@dataclass(frozen=True)
class Cell:
    """One combination of a factorial."""

    values: dict[str, Any]
    cost: Cost


def grid(
    experiment: Experiment, factorial: Factorial, found: Found, scope: str = ALL
) -> list[Cell]:
    out = []
    for overrides, values in combinations(experiment, factorial).items():
        paid = cost(found, factorial.unit, overrides, scope)
        if paid is not None:
            out.append(Cell(values, paid))
    return out


def script_json(value: Any) -> str:
    """JSON that is safe inside a <script> element."""
    return json.dumps(value).replace("</", "<\\/")
