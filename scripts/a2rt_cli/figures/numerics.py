"""Hard cases: which unit stays exact, which conservative, which misses, and by what mechanism.

Not a figure of the paper: it claims that A²RT misses no hit, this shows for which inputs. Writes
numerics.json and the page numerics.html.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from a2rt_cli import console
from a2rt_cli.engine import capture, numerics, scenes
from a2rt_cli.figures import Context, Drawn
from a2rt_cli.files import write_json
from a2rt_cli.report import numerics as page

TITLE = "hard cases: exact, conservative, or misses"
NAME = "numerics"
# At least so many quantized box tests of each design; the slow tier's test runs a thousand times
# as many as the fast tier's.
STRATA_TESTS = 10_000_000


def _workloads(context: Context) -> list[Path]:
    """Workload files of the experiment's scenes, named by the scene."""
    out = []
    for item in context.experiment.items():
        scene = scenes.find(item.text)
        with console.step(f"Drawing and capturing {scene.name}") as shown:
            found = capture.from_scene(scene, item.options, context.out / ".cache", shown=shown)
        named = context.out / ".cache" / f"{scene.name}.h5"
        named.unlink(missing_ok=True)
        named.symlink_to(found.file.resolve())
        out.append(named)
    return out


def collect(context: Context) -> dict[str, Any]:
    """All that the page shows."""
    cache = context.out / ".cache"
    workloads = _workloads(context)
    with console.step("Judging every unit on hard cases") as shown:
        found = numerics.hard_cases(workloads, cache / "hard-cases.json", shown)
    with console.step("Testing boxes in all strata") as shown:
        found["strata"] = numerics.strata(STRATA_TESTS, cache / "strata.json", shown)
    with console.step("Exhausting the multiplier") as shown:
        found["multiplier"] = {
            mode: numerics.multiplier(mode, shown) for mode in ("compress", "drop")
        }
    return found


def draw(context: Context) -> Drawn:
    found = collect(context)
    data = context.out / f"{NAME}.json"
    write_json(data, found)
    files = [data, *page.write_pictures(found, context.out), page.write(found, context.out)]
    return Drawn(_text(found), files)


def _text(found: dict[str, Any]) -> str:
    matrix = page.matrix(found)
    units = [unit["key"] for unit in found["units"]]
    rows = [[row.title, *[f"{c.symbol} {c.words}" for c in row.cells]] for row in matrix]
    leaks = page.leaks_table(found)
    strata = page.strata_table(found)
    return "\n\n".join(
        [
            console.table(("hard case", *units), rows, left=len(units) + 1),
            "misses: boxes missed / rays lost; the page names each mechanism.",
            console.table(leaks.columns, leaks.rows),
            console.table(strata.columns, strata.rows),
        ]
    )
