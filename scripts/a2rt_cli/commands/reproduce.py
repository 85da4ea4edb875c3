"""Draw the paper's figures and tables from our own runs, with the paper's numbers beside ours.

Each figure has an experiment in lumibench_configs/experiments/ that says which scenes and workloads
it uses. Finished runs are kept; the same command goes on where it was killed.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from a2rt_cli import options
from a2rt_cli.setup.needs import Need

EXAMPLES = """  scripts/a2rt reproduce fig7
  scripts/a2rt reproduce fig6 table3 -o out/paper
  scripts/a2rt reproduce fig8 --scenes cornell,spheres --size 32x32     a quick look
  scripts/a2rt reproduce all
"""
NEED = Need.ENGINE


def add_arguments(parser: argparse.ArgumentParser) -> None:
    from a2rt_cli import figures

    parser.add_argument(
        "figures",
        nargs="+",
        metavar="FIGURE",
        choices=(*figures.names(), "all"),
        help=", ".join((*figures.names(), "all")),
    )
    parser.add_argument("--scenes", type=options.names_list, help="instead of the experiment's")
    parser.add_argument(
        "--size", type=options.size, metavar="WxH", help="picture size, instead of the experiment's"
    )
    options.add_parallel(parser)
    parser.add_argument("-o", "--output", metavar="DIR", help="results (out/reproduce)")


def run(args: argparse.Namespace) -> int:
    from a2rt_cli import figures
    from a2rt_cli.paths import shown

    out = Path(args.output or "out/reproduce")
    chosen = figures.names() if "all" in args.figures else list(dict.fromkeys(args.figures))
    for name in chosen:
        drawn = figures.reproduce(
            name, out / name, scenes=args.scenes, size=args.size, parallel=args.parallel
        )
        print(drawn.text)
        print(f"\nFiles: {', '.join(shown(path) for path in drawn.files)}")
    return 0
