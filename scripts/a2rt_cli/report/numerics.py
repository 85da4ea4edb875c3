"""The page on numerical stability: matrix of hard cases, pictures of the failures, error tables."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from a2rt_cli import formats
from a2rt_cli.files import replacing, write_text
from a2rt_cli.report.sections import data_uri
from a2rt_cli.report.table import Table
from a2rt_cli.report.template import fill

NAME = "numerics.html"
# Verdicts differ by symbol as well as by colour (Okabe and Ito's set).
SYMBOLS = {"exact": "=", "conservative": "≥", "misses": "✕", "refuses": "–"}
_LETTERS = "abcdefghijklmnopqrstuvwxyz"
# Pixels that a unit loses, and those where it finds something farther; both also by a mechanism
# that is not the picture's.
_COLOURS = {"L": (213, 94, 0), "F": (0, 114, 178), "l": (240, 200, 175), "f": (175, 208, 228)}


@dataclass(frozen=True)
class Cell:
    verdict: str
    symbol: str
    words: str  # counts
    escapes: str  # boxes decided by the accurate unit instead, in words
    letters: str  # mechanisms, keys of mechanisms()
    tip: str


@dataclass(frozen=True)
class Row:
    group: str
    title: str
    what: str
    cells: list[Cell]


def mechanisms(found: dict[str, Any]) -> dict[str, str]:
    """Mechanism -> letter, in order of first appearance in the matrix."""
    names: dict[str, str] = {}
    for cell in found["cells"]:
        for name in (*cell["mechanisms"], *cell["lost_by_mechanism"]):
            names.setdefault(name, _LETTERS[len(names)])
    return names


def matrix(found: dict[str, Any]) -> list[Row]:
    letters = mechanisms(found)
    cells = {(cell["case"], cell["unit"]): cell for cell in found["cells"]}
    return [
        Row(
            case["group"],
            case["title"],
            case["what"],
            [_cell(cells[case["key"], unit["key"]], letters) for unit in found["units"]],
        )
        for case in found["cases"]
    ]


def _by_group(rows: list[Row]) -> list[tuple[str, list[Row]]]:
    groups: dict[str, list[Row]] = {}
    for row in rows:
        groups.setdefault(row.group, []).append(row)
    return list(groups.items())


def _cell(cell: dict[str, Any], letters: dict[str, str]) -> Cell:
    verdict = cell["verdict"]
    words = {
        "exact": "exact",
        "conservative": f"+{formats.count(cell['redundant'])}",
        "misses": f"{formats.count(cell['missed'])} / {formats.count(cell['lost'])}",
        "refuses": "refuses",
    }[verdict]
    escapes = f"{formats.count(cell['escapes'])} escapes" if cell["escapes"] else ""
    tip = (
        f"{formats.count(cell['rays'])} rays, {formats.count(cell['exact_hits'])} exact box hits, "
        f"{formats.count(cell['redundant'])} redundant, {formats.count(cell['missed'])} missed, "
        f"{formats.count(cell['lost'])} rays lost"
    )
    by = {**cell["lost_by_mechanism"], **cell["mechanisms"]}
    tip += "".join(f"; {name}: {formats.count(n)}" for name, n in by.items())
    tip += f"; {cell['refusal']}" if "refusal" in cell else ""
    marks = "".join(sorted(letters[name] for name in by))
    return Cell(verdict, SYMBOLS[verdict], words, escapes, marks, tip)


def leaks_table(found: dict[str, Any]) -> Table:
    """Rays through closed surfaces and scenes, one row a mesh, one column a unit."""
    units = [unit["key"] for unit in found["units"]]
    titles = [unit["title"] for unit in found["units"]]
    rows = []
    for mesh in dict.fromkeys(one["mesh"] for one in found["watertight"]):
        of_unit = {one["unit"]: one for one in found["watertight"] if one["mesh"] == mesh}
        any_unit = of_unit[units[0]]
        rows.append(
            [
                any_unit["title"],
                formats.count(any_unit["rays"]),
                formats.count(any_unit["hits"]),
                *[_leaks(of_unit[unit]) for unit in units],
            ]
        )
    note = (
        "Rays aimed exactly at vertices and edges; each count is rays that find nothing although "
        "brute force hits. “+ n far” are rays that find only something farther, “n boxes” wrong "
        "box decisions of scenes whose shapes are procedural or whose rays are audited."
    )
    return Table(["surface", "rays", "hits", *titles], rows, note)


def _leaks(one: dict[str, Any]) -> str:
    words = formats.count(one["leaked"])
    words += f" + {formats.count(one['farther'])} far" if one["farther"] else ""
    return words + (f", {formats.count(one['missed'])} boxes" if one["missed"] else "")


def strata_table(found: dict[str, Any], dimension: str = "") -> Table:
    """Found and redundant rates per design: over all strata, or by kind of one dimension."""
    columns = ["design", "tests", "exact hits", "lost", "found", "redundant of misses", "escaped"]
    rows = []
    for row in found["strata"]["rows"]:
        if row["dimension"] != dimension:
            continue
        lost = row["missed"] + row["group_missed"] + row["escaped_missed"]
        rows.append(
            [
                row["design"] + (f", {row['kind']}" if dimension else ""),
                formats.count(row["tests"]),
                formats.count(row["exact_hits"]),
                formats.count(lost),
                formats.percent(row["found_share"], 4),
                formats.percent(row["redundant_share"], 2),
                formats.count(row["escaped"]),
            ]
        )
    return Table(columns, rows)


def near_axis_table(found: dict[str, Any]) -> Table:
    rows = [
        [
            f"2^{row['exponent']} to 2^{row['exponent'] + 1}",
            formats.count(row["rays"]),
            f"{row['floor_percent']:.1f} %",
            f"{row['nearest_percent']:.1f} %",
            f"{row['study_percent']:.0f} %",
        ]
        for row in found["strata"]["near_axis"]
    ]
    columns = ["|d|", "rays into a box", "floor/ceil", "nearest-even", "study of the artifact"]
    return Table(columns, rows)


def multiplier_table(found: dict[str, Any], mode: str) -> Table:
    rows = [
        [
            row["k"],
            row["path"],
            row["carry"],
            formats.percent(float(row["worst_relative"]), 3),
            formats.percent(float(row["mean_relative"]), 4),
            formats.percent(float(row["worst_relative_rounded"]), 3),
            formats.percent(float(row["mean_relative_rounded"]), 4),
        ]
        for row in found["multiplier"][mode]
    ]
    columns = ["k", "path", "carry added", "worst error", "mean error"]
    columns += ["worst, rounded to BF16", "mean, rounded to BF16"]
    return Table(columns, rows)


def summary(found: dict[str, Any]) -> list[str]:
    """What a reader should leave with, computed from the data."""
    promising = [unit for unit in found["units"] if unit["promises"]]
    names = ", ".join(unit["title"] for unit in promising)
    of_promising = {unit["key"] for unit in promising}
    kept = [cell for cell in found["cells"] if cell["unit"] in of_promising]
    missed = sum(cell["missed"] + cell["lost"] for cell in kept)
    hits = sum(cell["exact_hits"] for cell in kept)
    tests = sum(cell["box_tests"] + cell["qbox_tests"] for cell in kept)
    out = [
        f"The units that promise it ({names}) missed {formats.count(missed)} boxes or rays in "
        f"{len(found['cases'])} hard cases: {formats.count(tests)} box decisions, "
        f"{formats.count(hits)} of them exact hits."
    ]
    for unit in found["units"]:
        if unit["promises"]:
            continue
        cells = [cell for cell in found["cells"] if cell["unit"] == unit["key"]]
        bad = [cell for cell in cells if cell["verdict"] == "misses"]
        refused = sum(cell["verdict"] == "refuses" for cell in cells)
        lost = sum(cell["lost"] for cell in bad)
        rays = sum(cell["rays"] for cell in bad)
        words = f"{unit['title']} misses in {len(bad)} of {len(cells)} cases"
        words += f" and refuses {refused}" if refused else ""
        out.append(f"{words}: {formats.count(lost)} of {formats.count(rays)} rays there are lost.")
    leaked = sum(one["leaked"] for one in found["watertight"] if one["unit"] in of_promising)
    rays = sum(one["hits"] for one in found["watertight"] if one["unit"] in of_promising)
    out.append(
        f"Of {formats.count(rays)} rays aimed exactly at vertices and edges, "
        f"{formats.count(leaked)} leak through those units."
    )
    return out


def _pixels(view: dict[str, Any]):
    """A view as an array (side, side, 3): grey body, lost pixels orange, farther ones blue, pale
    where another mechanism than the view's is the reason."""
    import numpy as np

    shade = np.array([list(bytes.fromhex(row)) for row in view["shade"]], dtype=np.float32)
    kind = np.array([list(row) for row in view["kind"]])
    body = np.where(shade > 0, 55 + 0.75 * shade, 250)
    out = np.repeat(body[:, :, None], 3, axis=2)
    for letter, colour in _COLOURS.items():
        where = kind == letter
        light = (0.6 + 0.4 * shade / 255)[:, :, None]
        out = np.where(where[:, :, None], light * np.array(colour, dtype=np.float32), out)
    return out.clip(0, 255).astype(np.uint8)


def write_pictures(found: dict[str, Any], out: Path) -> list[Path]:
    """One picture per failing mechanism: numerics-KEY.png."""
    from PIL import Image

    files = []
    for view in found["views"]:
        target = out / f"numerics-{view['key']}.png"
        with replacing(target) as temporary:
            Image.fromarray(_pixels(view)).save(temporary, format="PNG")
        files.append(target)
    return files


def _shots(found: dict[str, Any], out: Path) -> list[dict[str, str]]:
    titles = {unit["key"]: unit["title"] for unit in found["units"]}
    letters = mechanisms(found)
    shots = []
    for view in found["views"]:
        by = "; ".join(
            f"{name}: {formats.count(n)}" for name, n in view["lost_by_mechanism"].items()
        )
        counts = f"{formats.count(view['lost'])} of {formats.count(view['hit_pixels'])} pixels lost"
        if view["farther"]:
            counts += f", {formats.count(view['farther'])} show something farther"
        shots.append(
            {
                "source": data_uri(out / f"numerics-{view['key']}.png"),
                "title": view["title"],
                "letter": letters.get(view["mechanism"], ""),
                "unit": titles.get(view["unit"], view["unit"]),
                "detail": f"{view['what']} {counts}. By {by}.",
            }
        )
    return shots


def write(found: dict[str, Any], out: Path) -> Path:
    """Writes numerics.html into `out`, which holds the pictures."""
    dimensions = ("direction", "distance", "aspect", "magnitude")
    text = fill(
        "numerics.html.j2",
        summary=summary(found),
        units=found["units"],
        groups=_by_group(matrix(found)),
        mechanisms={letter: name for name, letter in mechanisms(found).items()},
        symbols=SYMBOLS,
        shots=_shots(found, out),
        leaks=leaks_table(found),
        strata=strata_table(found),
        by_stratum={name: strata_table(found, name) for name in dimensions},
        near_axis=near_axis_table(found),
        multiplier=multiplier_table(found, "compress"),
        dropped=multiplier_table(found, "drop"),
    )
    target = out / NAME
    write_text(target, text)
    return target


def link(folder: Path) -> tuple[str, str] | None:
    """Where a report in `folder` finds this page, and one sentence about it."""
    if not (folder / NAME).is_file():
        return None
    return NAME, "Numerical stability: every unit on hard cases, against exact arithmetic."
