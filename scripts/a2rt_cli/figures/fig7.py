"""Figure 7: build and classification time, and bytes asked of L1, normalised to the baseline."""

from __future__ import annotations

from a2rt_cli import plotting, results
from a2rt_cli.figures import Context, Drawn
from a2rt_cli.report import charts, measures

TITLE = "build time and memory access bytes of baseline, AQB8 and A²RT"
NAME = "fig7"


def _bars(axes, found, value, against: str, title: str, label: str) -> None:
    groups = results.by_workload(found)
    units = list(dict.fromkeys(results.label(one) for one in found))
    width = 0.8 / len(units)
    for index, unit in enumerate(units):
        shares = measures.ratios(found, unit, against, value)
        spots = [i + (index - (len(units) - 1) / 2) * width for i in range(len(groups))]
        heights = [shares.get(name, 0.0) for name in groups]
        axes.bar(spots, heights, width * 0.92, label=unit, color=charts.unit_colour(unit, index))
    axes.axhline(1.0, color="#1a2230", linewidth=0.8)
    axes.set_xticks(range(len(groups)), list(groups), rotation=30, ha="right")
    axes.set_title(title, loc="left")
    axes.set_ylabel(label)


def draw(context: Context) -> Drawn:
    found = context.runs()
    figure, (build, traffic) = plotting.new(11, 4, columns=2)
    _bars(
        build,
        found,
        measures.build_seconds,
        "aqb8",
        "(a) Build and classification time",
        "share of AQB8's",
    )
    _bars(
        traffic,
        found,
        results.tree_bytes,
        "baseline",
        "(b) Bytes asked of L1",
        "share of the baseline's",
    )
    figure.legend(*traffic.get_legend_handles_labels(), loc="outside lower center", ncols=6)
    rows = plotting.beside(NAME, found)
    files = plotting.save(figure, context.out, NAME)
    files.append(plotting.write_numbers(context.out, NAME, rows))
    return Drawn(plotting.beside_text(rows), files)
