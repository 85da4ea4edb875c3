"""One RT unit on many machines: its rays are traversed once and timed on each."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from a2rt_cli import options
from a2rt_cli.setup.needs import Need

EXAMPLES = """  scripts/a2rt vary w.h5 --unit a2rt --vary l1.capacity=32768,65536,131072
  scripts/a2rt vary w.h5 --unit baseline --vary rt.warps=2,4,8 --vary l1.latency=20,40
  scripts/a2rt vary w.h5 --unit aqb8 --set model=reserved --vary dram.mhz=1750,3500 -o mhz.json
"""
NEED = Need.ENGINE


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("workload", metavar="w.h5", help="workload file")
    parser.add_argument("--unit", required=True, metavar="U", help="RT unit, by name or .toml")
    parser.add_argument(
        "--vary",
        action="append",
        required=True,
        metavar="KEY=V,V,...",
        help="values of one parameter of the machine (sm., l1., l2., dram., rt., ...); if "
        "repeated, every value with every other; rt.stack_* and rt.context* first, as each of "
        "their values has the rays traversed anew",
    )
    parser.add_argument(
        "--gpu", default="table1", metavar="G", help="machine, by name or .toml (table1)"
    )
    options.add_overrides(parser)
    choices = ("same-count", "same-area", "config")
    parser.add_argument(
        "--counts",
        choices=choices,
        default=choices[0],
        help="testers of a unit: as many as A2RT has, as many as fit its area, or as the machine "
        "says (same-count)",
    )
    parser.add_argument("-o", "--output", metavar="r.json", help="results (W.UNIT.vary.json)")


def run(args: argparse.Namespace) -> int:
    from a2rt_cli import console, tables
    from a2rt_cli.engine import capture, core
    from a2rt_cli.errors import UserError
    from a2rt_cli.files import write_json
    from a2rt_cli.paths import shown

    captured = capture.from_file(Path(args.workload))
    unit = Path(args.unit).stem
    target = Path(args.output or f"{captured.name}.{unit}.vary.json")
    if target.suffix in (".png", ".svg"):
        raise UserError(f"{target}: the results are JSON", "pictures are written beside r.json")
    target.parent.mkdir(parents=True, exist_ok=True)
    with console.step(f"Simulating {captured.name} with {unit}") as step:
        found = core.vary(
            captured.file,
            args.unit,
            args.gpu,
            target,
            vary=args.vary,
            overrides=args.overrides,
            extra=("--compare-counts", args.counts),
            shown=step,
        )
    found["provenance"] = {"a2rt": options.command_line()}
    write_json(target, found)
    tables.print_machines(found)
    picture = _draw(found, f"{captured.name}, {unit}", target)
    print(f"\nResults: {shown(target)}\nPicture: {shown(picture)}")
    return 0


def _draw(found: dict[str, Any], title: str, target: Path) -> Path:
    """Cycles of every machine as a bar."""
    from a2rt_cli import formats, plotting
    from a2rt_cli.report import charts

    runs = found["runs"]
    figure, axes = plotting.new(8, 1.2 + 0.36 * len(runs))
    names = [", ".join(f"{key} = {value}" for key, value in one["set"].items()) for one in runs]
    cycles = [one["time"]["cycles"] for one in runs]
    spots = range(len(runs))
    axes.barh(spots, cycles, color=charts.unit_colour(found["unit"]["name"], 0))
    for spot, value, one in zip(spots, cycles, runs, strict=True):
        words = f" {value:,} ({formats.factor(one['speedup'])})"
        axes.annotate(words, (value, spot), va="center", fontsize=8)
    axes.set_yticks(spots, names)
    axes.invert_yaxis()
    axes.grid(axis="y", visible=False)
    axes.margins(x=0.25)
    axes.xaxis.set_major_formatter("{x:,.0f}")
    axes.set_xlabel("cycles (speedup over the first)")
    axes.set_title(title, loc="left")
    return plotting.save(figure, target.parent, target.stem)[0]
