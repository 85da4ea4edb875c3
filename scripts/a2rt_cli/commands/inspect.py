"""Show which effects a scene or a workload calls for, and which simulator parts that needs.

What nothing calls for is neither compiled, captured, simulated nor charged; the table says what was
left out and why.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from a2rt_cli import options
from a2rt_cli.setup.needs import Need

EXAMPLES = """  scripts/a2rt inspect forest
  scripts/a2rt inspect scene.glb --workload ao --effects all
  scripts/a2rt inspect w.h5
  scripts/a2rt inspect w.h5 --json
  scripts/a2rt inspect forest --compare-effects --size 64x64 --spp 1 -o out/forest
"""
NEED = Need.ENGINE


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("what", metavar="SCENE|w.h5", help="a scene or a workload file")
    options.add_render(parser)
    parser.add_argument("--json", action="store_true", help="print JSON instead of tables")
    group = parser.add_argument_group("what leaving out saves")
    group.add_argument(
        "--compare-effects",
        action="store_true",
        help="draw, capture and simulate with --effects auto and all, and compare",
    )
    group.add_argument("--unit", default="a2rt", metavar="U", help="unit to simulate (a2rt)")
    group.add_argument("--gpu", default="table1", metavar="G", help="machine (table1)")
    group.add_argument(
        "-o", "--output", metavar="DIR", help="keep the comparison in DIR/savings.json"
    )


def run(args: argparse.Namespace) -> int:
    from a2rt_cli.engine import effects, scenes

    if args.compare_effects:
        return _compare_effects(args)
    if scenes.is_workload_file(args.what):
        found = effects.of_workload(Path(args.what))
    else:
        found = effects.of_scene(scenes.find(args.what), options.render_options(args))
    if args.json:
        print(json.dumps(found, indent=1))
        return 0
    _print(args.what, found)
    return 0


def _compare_effects(args: argparse.Namespace) -> int:
    import tempfile

    from a2rt_cli import console, savings_table
    from a2rt_cli.engine import savings, scenes
    from a2rt_cli.errors import UserError

    if scenes.is_workload_file(args.what):
        raise UserError(f"{args.what}: a capture holds one choice of effects", "name a scene")
    scene, render = scenes.find(args.what), options.render_options(args)
    with tempfile.TemporaryDirectory() as folder:
        row = savings.measure(scene, render, args.unit, args.gpu, Path(args.output or folder))
    if args.output:
        savings_table.save(Path(args.output), [row])
    if args.json:
        print(json.dumps(row, indent=1))
        return 0
    print(console.table(savings_table.COLUMNS, [savings_table.cells(row)]))
    print(f"\n{savings_table.NOTE}\n\n{savings_table.sentence(row)}")
    return 0


def _print(name: str, found: dict) -> None:
    from a2rt_cli import console, results
    from a2rt_cli.engine import effects
    from a2rt_cli.report.sections import effects_table

    facts = {k: v for k, v in results.flatten(found).items() if not isinstance(v, bool)}
    console.heading(f"{name}")
    if facts:
        rows = [(key, f"{v:,}" if isinstance(v, int) else str(v)) for key, v in facts.items()]
        print(console.table(("what", "value"), rows))
    if found.get("effects"):
        console.heading("effects")
        table, summary = effects_table(found)
        print(console.table(table.columns, table.rows, left=len(table.columns)))
        print(f"\n{summary}")
        for effect in found["effects"]:
            if effect.get("why"):
                print(f"  {effect['name']}: {effect['why']}")
        lacking = effects.lacking(found)
        if lacking:
            print(f"\nThe picture lacks: {', '.join(lacking)}.")
    if found.get("parts"):
        console.heading("parts of the machine")
        rows = [
            (p["part"], "used" if p["instantiated"] else "left out", p["why"])
            for p in found["parts"]
        ]
        print(console.table(("part", "state", "why"), rows, left=3))
