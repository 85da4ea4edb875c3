"""Measure the speed of our own parts, with the limits the project sets itself beside them.

Ratios are of two things timed in the same run, so that they mean the same on any machine. Nothing
fails if a limit is not kept: a busy machine is no error. Real scenes that are absent are stood in
for by embedded ones.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from a2rt_cli import options
from a2rt_cli.setup.needs import Need

EXAMPLES = """  scripts/a2rt bench
  scripts/a2rt bench --only units,build --scenes bath,car
  scripts/a2rt bench --only overhead --scenes forest --pairs 7 --frames 1
"""
NEED = Need.ENGINE
# Part -> the scenes it is measured on.
PARTS = {
    "overhead": ("cornell", "spheres", "forest", "torture"),
    "units": ("bath", "car"),
    "build": ("car",),
    "simulate": ("ship",),
}
UNITS = ("baseline", "aqb8", "a2rt", "cwbvh", "clbvh")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--only",
        type=_parts,
        default=tuple(PARTS),
        metavar="A,B",
        help="overhead: layer with capture against without; units: functional rays/s against "
        "Embree; build: classify and encode against Embree's build; simulate: simulated rays/s",
    )
    parser.add_argument("--scenes", type=options.names_list, help="instead of each part's own")
    parser.add_argument(
        "--size",
        type=options.size,
        default=(1280, 720),
        metavar="WxH",
        help="picture size of the overhead measurement (1280x720)",
    )
    parser.add_argument(
        "--pairs", type=options.positive, default=3, help="pairs of runs of the overhead (3)"
    )
    parser.add_argument(
        "--frames",
        type=options.positive,
        default=3,
        help="frames a run of the overhead draws; their median counts (3)",
    )
    parser.add_argument("-o", "--output", metavar="FILE", help="JSON (out/bench/bench.json)")


def _parts(text: str) -> tuple[str, ...]:
    chosen = options.names_list(text)
    for part in chosen:
        if part not in PARTS:
            raise argparse.ArgumentTypeError(f"{part}: one of {', '.join(PARTS)}")
    return chosen


def run(args: argparse.Namespace) -> int:
    from a2rt_cli import bench, console
    from a2rt_cli.engine import scenes
    from a2rt_cli.files import write_json
    from a2rt_cli.paths import shown

    target = Path(args.output or "out/bench/bench.json")
    cache = target.parent / ".cache"
    found: dict = {"machine": bench.machine(), "limits": bench.LIMITS}
    for part in args.only:
        chosen = [scenes.find(text) for text in args.scenes or PARTS[part]]
        for note in filter(None, dict.fromkeys(scene.note for scene in chosen)):
            console.note(f"  {note}")
        if part == "overhead":
            found[part] = bench.layer_overhead(chosen, args.size, args.pairs, args.frames, cache)
            bench.print_overhead(found[part])
        elif part == "units":
            found[part] = bench.unit_rates(chosen, cache)
            bench.print_units(found[part])
        elif part == "build":
            found[part] = bench.build_cost(chosen, cache)
            bench.print_build(found[part])
        else:
            found[part] = bench.simulation_rates(chosen, UNITS, bench.REPEATS, cache)
            bench.print_simulation(found[part])
        write_json(target, found)
    print(f"\nNumbers: {shown(target)}   (load of the machine: {found['machine']['load']:.1f})")
    return 0
