"""Calls of a2rt-core, the simulator's engine. One function per subcommand that we use."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from a2rt_cli import console
from a2rt_cli.engine import programs
from a2rt_cli.errors import UserError
from a2rt_cli.files import replacing
from a2rt_cli.paths import config_folder, shown


def _call(words: Sequence[str | Path], what: str, shown: console.Step | None = None) -> list[str]:
    log = programs.log_file(f"core-{words[0]}-{os.getpid()}-{abs(hash(tuple(map(str, words))))}")
    lines = programs.call([programs.program("a2rt-core"), *words], what=what, log=log, shown=shown)
    log.unlink(missing_ok=True)  # kept only when the call failed
    return lines


def import_capture(
    raw: Path, target: Path, *, scene: str, workload: str, shown: console.Step | None = None
) -> None:
    """Turns a raw capture into a workload file; the file appears whole or not at all."""
    with replacing(target) as temporary:
        words = ["import", raw, "-o", temporary, "--scene", scene, "--workload", workload]
        _call(words, f"importing the capture of {scene}", shown)


def check_unit(unit: str, overrides: Sequence[str] = ()) -> None:
    """Refuses a unit that there is not, and keys that it does not read."""
    words: list[str | Path] = ["units", config_file("units", unit)]
    for override in overrides:
        words += ["--set", override]
    _call(words, f"reading the parameters of {unit}")


def check_gpu(gpu: str, overrides: Sequence[str] = ()) -> None:
    """The same of a machine."""
    words: list[str | Path] = ["describe-gpu", config_file("gpus", gpu)]
    for override in overrides:
        words += ["--set", override]
    _call(words, f"reading the parameters of {gpu}")


def check(workload: Path, shown: console.Step | None = None) -> list[str]:
    """Compares the driver's recorded hits with the exact walk over its own nodes."""
    return _call(["check", workload], f"checking {workload.name}", shown)


def inspect(workload: Path) -> dict[str, Any]:
    return _result(["inspect", workload, "--json"], f"inspecting {workload.name}")


def trace(
    workload: Path,
    unit: str,
    target: Path,
    *,
    overrides: Sequence[str] = (),
    audit: int | None = None,
    verdicts: Path | None = None,
    previous: Path | None = None,
    shown: console.Step | None = None,
) -> dict[str, Any]:
    """Functional run of one unit: hits, accuracy, node traffic. No time."""
    words: list[str | Path] = ["trace", workload, "--unit", unit, "-o", target]
    for override in overrides:
        words += ["--set", override]
    if audit is not None:
        words += ["--audit", str(audit)]
    if verdicts is not None:
        words += ["--verdicts", verdicts]
    if previous is not None:
        words += ["--previous", previous]
    _call(words, f"tracing {workload.name} with {unit}", shown)
    return read_result(target)


def simulate(
    workload: Path,
    unit: str,
    gpu: str,
    target: Path,
    *,
    overrides: Sequence[str] = (),
    extra: Sequence[str] = (),
    shown: console.Step | None = None,
) -> dict[str, Any]:
    """Cycles and energy of one unit. `extra`: --compare-counts, --heatmap, --sample, ..."""
    words: list[str | Path] = ["simulate", workload, "--unit", unit, "--gpu", gpu, "-o", target]
    for override in overrides:
        words += ["--set", override]
    _call([*words, *extra], f"simulating {workload.name} with {unit} on {gpu}", shown)
    return read_result(target)


def vary(
    workload: Path,
    unit: str,
    gpu: str,
    target: Path,
    *,
    vary: Sequence[str],
    overrides: Sequence[str] = (),
    extra: Sequence[str] = (),
    shown: console.Step | None = None,
) -> dict[str, Any]:
    """Cycles and energy of one unit on every machine that `vary` (KEY=V,V,...) makes of `gpu`."""
    words: list[str | Path] = ["vary", workload, "--unit", unit, "--gpu", gpu, "-o", target]
    for option, values in (("--set", overrides), ("--vary", vary)):
        for value in values:
            words += [option, value]
    _call([*words, *extra], f"simulating {workload.name} with {unit} on machines of {gpu}", shown)
    return read_result(target)


def bench_units(
    workload: Path,
    target: Path,
    *,
    units: Sequence[str] = (),
    extra: Sequence[str] = (),
    shown: console.Step | None = None,
) -> dict[str, Any]:
    """Functional rays a second, build times and peak memory; all units unless some are named.

    `extra`: --rays, --repeats. A unit that is named twice is measured twice.
    """
    words: list[str | Path] = ["bench-units", workload, "-o", target, *extra]
    words += ["--units", ",".join(units)] if units else []
    _call(words, f"timing units on {workload.name}", shown)
    return read_result(target)


def bench_simulate(
    workload: Path,
    target: Path,
    *,
    units: Sequence[str],
    repeats: int = 1,
    shown: console.Step | None = None,
) -> list[dict[str, Any]]:
    """Simulated rays a second of every unit in both models, one thread, best of `repeats`."""
    words: list[str | Path] = ["bench-simulate", workload, "--units", ",".join(units)]
    words += ["--repeats", str(repeats), "-o", target]
    _call(words, f"timing simulations of {workload.name}", shown)
    return read_result(target)


def direction_map(
    units: Sequence[str], bins: int, pairs: int, target: Path, shown: console.Step | None = None
) -> dict[str, Any]:
    """Wrong box decisions by direction, against exact arithmetic; scene-independent."""
    words: list[str | Path] = ["direction-map", "--units", ",".join(units), "--bins", str(bins)]
    with replacing(target) as temporary:
        _call([*words, "--pairs", str(pairs), "-o", temporary], "testing directions", shown)
    return read_result(target)


def tester(unit: str) -> dict[str, Any]:
    """Area and energy of the quantized box tester that a unit of A²RT is simulated with."""
    return _result(["tester", "--unit", unit], f"asking for the tester of {unit}")


def subcommands() -> frozenset[str]:
    """What this build of a2rt-core can do."""
    lines = _call(["--help"], "asking a2rt-core for its commands")
    start = next((i for i, line in enumerate(lines) if line.lower().startswith("subcommand")), -1)
    return frozenset(line.split()[0] for line in lines[start + 1 :] if line.strip())


def read_result(path: Path) -> Any:
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise UserError(
            f"{path}: not a result file ({error})", "remove it and run again"
        ) from error


def _result(words: Sequence[str | Path], what: str) -> dict[str, Any]:
    text = "\n".join(_call(words, what))
    try:
        return json.loads(text[text.index("{") :])
    except ValueError as error:
        raise UserError(f"{what}: a2rt-core printed no JSON", "please report this") from error


def config_names(kind: str) -> list[str]:
    """Names of configurations of a kind: units, gpus, workloads, scenes, experiments."""
    return sorted(path.stem for path in config_folder(kind).glob("*.toml"))


def config_file(kind: str, name: str) -> Path:
    """The file that a unit's or GPU's name, or a path to a .toml file, stands for."""
    path = Path(name) if name.endswith(".toml") else config_folder(kind) / f"{name}.toml"
    if not path.is_file():
        raise UserError(
            f"{name}: no such {kind.rstrip('s')}",
            f"write {shown(config_folder(kind))}/{path.stem}.toml, name another file, or one of: "
            f"{', '.join(config_names(kind))}",
        )
    return path
