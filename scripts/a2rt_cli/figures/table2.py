"""Table II: areas and powers of the A²RT engine, the table this project simulates with beside it.

Nothing is synthesised here yet. Rows marked published are the paper's own numbers, so that their
agreement with the paper shows only that they were copied right; estimated rows share out what the
paper prints for the whole ray tracing unit.
"""

from __future__ import annotations

from dataclasses import replace

from a2rt_cli import console, energy_table, formats, plotting
from a2rt_cli.config_table import Table
from a2rt_cli.energy_table import Row
from a2rt_cli.engine import core
from a2rt_cli.figures import Context, Drawn
from a2rt_cli.paths import CONFIGS, config_folder

TITLE = "areas and powers of the A²RT engine and of QBOX's computing part"
NAME = "table2"
# The ray tracing unit of Table II: component of our table -> tester of the machine, printed name.
ENGINE = {
    "qbox_a2rt": ("qbox", "QBOX"),
    "box": ("box", "BOX"),
    "quantizer": ("quantizer", "ray quantizer"),
    "triangle": ("triangle", "TRI"),
}
GPU = "table1"


def counts() -> dict[str, int]:
    """Testers of the machine that figures are simulated on."""
    testers = Table.read(config_folder("gpus") / f"{GPU}.toml").get("rt", dict)["testers"]
    return {component: testers[key]["count"] for component, (key, _) in ENGINE.items()}


def blocks() -> list[dict]:
    """The blocks that Table II prints; areas in mm², powers in W."""
    return Table.read(CONFIGS / "paper.toml").get("block", list)


def _engine_table(rows: dict[str, Row], number: dict[str, int]) -> tuple[str, dict[str, float]]:
    cells = []
    total = {"area_mm2": 0.0, "power_w": 0.0}
    for component, (_, name) in ENGINE.items():
        row, count = rows[component], number[component]
        area, power = count * row.area_um2 / 1e6, count * row.power_mw / 1e3
        total["area_mm2"] += area
        total["power_w"] += power
        cells.append(
            (
                name,
                row.note,
                str(count),
                f"{row.area_um2:,.1f}",
                f"{row.power_mw:.2f}",
                f"{area:.3f}",
                f"{power:.3f}",
            )
        )
    cells.append(("sum", "", "", "", "", f"{total['area_mm2']:.3f}", f"{total['power_w']:.3f}"))
    columns = ("tester", "source", "count", "µm² each", "mW each", "mm²", "W")
    return console.table(columns, cells, left=2), total


def _block_table(ours: dict[str, float]) -> str:
    cells = []
    whole = next(block for block in blocks() if block.get("total"))
    for block in blocks():
        mine = block.get("ours") == "engine"
        cells.append(
            (
                block["name"],
                f"{block['area_mm2']:.2f}",
                formats.percent(block["area_mm2"] / whole["area_mm2"]),
                f"{block['power_w']:.2f}",
                f"{ours['area_mm2']:.2f}" if mine else formats.NOTHING,
                f"{ours['power_w']:.2f}" if mine else formats.NOTHING,
            )
        )
    columns = ("block", "paper mm²", "share", "paper W", "ours mm²", "ours W")
    return console.table(columns, cells)


def _qbox(rows: dict[str, Row], simulated: Row) -> list[dict]:
    """The two ratios that the paper prints, of its own row and of the row we simulate with."""
    out = []
    for name, a2rt in (("published row", rows["qbox_a2rt"]), ("row simulated", simulated)):
        aqb8 = rows["qbox_aqb8"]
        ours = {
            "table2.area": a2rt.area_um2 / aqb8.area_um2,
            "table2.power": a2rt.power_mw / aqb8.power_mw,
        }
        for row in plotting.beside(NAME, []):
            what = f"{row['what']}, {name}"
            out.append({**row, "what": what, "ours": ours[row["id"]], "how": a2rt.note})
    return out


def _simulated(published: Row) -> tuple[Row, str]:
    """The tester of the unit a2rt as configured, and in words how it follows from the table's."""
    tester = core.tester("a2rt")
    scaled = {key: tester[key] for key in ("area_um2", "energy_pj", "leak_uw", "note", "source")}
    words = (
        f"a2rt is simulated with {tester['scale']:.2f} times the published QBOX: its boxes have "
        f"{tester['box_bits']} bits and\nits origins {tester['origin_bits']} ({tester['origin']}), "
        "where the paper's have 8; scaled by a count of gates, so that it is "
        f"{tester['note']}."
    )
    return replace(published, **scaled), words


def _said(rows: dict[str, Row]) -> str:
    """What the notes of the rows mean for what is shown."""
    by_note: dict[str, list[str]] = {}
    for component in (*ENGINE, "qbox_aqb8"):
        name = ENGINE.get(component, ("", "AQB8's QBOX"))[1]
        by_note.setdefault(rows[component].note, []).append(name)
    meaning = {
        "published": "their agreement with the paper says only that they were copied right",
        "estimated": "the paper's ray tracing unit less its QBOXes, shared out by operator counts, "
        "so that\ntheir sum meets the paper's by construction",
        "synthesised": "made from our own RTL",
    }
    said = [f"{', '.join(names)}: {note}, {meaning[note]}." for note, names in by_note.items()]
    said.append(
        "Powers take one test a cycle. Memories are charged by energy per access, not by area "
        "(a2rt_core/energy_tables/SOURCES.md)."
    )
    return "\n".join(said)


def draw(context: Context) -> Drawn:
    rows = energy_table.first_rows()
    engine, total = _engine_table(rows, counts())
    simulated, words = _simulated(rows["qbox_a2rt"])
    qbox = _qbox(rows, simulated)
    parts = [
        "Blocks of the accelerator:\n" + _block_table(total),
        f"Our table of the ray tracing unit (counts of lumibench_configs/gpus/{GPU}.toml):\n"
        + engine,
        "QBOX's computing part, A²RT against AQB8:\n" + plotting.beside_text(qbox),
        words,
        _said(rows),
    ]
    file = plotting.write_numbers(context.out, NAME, qbox, engine=total)
    return Drawn("\n\n".join(parts), [file])
