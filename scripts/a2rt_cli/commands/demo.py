"""Set the machine up, compare three RT units on four small scenes, and write a report.

The scenes are made by the project itself: a Cornell box, a field of procedural spheres, an
instanced forest with alpha-masked leaves, and a torture scene of slivers and flat boxes. Real
shaders draw them on lavapipe under the capture layer; the FP32 baseline, AQB8 and A²RT then run on
the same rays.
"""

from __future__ import annotations

import argparse

from a2rt_cli import options
from a2rt_cli.setup.needs import Need

EXAMPLES = """  scripts/a2rt demo
  scripts/a2rt demo -o out/first     choose where the report goes
  scripts/a2rt demo --size 256x256   larger pictures
"""
NEED = Need.ENGINE
# Keeps a warm demo within a minute on two cores, cycles included.
SIZE = (96, 96)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--size", type=options.size, default=SIZE, metavar="WxH", help="picture size (96x96)"
    )
    parser.add_argument("-o", "--output", metavar="DIR", help="folder of the results (out/demo)")


def run(args: argparse.Namespace) -> int:
    from a2rt_cli import comparison, tables
    from a2rt_cli.commands.compare import print_where
    from a2rt_cli.engine import core, scenes
    from a2rt_cli.engine.renderer import RenderOptions
    from a2rt_cli.engine.runs import RunSpec
    from a2rt_cli.report import page

    out = options.output_folder(args, "out/demo")
    width, height = args.size
    # One sample a pixel: enough to see every effect, short enough to wait for.
    render = RenderOptions(width=width, height=height, spp=1)
    gpu = "table1" if "simulate" in core.subcommands() else None
    found = comparison.compare(
        [comparison.Item(name, render) for name in scenes.embedded()],
        [RunSpec(unit, gpu, time_optional=True, heatmap=True) for unit in options.DEFAULT_UNITS],
        out,
        command=options.command_line(),
    )
    page.write(out)
    tables.print_comparison(found)
    print_where(out)
    print("\nNext: scripts/a2rt compare --help, scripts/a2rt test, README.md")
    return 0
