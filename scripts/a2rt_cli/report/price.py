"""The price list: what each step of each precision knob changes in accuracy, time and energy."""

from __future__ import annotations

import itertools
import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from a2rt_cli import formats, results
from a2rt_cli.experiment import Experiment, Knob
from a2rt_cli.results import Result
from a2rt_cli.sweep.plan import override


@dataclass(frozen=True)
class Cost:
    """Means over the workloads; ratios are against the unit's default configuration."""

    lost_hits: float | None
    missed: float | None
    redundant: float | None
    rmse: float | None
    cycles: float | None  # ratio
    node_bytes: float | None  # ratio
    energy: float | None  # ratio


def _of_config(found: Sequence[Result], unit: str, overrides: list[str]) -> dict[str, Result]:
    return {
        results.workload_name(one): one
        for one in found
        if results.unit_name(one) == unit and one.get("overrides", []) == overrides
    }


def _ratio(runs: dict[str, Result], base: dict[str, Result], value) -> float | None:
    shares = [results.ratio(value(runs[name]), value(base[name])) for name in runs if name in base]
    good = [share for share in shares if share is not None]
    return formats.geometric_mean(good) if len(good) == len(shares) else None


def _total(runs: dict[str, Result], value) -> float | None:
    values = [value(one) for one in runs.values()]
    return None if not values or any(v is None for v in values) else float(sum(values))


def _mean(runs: dict[str, Result], value) -> float | None:
    total = _total(runs, value)
    return None if total is None else total / len(runs)


def cost(found: Sequence[Result], unit: str, overrides: list[str]) -> Cost | None:
    runs = _of_config(found, unit, overrides)
    base = _of_config(found, unit, [])
    if not runs:
        return None
    return Cost(
        _total(runs, results.lost_hits),
        _total(runs, lambda one: results.get(one, "accuracy.missed_hits")),
        _mean(runs, results.redundant_share),
        _mean(runs, lambda one: results.get(one, "picture.rmse")),
        _ratio(runs, base, lambda one: results.get(one, "time.cycles")),
        _ratio(runs, base, results.node_bytes),
        _ratio(runs, base, lambda one: results.get(one, "energy.total_pj")),
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


def price_list(experiment: Experiment, found: Sequence[Result]) -> list[list[Price]]:
    """Per knob, its values in order."""
    out = []
    for knob in experiment.knobs:
        rows = []
        for value in knob.values:
            changes = [] if value == knob.default else [override(knob.key, value)]
            paid = cost(found, knob.unit, changes)
            if paid is not None:
                rows.append(Price(knob, value, paid))
        if rows:
            out.append(rows)
    return out


def one_more_bit(rows: Sequence[Price]) -> list[list[str]]:
    """Step by step: what going from one value to the next changes."""
    out = []
    for before, after in itertools.pairwise(rows):
        out.append(
            [
                f"{before.value} → {after.value}",
                _change(before.cost.redundant, after.cost.redundant),
                _difference(before.cost.lost_hits, after.cost.lost_hits),
                _change(before.cost.cycles, after.cost.cycles),
                _change(before.cost.node_bytes, after.cost.node_bytes),
                _change(before.cost.energy, after.cost.energy),
            ]
        )
    return out


def _change(before: float | None, after: float | None) -> str:
    share = results.ratio(after, before)
    return formats.NOTHING if share is None else f"{(share - 1) * 100:+.2f} %"


def _difference(before: float | None, after: float | None) -> str:
    if before is None or after is None:
        return formats.NOTHING
    return f"{after - before:+,.0f}"


def sentences(prices: Sequence[Sequence[Price]]) -> list[str]:
    """What the list says, knob by knob, in words the data support."""
    out = []
    for rows in prices:
        knob = rows[0].knob
        timed = [row for row in rows if row.cost.cycles is not None]
        clean = [row for row in rows if row.cost.lost_hits == 0]
        text = f"{knob.title}: "
        if len(clean) == len(rows):
            text += "no value loses a hit"
        else:
            losing = [str(row.value) for row in rows if row.cost.lost_hits]
            text += f"hits are lost at {', '.join(losing)}"
        if timed:
            low = min(timed, key=lambda row: row.cost.cycles)
            high = max(timed, key=lambda row: row.cost.cycles)
            spread = high.cost.cycles / low.cost.cycles - 1
            text += (
                f"; cycles differ by {formats.percent(spread)} between the best value "
                f"({low.value}) and the worst ({high.value}); the default is {knob.default}"
            )
        else:
            shares = [row for row in rows if row.cost.node_bytes is not None]
            if shares:
                low = min(shares, key=lambda row: row.cost.node_bytes)
                text += f"; fewest node bytes at {low.value} ({knob.default} is the default)"
        out.append(text + ".")
    return out


def pareto(points: Sequence[tuple[float, float]]) -> set[int]:
    """Indices of points that no other beats in both coordinates (smaller is better)."""
    order = sorted(range(len(points)), key=lambda i: points[i])
    front, best = set(), float("inf")
    for index in order:
        if points[index][1] < best:
            front.add(index)
            best = points[index][1]
    return front


def scatter(found: Sequence[Result]) -> list[dict[str, Any]]:
    """Points of the Pareto plot, per workload: redundant hits against cycles (or bytes)."""
    out = []
    for name, group in results.by_workload(found).items():
        rows = []
        for one in group:
            timed = results.get(one, "time.cycles")
            y = timed if timed is not None else results.tree_bytes(one)
            x = results.redundant_share(one)
            if x is None and results.unit_name(one) == results.BASELINE:
                x = 0.0
            if x is None or y is None:
                continue
            picture = one.get("picture") or {}
            rows.append(
                {
                    "x": x,
                    "y": y,
                    "workload": name,
                    "unit": results.unit_name(one),
                    "label": results.label(one),
                    "lost": results.lost_hits(one),
                    "picture": picture.get("file"),
                    "difference": picture.get("difference"),
                    "changed": picture.get("changed_pixels"),
                    "axis": "cycles" if timed is not None else "L1 bytes",
                }
            )
        front = pareto([(row["x"], row["y"]) for row in rows])
        for index, row in enumerate(rows):
            row["front"] = index in front
        out += rows
    return out


def script_json(value: Any) -> str:
    """JSON that is safe inside a <script> element."""
    return json.dumps(value).replace("</", "<\\/")
