"""The questions a sweep is run for, answered in words that are computed from its data.

No sentence is written for a wished result: signs, sizes and names all come from the runs, and a
question whose runs are missing is left out.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

from a2rt_cli import formats
from a2rt_cli.experiment import Experiment
from a2rt_cli.report import price
from a2rt_cli.report.price import ALL, Cell, Cost, Found, Price

# Below this a relative change is called none: it is less than one part in two thousand.
_NOTHING = 0.0005
# Settings within this of the best time are called as good as it.
FLAT = 0.01


@dataclass(frozen=True)
class Answer:
    question: str
    headline: str  # few words, with the number
    detail: str


def change(after: float | None, before: float | None = 1.0, digits: int = 1) -> str:
    """The relative change as "+1.2 %"; a dash if either is missing."""
    if after is None or not before:
        return formats.NOTHING
    share = after / before - 1
    if abs(share) < _NOTHING:
        return "±0 %"
    return f"{share * 100:+.{digits}f} %".replace("-", "−")


def _prices(experiment: Experiment, found: Found, unit: str, key: str, scope: str) -> list[Price]:
    for knob in experiment.knobs:
        if (knob.unit, knob.key) == (unit, key):
            return price.prices_of(knob, found, scope)
    return []


def _at(rows: Sequence[Price], value) -> Cost | None:
    return next((row.cost for row in rows if row.value == value), None)


def _costs(after: Cost, before: Cost) -> str:
    """Time, energy, bytes and area of `after` against `before`."""
    parts = [
        ("time", after.cycles, before.cycles),
        ("energy", after.energy, before.energy),
        ("node bytes", after.node_bytes, before.node_bytes),
        ("tester area", after.area_ratio, before.area_ratio),
    ]
    return ", ".join(f"{change(a, b)} {name}" for name, a, b in parts if a is not None)


def _hits(cost: Cost) -> str:
    if not cost.lost_hits:
        return "loses no hit"
    rays = "ray" if cost.lost_hits == 1 else "rays"
    text = f"loses the closest hit of {int(cost.lost_hits):,} {rays}"
    if cost.changed_pixels:
        text += f" ({int(cost.changed_pixels):,} pixels, FLIP {formats.small(cost.flip)})"
    return text


def _bits(experiment: Experiment, found: Found, scope: str) -> Answer | None:
    rows = _prices(experiment, found, "a2rt", "precision.box_bits", scope)
    eight, ten = _at(rows, 8), _at(rows, 10)
    if eight is None or ten is None or eight.redundant is None or ten.redundant is None:
        return None
    detail = (
        f"With 8 bits {formats.percent(eight.redundant, 2)} of the boxes that a ray misses are "
        f"entered all the same, with 10 bits {formats.percent(ten.redundant, 2)}. "
        f"8 against 10: {_costs(eight, ten)}. 8 bits {_hits(eight)}, 10 bits {_hits(ten)}."
    )
    headline = f"{change(eight.cycles, ten.cycles, 2)} time"
    headline += f", {change(eight.redundant, ten.redundant, 0)} redundant hits"
    if eight.area_ratio and ten.area_ratio:
        headline += f", {change(eight.area_ratio, ten.area_ratio, 0)} tester area"
    return Answer("8 box bits instead of 10", headline, detail)


def _rounding(experiment: Experiment, found: Found, scope: str) -> Answer | None:
    rows = _prices(experiment, found, "a2rt", "precision.rounding", scope)
    safe, nearest = _at(rows, "conservative"), _at(rows, "nearest")
    if safe is None or nearest is None or safe.redundant is None or nearest.redundant is None:
        return None
    detail = (
        f"Redundant hits: {formats.percent(safe.redundant, 2)} of true misses against "
        f"{formats.percent(nearest.redundant, 2)} to nearest; {_costs(safe, nearest)}. "
        f"Rounding to nearest {_hits(nearest)} and misses {formats.count(nearest.missed)} audited "
        f"box tests; conservative rounding {_hits(safe)} and misses {formats.count(safe.missed)}."
    )
    headline = f"{change(safe.cycles, nearest.cycles, 2)} time"
    headline += f", {change(safe.redundant, nearest.redundant, 0)} redundant hits"
    return Answer("Conservative rounding instead of nearest", headline, detail)


def _columns(experiment: Experiment, found: Found, scope: str) -> Answer | None:
    rows = _prices(experiment, found, "a2rt", "precision.multiplier_columns", scope)
    rows = [row for row in rows if row.cost.area_ratio and row.cost.redundant]
    if len(rows) < 2:
        return None
    first, last = rows[0], rows[-1]
    count = last.value - first.value
    saved = (1 - last.cost.area_ratio / first.cost.area_ratio) / count
    steps = [
        f"{b.label}: {change(b.cost.area_ratio, a.cost.area_ratio)} area, "
        f"{change(b.cost.redundant, a.cost.redundant)} redundant"
        for a, b in itertools.pairwise(rows)
    ]
    detail = (
        f"From {first.label} to {last.label} columns: {_costs(last.cost, first.cost)}, testers' "
        f"energy {change(last.cost.tester_energy, first.cost.tester_energy)}, redundant hits "
        f"{change(last.cost.redundant, first.cost.redundant)}. Step by step: {'; '.join(steps)}."
    )
    own = next((row for row in rows if row.is_default), last)
    headline = f"{change(1 - saved)} tester area each; "
    headline += f"dropping {own.label}: {change(own.cost.cycles, first.cost.cycles, 2)} time"
    return Answer("Each multiplier column dropped", headline, detail)


_S_T, _L_T = "classify.area_ratio", "classify.length_ratio"


def classification(experiment: Experiment, found: Found, scope: str = ALL) -> list[Cell]:
    """The timed cells of the S_t x L_t grid, if the experiment has one."""
    for factorial in experiment.factorials:
        if set(factorial.space) == {_S_T, _L_T}:
            cells = price.grid(experiment, factorial, found, scope)
            return [cell for cell in cells if cell.cost.cycles is not None]
    return []


def best_cell(cells: Sequence[Cell]) -> Cell | None:
    return min(cells, key=lambda cell: cell.cost.cycles, default=None)


def _thresholds(experiment: Experiment, found: Found, scope: str) -> Answer | None:
    cells = classification(experiment, found, scope)
    best = best_cell(cells)
    if best is None:
        return None
    good = [c for c in cells if c.cost.cycles <= best.cost.cycles * (1 + FLAT)]
    own = 1 / best.cost.cycles - 1
    worst = max(cells, key=lambda c: c.cost.cycles)

    def slowest(changed: str, kept: str) -> str:
        line = [c for c in cells if c.values[kept] == best.values[kept]]
        low, high = (f(c.values[changed] for c in line) for f in (min, max))
        slower = max(c.cost.cycles for c in line) / best.cost.cycles - 1
        return f"anywhere from {low:g} to {high:g} costs at most {slower * 100:.1f} % of time"

    detail = (
        f"{len(good)} of {len(cells)} settings tried are within {FLAT * 100:g} % of the best time. "
        f"S_t alone {slowest(_S_T, _L_T)}; L_t alone {slowest(_L_T, _S_T)}. "
        f"The defaults are {own * 100:.2f} % slower than the best; the worst "
        f"(S_t = {worst.values[_S_T]:g}, L_t = {worst.values[_L_T]:g}) is "
        f"{(worst.cost.cycles / best.cost.cycles - 1) * 100:.1f} % slower."
    )
    headline = f"S_t = {best.values[_S_T]:g}, L_t = {best.values[_L_T]:g}; "
    headline += f"{len(good)} of {len(cells)} settings within {FLAT * 100:g} %"
    return Answer("The best thresholds of the classification", headline, detail)


def answers(experiment: Experiment, found: Found, scope: str = ALL) -> list[Answer]:
    """Those of the sweep's four questions that its runs can answer."""
    asked = [_bits, _rounding, _columns, _thresholds]
    return [answer for ask in asked if (answer := ask(experiment, found, scope)) is not None]


def sentence(rows: Sequence[Price]) -> str:
    """One knob in one sentence."""
    knob = rows[0].knob
    losing = [row.label for row in rows if row.cost.lost_hits]
    text = f"hits are lost at {', '.join(losing)}" if losing else "no value loses a hit"
    timed = [row for row in rows if row.cost.cycles is not None]
    if len(timed) > 1:
        low = min(timed, key=lambda row: row.cost.cycles)
        high = max(timed, key=lambda row: row.cost.cycles)
        spread = high.cost.cycles / low.cost.cycles - 1
        if spread < _NOTHING:
            return f"{knob.title}: {text}; the time does not change."
        text += (
            f"; {low.label} is the fastest, {high.label} the slowest, "
            f"{formats.percent(spread, 2)} apart"
        )
    return f"{knob.title}: {text}."


def steps(rows: Sequence[Price]) -> list[list[str]]:
    """What one step from the unit's own value buys: towards more precision, and towards less."""
    knob = rows[0].knob
    own = next((i for i, row in enumerate(rows) if row.is_default), None)
    if own is None or not knob.order:
        return []
    finer = 1 if knob.order == "finer" else -1
    out = []
    for word, index in (("finer", own + finer), ("coarser", own - finer)):
        if not 0 <= index < len(rows):
            continue
        to, base = rows[index], rows[own].cost
        out.append(
            [
                f"{knob.unit}: {knob.title}",
                f"{rows[own].label} → {to.label} ({word})",
                change(to.cost.redundant, base.redundant),
                _difference(to.cost.lost_hits, base.lost_hits),
                change(to.cost.cycles, base.cycles, 2),
                change(to.cost.energy, base.energy, 2),
                change(to.cost.tester_energy, base.tester_energy),
                change(to.cost.node_bytes, base.node_bytes),
                change(to.cost.area_ratio, base.area_ratio),
            ]
        )
    return out


STEP_COLUMNS = ["knob", "one step", "redundant hits", "lost hits", "time", "energy"]
STEP_COLUMNS += ["testers' energy", "node bytes", "tester area"]


def _difference(after: float | None, before: float | None) -> str:
    if after is None or before is None:
        return formats.NOTHING
    return "0" if after == before else f"{after - before:+,.0f}".replace("-", "−")
