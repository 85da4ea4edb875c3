"""The paper's figures and tables, one module each; a new file here is a new figure.

A module NAME defines
  TITLE                                    what the paper shows
  draw(context: Context) -> Drawn          runs, draws and tells
and has its scenes, workloads and units in lumibench_configs/experiments/NAME.toml.
"""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from a2rt_cli.experiment import Experiment
    from a2rt_cli.results import Result


@dataclass(frozen=True)
class Context:
    """What a figure may use: its experiment, its folder, and the runs (made when asked for)."""

    experiment: Experiment
    out: Path
    parallel: int

    def runs(self) -> list[Result]:
        from a2rt_cli import comparison, options

        return comparison.compare(
            self.experiment.items(),
            self.experiment.specs(),
            self.out,
            parallel=self.parallel,
            command=options.command_line(),
        )


@dataclass(frozen=True)
class Drawn:
    text: str  # for the terminal
    files: list[Path]


def names() -> list[str]:
    return sorted(info.name for info in pkgutil.iter_modules(__path__))


def reproduce(name: str, out: Path, scenes: Sequence[str] | None, parallel: int) -> Drawn:
    from a2rt_cli import console, experiment

    module = importlib.import_module(f"{__name__}.{name}")
    console.heading(f"{name}: {module.TITLE}")
    loaded = experiment.load(experiment.find(name), scenes)
    return module.draw(Context(loaded, out, parallel))
