"""A scene as a workload file: drawn and captured once, then found again by its content."""

from __future__ import annotations

import shutil
from dataclasses import dataclass
from pathlib import Path

from a2rt_cli import console
from a2rt_cli.engine import core, keys, programs, renderer, scenes
from a2rt_cli.engine.renderer import RenderOptions
from a2rt_cli.files import HashCache, hash_values, read_json, write_json

_HASHES = HashCache()


@dataclass(frozen=True)
class Captured:
    """A workload file, and, if our program drew it, what is needed to draw it again."""

    name: str
    file: Path
    key: str  # content hash
    scene: scenes.Scene | None = None
    options: RenderOptions | None = None
    picture: Path | None = None  # the driver's


def from_file(path: Path) -> Captured:
    """An existing workload file; a2rt-core refuses it if it is truncated or foreign."""
    core.inspect(path)
    return Captured(path.stem, path, _HASHES.of(path))


def find_finished(
    scene: scenes.Scene, options: RenderOptions, cache: Path, *, name: str = ""
) -> Captured | None:
    """The capture of the same inputs, if `cache` holds it whole."""
    options = scene.drawn_with(options)
    key = _key(scene, options)
    found = _captured(scene, options, cache, key, name)
    return found if _mark(found).is_file() else None


def key_of(scene: scenes.Scene, options: RenderOptions) -> str:
    """Hash of all that decides the capture of a scene; known before it is drawn."""
    return _key(scene, scene.drawn_with(options))


def _key(scene: scenes.Scene, options: RenderOptions) -> str:
    settings = keys.of_workload(options.workload)
    return hash_values(scene.content_key(), options.as_dict(), settings, programs.capture_key())


def _captured(
    scene: scenes.Scene, options: RenderOptions, cache: Path, key: str, name: str
) -> Captured:
    folder = cache / f"{scene.name}-{key[:16]}"
    workload, picture = folder / "workload.h5", folder / "driver.png"
    return Captured(name or scene.name, workload, key, scene, options, picture)


def _mark(captured: Captured) -> Path:
    """Written last: a folder without it is not trusted."""
    return captured.file.parent / "capture.json"


def from_scene(
    scene: scenes.Scene,
    options: RenderOptions,
    cache: Path,
    *,
    name: str = "",
    shown: console.Step | None = None,
) -> Captured:
    """Draws `scene` under the layer unless `cache` holds the result of the same inputs."""
    known = find_finished(scene, options, cache, name=name)
    if known is not None:
        return known
    options = scene.drawn_with(options)
    captured = _captured(scene, options, cache, _key(scene, options), name)
    folder = captured.file.parent
    shutil.rmtree(folder, ignore_errors=True)  # left by a killed run
    with renderer.scratch(cache) as scratch:
        raw, picture, workload = scratch / "raw", scratch / "driver.png", scratch / "w.h5"
        raw.mkdir()
        numbers = scratch / "statistics.json"
        extra = ["--json", str(numbers)]
        renderer.render(scene, options, picture, capture=raw, shown=shown, extra=extra)
        # "auto" is a choice of the program; results name what it chose.
        chosen = read_json(numbers)["workload"]["name"]
        core.import_capture(raw, workload, scene=scene.name, workload=chosen, shown=shown)
        folder.mkdir(parents=True, exist_ok=True)
        picture.replace(folder / "driver.png")
        workload.replace(folder / "workload.h5")
    write_json(_mark(captured), {"scene": scene.name, "options": options.as_dict()})
    return captured
