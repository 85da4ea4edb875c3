"""Run any Vulkan program under the capture layer and write its rays to a workload file.

The program is not changed; its picture is the same as without the layer. Everything after `--` is
the program and its arguments. If it crashes or traces no ray, no file is left behind.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from a2rt_cli.setup.needs import Need

EXAMPLES = """  scripts/a2rt capture w.h5 -- ./my_vulkan_app --frames 1
  scripts/a2rt capture out/app.h5 --name app -- /usr/bin/some-ray-tracer scene.obj
"""
NEED = Need.ENGINE


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("target", metavar="w.h5", help="workload file to write")
    parser.add_argument("--name", help="name of the workload in reports (the program's)")
    parser.add_argument(
        "program", nargs="+", metavar="PROGRAM", help="after `--`: the program and its arguments"
    )


def run(args: argparse.Namespace) -> int:
    from a2rt_cli import console
    from a2rt_cli.engine import core, renderer, scenes
    from a2rt_cli.errors import UserError
    from a2rt_cli.paths import shown

    target = Path(args.target)
    if not scenes.is_workload_file(args.target):
        raise UserError(f"{target}: a workload file ends in .h5", "name it so")
    name = args.name or Path(args.program[0]).name
    target.parent.mkdir(parents=True, exist_ok=True)
    with renderer.scratch(target.parent) as raw:
        with console.step(f"Running {name} under the layer") as step:
            renderer.capture_program(args.program, raw, step)
        with console.step("Importing the capture") as step:
            core.import_capture(raw, target, scene=name, workload="program", shown=step)
    summary = core.inspect(target)
    print(f"{shown(target)}: {summary['rays']['count']:,} rays of {name}")
    print(f"Next: scripts/a2rt inspect {shown(target)}; scripts/a2rt compare {shown(target)}")
    return 0
