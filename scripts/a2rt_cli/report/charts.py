"""Bars as inline SVG: no script, sharp in print, readable by all kinds of colour vision.

Colours are Okabe and Ito's set, of other units Tol's muted one; every bar also carries its value in
words.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from html import escape

UNIT_COLOURS = {
    "baseline": "#6b7280",
    "aqb8": "#e69f00",
    "a2rt": "#0072b2",
    "cwbvh": "#cc79a7",
    "clbvh": "#009e73",
    "a2rt-literal": "#d55e00",
}
SERIES_COLOURS = (
    "#0072b2",
    "#e69f00",
    "#009e73",
    "#cc79a7",
    "#56b4e9",
    "#d55e00",
    "#f0e442",
    "#6b7280",
)
# Of units that have none above: never the colour of one that has.
_OTHER_UNITS = (
    "#56b4e9",
    "#882255",
    "#44aa99",
    "#999933",
    "#332288",
    "#aa4499",
    "#117733",
    "#f0e442",
)
_DARK = {"#0072b2", "#6b7280", "#009e73", "#d55e00"}
_ROW = 22
_GAP = 12
_LABEL = 150
_VALUE = 110
_WIDTH = 860


@dataclass(frozen=True)
class Bar:
    group: str
    label: str
    parts: Mapping[str, float]  # series -> length


def unit_colour(unit: str, index: int = 0) -> str:
    return UNIT_COLOURS.get(unit, _OTHER_UNITS[index % len(_OTHER_UNITS)])


def series_colours(names: Sequence[str]) -> dict[str, str]:
    return {name: SERIES_COLOURS[i % len(SERIES_COLOURS)] for i, name in enumerate(names)}


def text(x: float, y: float, words: str, anchor: str = "start", cls: str = "t") -> str:
    return (
        f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" class="{cls}">{escape(words)}</text>'
    )


def stacked(
    bars: Sequence[Bar],
    colours: Mapping[str, str],
    write: Callable[[float], str],
    title: str,
    *,
    marks: bool = False,
) -> str:
    """Horizontal stacked bars in groups; each group is scaled to its own longest bar.

    With `marks` a part that has room for it carries its share in percent.
    """
    groups: dict[str, list[Bar]] = {}
    for bar in bars:
        groups.setdefault(bar.group, []).append(bar)
    y, out = 0.0, []
    room = _WIDTH - _LABEL - _VALUE
    for name, members in groups.items():
        if name:
            out.append(text(0, y + 15, name, cls="t b"))
            y += _ROW
        longest = max(sum(bar.parts.values()) for bar in members) or 1.0
        for bar in members:
            out.append(text(_LABEL - 10, y + 15, bar.label, "end"))
            x = float(_LABEL)
            for series, length in bar.parts.items():
                width = room * length / longest
                if width <= 0:
                    continue
                tip = escape(f"{bar.label}, {series}: {write(length)}")
                out.append(
                    f'<rect x="{x:.1f}" y="{y + 2}" width="{width:.2f}" height="{_ROW - 5}" '
                    f'fill="{colours[series]}"><title>{tip}</title></rect>'
                )
                if marks and width > 34:
                    ink = "#fff" if colours[series] in _DARK else "#1a2230"
                    share = f"{100 * length / sum(bar.parts.values()):.0f} %"
                    middle = text(x + width / 2, y + 14, share, "middle")
                    out.append(middle.replace("<text ", f'<text style="fill:{ink}" ', 1))
                x += width
            out.append(text(x + 8, y + 15, write(sum(bar.parts.values()))))
            y += _ROW
        y += _GAP
    return svg(out, y, title)


def legend(colours: Mapping[str, str]) -> str:
    items = "".join(
        f'<span class="key"><i style="background:{colour}"></i>{escape(name)}</span>'
        for name, colour in colours.items()
    )
    return f'<div class="legend">{items}</div>'


def svg(parts: Sequence[str], height: float, title: str, width: int = _WIDTH) -> str:
    return (
        f'<svg viewBox="0 0 {width} {height:.0f}" role="img" class="chart">'
        f"<title>{escape(title)}</title>{''.join(parts)}</svg>"
    )
