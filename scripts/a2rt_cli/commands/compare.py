"""Compare RT units side by side on the same rays, and write a report.

Every scene is drawn once by real Vulkan shaders under the capture layer; every unit then runs on
exactly those rays. A killed comparison goes on where it was when the same command is given again.
Writes DIR/results.json, DIR/results.csv, DIR/report.html and the pictures.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from a2rt_cli import options
from a2rt_cli.setup.needs import Need

EXAMPLES = """  scripts/a2rt compare cornell forest
  scripts/a2rt compare lumi:ship_sh lumi:bath_pt      LumiBench's runs; a2rt scenes lists them
  scripts/a2rt compare scene.glb --workload ao --size 256x256 -o out/ao
  scripts/a2rt compare w.h5 --units baseline,a2rt,cwbvh --gpu none
  scripts/a2rt compare forest --set rt.warps=8 --set l1.capacity=131072
  scripts/a2rt compare bath --sample 0.2 --check-sample
  scripts/a2rt compare cornell --units a2rt --set precision.box_bits=6 --audit 100000
"""
NEED = Need.ENGINE


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "what",
        nargs="+",
        metavar="SCENE|w.h5",
        help="scenes, workload files, LumiBench runs such as lumi:ship_sh",
    )
    options.add_units(parser)
    options.add_overrides(parser)
    options.add_gpu(parser, "table1")
    options.add_timing(parser, both=True)
    options.add_render(parser)
    options.add_parallel(parser)
    parser.add_argument(
        "--audit",
        type=int,
        metavar="RAYS",
        help="rays compared with exact arithmetic, 0 for none (20000)",
    )
    parser.add_argument(
        "--no-pictures", action="store_true", help="skip drawing what each unit would draw"
    )
    parser.add_argument("-o", "--output", metavar="DIR", help="folder of the results (out/compare)")


def run(args: argparse.Namespace) -> int:
    from a2rt_cli import comparison, tables
    from a2rt_cli.engine.runs import DEFAULT_AUDIT, RunSpec
    from a2rt_cli.report import page

    out = options.output_folder(args, "out/compare")
    render = options.render_options(args)
    items = comparison.items_of(args.what, render)
    specs = [
        RunSpec(
            unit,
            options.gpu_of(args),
            tuple(args.overrides),
            DEFAULT_AUDIT if args.audit is None else args.audit,
            picture=not args.no_pictures,
        )
        for unit in args.units
    ]
    if options.gpu_of(args) is not None:
        specs = options.timed_specs(args, specs)
    found = comparison.compare(
        items, specs, out, parallel=args.parallel, command=options.command_line()
    )
    page.write(out)
    tables.print_comparison(found)
    tables.print_match(found)
    tables.print_samples(found)
    print_where(out)
    return 0


def print_where(out: Path) -> None:
    from a2rt_cli.paths import shown

    print(f"\nReport:  {shown(out / 'report.html')}   (one file, opens in any browser)")
    print(f"Numbers: {shown(out / 'results.json')}, {shown(out / 'results.csv')}")
    if (out / "pictures").is_dir():  # a workload file's scene cannot be drawn again
        print(f"Pictures: {shown(out / 'pictures')}/")
