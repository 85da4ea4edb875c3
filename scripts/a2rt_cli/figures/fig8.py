"""Figure 8: speedup over the baseline (marks) and energy by component (bars)."""

from __future__ import annotations

from a2rt_cli import formats, plotting, results
from a2rt_cli.console import table
from a2rt_cli.figures import Context, Drawn
from a2rt_cli.report import charts, measures

TITLE = "normalised speedup and energy of baseline, AQB8 and A²RT"
NAME = "fig8"


def _components(found) -> list[str]:
    return list(
        dict.fromkeys(k for one in found for k in results.get(one, "energy.by_component", {}))
    )


def _draw_energy(axes, groups, units, components) -> None:
    colours = charts.series_colours(components)
    width = 0.8 / len(units)
    for column, group in enumerate(groups.values()):
        base = results.baseline_of(group)
        whole = measures.energy(base) if base else None
        if not whole:
            continue
        for index, unit in enumerate(units):
            one = measures.pick(group, unit)
            if one is None:
                continue
            x, bottom = column + (index - (len(units) - 1) / 2) * width, 0.0
            for component in components:
                part = results.get(one, "energy.by_component", {}).get(component, 0) / whole
                axes.bar(x, part, width * 0.9, bottom=bottom, color=colours[component])
                bottom += part
    handles = [axes.bar(0, 0, color=colours[c], label=c.replace("_", " ")) for c in components]
    axes.legend(handles=handles, loc="upper left", bbox_to_anchor=(1.06, 1.0), title="energy")
    axes.set_ylabel("energy, share of the baseline's")


def _draw_speed(axes, found, groups, units) -> None:
    width = 0.8 / len(units)
    for index, unit in enumerate(units):
        shares = measures.ratios(found, unit, "baseline", measures.cycles)
        points = [
            (i + (index - (len(units) - 1) / 2) * width, 1 / shares[name])
            for i, name in enumerate(groups)
            if name in shares
        ]
        if points:
            colour = charts.unit_colour(unit, index)
            axes.plot(*zip(*points, strict=True), "o-", color=colour, label=unit, markersize=5)
    axes.set_ylabel("speedup over the baseline")
    axes.set_ylim(bottom=0)
    axes.grid(False)
    axes.spines["right"].set_visible(True)
    axes.legend(loc="lower left", bbox_to_anchor=(1.06, 0.0), title="speedup")


def _table(found) -> str:
    rows = []
    for name, group in results.by_workload(found).items():
        base = results.baseline_of(group)
        for one in group:
            speed = results.ratio(measures.cycles(base) if base else None, measures.cycles(one))
            share = results.ratio(measures.energy(one), measures.energy(base) if base else None)
            rows.append(
                (
                    name,
                    results.label(one),
                    formats.count(measures.cycles(one)),
                    formats.factor(speed),
                    formats.energy(measures.energy(one)),
                    formats.percent(share),
                )
            )
    columns = ("workload", "unit", "cycles", "speedup", "energy", "of baseline")
    return table(columns, rows, left=2)


def draw(context: Context) -> Drawn:
    found = context.runs()
    groups = results.by_workload(found)
    units = list(dict.fromkeys(results.label(one) for one in found))
    figure, axes = plotting.new(max(8.0, 1.1 * len(groups) + 4), 4.2)
    _draw_energy(axes, groups, units, _components(found))
    _draw_speed(axes.twinx(), found, groups, units)
    axes.set_xticks(range(len(groups)), list(groups), rotation=30, ha="right")
    rows = plotting.beside(NAME, found)
    files = plotting.save(figure, context.out, NAME)
    files.append(plotting.write_numbers(context.out, NAME, rows))
    return Drawn(f"{_table(found)}\n\n{plotting.beside_text(rows)}", files)
