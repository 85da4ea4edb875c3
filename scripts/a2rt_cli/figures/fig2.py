"""Figure 2: what ray tracing spends instructions, time, cache and storage on (FP32 baseline)."""

from __future__ import annotations

from collections.abc import Sequence

from a2rt_cli import console, formats, plotting, results
from a2rt_cli.figures import Context, Drawn
from a2rt_cli.report import measures
from a2rt_cli.results import Result

TITLE = "where an FP32 RT core spends instructions, time and memory"
NAME = "fig2"
# Columns of the table: heading -> key of a result.
SHARES = {
    "instructions": "time.shares.rt_instructions",
    "time": "time.shares.rt_time",
    "boxes of it": "time.shares.box_of_intersection",
    "BVH of L1": "memory.shares.bvh_of_l1",
}


def draw(context: Context) -> Drawn:
    found = context.runs()
    rows = plotting.beside(NAME, found)
    files = _draw(rows, context)
    words = _gap(found)
    files.append(plotting.write_numbers(context.out, NAME, rows, gap=words))
    said = "\n".join(f"- {one}" for one in words)
    parts = [plotting.beside_text(rows), _table(found), f"How ours are counted:\n{said}"]
    return Drawn("\n\n".join(parts), files)


def _draw(rows: Sequence[dict], context: Context) -> list:
    figure, axes = plotting.new(8.5, 3.4)
    axes.grid(axis="y", visible=False)
    axes.grid(axis="x", visible=True)
    for index, row in enumerate(reversed(rows)):
        for offset, key, colour in ((0.19, "paper", "#6b7280"), (-0.19, "ours", "#0072b2")):
            value = row[key]
            if value is not None:
                axes.barh(index + offset, value * 100, 0.34, color=colour)
                axes.text(value * 100 + 1, index + offset, formats.percent(value), va="center")
    axes.set_yticks(range(len(rows)), [row["what"] for row in reversed(rows)])
    axes.set_xlim(0, 110)
    axes.set_xlabel("%")
    axes.barh(0, 0, color="#6b7280", label="paper")
    axes.barh(0, 0, color="#0072b2", label="ours, mean of the workloads")
    figure.legend(loc="outside lower center", ncols=2)
    return plotting.save(figure, context.out, NAME)


def _table(found: Sequence[Result]) -> str:
    cells = [
        (
            results.workload_name(one),
            *[formats.percent(results.get(one, key)) for key in SHARES.values()],
            formats.percent(measures.box_storage_share([one])),
        )
        for one in found
    ]
    return console.table(("workload", *SHARES, "boxes of BVH"), cells)


def _gap(found: Sequence[Result]) -> list[str]:
    """How each share is counted here, and the counts behind the one that differs most."""
    first = next((one for one in found if results.get(one, "fig2.how")), None)
    if first is None:
        return []
    out = [f"{name.replace('_', ' ')}: {how}." for name, how in first["fig2"]["how"].items()]
    box = results.get(first, "time.testers.box.latency")
    triangle = results.get(first, "time.testers.triangle.latency")
    tested = "time.testers.{}.tests"
    counts = [
        [results.get(one, tested.format(name)) for name in ("box", "triangle")] for one in found
    ]
    ratios = [boxes / triangles for boxes, triangles in counts if boxes and triangles]
    if box and triangle and ratios:
        mean = formats.geometric_mean(ratios)
        heavier = ", so that triangles weigh more in time than in number" if triangle > box else ""
        out.append(
            f"the baseline makes {mean:.1f} box tests for each triangle test (geometric mean); a "
            f"box test takes {box} cycles here and a triangle test {triangle}, the stages of the "
            f"public AQB8 RTL{heavier}."
        )
    return out
