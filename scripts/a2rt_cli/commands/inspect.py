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
"""
NEED = Need.ENGINE


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("what", metavar="SCENE|w.h5", help="a scene or a workload file")
    options.add_render(parser)
    parser.add_argument("--json", action="store_true", help="print JSON instead of tables")


def run(args: argparse.Namespace) -> int:
    from a2rt_cli.engine import effects, scenes

    if scenes.is_workload_file(args.what):
        found = effects.of_workload(Path(args.what))
    else:
        found = effects.of_scene(scenes.find(args.what), options.render_options(args))
    if args.json:
        print(json.dumps(found, indent=1))
        return 0
    _print(args.what, found)
    return 0


def _print(name: str, found: dict) -> None:
    from a2rt_cli import console, results
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
