"""Say what is installed, which driver is used, what is missing and the command that gets it.

Changes nothing. Exit status 0 if everything needed is there, 1 if something is missing.
"""

from __future__ import annotations

import argparse
import json

from a2rt_cli import console
from a2rt_cli.errors import EXIT_FALSE
from a2rt_cli.setup.needs import Need

EXAMPLES = """  scripts/a2rt doctor            a table of what is there and what is not
  scripts/a2rt doctor --json     the same for programs
"""
NEED = Need.NOTHING


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--json", action="store_true", help="print JSON instead of a table")


def run(args: argparse.Namespace) -> int:
    from a2rt_cli.setup.checks import examine

    findings = examine()
    missing = [finding for finding in findings if finding.state == "missing"]
    if args.json:
        print(json.dumps([finding.as_dict() for finding in findings], indent=1))
    else:
        rows = [(f.what, f.state, f.found) for f in findings]
        print(console.table(("what", "state", "found"), rows, left=3))
        for finding in findings:
            if finding.remedy:
                print(f"\n{finding.what} ({finding.state})\n  remedy: {finding.remedy}")
        if missing:
            print(f"\n{len(missing)} missing. `scripts/a2rt demo` installs and builds what it can.")
        else:
            print("\nEverything needed is here.")
    return EXIT_FALSE if missing else 0
