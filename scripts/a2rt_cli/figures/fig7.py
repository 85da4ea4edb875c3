"""Figure 7: build and classification time, and bytes asked of L1, normalised to the baseline."""

from __future__ import annotations

import statistics
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from a2rt_cli import console, formats, plotting, results
from a2rt_cli.engine import core, renderer
from a2rt_cli.figures import Context, Drawn
from a2rt_cli.report import charts, measures

TITLE = "build time and memory access bytes of baseline, AQB8 and A²RT"
NAME = "fig7"
REPEATS = 3
UNITS = ("aqb8", "a2rt")
HOW = (
    "All units share one tree, the SAH build of Embree, so that its time is one number a workload: "
    "the median of\nall builds, {repeats} of each unit in turn in one process, in processor time. "
    "Classification and encoding are the\nunit's own, medians of {repeats}. Our total is the tree "
    "and both of these. The paper's 38.97 % is a total of build\nand classification too, A²RT's "
    "running while the tree is built and AQB8's after it; ours runs after it for both. One tree\n"
    "serves both, so that its time pulls the ratio of the totals towards 1: the ratio of what "
    "differs stands beside it."
)


@dataclass(frozen=True)
class Build:
    """Seconds of one workload: the tree, and what each unit does to it (classify, encode)."""

    workload: str
    tree: float
    classify: dict[str, float]
    encode: dict[str, float]

    def own(self, unit: str) -> float:
        return self.classify[unit] + self.encode[unit]

    def total(self, unit: str) -> float:
        return self.tree + self.own(unit)


def build_of(workload: str, measured: Sequence[dict[str, Any]]) -> Build:
    """From what `bench-units` says of every build, several of each unit."""

    def median(key: str, unit: str) -> float:
        return statistics.median(one[key] for one in measured if one["unit"] == unit)

    units = list(dict.fromkeys(one["unit"] for one in measured))
    return Build(
        workload,
        statistics.median(one["build_seconds"] for one in measured),
        {unit: median("classify_seconds", unit) for unit in units},
        {unit: median("encode_seconds", unit) for unit in units},
    )


def _measure(context: Context) -> list[Build]:
    found = []
    for captured in context.captured():
        with (
            console.step(f"Building the trees of {captured.name}") as shown,
            renderer.scratch(context.out) as scratch,
        ):
            measured = core.bench_units(
                captured.file,
                scratch / "bench.json",
                units=[*UNITS] * REPEATS,
                extra=["--rays", "1", "--repeats", "1"],
                shown=shown,
            )
        found.append(build_of(captured.name, measured["units"]))
    return found


def _mean(builds: Sequence[Build], seconds: Callable[[Build, str], float]) -> float | None:
    """Geometric mean of A²RT's over AQB8's."""
    ratios = [results.ratio(seconds(one, "a2rt"), seconds(one, "aqb8")) for one in builds]
    return formats.geometric_mean([ratio for ratio in ratios if ratio is not None])


def build_rows(builds: Sequence[Build]) -> list[dict]:
    """The paper's number beside our total, and beside what differs between the units."""
    (printed,) = (row for row in plotting.beside(NAME, []) if row["id"] == "fig7a.build")
    how = measures.GEOMETRIC
    total = {**printed, "ours": _mean(builds, Build.total), "how": how}
    parts = {
        "... tree and classification, without encoding": lambda b, u: b.tree + b.classify[u],
        "... without the tree that both share": Build.own,
    }
    shared = {"id": "", "kind": "ratio", "paper": None, "how": how, "source": "ours"}
    return [total, *[{**shared, "what": w, "ours": _mean(builds, s)} for w, s in parts.items()]]


def build_table(builds: Sequence[Build]) -> str:
    columns = ["workload", "tree, shared"]
    columns += [f"{unit}: {what}" for unit in UNITS for what in ("classify", "encode", "total")]
    rows = []
    for one in builds:
        cells = [one.workload, _seconds(one.tree)]
        for unit in UNITS:
            parts = (one.classify[unit], one.encode[unit], one.total(unit))
            cells += [_seconds(part) for part in parts]
        rows.append(cells)
    return console.table(columns, rows)


def _seconds(value: float) -> str:
    return f"{value * 1000:.1f} ms" if value < 1 else f"{value:.2f} s"


def _draw_builds(axes, builds: Sequence[Build]) -> None:
    """Stacks of AQB8's total: the shared tree below, what the unit adds above."""
    width = 0.8 / len(UNITS)
    for index, unit in enumerate(UNITS):
        spots = [i + (index - (len(UNITS) - 1) / 2) * width for i in range(len(builds))]
        whole = [one.total("aqb8") for one in builds]
        tree = [one.tree / of for one, of in zip(builds, whole, strict=True)]
        own = [one.own(unit) / of for one, of in zip(builds, whole, strict=True)]
        words = "tree, shared by all units" if index == 0 else None
        axes.bar(spots, tree, width * 0.92, color="#c3c9d4", label=words)
        colour = charts.unit_colour(unit)
        axes.bar(spots, own, width * 0.92, bottom=tree, color=colour, label=f"{unit}: its own")
    _finish(axes, [one.workload for one in builds], "(a) Build and classification time")
    axes.set_ylabel("share of AQB8's")


def _draw_bytes(axes, found: Sequence[results.Result]) -> None:
    groups = results.by_workload(found)
    units = list(dict.fromkeys(results.label(one) for one in found))
    width = 0.8 / len(units)
    for index, unit in enumerate(units):
        shares = measures.ratios(found, unit, results.BASELINE, results.tree_bytes)
        spots = [i + (index - (len(units) - 1) / 2) * width for i in range(len(groups))]
        heights = [shares.get(name, 0.0) for name in groups]
        axes.bar(spots, heights, width * 0.92, label=unit, color=charts.unit_colour(unit, index))
    _finish(axes, list(groups), "(b) Bytes asked of L1")
    axes.set_ylabel("share of the baseline's")


def _finish(axes, names: Sequence[str], title: str) -> None:
    axes.set_ylim(0, 1.15 * axes.get_ylim()[1])
    axes.legend(fontsize=8, loc="upper center", ncols=3)
    axes.axhline(1.0, color="#1a2230", linewidth=0.8)
    axes.set_xticks(range(len(names)), names, rotation=30, ha="right")
    axes.set_title(title, loc="left")


def draw(context: Context) -> Drawn:
    found = context.runs()
    builds = _measure(context)
    figure, (build, traffic) = plotting.new(11, 4, columns=2)
    _draw_builds(build, builds)
    _draw_bytes(traffic, found)
    rows = build_rows(builds)
    rows += [row for row in plotting.beside(NAME, found) if row["id"] != "fig7a.build"]
    files = plotting.save(figure, context.out, NAME)
    files.append(plotting.write_numbers(context.out, NAME, rows, builds=[vars(b) for b in builds]))
    parts = [plotting.beside_text(rows), build_table(builds), HOW.format(repeats=REPEATS)]
    return Drawn("\n\n".join(parts), files)
