"""Which effects a scene or a captured program calls for, as the engines report it.

One shape for both: {"effects": [{name, needed, built, called_for_by, rays, stages, part, why}]}.
"""

from __future__ import annotations

import json
import os
import tempfile
from pathlib import Path
from typing import Any

from a2rt_cli.engine import core, programs, scenes
from a2rt_cli.engine.capture import Captured
from a2rt_cli.engine.renderer import RenderOptions
from a2rt_cli.errors import UserError


def of_scene(scene: scenes.Scene, options: RenderOptions) -> dict[str, Any]:
    """Decided from the scene and the workload alone; nothing is drawn."""
    with tempfile.TemporaryDirectory(prefix="a2rt-") as scratch:
        target = Path(scratch) / "effects.json"
        command = [programs.program("a2rt-render"), scene.argument, *options.arguments()]
        programs.call(
            [*command, "--effects-json", target],
            what=f"analysing {scene.name}",
            log=programs.log_file(f"effects-{scene.name}-{os.getpid()}"),
            env=programs.lavapipe(),
        )
        try:
            return json.loads(target.read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            raise UserError(f"{scene.name}: no effect table was written ({error})") from error


def of_workload(path: Path) -> dict[str, Any]:
    """Derived by the layer from a foreign program's pipelines."""
    return core.inspect(path)


def of_captured(captured: Captured) -> dict[str, Any]:
    if captured.scene is not None and captured.options is not None:
        return of_scene(captured.scene, captured.options)
    return of_workload(captured.file)
