"""Figure 8: speedup over the baseline (line) and energy by part (bars), for both comparisons."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from a2rt_cli import formats, plotting, results
from a2rt_cli.console import table
from a2rt_cli.figures import Context, Drawn
from a2rt_cli.report import charts, gap, measures
from a2rt_cli.results import Result
from a2rt_cli.tables import COMPARISON_WORDS

TITLE = "normalised speedup and energy of baseline, AQB8 and A²RT"
NAME = "fig8"
# Energy components of the ledger, gathered into what a bar can show.
PARTS = {
    "box testers": (
        "box",
        "qbox_a2rt",
        "qbox_aqb8",
        "quantizer",
        "anchor",
        "update",
        "dequantizer",
    ),
    "triangles, set-up": ("triangle", "transform", "setup"),
    "RT buffers": ("ray_buffer", "rt_stack", "rt_context"),
    "L1": ("l1",),
    "L2, crossbar": ("l2", "crossbar"),
    "DRAM": ("dram",),
    "SM": ("sm",),
}
OTHER = "other"
LOSES = "×"  # marks the bars of runs that lose hits
LEGEND = (
    f"{LOSES}: the unit loses hits, work it does not do. *: not printed, follows from two others"
)
FAITHFUL = "where neither loses a hit"


def paper_means() -> dict[str, dict[str, float]]:
    """Section V-C.4 and 5: the means of Fig. 8. AQB8's follow from A²RT's two ratios."""
    printed = {one.id: one.value for one in measures.paper_numbers() if one.figure == NAME}
    out = {}
    for kind in ("energy", "speedup"):
        a2rt, over_aqb8 = (printed[f"{NAME}.{kind}_{unit}"] for unit in ("baseline", "aqb8"))
        out[kind] = {"baseline": 1.0, "aqb8": a2rt / over_aqb8, "a2rt": a2rt}
    return out


def parts_of(one: Result) -> dict[str, float]:
    """Energy in pJ by part; every component of the ledger is in exactly one."""
    place = {component: part for part, names in PARTS.items() for component in names}
    out = dict.fromkeys([*PARTS, OTHER], 0.0)
    for component, energy in results.get(one, "energy.by_component", {}).items():
        out[place.get(component, OTHER)] += energy
    return out


def _rows_of(found: Sequence[Result]) -> dict[str, list[str]]:
    """Workload names by the shaders they run: one row of the figure each."""
    out: dict[str, list[str]] = {}
    for name, group in results.by_workload(found).items():
        out.setdefault(group[0]["workload"].get("workload", ""), []).append(name)
    return out


def _units(found: Sequence[Result]) -> list[str]:
    return list(dict.fromkeys(results.plain_label(one) for one in found))


def _loses(group: Sequence[Result], unit: str) -> bool:
    one = measures.pick(results.primary(group), unit)
    return one is not None and bool(results.lost_hits(one))


def _draw_row(axes, names: Sequence[str], found: Sequence[Result], comparison: str) -> None:
    groups, units = results.by_workload(found), _units(found)
    colours = {**charts.series_colours(list(PARTS)), OTHER: "#9aa3b2"}
    width = 0.8 / len(units)
    highest = 1.0
    for column, name in enumerate(names):
        base = measures.pick(groups[name], results.BASELINE, comparison)
        whole = measures.energy(base) if base else None
        for index, unit in enumerate(units):
            one = measures.pick(groups[name], unit, comparison)
            if one is None or not whole:
                continue
            x, bottom = column + (index - (len(units) - 1) / 2) * width, 0.0
            for part, energy in parts_of(one).items():
                share = energy / whole
                axes.bar(x, share, width * 0.88, bottom=bottom, color=colours[part])
                bottom += share
            if _loses(groups[name], unit):
                axes.text(x, bottom, LOSES, ha="center", color="#b00020", weight="bold", size=13)
            highest = max(highest, bottom)
    highest = max(highest, _draw_means(axes, len(names), names, found, comparison))
    labels = [name.rsplit("-", 1)[0] for name in names]
    axes.set_xticks(range(len(names) + 2), [*labels, "mean", "paper,\nits mean"])
    axes.set_ylabel("energy, of baseline's")
    axes.set_ylim(0, 1.16 * highest)


def _draw_means(axes, first: int, names, found, comparison: str) -> float:
    """Grey bars: the row's geometric mean, then the paper's mean over its own scenes."""
    units = _units(found)
    width = 0.8 / len(units)
    row = [one for one in found if results.workload_name(one) in names]
    paper = paper_means()["energy"]
    highest = 0.0
    for index, unit in enumerate(units):
        x = (index - (len(units) - 1) / 2) * width
        mean = measures.mean_ratio(row, unit, results.BASELINE, measures.energy, comparison)
        for place, value in ((first, mean), (first + 1, paper.get(unit))):
            if value is not None:
                hatch = "" if place == first else "///"
                axes.bar(place + x, value, width * 0.88, color="#c3c9d4", hatch=hatch)
                highest = max(highest, value)
    return highest


def _draw_speed(axes, names: Sequence[str], found: Sequence[Result], comparison: str) -> None:
    units = _units(found)
    width = 0.8 / len(units)
    row = [one for one in found if results.workload_name(one) in names]
    highest = 1.0
    for place, name in enumerate([*names, "mean", "paper"]):
        points = []
        for index, unit in enumerate(units):
            speed = _speed(row, unit, name, comparison)
            if speed is not None:
                points.append((place + (index - (len(units) - 1) / 2) * width, speed, unit))
        if points:
            axes.plot([p[0] for p in points], [p[1] for p in points], color="#1a2230", lw=0.8)
        for x, speed, unit in points:
            highest = max(highest, speed)
            derived = "*" if name == "paper" and unit == "aqb8" else ""
            axes.plot(x, speed, "o", color=_colour(units, unit), mec="#1a2230", ms=6, mew=0.8)
            axes.annotate(
                f"{speed:.2f}{derived}",
                (x, speed),
                (0, 7),
                textcoords="offset points",
                ha="center",
                size=8,
                bbox={"boxstyle": "round,pad=0.12", "fc": "white", "ec": "none", "alpha": 0.85},
            )
    axes.set_ylabel("speedup")
    axes.set_ylim(0, 1.25 * highest)
    axes.grid(False)
    axes.spines["right"].set_visible(True)


def _speed(row: Sequence[Result], unit: str, name: str, comparison: str) -> float | None:
    if name == "paper":
        return paper_means()["speedup"].get(unit)
    shares = measures.ratios(row, unit, results.BASELINE, measures.cycles, comparison)
    share = formats.geometric_mean(list(shares.values())) if name == "mean" else shares.get(name)
    return 1 / share if share else None


def _colour(units: Sequence[str], unit: str) -> str:
    return charts.unit_colour(unit, units.index(unit))


def _draw(found: Sequence[Result], comparison: str, out: Path) -> list[Path]:
    rows = _rows_of(found)
    widest = max(len(names) for names in rows.values())
    figure, _ = plotting.new(max(9.0, 1.35 * (widest + 2) + 2), 3.1 * len(rows) + 0.9)
    figure.clf()
    grid = figure.subplots(len(rows), 1, squeeze=False)
    for axes, (shaders, names) in zip(grid[:, 0], rows.items(), strict=True):
        _draw_row(axes, names, found, comparison)
        _draw_speed(axes.twinx(), names, found, comparison)
        axes.set_title(f"{shaders}: {COMPARISON_WORDS[comparison]}", loc="left", fontsize=10)
    colours = charts.series_colours(list(PARTS))
    handles = [grid[0, 0].bar(0, 0, color=colours[part], label=part) for part in PARTS]
    units = _units(found)
    for unit in units:
        handles += grid[0, 0].plot(
            [], [], "o", color=_colour(units, unit), mec="#1a2230", label=f"{unit}: speedup"
        )
    title = f"bars, left to right: {', '.join(units)}. {LEGEND}"
    figure.legend(handles=handles, loc="outside lower center", ncols=5, title=title)
    return plotting.save(figure, out, f"{NAME}-{comparison}")


def _table(found: Sequence[Result]) -> str:
    rows = []
    for name, group in results.by_workload(found).items():
        for unit in _units(found):
            one = measures.pick(results.primary(group), unit)
            cells = [name, unit, formats.count(results.lost_hits(one) if one else None)]
            for comparison in COMPARISON_WORDS:
                cells += _cells(group, unit, comparison)
            rows.append(cells)
    for unit in _units(found):
        rows.append(_mean_row("geometric mean", found, unit))
    for unit in _units(found):
        kept = measures.without_losses(found, [unit, results.BASELINE])
        number, of = len(results.by_workload(kept)), len(results.by_workload(found))
        rows.append(_mean_row(f"no lost hits: {number} of {of}", kept, unit))
    columns = ["workload", "unit", "lost hits", "cycles", "speedup", "energy", "of base."]
    columns += ["| area: cycles", "speedup", "energy", "of base."]
    return table(columns, rows, left=2)


def _mean_row(title: str, among: Sequence[Result], unit: str) -> list[str]:
    cells = [title, unit, formats.NOTHING]
    for comparison in COMPARISON_WORDS:
        cells += _mean_cells(among, unit, comparison)
    return cells


def _cells(group: Sequence[Result], unit: str, comparison: str) -> list[str]:
    one = measures.pick(group, unit, comparison)
    base = measures.pick(group, results.BASELINE, comparison)
    if one is None or base is None:
        return [formats.NOTHING] * 4
    return [
        formats.count(measures.cycles(one)),
        formats.factor(results.ratio(measures.cycles(base), measures.cycles(one))),
        formats.energy(measures.energy(one)),
        formats.percent(results.ratio(measures.energy(one), measures.energy(base))),
    ]


def _mean_cells(found: Sequence[Result], unit: str, comparison: str) -> list[str]:
    speed = measures.mean_ratio(found, unit, results.BASELINE, measures.cycles, comparison)
    energy = measures.mean_ratio(found, unit, results.BASELINE, measures.energy, comparison)
    faster = formats.factor(1 / speed if speed else None)
    return [formats.NOTHING, faster, formats.NOTHING, formats.percent(energy)]


def _paper_rows(found: Sequence[Result]) -> list[dict]:
    """The paper's numbers beside both comparisons, over all workloads and over the faithful."""
    rows = []
    for comparison, words in COMPARISON_WORDS.items():
        for row in plotting.beside(NAME, found):
            kind, against = row["id"].removeprefix(f"{NAME}.").split("_")
            faithful = measures.without_losses(found, ["a2rt", against])
            kept, of = len(results.by_workload(faithful)), len(results.by_workload(found))
            what = f"{row['what']}, {words.removesuffix(' of box testers')}"
            rows.append({**row, "what": what, "ours": _against(found, kind, against, comparison)})
            if kept < of:
                value = _against(faithful, kind, against, comparison)
                more = f"{what}, {FAITHFUL} ({kept} of {of})"
                rows.append({**row, "what": more, "ours": value})
    return rows


def _against(found: Sequence[Result], kind: str, unit: str, comparison: str) -> float | None:
    value = measures.cycles if kind == "speedup" else measures.energy
    ratio = measures.mean_ratio(found, "a2rt", unit, value, comparison)
    return 1 / ratio if ratio and kind == "speedup" else ratio


def draw(context: Context) -> Drawn:
    found = context.runs()
    rows = _paper_rows(found)
    files: list[Path] = []
    for comparison in COMPARISON_WORDS:
        files += _draw(found, comparison, context.out)
    words = gap.sentences(found)
    files.append(plotting.write_numbers(context.out, NAME, rows, gap=words))
    means = (
        "Means are geometric, over the workloads of this table; the second ones over those in "
        "which neither the\nunit nor the baseline loses a hit: work that is not done because a hit "
        "is missed is no gain."
    )
    said = "\n".join(f"- {one}" for one in words)
    parts = [_table(found), means, plotting.beside_text(rows), f"The gap, as measured:\n{said}"]
    return Drawn("\n\n".join(parts), files)
