"""The built programs and how they are called: progress shown, output logged, failure explained."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path

from a2rt_cli import console, energy_table
from a2rt_cli.errors import UserError
from a2rt_cli.files import hash_files
from a2rt_cli.paths import LOGS
from a2rt_cli.process import progress_line, run_logged
from a2rt_cli.setup import build, driver

_LAYER_GLOB = "*VkLayer*a2rt*.so"


def program(name: str) -> Path:
    found = build.find_program(name)
    if found is None:
        raise UserError(f"{name} is not built", "run: scripts/a2rt demo")
    return found


def layer_library() -> Path:
    found = sorted(build.BUILD.glob(f"vulkan_sim_patch/**/{_LAYER_GLOB}"))
    if not found:
        raise UserError("the Vulkan layer is not built", "run: scripts/a2rt demo")
    return found[0]


def lavapipe() -> dict[str, str]:
    icd = driver.icd_file()
    if icd is None:
        raise UserError("no lavapipe driver is installed", "run: scripts/a2rt doctor")
    return driver.environment(icd)


@cache
def core_key() -> str:
    """Changes when a2rt-core or its energy table does; results made by others are not reused."""
    return hash_files([program("a2rt-core"), energy_table.FILE])


@cache
def capture_key() -> str:
    """Changes when anything that decides what is captured does."""
    ours = [program("a2rt-render"), layer_library(), program("a2rt-core")]
    return hash_files([*ours, *driver.files()])


def log_file(name: str) -> Path:
    """A fresh log; one per call so that parallel runs do not mix."""
    LOGS.mkdir(parents=True, exist_ok=True)
    path = LOGS / f"{name}.log"
    path.write_text("", encoding="utf-8")
    return path


def call(
    command: Sequence[str | Path],
    *,
    what: str,
    log: Path,
    env: Mapping[str, str] | None = None,
    shown: console.Step | None = None,
    remedy: str = "",
) -> list[str]:
    """Runs one program; returns the lines it printed. Raises ProgramFailed."""
    lines: list[str] = []

    def follow(line: str) -> None:
        progress = progress_line(line)
        if progress is None:
            lines.append(line)
        elif shown is not None:
            shown.update(progress[0], progress[1])

    full = {**os.environ, **(env or {}), "A2RT_PROGRESS": "1"}
    run_logged([str(c) for c in command], log, what=what, remedy=remedy, env=full, on_line=follow)
    return lines
