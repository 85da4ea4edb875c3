"""Where did the time go: per workload, what every part of the machine did with its cycles."""

from __future__ import annotations

import base64
import io
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from a2rt_cli import formats, results
from a2rt_cli.report import charts, plots, stalls
from a2rt_cli.report.table import Table
from a2rt_cli.results import Result

PARTS = {
    "rt_unit": "The RT units",
    "scheduler": "The SMs' schedulers",
    "rt_lane": "The lanes of warps in the RT units",
}
TESTERS = {
    "box": "BOX (FP32 boxes)",
    "qbox": "QBOX (quantized boxes)",
    "quantizer": "ray quantizers",
    "anchor": "anchor units",
    "update": "update units",
    "dequantize": "dequantizers",
    "triangle": "TRI (triangles)",
    "transform": "instance transforms",
    "setup": "ray set-up",
}
OTHERS = {
    "rt_port": "the RT units' L1 port",
    "lsu_port": "the SMs' L1 port",
    "l1_banks": "L1 banks",
    "l2_slices": "L2 slices",
    "dram_bus": "DRAM bus",
    "schedulers": "SM issue slots",
}
TRAFFIC = {
    "node": ("FP32 nodes", "#6b7280"),
    "group_node": ("group nodes", "#56b4e9"),
    "sub_node": ("sub nodes", "#0072b2"),
    "anchor": ("anchor nodes", "#e69f00"),
    "triangle": ("triangles", "#009e73"),
    "aabb": ("procedural boxes", "#d55e00"),
    "instance": ("instances", "#f0e442"),
    "stack": ("stack spills", "#1a2230"),
    "shader": ("shader data", "#cc79a7"),
}
# Kinds that a later engine may add still get a colour.
_SPARE = "#9aa3b2"


@dataclass
class Heat:
    unit: str
    source: str  # data URI
    detail: str


@dataclass
class TimeSection:
    """One workload. `spent`: (title, legend, SVG) per part of the machine."""

    name: str
    sentences: list[str]
    spent: list[tuple[str, str, str]]
    occupancy: list[tuple[str, str]]  # title, SVG
    utilisation: Table
    traffic: tuple[str, str]
    histogram: str
    heats: list[Heat]
    heat_scale: str


def sections(found: Sequence[Result], folder: Path) -> list[TimeSection]:
    out = []
    for name, group in results.by_workload(results.primary(found)).items():
        timed = [one for one in group if results.is_timed(one)]
        if timed:
            out.append(_section(name, timed, folder))
    return out


def _section(name: str, timed: Sequence[Result], folder: Path) -> TimeSection:
    heats, scale = _heat_maps(timed, folder)
    return TimeSection(
        name,
        [sentence(one) for one in timed if stalls.bound(one)],
        [_spent(timed, part, title) for part, title in PARTS.items()],
        _occupancy(timed),
        _utilisation(timed),
        _traffic(timed),
        _histogram(timed),
        heats,
        scale,
    )


def sentence(one: Result) -> str:
    found = stalls.bound(one)
    assert found is not None
    share, testing = formats.percent(found.share, 0), formats.percent(found.testing, 0)
    text = f"{results.label(one)}: with a warp to trace, an RT unit spends {share} of its cycles "
    text += found.what
    if found.what != "testing":
        text += f" and {testing} testing"
    busiest = TESTERS.get(found.busiest, found.busiest)
    text += f"; its busiest testers ({busiest}) are {formats.percent(found.utilisation)} in use"
    dram = results.get(one, "time.utilisation.dram_bus")
    l1 = results.get(one, "memory.levels.l1.hit_rate")
    if dram is not None and l1 is not None:
        text += f", L1 answers {formats.percent(l1, 0)} of reads"
        text += f" and the DRAM bus is {formats.percent(dram)} busy"
    return text + "."


def _spent(timed: Sequence[Result], part: str, title: str) -> tuple[str, str, str]:
    """Bars of shares: bars of different lengths would compare runs of different cycles."""
    found = {results.label(one): stalls.shares(one, part) for one in timed}
    names = [
        words
        for words in dict.fromkeys(stalls.WORDS[part].values())
        if any(group.get(words, 0) > 0 for group in found.values())
    ]
    names += [w for group in found.values() for w in group if w not in names and group[w] > 0]
    names = list(dict.fromkeys(names))
    colours = {words: stalls.colour(words) for words in names}
    bars = [
        charts.Bar("", label, {words: group.get(words, 0.0) for words in names})
        for label, group in found.items()
    ]
    return title, charts.legend(colours), charts.stacked(bars, colours, _nothing, title, marks=True)


def _nothing(_: float) -> str:
    return ""


def _occupancy(timed: Sequence[Result]) -> list[tuple[str, str]]:
    wanted = {"rt_warps": "Warps in the RT units", "rt_rays": "Rays in the RT units"}
    out = []
    for name, title in wanted.items():
        drawn = []
        for one in timed:
            series = next(
                (s for s in results.get(one, "time.series", []) if s["name"] == name), None
            )
            if series:
                drawn.append(plots.Line(results.label(one), _points(series, one)))
        if drawn:
            text = plots.lines(
                drawn, title, "cycles", write_x=lambda x: f"{x:,.0f}", write_y=lambda y: f"{y:,.0f}"
            )
            out.append((title, text))
    return out


def _points(series: dict, one: Result) -> list[tuple[float, float]]:
    """Bin centres; long runs are thinned so that a page of many runs stays small."""
    width, means = series["bin_cycles"], series["means"]
    step = max(1, len(means) // 120)
    out = []
    for start in range(0, len(means), step):
        part = means[start : start + step]
        out.append(((start + len(part) / 2) * width, sum(part) / len(part)))
    end = results.get(one, "time.cycles")
    return [(min(x, end), y) for x, y in out]


def _utilisation(timed: Sequence[Result]) -> Table:
    rows = []
    for kind, words in {**TESTERS, **OTHERS}.items():
        cells = [_use(one, kind) for one in timed]
        if any(cell != formats.NOTHING for cell in cells):
            rows.append([words, *cells])
    return Table(
        ["in use, share of cycles", *[results.label(one) for one in timed]],
        rows,
        "In brackets: how many there are. A tester in use starts a test in that cycle.",
    )


def _use(one: Result, kind: str) -> str:
    used = results.get(one, f"time.utilisation.{kind}")
    if used is None:
        return formats.NOTHING
    count = results.get(one, f"time.testers.{kind}.count")
    return formats.percent(used) + (f" ({count})" if count else "")


def _traffic(timed: Sequence[Result]) -> tuple[str, str]:
    """Bytes at each level by kind of data; each level has its own scale."""
    bars, seen = [], []
    for level, title in (("l1", "L1"), ("l2", "L2"), ("dram", "DRAM")):
        for one in timed:
            kinds = results.get(one, f"memory.levels.{level}.by_kind", {})
            parts = {kind: float(entry.get("bytes", 0)) for kind, entry in kinds.items()}
            seen += [kind for kind, value in parts.items() if value > 0 and kind not in seen]
            named = {kind_words(kind)[0]: value for kind, value in parts.items()}
            bars.append(charts.Bar(title, results.label(one), named))
    order = [kind for kind in TRAFFIC if kind in seen] + [k for k in seen if k not in TRAFFIC]
    colours = dict(kind_words(kind) for kind in order)
    for bar in bars:
        for name in bar.parts:
            colours.setdefault(name, _SPARE)
    shown = dict(kind_words(kind) for kind in order)
    chart = charts.stacked(bars, colours, formats.size, "Bytes moved at each level, by kind")
    return charts.legend(shown), chart


def kind_words(kind: str) -> tuple[str, str]:
    """Words and colour of a kind of traffic; the same in every chart."""
    return TRAFFIC.get(kind, (kind.replace("_", " "), _SPARE))


def _histogram(timed: Sequence[Result]) -> str:
    edges: list[int] = []
    for one in timed:
        edges += [b["from"] for b in results.get(one, "time.ray_cycles.bins", [])]
    edges = sorted(set(edges))
    if not edges:
        return ""
    heights = {}
    for one in timed:
        counts = {b["from"]: b["rays"] for b in results.get(one, "time.ray_cycles.bins", [])}
        total = sum(counts.values()) or 1
        heights[results.label(one)] = [counts.get(edge, 0) / total for edge in edges]
    return plots.histogram(
        [f"{edge:,}" for edge in edges],
        heights,
        "Cycles from a ray's entry into the RT unit to its end",
        "cycles of a ray in the RT unit (each column up to twice its left edge)",
    )


def _heat_maps(timed: Sequence[Result], folder: Path) -> tuple[list[Heat], str]:
    """Cycles per pixel; all units of a workload share one scale."""
    import numpy as np

    maps = {}
    for one in timed:
        path = folder / one["heatmap"] if one.get("heatmap") else None
        if path is not None and path.is_file():
            cycles = np.load(path)
            if cycles.ndim == 2:
                maps[results.label(one)] = cycles
    if not maps:
        return [], ""
    high = max(float(np.percentile(cycles, 99.5)) for cycles in maps.values()) or 1.0
    heats = [
        Heat(label, _picture(cycles, high), f"mean {cycles.mean():,.0f}, most {cycles.max():,}")
        for label, cycles in maps.items()
    ]
    return heats, f"dark: 0 cycles, bright: {high:,.0f} or more"


def _picture(cycles, high: float) -> str:
    import matplotlib
    import numpy as np
    from PIL import Image

    colours = matplotlib.colormaps["cividis"](np.clip(cycles / high, 0, 1), bytes=True)
    stream = io.BytesIO()
    Image.fromarray(colours[:, :, :3]).save(stream, format="PNG", optimize=True)
    return "data:image/png;base64," + base64.b64encode(stream.getvalue()).decode("ascii")
