"""Small glTF files that a test writes and edits."""

from __future__ import annotations

import base64
import json
import struct
from pathlib import Path
from typing import Any

# x, y, z of the four corners of a quad in the plane z = 0 and its two triangles.
_CORNERS = ((-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0))
_TRIANGLES = (0, 1, 2, 0, 2, 3)


def _paint(name: str, color: tuple[float, float, float, float]) -> dict[str, Any]:
    return {
        "name": name,
        "doubleSided": True,
        "pbrMetallicRoughness": {
            "baseColorFactor": list(color),
            "metallicFactor": 0,
            "roughnessFactor": 1,
        },
    }


def three_plates() -> dict[str, Any]:
    """Under a sky: a large wall, a pane before its left half, a masked leaf before its right."""
    data = struct.pack("<12f6H", *[value for corner in _CORNERS for value in corner], *_TRIANGLES)
    primitive = {"attributes": {"POSITION": 0}, "indices": 1}
    leaf = _paint("leaf", (0.2, 0.8, 0.2, 0.25))
    leaf["alphaMode"] = "MASK"
    return {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0, 1, 2, 3]}],
        "nodes": [
            {"mesh": 0, "scale": [3, 3, 1], "translation": [0, 0, -1]},
            {"mesh": 1, "scale": [0.6, 0.6, 1], "translation": [-0.8, 0, 0.1]},
            {"mesh": 2, "scale": [0.6, 0.6, 1], "translation": [0.8, 0, 0.2]},
            {"camera": 0, "translation": [0, 0, 5]},
        ],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.6, "znear": 0.1}}],
        "meshes": [{"primitives": [{**primitive, "material": i}]} for i in range(3)],
        "materials": [
            _paint("wall", (0.7, 0.7, 0.7, 1)),
            _paint("pane", (0.9, 0.3, 0.3, 1)),
            leaf,
        ],
        "accessors": [
            {
                "bufferView": 0,
                "componentType": 5126,
                "count": 4,
                "type": "VEC3",
                "min": [-1, -1, 0],
                "max": [1, 1, 0],
            },
            {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": 48},
            {"buffer": 0, "byteOffset": 48, "byteLength": 12},
        ],
        "buffers": [
            {
                "byteLength": len(data),
                "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode(),
            }
        ],
    }


def put(document: dict[str, Any], form: str, at: int, value: float) -> None:
    """Overwrites one value of the data: `form` as in struct, at byte `at`."""
    prefix, _, text = document["buffers"][0]["uri"].partition(",")
    data = bytearray(base64.b64decode(text))
    struct.pack_into(form, data, at, value)
    document["buffers"][0]["uri"] = f"{prefix},{base64.b64encode(data).decode()}"


def material(document: dict[str, Any], name: str) -> dict[str, Any]:
    return next(one for one in document["materials"] if one["name"] == name)


def turn_to_glass(document: dict[str, Any], name: str) -> None:
    one = material(document, name)
    one["pbrMetallicRoughness"]["roughnessFactor"] = 0
    one["extensions"] = {
        "KHR_materials_transmission": {"transmissionFactor": 1},
        "KHR_materials_volume": {"thicknessFactor": 1},
    }
    document["extensionsUsed"] = ["KHR_materials_transmission", "KHR_materials_volume"]


def write(document: dict[str, Any], path: Path) -> Path:
    path.write_text(json.dumps(document), encoding="utf-8")
    return path
