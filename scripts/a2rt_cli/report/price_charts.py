"""The price list's charts as inline SVG: what each value of a knob buys, and what it costs.

Colours are Okabe and Ito's; lines are told apart by marker and label as well, bars carry numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from html import escape

from a2rt_cli import formats
from a2rt_cli.report.price import Cost, Price

_WIDTH, _HEIGHT = 1010, 280
_TOP, _BOTTOM = 44, 236
_BARS = (52, 440)  # x of the left panel
_LINES = (540, 848)  # x of the right panel; names of the lines stand right of it
_BUYS, _LOSES = "#0072b2", "#d55e00"
# Values far outside what the steps beside the unit's own value show are drawn at the panel's edge
# with their number, or they would press everything else flat.
_OUTLIER, _LEAST_CAP = 3.0, 0.15
# Relative changes below this are drawn on an axis this high: noise must not look like a trend.
_LEAST_RANGE = 0.02


@dataclass(frozen=True)
class Series:
    name: str
    colour: str
    marker: str
    value: Callable[[Cost], float | None]


SERIES = (
    Series("time", "#000000", "circle", lambda c: c.cycles),
    Series("energy", "#e69f00", "square", lambda c: c.energy),
    Series("node bytes", "#56b4e9", "diamond", lambda c: c.node_bytes),
    Series("tester area", "#009e73", "triangle", lambda c: c.area_ratio),
)


def _text(x: float, y: float, text: str, anchor: str = "middle", cls: str = "t") -> str:
    place = f'x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}"'
    return f'<text {place} class="{cls}">{escape(text)}</text>'


def _marker(kind: str, x: float, y: float, colour: str, tip: str) -> str:
    tip = f"<title>{escape(tip)}</title>"
    if kind == "circle":
        return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4.5" fill="{colour}">{tip}</circle>'
    shapes = {
        "square": [(-4, -4), (4, -4), (4, 4), (-4, 4)],
        "diamond": [(0, -6), (6, 0), (0, 6), (-6, 0)],
        "triangle": [(0, -5), (5, 4), (-5, 4)],
    }
    points = " ".join(f"{x + dx:.1f},{y + dy:.1f}" for dx, dy in shapes[kind])
    return f'<polygon points="{points}" fill="{colour}">{tip}</polygon>'


def _columns(count: int, left: float, right: float) -> list[float]:
    step = (right - left) / count
    return [left + step * (i + 0.5) for i in range(count)]


def _band(rows: Sequence[Price], xs: Sequence[float]) -> str:
    """Marks the unit's own value."""
    at = next((x for row, x in zip(rows, xs, strict=True) if row.is_default), None)
    if at is None:
        return ""
    half = (xs[1] - xs[0]) / 2 if len(xs) > 1 else 30
    place = f'x="{at - half:.1f}" y="{_TOP - 8}" width="{2 * half:.1f}"'
    return f'<rect {place} height="{_BOTTOM - _TOP + 8}" class="own"/>'


def _ticks(rows: Sequence[Price], xs: Sequence[float]) -> list[str]:
    crowded = max(len(row.label) for row in rows) * 7 > (xs[1] - xs[0] if len(xs) > 1 else 400)
    out = []
    for row, x in zip(rows, xs, strict=True):
        if crowded:
            place = f'transform="translate({x + 4:.1f} {_BOTTOM + 14}) rotate(-32)"'
            out.append(f'<text {place} text-anchor="end" class="t">{escape(row.label)}</text>')
        else:
            cls = "t b" if row.is_default else "t"
            out.append(_text(x, _BOTTOM + 18, row.label, cls=cls))
    return out


def _bars(rows: Sequence[Price]) -> list[str]:
    xs = _columns(len(rows), *_BARS)
    known = [row.cost.redundant for row in rows if row.cost.redundant is not None]
    if not known:
        return []
    high = max(known) or 1.0
    wide = min(46.0, (_BARS[1] - _BARS[0]) / len(rows) * 0.62)
    digits = 1 if high > 0.1 else 2
    out = [_text(_BARS[0], 16, "What it buys: redundant box hits, % of true misses", "start", "h")]
    out.append(_band(rows, xs))
    for row, x in zip(rows, xs, strict=True):
        value = row.cost.redundant
        if value is None:
            continue
        height = (_BOTTOM - _TOP - 16) * value / high
        colour = _LOSES if row.cost.lost_hits else _BUYS
        place = f'x="{x - wide / 2:.1f}" y="{_BOTTOM - height:.1f}" width="{wide:.1f}"'
        tip = f"<title>{escape(row.label)}: {formats.percent(value, 3)}</title>"
        out.append(f'<rect {place} height="{height:.1f}" fill="{colour}">{tip}</rect>')
        out.append(_text(x, _BOTTOM - height - 5, f"{value * 100:.{digits}f}"))
        if row.cost.lost_hits and height > 24:
            lost = f"−{int(row.cost.lost_hits):,}"
            out.append(_text(x, _BOTTOM - 7, lost, cls="t inverse"))
    out += _ticks(rows, xs)
    if any(row.cost.lost_hits for row in rows):
        out.append(
            _text(
                _BARS[0],
                34,
                "orange: loses hits; the number in the bar says how many rays",
                "start",
                "t soft",
            )
        )
    return out


def _lines(rows: Sequence[Price]) -> list[str]:
    xs = _columns(len(rows), *_LINES)
    every = [(series, [series.value(row.cost) for row in rows]) for series in SERIES]
    shown = [(series, values) for series, values in every if any(v is not None for v in values)]
    if not shown:
        return []
    low, high = _range(rows, [values for _, values in shown])

    def y(change: float) -> float:
        return _BOTTOM - (min(change, high) - low) / (high - low) * (_BOTTOM - _TOP)

    own = next((row.label for row in rows if row.is_default), "")
    title = f"What it costs: change against {own}" if own else "What it costs"
    out = [_text(_LINES[0], 16, title, "start", "h"), _band(rows, xs)]
    for tick in _nice(low, high):
        cls = "zero" if tick == 0 else "grid"
        place = f'x1="{_LINES[0]}" x2="{_LINES[1]}" y1="{y(tick):.1f}" y2="{y(tick):.1f}"'
        out.append(f'<line {place} class="{cls}"/>')
        out.append(_text(_LINES[0] - 6, y(tick) + 4, _signed(tick), "end"))
    ends = []
    for series, values in shown:
        dots = [
            (x, y(v - 1), row.label, v)
            for x, v, row in zip(xs, values, rows, strict=True)
            if v is not None
        ]
        if rows[0].knob.order:
            path = " ".join(f"{x:.1f},{at:.1f}" for x, at, _, _ in dots)
            line = f'fill="none" stroke="{series.colour}" stroke-width="2"'
            out.append(f'<polyline points="{path}" {line}/>')
        for index, (x, at, label, value) in enumerate(dots):
            tip = f"{series.name} at {label}: {(value - 1) * 100:+.2f} %"
            out.append(_marker(series.marker, x, at, series.colour, tip))
            if value - 1 > high and series is shown[0][0]:
                lift = 6 + 9 * (index % 2)  # neighbours must not touch
                out.append(_text(x, at - lift, f"{(value - 1) * 100:+.0f}%", cls="t small"))
        ends.append((dots[-1][1], series, dots[-1][3]))
    out += _names(ends) + _ticks(rows, xs)
    return out


def _range(rows: Sequence[Price], series: Sequence[Sequence[float | None]]) -> tuple[float, float]:
    """Lowest and highest change that the panel shows."""
    own = next((i for i, row in enumerate(rows) if row.is_default), 0)
    near = range(max(0, own - 1), min(len(rows), own + 2))
    flat = [value - 1 for values in series for value in values if value is not None]
    beside = [abs(values[i] - 1) for values in series for i in near if values[i] is not None]
    cap = max(_LEAST_CAP, _OUTLIER * max(beside, default=0.0)) if rows[own].knob.order else None
    low, high = min(0.0, *flat), max(0.0, *flat)
    high = high if cap is None else min(high, cap)
    spare = max(0.0, _LEAST_RANGE - (high - low)) / 2
    margin = (high - low) * 0.04 + spare
    return low - margin, high + margin


def _names(ends: Sequence[tuple[float, Series, float]]) -> list[str]:
    """Names at the lines' ends, moved apart where they would overlap."""
    out, last = [], 0.0
    places = sorted(ends, key=lambda end: end[0])
    room = _BOTTOM - 17 * (len(places) - 1)
    for index, (y, series, value) in enumerate(places):
        at = max(min(y, room + 17 * index), last + 17 if index else _TOP)
        last = at
        out.append(_marker(series.marker, _LINES[1] + 12, at, series.colour, series.name))
        words = f"{series.name} {(value - 1) * 100:+.1f} %".replace("-", "−")
        out.append(_text(_LINES[1] + 22, at + 4, words, "start"))
    return out


def _signed(tick: float) -> str:
    return f"{tick * 100:+.3g} %".replace("-", "−") if tick else "0"


def _nice(low: float, high: float) -> list[float]:
    raw = (high - low) / 4
    power = 10.0 ** len(f"{int(1 / raw)}") if raw < 1 else 1.0
    step = next(m / power for m in (0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100) if m / power >= raw)
    first = int(low / step) - 1
    ticks = [step * i for i in range(first, first + 20)]
    return [round(t, 9) for t in ticks if low - 1e-9 <= t <= high + 1e-9]


def ladder(rows: Sequence[Price]) -> str:
    """Redundant hits as bars, prices as lines, over the values of one knob."""
    parts = [*_bars(rows), *_lines(rows)]
    title = escape(f"{rows[0].knob.title}: what each value buys and costs")
    box = f'viewBox="0 0 {_WIDTH} {_HEIGHT}"'
    return (
        f'<svg {box} role="img" class="chart ladder"><title>{title}</title>{"".join(parts)}</svg>'
    )
