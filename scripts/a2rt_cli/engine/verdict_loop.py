"""What a unit would draw: its verdicts are injected and the program re-run until none changes.

A unit that loses a hit changes the shaders' control flow, so that later rays change too. One pass
injects the verdicts known so far, captures again and traces again; when a pass asks for the same
verdicts as the one before, the picture is the unit's own, secondary rays included.
"""

from __future__ import annotations

import filecmp
import shutil
from dataclasses import dataclass
from pathlib import Path

from a2rt_cli import console
from a2rt_cli.engine import core, renderer
from a2rt_cli.engine.capture import Captured
from a2rt_cli.errors import UserError
from a2rt_cli.files import replacing

DEFAULT_PASSES = 12


@dataclass(frozen=True)
class Outcome:
    passes: int  # runs of the program, the first capture included
    converged: bool
    overridden_rays: int


@dataclass(frozen=True)
class Verdicts:
    """What one trace asks to change: the verdict file and how many rays it overrides."""

    file: Path
    entries: int


def of_trace(result: dict, file: Path) -> Verdicts:
    return Verdicts(file, int(result.get("verdicts", {}).get("entries", 0)))


def draw(
    captured: Captured,
    unit: str,
    target: Path,
    *,
    first: Verdicts | None = None,
    overrides: tuple[str, ...] = (),
    max_passes: int = DEFAULT_PASSES,
    shown: console.Step | None = None,
) -> Outcome:
    """Writes the picture that `unit` would draw of a captured scene into `target`.

    `first` are the verdicts on the capture itself, if a trace has them already.
    """
    if captured.scene is None or captured.options is None or captured.picture is None:
        raise UserError(
            "a picture needs the program that made the capture",
            "name a scene instead of a workload file",
        )
    with renderer.scratch(target.parent) as scratch:

        def trace(workload: Path, before: Path | None, passes: int) -> Verdicts:
            file = scratch / f"{passes}.a2rv"
            result = core.trace(
                workload,
                unit,
                scratch / "trace.json",
                overrides=overrides,
                audit=0,
                verdicts=file,
                previous=before,
                shown=shown,
            )
            return of_trace(result, file)

        picture = captured.picture
        current = first or trace(captured.file, None, 0)
        passes, converged = 1, current.entries == 0
        while not converged and passes < max_passes:
            previous = current
            if shown is not None:
                shown.update(None, f"{unit}: pass {passes + 1}, {previous.entries} rays overridden")
            picture = scratch / "picture.png"
            workload = _run_again(captured, previous.file, picture, scratch)
            current = trace(workload, previous.file, passes)
            passes += 1
            converged = filecmp.cmp(current.file, previous.file, shallow=False)
        with replacing(target) as temporary:
            shutil.copyfile(picture, temporary)
    return Outcome(passes, converged, current.entries)


def _run_again(captured: Captured, verdicts: Path, picture: Path, scratch: Path) -> Path:
    """Draws and captures the scene under `verdicts`; returns the workload file."""
    assert captured.scene is not None and captured.options is not None
    raw, workload = scratch / "raw", scratch / "pass.h5"
    shutil.rmtree(raw, ignore_errors=True)
    raw.mkdir()
    renderer.render(captured.scene, captured.options, picture, capture=raw, verdicts=verdicts)
    core.import_capture(
        raw, workload, scene=captured.scene.name, workload=captured.options.workload
    )
    return workload
