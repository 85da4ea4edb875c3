"""The command line: finds the commands, sets the machine up as far as one needs, runs it."""

from __future__ import annotations

import argparse
import importlib
import os
import pkgutil
import signal
import traceback
from types import ModuleType

from a2rt_cli import commands, console
from a2rt_cli.errors import EXIT_BUG, EXIT_INTERRUPTED, EXIT_USER, UserError
from a2rt_cli.setup.needs import Need

PURPOSE = """a2rt: run real Vulkan ray-tracing shaders with a modelled RT unit, and see what its
precision costs in accuracy, memory traffic, time and energy."""
EPILOG = """Examples:
  scripts/a2rt demo                        set up, compare three RT units, write a report
  scripts/a2rt test                        set up, run the tests
  scripts/a2rt compare cornell forest      compare units on scenes of your choice
  scripts/a2rt COMMAND --help              options and examples of a command
"""


def command_names() -> list[str]:
    return sorted(info.name for info in pkgutil.iter_modules(commands.__path__))


def load(name: str) -> ModuleType:
    """One command module; see commands/__init__.py for what it must define."""
    return importlib.import_module(f"a2rt_cli.commands.{name}")


def build_parser() -> argparse.ArgumentParser:
    formatter = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(
        prog="a2rt", description=PURPOSE, epilog=EPILOG, formatter_class=formatter
    )
    subparsers = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)
    for name in command_names():
        module = load(name)
        summary = (module.__doc__ or "").strip().splitlines()[0]
        sub = subparsers.add_parser(
            name,
            help=summary,
            description=(module.__doc__ or "").strip(),
            epilog=f"Examples:\n{module.EXAMPLES}",
            formatter_class=formatter,
        )
        module.add_arguments(sub)
        sub.set_defaults(module=module)
    return parser


def _prepare(need: Need) -> None:
    if need is Need.NOTHING or "A2RT_NO_SETUP" in os.environ:
        return
    from a2rt_cli.setup.machine import prepare

    prepare(need)


def main(argv: list[str]) -> int:
    # A closed pipe (`a2rt ... | head`) is the reader's choice, not an error.
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    # A polite kill ends our children and removes temporary files, as Ctrl-C does.
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    args = build_parser().parse_args(argv)
    try:
        need = args.module.NEED
        _prepare(need(args) if callable(need) else need)
        return args.module.run(args)
    except UserError as error:
        console.note("\n".join(error.lines()))
        return EXIT_USER
    except KeyboardInterrupt:
        console.note("a2rt: interrupted; finished results are kept, the same command resumes")
        return EXIT_INTERRUPTED
    except Exception:
        traceback.print_exc()
        console.note("a2rt: this is a bug in a2rt; please report the lines above")
        return EXIT_BUG
