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


def _entries(result: dict) -> int:
    return int(result.get("verdicts", {}).get("entries", 0))


def draw(
    captured: Captured,
    unit: str,
    target: Path,
    *,
    overrides: tuple[str, ...] = (),
    max_passes: int = DEFAULT_PASSES,
    shown: console.Step | None = None,
) -> Outcome:
    """Writes the picture that `unit` would draw of a captured scene into `target`."""
    if captured.scene is None or captured.options is None or captured.picture is None:
        raise UserError(
            "a picture needs the program that made the capture",
            "name a scene instead of a workload file",
        )
    with renderer.scratch(target.parent) as scratch:
        verdicts, previous = scratch / "new.a2rv", scratch / "old.a2rv"
        trace_to = scratch / "trace.json"

        def trace(workload: Path, before: Path | None) -> int:
            result = core.trace(
                workload,
                unit,
                trace_to,
                overrides=overrides,
                verdicts=verdicts,
                previous=before,
                shown=shown,
            )
            return _entries(result)

        picture = captured.picture
        overridden = trace(captured.file, None)
        passes, converged = 1, overridden == 0
        while not converged and passes < max_passes:
            verdicts.replace(previous)
            if shown is not None:
                shown.update(None, f"{unit}: pass {passes + 1}, {overridden} rays overridden")
            raw, workload = scratch / "raw", scratch / "pass.h5"
            shutil.rmtree(raw, ignore_errors=True)
            raw.mkdir()
            picture = scratch / "picture.png"
            renderer.render(
                captured.scene, captured.options, picture, capture=raw, verdicts=previous
            )
            core.import_capture(
                raw,
                workload,
                scene=captured.scene.name,
                workload=captured.options.workload,
            )
            overridden = trace(workload, previous)
            passes += 1
            converged = filecmp.cmp(verdicts, previous, shallow=False)
        with replacing(target) as temporary:
            shutil.copyfile(picture, temporary)
    return Outcome(passes, converged, overridden)
