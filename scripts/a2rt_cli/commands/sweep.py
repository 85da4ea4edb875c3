"""Run an experiment: parameters × scenes × workloads, resumable, on a laptop or a cluster.

The experiment is a TOML file; it becomes a Snakemake workflow whose finished points are never run
again. With --search an optimiser looks for the cheapest configuration within an accuracy budget.
"""

from __future__ import annotations

import argparse
import dataclasses
from pathlib import Path

from a2rt_cli import options
from a2rt_cli.setup.needs import Need

EXAMPLES = """  scripts/a2rt sweep lumibench_configs/experiments/price-of-accuracy.toml
  scripts/a2rt sweep smoke --dry-run
  scripts/a2rt sweep price-of-accuracy --scenes ship,bath --size 48x48 -o out/real
  scripts/a2rt sweep my.toml -o out/my --parallel 8
  scripts/a2rt sweep my.toml --profile slurm --dry-run
  scripts/a2rt sweep my.toml --search --trials 60
"""
NEED = Need.SWEEP


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("experiment", metavar="EXPERIMENT", help="name or .toml file")
    parser.add_argument("--scenes", type=options.names_list, help="instead of the experiment's")
    parser.add_argument(
        "--size", metavar="WxH", type=options.size, help="of the pictures, not the experiment's"
    )
    parser.add_argument("--dry-run", action="store_true", help="only say what would run")
    parser.add_argument(
        "--profile", metavar="NAME|DIR", help="Snakemake profile: slurm, or a folder of your own"
    )
    parser.add_argument("--search", action="store_true", help="look for the best configuration")
    parser.add_argument("--trials", type=options.positive, default=40, help="of --search (40)")
    options.add_parallel(parser)
    parser.add_argument("-o", "--output", metavar="DIR", help="results (out/sweep/NAME)")


def run(args: argparse.Namespace) -> int:
    from a2rt_cli.files import exclusive
    from a2rt_cli.paths import shown
    from a2rt_cli.report import price_page
    from a2rt_cli.sweep import plan, search, workflow

    experiment = plan.load(plan.find(args.experiment), args.scenes)
    if args.size:
        experiment = dataclasses.replace(experiment, size=args.size)
    out = Path(args.output or Path("out") / "sweep" / experiment.name)
    if args.search:
        best = search.run(experiment, out, args.trials, args.parallel)
        search.print_best(experiment, best)
        return 0
    if args.dry_run:
        workflow.dry_run(experiment, out, args.parallel, args.profile)
        return 0
    with exclusive(out):
        planned = plan.write(experiment, out)
        points = f"{len(planned.points)} points on {len(planned.captures)} captures"
        print(f"{experiment.title}: {points}")
        workflow.run(planned, out, args.parallel, args.profile)
        plan.collect(planned, out, options.command_line())
        page = price_page.write(out, experiment)
    print(f"\nReport:  {shown(page)}\nNumbers: {shown(out / 'results.json')}")
    return 0
