"""Options that several commands share, spelled the same everywhere."""

from __future__ import annotations

import argparse
import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from a2rt_cli.engine.renderer import RenderOptions, parse_size
from a2rt_cli.errors import UserError

if TYPE_CHECKING:
    from a2rt_cli.engine.runs import RunSpec

DEFAULT_SIZE = (128, 128)
DEFAULT_UNITS = ("baseline", "aqb8", "a2rt")


def add_render(parser: argparse.ArgumentParser) -> None:
    group = parser.add_argument_group("what is drawn")
    group.add_argument(
        "--workload",
        default="auto",
        metavar="W",
        help="shaders: auto (what the scene calls for), pt, sh, ao, ... (auto)",
    )
    group.add_argument(
        "--size", type=size, default=DEFAULT_SIZE, metavar="WxH", help="picture size (128x128)"
    )
    group.add_argument(
        "--spp", type=positive, metavar="N", help="samples a pixel (what the workload asks for)"
    )
    group.add_argument("--seed", type=int, default=1, help="seed of all random numbers (1)")
    group.add_argument(
        "--effects",
        default="auto",
        metavar="LIST",
        help="auto: only what the scene calls for; all; or a list such as shadow,ao (auto)",
    )


def render_options(args: argparse.Namespace) -> RenderOptions:
    width, height = args.size
    return RenderOptions(args.workload, width, height, args.spp, args.seed, args.effects)


def add_units(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--units",
        type=names_list,
        default=DEFAULT_UNITS,
        metavar="A,B,C",
        help=f"RT units by name or .toml file ({','.join(DEFAULT_UNITS)})",
    )


def add_overrides(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--set",
        dest="overrides",
        action="append",
        default=[],
        metavar="KEY=VALUE",
        help="change one parameter of the unit, or of the machine (sm., l1., l2., dram., rt.); "
        "may be repeated",
    )


def add_gpu(parser: argparse.ArgumentParser, default: str | None) -> None:
    shown = default or "none: no cycles"
    parser.add_argument(
        "--gpu",
        default=default,
        metavar="G",
        help=f"machine to simulate cycles on, by name or .toml file; 'none' for none ({shown})",
    )


def add_timing(parser: argparse.ArgumentParser, both: bool) -> None:
    """`both`: the command may run a unit twice, once for each comparison."""
    group = parser.add_argument_group("how cycles are simulated")
    choices = ("both", "same-count", "same-area") if both else ("same-count", "same-area")
    group.add_argument(
        "--counts",
        choices=choices,
        default=choices[0],
        help=f"testers of a unit: as many as A2RT has, or as many as fit its area ({choices[0]})",
    )
    group.add_argument(
        "--sample",
        type=share,
        metavar="SHARE",
        help="simulate this share of the warps, for example 0.2, and extrapolate the cycles",
    )
    group.add_argument(
        "--check-sample", action="store_true", help="also simulate all warps: the sample's error"
    )


def timed_specs(args: argparse.Namespace, specs: list[RunSpec]) -> list[RunSpec]:
    """`specs` with the options of add_timing."""
    from dataclasses import replace

    from a2rt_cli.engine import runs

    if args.check_sample and args.sample is None:
        raise UserError("--check-sample checks a sample", "add --sample 0.2")
    specs = [
        replace(one, sample=args.sample, check_sample=args.check_sample, heatmap=True)
        for one in specs
    ]
    if args.counts == "both":
        return runs.with_same_area(specs)
    return [replace(one, comparison=args.counts) for one in specs]


def gpu_of(args: argparse.Namespace) -> str | None:
    return None if args.gpu in (None, "none") else args.gpu


def add_parallel(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "-j", "--parallel", type=positive, default=2, metavar="N", help="simulations at a time (2)"
    )


def command_line() -> str:
    """The call as the user made it, for provenance."""
    return "a2rt " + shlex.join(sys.argv[1:])


def output_folder(args: argparse.Namespace, fallback: str) -> Path:
    return Path(args.output or fallback)


def size(text: str) -> tuple[int, int]:
    try:
        return parse_size(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def positive(text: str) -> int:
    if not text.isdigit() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"{text}: a whole number of at least 1")
    return int(text)


def share(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 0 < value <= 1:
        raise argparse.ArgumentTypeError(f"{text}: a share is above 0 and at most 1")
    return value


def names_list(text: str) -> tuple[str, ...]:
    names = tuple(dict.fromkeys(name.strip() for name in text.split(",") if name.strip()))
    if not names:
        raise argparse.ArgumentTypeError("at least one name")
    return names
