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
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from a2rt_cli.engine.capture import Captured
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
            cache=self.cache,
        )

    def captured(self) -> list[Captured]:
        """The workload files of the runs."""
        from a2rt_cli import comparison

        return comparison.capture_all(self.experiment.items(), self.cache / "captures")

    @property
    def cache(self) -> Path:
        """Figures share captures and runs: most need the same ones."""
        return self.out.parent / ".cache"


@dataclass(frozen=True)
class Drawn:
    text: str  # for the terminal, kept as NAME.txt beside the files
    files: list[Path]


def names() -> list[str]:
    return sorted(info.name for info in pkgutil.iter_modules(__path__))


def reproduce(
    name: str,
    out: Path,
    *,
    scenes: Sequence[str] | None = None,
    size: tuple[int, int] | None = None,
    parallel: int = 2,
) -> Drawn:
    """Draws one figure into `out`; `scenes` and `size` go before the experiment's own."""
    from a2rt_cli import console, experiment
    from a2rt_cli.files import write_text

    module = importlib.import_module(f"{__name__}.{name}")
    console.heading(f"{name}: {module.TITLE}")
    loaded = experiment.load(experiment.find(name), scenes)
    loaded = replace(loaded, size=size or loaded.size)
    drawn = module.draw(Context(loaded, out, parallel))
    text = "\n\n".join([drawn.text, *_notes(out)])
    target = out / f"{name}.txt"
    write_text(target, f"{name}: {module.TITLE}\n\n{text}\n")
    return Drawn(text, [*drawn.files, target])


def _notes(out: Path) -> list[str]:
    """Scenes that are partial or stood in for; a reader of the figure must know."""
    from a2rt_cli import results

    if not (out / "results.json").is_file():
        return []
    notes = [results.get(one, "workload.note") for one in results.load(out)]
    known = [note for note in dict.fromkeys(notes) if note]
    return ["Scenes:\n" + "\n".join(f"- {note}" for note in known)] if known else []
