"""Set the machine up if needed, build the tests and run them.

Ends with the test runner's own summary. The fast tier answers "is it right?" in minutes; the slow
tier searches longer (fuzzing, large samples against the exact oracle).
"""

from __future__ import annotations

import argparse
import os
import subprocess

from a2rt_cli.setup.needs import Need

EXAMPLES = """  scripts/a2rt test                    the fast tier
  scripts/a2rt test --tier all         everything
  scripts/a2rt test --only hard_cases  the tests whose names contain hard_cases
"""
PARALLEL = 2


def NEED(args: argparse.Namespace) -> Need:
    return Need.TESTS if args.tier == "fast" else Need.SLOW_TESTS


# Written by the slow tier's test of the guarantee: found and redundant rates of every design.
FOUND_RATES = "tests/unit/arith/guarantee-1000000000.txt"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--tier", choices=("fast", "slow", "all"), default="fast", help="which tests (fast)"
    )
    parser.add_argument("--only", metavar="REGEX", help="only tests whose names match")
    parser.add_argument(
        "-j", "--parallel", type=int, default=PARALLEL, help=f"tests at a time ({PARALLEL})"
    )


def run(args: argparse.Namespace) -> int:
    from a2rt_cli.paths import BUILD

    rates = BUILD / FOUND_RATES
    results = BUILD / "test-results.xml"
    command = ["ctest", "--test-dir", str(BUILD), "--output-on-failure", "--no-tests=error"]
    command += ["--parallel", str(args.parallel), "--output-junit", str(results)]
    if args.tier != "all":
        command += ["--label-regex", f"^{args.tier}$"]
    if args.only:
        command += ["--tests-regex", args.only]
    env = {**os.environ, "A2RT_NO_SETUP": "1", "A2RT_BUILD_DIR": str(BUILD)}
    code = subprocess.run(command, env=env, stdin=subprocess.DEVNULL, check=False).returncode
    if args.tier != "fast" and rates.is_file():
        print("\nBox tests against exact arithmetic (the last run of the slow tier):\n")
        print(rates.read_text(encoding="utf-8"))
    return code
