"""Table III: four quantized RT units, by what they quantize, with what we measure of each."""

from __future__ import annotations

from a2rt_cli import console, formats, plotting, results
from a2rt_cli.figures import Context, Drawn
from a2rt_cli.report import measures

TITLE = "compressed-leaf BVH, compressed wide BVH, AQB8 and A²RT"
NAME = "table3"

# The paper's marks: multi-level boxes, origin, direction, low-bit arithmetic, approximation.
FEATURES = {
    "clbvh": ("[9]", (False, False, False, False, False)),
    "cwbvh": ("[10]", (True, False, False, False, False)),
    "aqb8": ("[13]", (True, False, False, True, False)),
    "a2rt": ("A²RT", (True, True, True, True, True)),
}
HOW = (
    "L1 bytes, speedup and energy are against the FP32 baseline on the same rays, with the same "
    "number of box testers:\ngeometric means; of a unit that loses hits they count work that it "
    "does not do. Redundant: arithmetic mean."
)
COLUMNS = (
    "unit",
    "paper",
    "boxes",
    "origin",
    "direction",
    "low-bit",
    "approx.",
    "lost hits",
    "redundant",
    "L1 bytes",
    "speedup",
    "energy",
)


def _row(found, unit: str) -> list[str]:
    name, marks = FEATURES[unit]
    runs = [one for one in found if results.label(one) == unit]
    lost = [results.lost_hits(one) for one in runs]
    total = sum(lost) if lost and all(value is not None for value in lost) else None
    redundant = [s for one in runs if (s := results.redundant_share(one)) is not None]
    cycles = measures.mean_ratio(found, unit, "baseline", measures.cycles)
    return [
        unit,
        name,
        *["yes" if mark else "no" for mark in marks],
        formats.count(total),
        formats.percent(sum(redundant) / len(redundant) if redundant else None, 2),
        formats.percent(measures.mean_ratio(found, unit, "baseline", results.tree_bytes)),
        formats.factor(1 / cycles if cycles else None),
        formats.percent(measures.mean_ratio(found, unit, "baseline", measures.energy)),
    ]


def draw(context: Context) -> Drawn:
    found = context.runs()
    units = [unit for unit in FEATURES if any(results.label(one) == unit for one in found)]
    rows = [_row(found, unit) for unit in units]
    text = console.table(COLUMNS, rows, left=7)
    text += f"\n\n{HOW}"
    numbers = [dict(zip(COLUMNS, row, strict=True)) for row in rows]
    return Drawn(text, [plotting.write_numbers(context.out, NAME, [], rows=numbers)])
