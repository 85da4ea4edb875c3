"""What a user may name as a scene: an embedded one, a glTF file, or a real scene by its stem."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

from a2rt_cli.errors import UserError
from a2rt_cli.files import hash_file, hash_values
from a2rt_cli.paths import SHARED_SCENES

EMBEDDED = ("cornell", "spheres", "forest", "torture")
_SUFFIXES = (".glb", ".gltf")


@dataclass(frozen=True)
class Scene:
    name: str
    argument: str  # what a2rt-render is given
    path: Path | None  # None: embedded

    def content_key(self) -> str:
        """Hash of everything the scene is made of, buffers and images beside it included."""
        if self.path is None:
            return hash_values("embedded", self.name)
        return hash_values([hash_file(path) for path in (self.path, *_companions(self.path))])


def _companions(path: Path) -> list[Path]:
    """Files a .gltf refers to; a .glb carries its own."""
    if path.suffix != ".gltf":
        return []
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
        parts = [*document.get("buffers", []), *document.get("images", [])]
        uris = [part.get("uri", "") for part in parts]
    except (ValueError, AttributeError):
        return []  # a2rt-render reports what is wrong with the file
    files = [path.parent / uri for uri in uris if uri and not uri.startswith("data:")]
    return [file for file in files if file.is_file()]


def is_workload_file(text: str) -> bool:
    return text.endswith((".h5", ".hdf5"))


def find(text: str) -> Scene:
    if text in EMBEDDED:
        return Scene(text, text, None)
    path = Path(text)
    if path.suffix in _SUFFIXES:
        if not path.is_file():
            raise UserError(f"{text}: no such file", _choices())
        return Scene(path.stem, str(path.resolve()), path.resolve())
    for suffix in _SUFFIXES:
        shared = SHARED_SCENES / f"{text}{suffix}"
        if shared.is_file():
            return Scene(text, str(shared.resolve()), shared.resolve())
    raise UserError(f"{text}: not a scene", _choices())


def _choices() -> str:
    real = sorted(path.stem for path in SHARED_SCENES.glob("*.glb"))
    names = ", ".join([*EMBEDDED, *real])
    return f"name a .glb or .gltf file, or one of: {names}"
