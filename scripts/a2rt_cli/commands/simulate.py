"""Simulate one RT unit on one workload file: cycles, memory traffic, energy."""

from __future__ import annotations

import argparse
from pathlib import Path

from a2rt_cli import options
from a2rt_cli.setup.needs import Need

EXAMPLES = """  scripts/a2rt simulate w.h5 --unit a2rt
  scripts/a2rt simulate w.h5 --unit aqb8 --gpu table1 -o aqb8.json
  scripts/a2rt simulate w.h5 --unit a2rt --set precision.box_bits=6 -o six.json
"""
NEED = Need.ENGINE


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("workload", metavar="w.h5", help="workload file")
    parser.add_argument("--unit", required=True, metavar="U", help="RT unit, by name or .toml")
    options.add_gpu(parser, "table1")
    options.add_overrides(parser)
    options.add_timing(parser, both=False)
    parser.add_argument("-o", "--output", metavar="r.json", help="result (W.UNIT.json)")


def run(args: argparse.Namespace) -> int:
    from a2rt_cli import console, tables
    from a2rt_cli.engine import capture, runs
    from a2rt_cli.paths import shown

    captured = capture.from_file(Path(args.workload))
    plain = runs.RunSpec(args.unit, options.gpu_of(args), tuple(args.overrides), picture=False)
    (spec,) = options.timed_specs(args, [plain])
    target = Path(args.output or f"{captured.name}.{Path(args.unit).stem}.json")
    with console.step(f"Simulating {captured.name} with {spec.label()}"):
        result = runs.execute(captured, spec, target, target.parent)
    tables.print_comparison([result])
    tables.print_time(result)
    print(f"\nResult: {shown(target)}")
    return 0
