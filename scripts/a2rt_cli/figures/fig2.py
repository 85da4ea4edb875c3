"""Figure 2: what ray tracing spends instructions, time, cache and storage on (FP32 baseline)."""

from __future__ import annotations

from a2rt_cli import plotting
from a2rt_cli.figures import Context, Drawn

TITLE = "where an FP32 RT core spends instructions, time and memory"
NAME = "fig2"


def draw(context: Context) -> Drawn:
    found = context.runs()
    rows = plotting.beside(NAME, found)
    figure, axes = plotting.new(8.5, 3.4)
    axes.grid(axis="y", visible=False)
    axes.grid(axis="x", visible=True)
    for index, row in enumerate(reversed(rows)):
        axes.barh(index + 0.19, row["paper"] * 100, 0.34, color="#6b7280")
        axes.text(row["paper"] * 100 + 1, index + 0.19, f"{row['paper']:.1%}", va="center")
        if row["ours"] is not None:
            axes.barh(index - 0.19, row["ours"] * 100, 0.34, color="#0072b2")
            axes.text(row["ours"] * 100 + 1, index - 0.19, f"{row['ours']:.1%}", va="center")
    axes.set_yticks(range(len(rows)), [row["what"] for row in reversed(rows)])
    axes.set_xlim(0, 110)
    axes.set_xlabel("%")
    axes.barh(0, 0, color="#6b7280", label="paper")
    axes.barh(0, 0, color="#0072b2", label="ours")
    figure.legend(loc="outside lower center", ncols=2)
    files = plotting.save(figure, context.out, NAME)
    files.append(plotting.write_numbers(context.out, NAME, rows))
    return Drawn(plotting.beside_text(rows), files)
