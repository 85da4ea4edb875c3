"""Lines and histograms as inline SVG, in the look of charts.py.

A line is told apart by its colour and by its dashes, so that it survives a black-and-white print.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from html import escape

from a2rt_cli.report import charts

_DASHES = ("", "7 4", "2 3", "9 3 2 3", "4 2", "12 4")
_WIDTH, _HEIGHT = 860, 190
_LEFT, _RIGHT, _TOP, _BOTTOM = 64, 120, 14, 40


@dataclass(frozen=True)
class Line:
    label: str
    points: Sequence[tuple[float, float]]


def nice_ticks(most: float, wanted: int = 4) -> list[float]:
    """Round steps from 0 to at least `most`."""
    if most <= 0:
        return [0.0, 1.0]
    raw = most / wanted
    power = 10 ** (len(str(int(raw))) - 1) if raw >= 1 else 10.0 ** _exponent(raw)
    step = next(m * power for m in (1, 2, 2.5, 5, 10) if m * power >= raw)
    count = int(most / step + 0.999)
    return [step * i for i in range(count + 1)]


def _exponent(value: float) -> int:
    exponent = 0
    while value < 1:
        value *= 10
        exponent -= 1
    return exponent


def _frame(
    ticks_x: Sequence[tuple[float, str]], ticks_y: Sequence[tuple[float, str]], words: str
) -> list[str]:
    out = []
    right = _WIDTH - _RIGHT
    for y, text in ticks_y:
        out.append(f'<line x1="{_LEFT}" x2="{right}" y1="{y:.1f}" y2="{y:.1f}" class="g"/>')
        out.append(charts.text(_LEFT - 8, y + 4, text, "end"))
    for x, text in ticks_x:
        out.append(charts.text(x, _HEIGHT - _BOTTOM + 16, text, "middle"))
    out.append(charts.text((_LEFT + _WIDTH - _RIGHT) / 2, _HEIGHT - 6, words, "middle"))
    return out


def _key(index: int, name: str, colour: str, dash: str | None) -> str:
    """One name of the legend to the right of the axes; with the line's dashes if it is a line."""
    x, y = _WIDTH - _RIGHT + 8, _TOP + 8 + 17.0 * index
    sample = (
        f'<rect x="{x}" y="{y - 5:.1f}" width="10" height="10" fill="{colour}"/>'
        if dash is None
        else f'<line x1="{x}" x2="{x + 24}" y1="{y:.1f}" y2="{y:.1f}" stroke="{colour}" '
        f'stroke-width="2.2" stroke-dasharray="{dash}"/>'
    )
    return sample + charts.text(x + (15 if dash is None else 29), y + 4, name)


def lines(
    found: Sequence[Line],
    title: str,
    across: str,
    *,
    write_x: Callable[[float], str],
    write_y: Callable[[float], str],
    top: float | None = None,
) -> str:
    """Each line from its first to its last point; x and y start at 0. `top`: end of the y axis."""
    most_x = max((x for line in found for x, _ in line.points), default=1.0) or 1.0
    most_y = top or max((y for line in found for _, y in line.points), default=1.0)
    ticks = nice_ticks(most_y)
    most_y = ticks[-1] if top is None else top

    def place(x: float, y: float) -> tuple[float, float]:
        return (
            _LEFT + (_WIDTH - _LEFT - _RIGHT) * x / most_x,
            _TOP + (_HEIGHT - _TOP - _BOTTOM) * (1 - min(y, most_y) / most_y),
        )

    out = _frame(
        [(place(x, 0)[0], write_x(x)) for x in nice_ticks(most_x, 6) if x <= most_x],
        [(place(0, y)[1], write_y(y)) for y in ticks if y <= most_y],
        across,
    )
    for index, line in enumerate(found):
        colour = charts.unit_colour(line.label, index)
        dash = _DASHES[index % len(_DASHES)]
        spots = [place(x, y) for x, y in line.points]
        path = " ".join(f"{x:.1f},{y:.1f}" for x, y in spots)
        out.append(
            f'<polyline points="{path}" fill="none" stroke="{colour}" stroke-width="1.8" '
            f'stroke-dasharray="{dash}"><title>{escape(line.label)}</title></polyline>'
        )
        out.append(_key(index, line.label, colour, dash))
    return charts.svg(out, _HEIGHT, title, _WIDTH)


def histogram(
    bins: Sequence[str], heights: Mapping[str, Sequence[float]], title: str, across: str
) -> str:
    """Columns side by side, one for each label in each bin; heights are shares."""
    ticks = nice_ticks(100 * max((h for column in heights.values() for h in column), default=0.01))
    room_x, room_y = _WIDTH - _LEFT - _RIGHT, _HEIGHT - _TOP - _BOTTOM
    slot = room_x / max(1, len(bins))
    width = slot * 0.84 / max(1, len(heights))
    bottom = _TOP + room_y
    out = _frame(
        [(_LEFT + slot * i, text) for i, text in enumerate(bins)],
        [(bottom - room_y * tick / ticks[-1], f"{tick:g} %") for tick in ticks],
        across,
    )
    for index, (label, column) in enumerate(heights.items()):
        colour = charts.unit_colour(label, index)
        for i, share in enumerate(column):
            height = room_y * 100 * share / ticks[-1]
            x = _LEFT + slot * (i + 0.08) + width * index
            tip = escape(f"{label}: {share:.1%}")
            out.append(
                f'<rect x="{x:.1f}" y="{bottom - height:.1f}" width="{width * 0.94:.2f}" '
                f'height="{height:.2f}" fill="{colour}"><title>{tip}</title></rect>'
            )
        out.append(_key(index, label, colour, None))
    return charts.svg(out, _HEIGHT, title, _WIDTH)
