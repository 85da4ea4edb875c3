"""Table II: areas and powers of the A²RT engine, the table this project simulates with beside it.

Nothing is synthesised here yet. Rows marked published are the paper's own numbers, so that their
agreement with the paper shows only that they were copied right; estimated rows share out what the
paper prints for the whole ray tracing unit.
"""

from __future__ import annotations

from a2rt_cli import console, energy_table, formats, plotting
from a2rt_cli.config_table import Table
from a2rt_cli.energy_table import Row
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


def _qbox(rows: dict[str, Row]) -> list[dict]:
    """The two ratios that the paper prints; ours come from published rows."""
    a2rt, aqb8 = rows["qbox_a2rt"], rows["qbox_aqb8"]
    ours = {
        "table2.area": a2rt.area_um2 / aqb8.area_um2,
        "table2.power": a2rt.power_mw / aqb8.power_mw,
    }
    found = plotting.beside(NAME, [])
    for row in found:
        row["ours"] = ours[row["id"]]
    return found


def draw(context: Context) -> Drawn:
    rows = energy_table.first_rows()
    engine, total = _engine_table(rows, counts())
    qbox = _qbox(rows)
    said = (
        f"Both QBOX rows are {rows['qbox_a2rt'].note}: their agreement says only that they were "
        "copied right.\nBOX, ray quantizer and TRI are estimated: the paper's ray tracing unit "
        "less its QBOXes, shared out by\noperator counts, so that their sum meets the paper's by "
        "construction. Powers take one test a cycle.\nMemories are charged by energy per access, "
        "not by area (a2rt_core/energy_tables/SOURCES.md)."
    )
    parts = [
        "Blocks of the accelerator:\n" + _block_table(total),
        f"Our table of the ray tracing unit (counts of lumibench_configs/gpus/{GPU}.toml):\n"
        + engine,
        "QBOX's computing part, A²RT against AQB8:\n" + plotting.beside_text(qbox),
        said,
    ]
    file = plotting.write_numbers(context.out, NAME, qbox, engine=total)
    return Drawn("\n\n".join(parts), [file])
