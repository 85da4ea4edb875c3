"""Which effects a scene or a captured program calls for, as the engines report it.

One shape for both: {"effects": [{name, needed, built, called_for_by, rays, stages, part, why}]}.
"""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

from a2rt_cli.engine import core, programs, scenes
from a2rt_cli.engine.capture import Captured
from a2rt_cli.engine.renderer import RenderOptions
from a2rt_cli.errors import UserError


def of_scene(scene: scenes.Scene, options: RenderOptions) -> dict[str, Any]:
    """Decided from the scene and the workload alone; nothing is drawn."""
    command = [programs.program("a2rt-render"), scene.argument, *options.arguments()]
    lines = programs.call(
        [*command, "--list-effects"],
        what=f"analysing {scene.name}",
        log=programs.log_file(f"effects-{scene.name}-{os.getpid()}"),
        env=programs.lavapipe(),
    )
    text = "\n".join(lines)
    try:
        found = json.loads(text[text.index("{") : text.rindex("}") + 1])
    except ValueError as error:
        raise UserError(f"{scene.name}: a2rt-render printed no effect table ({error})") from error
    return {"effects": [_entry(name, entry) for name, entry in found.items()]}


def _entry(name: str, entry: dict[str, Any]) -> dict[str, Any]:
    return {"name": name, "why": entry.get("left_out_because", ""), **entry}


def of_workload(path: Path) -> dict[str, Any]:
    """Derived by the layer from a foreign program's pipelines."""
    return core.inspect(path)


def of_captured(captured: Captured) -> dict[str, Any]:
    if captured.scene is not None and captured.options is not None:
        return of_scene(captured.scene, captured.options)
    return of_workload(captured.file)
