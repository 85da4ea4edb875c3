"""Figure 6: wrong box decisions over the ray's direction, A²RT and AQB8, against exact arithmetic.

As the paper: directions (θ, φ) in one octant. Besides, what the paper's axes hide: the zoom to
directions almost parallel to an axis, over the logarithm of the small component.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from a2rt_cli import console, formats, plotting
from a2rt_cli.engine import core
from a2rt_cli.figures import Context, Drawn
from a2rt_cli.report import charts

TITLE = "accuracy of box tests over the ray's direction"
NAME = "fig6"
BINS = 24
PAIRS = 1_000_000


def _rate(counts: Any, among: Any):
    import numpy as np

    a, b = np.asarray(counts, dtype=float), np.asarray(among, dtype=float)
    return np.divide(a, b, out=np.full_like(a, np.nan), where=b > 0)


def _map(axes, figure, grid, title: str, high: float) -> None:
    shown = axes.imshow(
        grid * 100, origin="lower", extent=(0, 90, 0, 90), cmap="cividis", vmin=0, vmax=high
    )
    axes.set_title(title, loc="left", fontsize=10)
    axes.set_xlabel("φ in degrees")
    axes.set_ylabel("θ in degrees")
    axes.grid(False)
    figure.colorbar(shown, ax=axes, label="%", shrink=0.8)


def _draw_maps(found: dict[str, Any], out: Path) -> list[Path]:
    import numpy as np

    units = found["units"]
    figure, _ = plotting.new(10, 4.0 * len(units))
    figure.clf()
    grid = figure.subplots(len(units), 2, squeeze=False)
    kinds = (("redundant", "exact_misses"), ("missed", "exact_hits"))
    rates = {
        (unit, kind): _rate(data[kind], data[among])
        for unit, data in units.items()
        for kind, among in kinds
    }
    for row, unit in enumerate(units):
        for column, (kind, _) in enumerate(kinds):
            # Both units share a scale, so that brightness compares.
            high = max(float(np.nanmax(rates[u, kind])) for u in units) * 100 or 1.0
            _map(grid[row][column], figure, rates[unit, kind], f"{unit}: {kind} hits", high)
    return plotting.save(figure, out, NAME)


def _draw_near_axis(found: dict[str, Any], out: Path) -> list[Path]:
    near = found["near_axis"]
    figure, (redundant, missed) = plotting.new(10, 3.6, columns=2)
    for index, (unit, data) in enumerate(near["units"].items()):
        colour = charts.unit_colour(unit, index)
        for axes, kind, among in (
            (redundant, "redundant", "exact_misses"),
            (missed, "missed", "exact_hits"),
        ):
            rate = _rate(data[kind], data[among]) * 100
            axes.plot(near["log2_d"], rate, color=colour, label=unit, marker=".")
    for axes, kind in ((redundant, "redundant"), (missed, "missed")):
        axes.set_xlabel("log2 of the smallest direction component")
        axes.set_ylabel(f"{kind} hits, %")
        axes.legend()
    return plotting.save(figure, out, f"{NAME}-near-axis")


def totals(found: dict[str, Any]) -> dict[str, dict[str, float]]:
    """Per unit: rates over all directions."""
    out = {}
    for unit, data in found["units"].items():
        sums = {key: sum(map(sum, rows)) for key, rows in data.items()}
        out[unit] = {
            "redundant": sums["redundant"] / max(1, sums["exact_misses"]),
            "missed": sums["missed"] / max(1, sums["exact_hits"]),
            "missed_hits": sums["missed"],
            "exact_hits": sums["exact_hits"],
            "exact_misses": sums["exact_misses"],
        }
    return out


def draw(context: Context) -> Drawn:
    raw = context.out / f"{NAME}-directions.json"
    units = [unit for unit in context.experiment.units if unit != "baseline"]
    with console.step("Testing boxes over all directions") as shown:
        found = core.direction_map(units, BINS, PAIRS, raw, shown)
    files = [*_draw_maps(found, context.out), *_draw_near_axis(found, context.out)]
    rates = totals(found)
    rows = plotting.beside(NAME, [])
    ours = {
        "fig6.redundant": _ratio(rates, "redundant"),
        "fig6.missed": rates.get("a2rt", {}).get("missed_hits"),
    }
    for row in rows:
        row["ours"] = ours.get(row["id"])
    files.append(plotting.write_numbers(context.out, NAME, rows, totals=rates))
    cells = [
        (
            unit,
            formats.percent(rate["redundant"], 3),
            formats.percent(rate["missed"], 3),
            formats.count(rate["missed_hits"]),
            formats.count(rate["exact_hits"]),
        )
        for unit, rate in rates.items()
    ]
    columns = ("unit", "redundant of misses", "missed of hits", "missed", "exact hits")
    text = f"{console.table(columns, cells)}\n\n{plotting.beside_text(rows)}"
    return Drawn(text, files)


def _ratio(rates: dict[str, dict[str, float]], key: str) -> float | None:
    if "a2rt" not in rates or not rates.get("aqb8", {}).get(key):
        return None
    return rates["a2rt"][key] / rates["aqb8"][key]
