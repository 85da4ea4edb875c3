"""Figure 6: wrong box decisions over the ray's direction, A²RT and AQB8, against exact arithmetic.

As the paper: directions (θ, φ) in one octant. Besides, what the paper's axes hide: the zoom to
directions almost parallel to an axis, over the logarithm of the small component.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from a2rt_cli import console, formats, plotting, results
from a2rt_cli.engine import core
from a2rt_cli.figures import Context, Drawn
from a2rt_cli.report import charts

TITLE = "accuracy of box tests over the ray's direction"
NAME = "fig6"
BINS = 18
PAIRS = 4_000_000


_TITLES = {"a2rt": "A²RT, our default", "aqb8": "AQB8", "a2rt-literal": "A²RT as printed"}
# Exponent below which AQB8's 5-bit shift overflows its 32-bit integers (spec of its artifact).
_AQB8_LIMIT = -16


def _title(unit: str) -> str:
    return _TITLES.get(unit, unit)


def _rate(counts: Any, among: Any):
    """Counts over their population; NaN where there is none."""
    import numpy as np

    a, b = np.asarray(counts, dtype=float), np.asarray(among, dtype=float)
    return np.divide(a, b, out=np.full_like(a, np.nan), where=b > 0)


_KINDS = (("redundant", "exact_misses", "true misses"), ("missed", "exact_hits", "true hits"))


def _map(axes, grid, title: str, high: float):
    import numpy as np

    # Bins without any error keep the panel's own grey: none is told from few.
    shown = axes.imshow(
        np.ma.masked_equal(grid * 100, 0),
        origin="lower",
        extent=(0, 0.5, 0, 0.5),
        cmap="cividis_r",
        vmin=0,
        vmax=high,
    )
    axes.set_facecolor("#eef1f5")
    if not np.nansum(grid):
        axes.text(0.25, 0.25, "none in any direction", ha="center", va="center", color="#5b6577")
    axes.set_title(title, loc="left", fontsize=8.5)
    ticks = [0, 0.125, 0.25, 0.375, 0.5]
    words = ["0", "π/8", "π/4", "3π/8", "π/2"]
    axes.set_xticks(ticks, words)
    axes.set_yticks(ticks, words)
    axes.set_xlabel("φ (azimuth)")
    axes.set_ylabel("θ (from the z axis)")
    axes.grid(False)
    for side in ("top", "right", "bottom", "left"):
        axes.spines[side].set_visible(False)
    return shown


def _share(value: float) -> str:
    """As percent, with enough digits that a few in a million do not read as none."""
    return f"{value * 100:.2f} %" if value >= 1e-4 or value == 0 else f"{value * 100:.4f} %"


def _map_title(unit: str, kind: str, data: dict[str, Any], among: str, population: str) -> str:
    wrong, of = (sum(map(sum, data[key])) for key in (kind, among))
    share = _share(wrong / of) if of else formats.NOTHING
    return f"{_title(unit)}: {kind} hits\n{share} of {population} ({wrong:,} of {of:,})"


def _draw_maps(found: dict[str, Any], out: Path) -> list[Path]:
    """One row a unit, one column a kind of error; a column shares its scale and colour bar."""
    import numpy as np

    units = found["units"]
    figure, _ = plotting.new(9.2, 4.1 * len(units))
    figure.clf()
    grid = figure.subplots(len(units), 2, squeeze=False)
    for column, (kind, among, population) in enumerate(_KINDS):
        rates = {unit: _rate(data[kind], data[among]) for unit, data in units.items()}
        # Both units share a scale, so that brightness compares.
        high = max(float(np.nanmax(rate)) for rate in rates.values()) * 100 or 1.0
        for row, (unit, data) in enumerate(units.items()):
            title = _map_title(unit, kind, data, among, population)
            shown = _map(grid[row][column], rates[unit], title, high)
        bar = figure.colorbar(shown, ax=[rows[column] for rows in grid], shrink=0.6, pad=0.03)
        bar.set_label(f"{kind} hits, % of {population} in the bin")
        bar.outline.set_visible(False)
    return plotting.save(figure, out, NAME)


def _draw_near_axis(found: dict[str, Any], out: Path) -> list[Path]:
    import numpy as np

    near = found["near_axis"]
    figure, panels = plotting.new(10, 3.8, columns=2)
    exponents = near["log2_d"]
    for axes, (kind, among, population) in zip(panels, _KINDS, strict=True):
        for index, (unit, data) in enumerate(near["units"].items()):
            rate = _rate(data[kind], data[among]) * 100
            style = {"color": charts.unit_colour(unit, index), "marker": "os^D"[index % 4]}
            # The unit that errs least is drawn last, so that zeros are seen.
            order = 2 + 1 / (1 + float(np.nansum(rate)))
            axes.plot(exponents, rate, label=_title(unit), markersize=4, zorder=order, **style)
        axes.set_title(f"{kind.capitalize()} hits, % of {population}", loc="left", fontsize=10)
        axes.set_xlabel("smallest component of the direction, |d|")
        ticks = range(int(exponents[0] - 0.5), 1, 5)
        axes.set_xticks(list(ticks), [f"$2^{{{e}}}$" for e in ticks])
        axes.set_ylim(bottom=0)
        if "aqb8" in near["units"]:
            axes.axvline(_AQB8_LIMIT, color="#6b7280", linewidth=1, linestyle=":")
            words = "below $2^{-16}$ AQB8's\n5-bit shift overflows"
            place = (_AQB8_LIMIT + 0.5, axes.get_ylim()[1] * 0.97)
            axes.annotate(words, place, va="top", fontsize=8.5, color="#5b6577")
    panels[0].legend(loc="center right")
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


def origin_words(precision: dict[str, Any]) -> str:
    """Names the design of the quantized origin: the paper's is an unsigned byte."""
    if precision["origin"] == "literal":
        return f"origin UINT{precision['origin_bits']}, as the paper's"
    sign = ", signed" if precision["origin"] == "wide" else ", guarded"
    return f"origin of {precision['origin_bits']} bits{sign}"


def paper_rows(found: dict[str, Any], rates: dict[str, dict[str, float]]) -> list[dict]:
    """The paper's numbers beside each design of A²RT, the paper's own first."""
    designs = found["precision"]
    rows = []
    for unit in sorted(designs, key=lambda unit: designs[unit]["origin"] != "literal"):
        ours = {
            "fig6.redundant": (_ratio(rates, unit, "redundant"), "ratio of two rates, all pairs"),
            "fig6.missed": (rates[unit]["missed_hits"], "sum over all pairs"),
        }
        for row in plotting.beside(NAME, []):
            value, how = ours[row["id"]]
            what = f"{row['what']}, {origin_words(designs[unit])}"
            rows.append({**row, "what": what, "unit": unit, "ours": value, "how": how})
    return rows


def draw(context: Context) -> Drawn:
    raw = context.out / f"{NAME}-directions.json"
    units = [unit for unit in context.experiment.units if unit != "baseline"]
    with console.step("Testing boxes over all directions") as shown:
        found = core.direction_map(units, BINS, PAIRS, raw, shown)
    # In the experiment's order; the file's is the alphabet's.
    found["units"] = {unit: found["units"][unit] for unit in units}
    files = [*_draw_maps(found, context.out), *_draw_near_axis(found, context.out)]
    rates = totals(found)
    rows = paper_rows(found, rates)
    files.append(plotting.write_numbers(context.out, NAME, rows, totals=rates))
    cells = [
        (
            unit,
            origin_words(found["precision"][unit]) if unit in found["precision"] else "",
            formats.percent(rate["redundant"], 3),
            formats.percent(rate["missed"], 3),
            formats.count(rate["missed_hits"]),
            formats.count(rate["exact_hits"]),
        )
        for unit, rate in rates.items()
    ]
    columns = ("unit", "design", "redundant of misses", "missed of hits", "missed", "exact hits")
    text = f"{console.table(columns, cells, left=2)}\n\n{plotting.beside_text(rows)}"
    return Drawn(text, files)


def _ratio(rates: dict[str, dict[str, float]], unit: str, key: str) -> float | None:
    return results.ratio(rates[unit][key], rates.get("aqb8", {}).get(key))
