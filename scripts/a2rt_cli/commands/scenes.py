"""List the scenes and LumiBench runs that can be named, and what stands in for absent ones.

A real scene is used when its file is in ../shared/scenes or in $A2RT_SCENES; otherwise an embedded
scene stands in for it, drawn with the real scene's effects only and called by a name of its own.
"""

from __future__ import annotations

import argparse
import json

from a2rt_cli.setup.needs import Need

EXAMPLES = """  scripts/a2rt scenes
  scripts/a2rt scenes --lumibench      the 46 standard runs, for example lumi:ship_sh
  scripts/a2rt scenes --json
"""
NEED = Need.PYTHON


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--lumibench", action="store_true", help="list LumiBench's standard runs")
    parser.add_argument("--json", action="store_true", help="print JSON instead of a table")


def run(args: argparse.Namespace) -> int:
    from a2rt_cli import console

    rows = _runs() if args.lumibench else _scenes()
    if args.json:
        print(json.dumps(rows, indent=1))
        return 0
    columns = list(rows[0])
    cells = [[str(row[column]) for column in columns] for row in rows]
    print(console.table(columns, cells, left=len(columns)))
    if not args.lumibench:
        print("\nAny .glb or .gltf file is a scene too. LumiBench's runs: a2rt scenes --lumibench")
    return 0


def _scenes() -> list[dict[str, str]]:
    from a2rt_cli.engine import scenes

    rows = []
    for config in sorted(scenes.configs().values(), key=lambda one: (bool(one.embedded), one.name)):
        found = scenes.find(config.name)
        rows.append(
            {
                "scene": config.name,
                "title": config.title,
                "here": "embedded" if config.embedded else _here(config, found.name),
                "calls for": ", ".join(config.features),
            }
        )
    return rows


def _here(config, drawn: str) -> str:
    return "file" if config.path() is not None else f"no: {drawn}"


def _runs() -> list[dict[str, str]]:
    from a2rt_cli.engine import lumibench, scenes

    rows = []
    for one in lumibench.all_runs():
        found = scenes.find(one.scene.name)
        options = found.drawn_with(lumibench.options_of(one))
        rows.append(
            {
                "run": lumibench.PREFIX + one.name,
                "LumiBench": f"{one.scene.lumibench}_{one.label}",
                "size": f"{options.width}x{options.height}",
                "rays": one.rays,
                "draws": found.name,
                "effects": options.effects,
            }
        )
    return rows
