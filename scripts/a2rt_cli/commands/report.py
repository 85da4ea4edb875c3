"""Write the HTML report of a folder of results.

The page is one self-contained file: it works offline, prints well, and holds its pictures. The
folder of a sweep gets the page of its price list, any other that of a comparison.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from a2rt_cli.setup.needs import Need

EXAMPLES = """  scripts/a2rt report out/demo
  scripts/a2rt report out/compare -o page.html
  scripts/a2rt report out/sweep/price-of-accuracy
"""
NEED = Need.PYTHON


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("folder", metavar="DIR", help="folder that compare, demo or sweep wrote")
    parser.add_argument("-o", "--output", metavar="FILE", help="page to write (DIR/report.html)")


def run(args: argparse.Namespace) -> int:
    from a2rt_cli.paths import shown
    from a2rt_cli.report import page, price_page
    from a2rt_cli.sweep import plan

    folder, target = Path(args.folder), Path(args.output) if args.output else None
    if plan.is_sweep(folder):
        target = price_page.write(folder, plan.kept_experiment(folder), target)
    else:
        target = page.write(folder, target)
    print(f"Report: {shown(target)}")
    return 0
