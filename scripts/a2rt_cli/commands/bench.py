"""Measure the speed of our own parts as ratios, so that the numbers mean the same on any machine.

Functional rays a second of every unit against Embree on the same rays (one thread); frame time
under the layer with capture against the layer without, paired in one run; simulated rays a second.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from a2rt_cli import options
from a2rt_cli.setup.needs import Need

EXAMPLES = """  scripts/a2rt bench
  scripts/a2rt bench bath car --no-overhead
  scripts/a2rt bench cornell --size 1280x720 --frames 7 -o bench.json
"""
NEED = Need.ENGINE


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "scenes", nargs="*", metavar="SCENE", help="scenes to measure on (the embedded ones)"
    )
    parser.add_argument(
        "--size",
        type=options.size,
        default=(1280, 720),
        metavar="WxH",
        help="picture size of the overhead measurement (1280x720)",
    )
    parser.add_argument(
        "--frames", type=options.positive, default=5, help="pairs of frames per scene (5)"
    )
    parser.add_argument("--no-units", action="store_true", help="skip the units' rates")
    parser.add_argument("--no-overhead", action="store_true", help="skip the layer's overhead")
    parser.add_argument("-o", "--output", metavar="FILE", help="JSON (out/bench/bench.json)")


def run(args: argparse.Namespace) -> int:
    from a2rt_cli import bench
    from a2rt_cli.engine import scenes
    from a2rt_cli.files import write_json
    from a2rt_cli.paths import shown

    target = Path(args.output or "out/bench/bench.json")
    chosen = [scenes.find(text) for text in args.scenes or scenes.EMBEDDED]
    found: dict = {"machine": bench.machine()}
    if not args.no_overhead:
        found["layer_overhead"] = bench.layer_overhead(chosen, args.size, args.frames)
        bench.print_overhead(found["layer_overhead"])
    if not args.no_units:
        found["units"] = bench.unit_rates(chosen, target.parent / ".cache")
        bench.print_units(found["units"])
    write_json(target, found)
    print(f"\nNumbers: {shown(target)}")
    return 0
