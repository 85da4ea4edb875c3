"""What never missing a hit costs: A²RT's origin designs wide, guard and literal on the same rays.

Not a figure of the paper, which prints the literal design. Costs are box tests, escapes to the
accurate unit and node bytes, each against the literal design; the default follows from them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from a2rt_cli import comparison, console, formats, options, plotting, results
from a2rt_cli.engine.runs import RunSpec
from a2rt_cli.figures import Context, Drawn
from a2rt_cli.results import Result

TITLE = "the cost of robustness: wide, guard and literal origins"
NAME = "robustness"
DEFAULT = "wide"  # of precision.origin in lumibench_configs/units/a2rt.toml
PROMISING = ("wide", "guard")  # literal may miss, whether or not it does on these rays
COLUMNS = ("workload", "design", "missed boxes", "lost rays", "redundant", "quantized tests")
COLUMNS += ("tests of literal", "escapes", "node bytes", "bytes of literal")


@dataclass(frozen=True)
class Design:
    name: str
    spec: RunSpec


def _designs(audit: int) -> list[Design]:
    def one(name: str, unit: str, *overrides: str) -> Design:
        return Design(name, RunSpec(unit, overrides=overrides, audit=audit, picture=False))

    return [
        one("wide", "a2rt", "precision.origin=wide"),
        one("guard", "a2rt", "precision.origin=guard"),
        one("literal", "a2rt-literal"),
    ]


@dataclass(frozen=True)
class Cost:
    """Sums over box decisions of one run, or of several."""

    missed: int
    lost: int
    redundant: int  # of the audited rays
    exact_misses: int
    tests: int  # boxes decided for all rays, in the quantized and in the accurate unit
    escapes: int  # of these, in the accurate unit because the ray left its group's range
    node_bytes: int

    def __add__(self, other: Cost) -> Cost:
        return Cost(*(a + b for a, b in zip(self._values(), other._values(), strict=True)))

    def _values(self) -> tuple[int, ...]:
        return tuple(vars(self).values())

    @property
    def redundant_share(self) -> float:
        return self.redundant / self.exact_misses if self.exact_misses else 0.0


def _cost(result: Result) -> Cost:
    accuracy, events = result["accuracy"], result["events"]
    return Cost(
        missed=accuracy["missed_hits"],
        lost=results.lost_hits(result) or 0,
        redundant=accuracy["redundant_hits"],
        exact_misses=accuracy["decided"] - accuracy["exact_hits"],
        tests=events["qbox_test"] + events["escape"],
        escapes=events["escape"],
        node_bytes=results.node_bytes(result) or 0,
    )


def _rows(workload: str, costs: dict[str, Cost]) -> list[tuple[str, ...]]:
    literal = costs["literal"]
    return [
        (
            workload,
            name,
            formats.count(cost.missed),
            formats.count(cost.lost),
            formats.percent(cost.redundant_share, 3),
            formats.count(cost.tests),
            formats.percent(results.ratio(cost.tests, literal.tests), 2),
            formats.count(cost.escapes),
            formats.size(cost.node_bytes),
            formats.percent(results.ratio(cost.node_bytes, literal.node_bytes), 2),
        )
        for name, cost in costs.items()
    ]


def verdict(total: dict[str, Cost]) -> str:
    """Which design these costs speak for, and whether it is the default."""
    keeps = {name: total[name] for name in PROMISING if not total[name].missed + total[name].lost}
    if not keeps:
        return "No design that promises to keep every hit did so on these rays."
    # An escaped box is decided by the FP32 unit, which is dearer than the quantized one.
    best = min(keeps, key=lambda name: (keeps[name].escapes > 0, keeps[name].tests))
    literal = total["literal"]
    words = []
    for name, cost in total.items():
        more = results.ratio(cost.tests, literal.tests)
        extra = f"{(more - 1) * 100:+.2f} % box tests" if more else "no box tests"
        size = results.ratio(cost.node_bytes, literal.node_bytes)
        extra += f", {(size - 1) * 100:+.2f} % node bytes" if size else ""
        lost = f"misses {cost.missed:,} boxes and {cost.lost:,} rays"
        words.append(f"{name} {lost}, {extra} against literal, {cost.escapes:,} escapes")
    sentence = "; ".join(words) + f". Of the designs that promise every hit, {best} costs least"
    return sentence + (
        f": it is the default of a2rt (precision.origin = {best})."
        if best == DEFAULT
        else f", but the default of a2rt is {DEFAULT}."
    )


def table(found: dict[str, list[Result]]) -> tuple[list[tuple[str, ...]], dict[str, Cost]]:
    """Rows per workload and design, the sums last; and the sums. `found`: results by design."""
    rows: list[tuple[str, ...]] = []
    total: dict[str, Cost] = {}
    for index, first in enumerate(next(iter(found.values()))):
        costs = {name: _cost(group[index]) for name, group in found.items()}
        rows += _rows(results.workload_name(first), costs)
        for name, cost in costs.items():
            total[name] = total[name] + cost if name in total else cost
    return rows + _rows("all", total), total


def _by_design(found: Sequence[Result], designs: Sequence[Design]) -> dict[str, list[Result]]:
    return {
        design.name: [one for one in found if results.label(one) == design.spec.label()]
        for design in designs
    }


def draw(context: Context) -> Drawn:
    designs = _designs(context.experiment.audit)
    found = comparison.compare(
        context.experiment.items(),
        [design.spec for design in designs],
        context.out,
        parallel=context.parallel,
        command=options.command_line(),
    )
    rows, total = table(_by_design(found, designs))
    text = f"{console.table(COLUMNS, rows, left=2)}\n\n{verdict(total)}"
    numbers = [dict(zip(COLUMNS, row, strict=True)) for row in rows]
    written = plotting.write_numbers(context.out, NAME, [], rows=numbers, words=verdict(total))
    return Drawn(text, [written])
