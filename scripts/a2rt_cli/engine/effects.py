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
    options = scene.drawn_with(options)
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
    found = core.inspect(path)
    return {**found, "effects": [_derived(entry) for entry in found.get("effects", [])]}


def _derived(entry: dict[str, Any]) -> dict[str, Any]:
    """a2rt-core's entry in the common shape; what a program does not use is not captured."""
    used, reason = bool(entry["used"]), entry.get("reason", "")
    stages = entry.get("stages") or []
    return {
        "name": entry["effect"],
        "needed": used,
        "built": used,
        "called_for_by": [reason] if used and reason else [],
        "rays": f"{entry['rays']:,}" if entry.get("rays") else "",
        "stages": [stages] if isinstance(stages, str) else stages,
        "part": entry.get("parts", ""),
        "why": "" if used else reason,
    }


def lacking(found: dict[str, Any]) -> list[str]:
    """Effects that the scene calls for, a list left out, and the picture shows the lack of.

    Without instancing, copies are drawn: they look the same.
    """
    return [
        e["name"]
        for e in found["effects"]
        if e["needed"] and not e["built"] and e["name"] != "instancing"
    ]


def of_captured(captured: Captured) -> dict[str, Any]:
    if captured.scene is not None and captured.options is not None:
        return of_scene(captured.scene, captured.options)
    return of_workload(captured.file)
