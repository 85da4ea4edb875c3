"""Calls of a2rt-core about the arithmetic alone: hard cases, strata, the multiplier."""

from __future__ import annotations

import csv
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from a2rt_cli import console
from a2rt_cli.engine import programs
from a2rt_cli.engine.core import read_result
from a2rt_cli.files import replacing


def hard_cases(
    scenes: Sequence[Path], target: Path, shown: console.Step | None = None
) -> dict[str, Any]:
    """The matrix of hard cases against units, leaks of closed surfaces, views of the failures.

    `scenes`: workload files whose edges and vertices are aimed at as well.
    """
    words: list[str | Path] = ["hard-cases"]
    for scene in scenes:
        words += ["--scene", scene]
    with replacing(target) as temporary:
        _call([*words, "-o", temporary], "judging the units on hard cases", shown)
    return read_result(target)


def strata(tests: int, target: Path, shown: console.Step | None = None) -> dict[str, Any]:
    """Every design's box test against exact arithmetic, at least `tests` of each, by stratum."""
    with replacing(target) as temporary:
        words = ["strata", "--tests", str(tests), "-o", temporary]
        _call(words, "testing boxes against exact arithmetic", shown)
    return read_result(target)


def multiplier(mode: str, shown: console.Step | None = None) -> list[dict[str, str]]:
    """Errors of the approximate multiplier for k = 0..8 and both directions, exhausted."""
    words = ["multiplier-table", "--csv", "--mode", mode]
    return list(csv.DictReader(_call(words, "exhausting the multiplier", shown)))


def _call(words: Sequence[str | Path], what: str, shown: console.Step | None) -> list[str]:
    log = programs.log_file(f"core-{words[0]}-{os.getpid()}")
    lines = programs.call([programs.program("a2rt-core"), *words], what=what, log=log, shown=shown)
    log.unlink(missing_ok=True)  # kept only when the call failed
    return lines
