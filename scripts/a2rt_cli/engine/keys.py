"""What a configuration decides, as a hash: the files the programs read, not their names."""

from __future__ import annotations

import tomllib
from pathlib import Path

from a2rt_cli.engine import core
from a2rt_cli.files import hash_file, hash_values
from a2rt_cli.paths import config_folder

# The unit whose testers' area the machine is filled to: a2rt-core simulate reads it for every unit.
YARDSTICK = "a2rt"


def of_unit(unit: str) -> str:
    return _of_chain(core.config_file("units", unit))


def of_gpu(gpu: str) -> str:
    """Of a machine, and of what its testers' number is measured by."""
    return hash_values(_of_chain(core.config_file("gpus", gpu)), of_unit(YARDSTICK))


def of_workload(workload: str) -> str:
    """Of the shaders' settings. The program chooses `auto` among all that there are."""
    named = config_folder("workloads") / f"{workload}.toml"
    paths = [named] if named.is_file() else sorted(config_folder("workloads").glob("*.toml"))
    return hash_values([(path.stem, _of_chain(path)) for path in paths])


def _of_chain(path: Path) -> str:
    return hash_values([hash_file(one) for one in _with_parents(path)])


def _with_parents(path: Path) -> list[Path]:
    """A configuration and those it inherits from: an edit of a parent is an edit of it."""
    chain = [path]
    while True:
        try:
            inherits = tomllib.loads(chain[-1].read_text(encoding="utf-8")).get("inherits")
        except tomllib.TOMLDecodeError:
            return chain  # a2rt-core reports it with its place
        if not isinstance(inherits, str):
            return chain
        parent = chain[-1].parent / (inherits if inherits.endswith(".toml") else f"{inherits}.toml")
        if not parent.is_file() or parent in chain:
            return chain
        chain.append(parent)
