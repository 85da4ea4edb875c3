"""Bad input: a clear message, a failing status, nothing half-written."""

from __future__ import annotations

import json
import math

import gltf_scene
import pytest
from conftest import SMALL


def test_an_unknown_scene_is_refused_with_the_known_ones(a2rt):
    message = a2rt.refused("compare", "no-such-scene", *SMALL)
    assert "no-such-scene" in message and "cornell" in message


def test_an_unknown_unit_is_refused_with_the_known_ones(a2rt):
    a2rt.ok("render", "cornell", *SMALL, "--capture", "w.h5", "-o", "x.png")
    message = a2rt.refused("compare", "w.h5", "--units", "no-such-unit", "-o", "out")
    assert "no-such-unit" in message and "baseline" in message


@pytest.mark.parametrize("keep", [0, 7, 200, 5000])
def test_a_truncated_workload_file_is_refused(a2rt, keep):
    a2rt.ok("render", "cornell", *SMALL, "--capture", "w.h5", "-o", "x.png")
    whole = (a2rt.folder / "w.h5").read_bytes()
    (a2rt.folder / "cut.h5").write_bytes(whole[:keep])
    message = a2rt.refused("compare", "cut.h5", "-o", "out")
    assert "cut.h5" in message


def test_a_foreign_hdf5_file_is_refused(a2rt):
    import h5py

    with h5py.File(a2rt.folder / "foreign.h5", "w") as file:
        file["x"] = [1, 2, 3]
    message = a2rt.refused("inspect", "foreign.h5")
    assert "foreign.h5: an HDF5 file, but not an a2rt workload" in message
    assert "make one with `a2rt capture`" in message


def test_a_workload_file_that_is_absent_or_no_hdf5_is_refused(a2rt):
    (a2rt.folder / "text.h5").write_text("hello", encoding="utf-8")
    assert "capture it again" in a2rt.refused("inspect", "text.h5")
    assert "check its name" in a2rt.refused("compare", "absent.h5", "-o", "out")


def test_a_malformed_scene_is_refused_by_name(a2rt):
    (a2rt.folder / "bad.gltf").write_text("{ this is not glTF", encoding="utf-8")
    message = a2rt.refused("render", "bad.gltf", *SMALL, "-o", "x.png")
    assert "bad.gltf" in message


def test_an_empty_scene_is_refused(a2rt):
    text = json.dumps({"asset": {"version": "2.0"}, "scenes": [{"nodes": []}], "scene": 0})
    (a2rt.folder / "empty.gltf").write_text(text, encoding="utf-8")
    message = a2rt.refused("render", "empty.gltf", *SMALL, "-o", "x.png")
    assert "nothing to draw" in message


def _vertex_is_nan(scene: dict) -> None:
    gltf_scene.put(scene, "<f", 4 * 4, math.nan)


def _vertex_is_infinite(scene: dict) -> None:
    gltf_scene.put(scene, "<f", 4 * 5, math.inf)


def _index_is_too_large(scene: dict) -> None:
    gltf_scene.put(scene, "<H", 48 + 2 * 3, 77)


def _buffer_is_missing(scene: dict) -> None:
    scene["buffers"][0]["uri"] = "absent.bin"


def _camera_has_no_area(scene: dict) -> None:
    scene["cameras"][0]["perspective"]["yfov"] = 0


def _triangles_have_no_area(scene: dict) -> None:
    for node in scene["nodes"][:3]:
        node["scale"] = [0, 0, 0]


@pytest.mark.parametrize(
    ("damage", "said", "remedy"),
    [
        (
            _vertex_is_nan,
            "mesh '0', primitive 0: vertex 1 is not finite",
            "repair the file",
        ),
        (
            _vertex_is_infinite,
            "mesh '0', primitive 0: vertex 1 is not finite",
            "repair the file",
        ),
        (_index_is_too_large, "index 77 is outside its 4 vertices", "repair the file"),
        (
            _buffer_is_missing,
            "absent.bin",
            "put the files that its buffers name beside it",
        ),
        (_camera_has_no_area, "camera '3': it sees no area", "repair the file"),
        (_triangles_have_no_area, "has an area", "repair the file"),
    ],
)
def test_a_damaged_scene_is_refused_with_file_place_and_remedy(a2rt, damage, said, remedy):
    scene = gltf_scene.three_plates()
    damage(scene)
    gltf_scene.write(scene, a2rt.folder / "bad.gltf")
    words = ("render", "bad.gltf", *SMALL, "--capture", "w.h5", "-o", "x.png")
    message = a2rt.refused(*words)
    assert "bad.gltf: " in message and said in message and remedy in message


def test_a_program_that_is_not_vulkan_leaves_no_workload_file(a2rt):
    message = a2rt.refused("capture", "w.h5", "--", "/bin/true")
    assert "without a ray-tracing capture" in message


def test_a_program_that_crashes_leaves_no_workload_file(a2rt):
    message = a2rt.refused("capture", "w.h5", "--", "/bin/sh", "-c", "kill -SEGV $$")
    assert "SIGSEGV" in message and "without the layer" in message


def test_a_program_that_does_not_exist_is_refused(a2rt):
    message = a2rt.refused("capture", "w.h5", "--", "no-such-program")
    assert "no-such-program" in message
    (a2rt.folder / "text").write_text("hello", encoding="utf-8")
    assert "no executable one" in a2rt.refused("capture", "w.h5", "--", "./text")


def test_an_unknown_parameter_is_refused(a2rt):
    a2rt.ok("render", "cornell", *SMALL, "--capture", "w.h5", "-o", "x.png")
    words = (
        "compare",
        "w.h5",
        "--units",
        "a2rt",
        "--set",
        "precision.box_bots=6",
        "-o",
        "out",
    )
    message = a2rt.refused(*words)
    assert "box_bots" in message


def test_an_unknown_key_of_a_unit_is_refused_with_its_place(a2rt):
    a2rt.ok("render", "cornell", *SMALL, "--capture", "w.h5", "-o", "x.png")
    text = "[precision]\nbox_bits = 8\n  sparkle = true\n"
    (a2rt.folder / "a2rt.toml").write_text(text, encoding="utf-8")
    message = a2rt.refused("compare", "w.h5", "--units", "a2rt.toml", "-o", "out")
    assert "a2rt.toml:3:3" in message


def test_a_report_of_a_folder_without_results_is_refused(a2rt):
    (a2rt.folder / "empty").mkdir()
    assert "results.json" in a2rt.refused("report", "empty")
    (a2rt.folder / "six.json").write_text("{}", encoding="utf-8")
    assert "name a folder" in a2rt.refused("report", "six.json")


@pytest.mark.parametrize("size", ["0x4", "12", "axb", "4x-1"])
def test_an_impossible_size_is_refused(a2rt, size):
    a2rt.refused("render", "cornell", f"--size={size}", "-o", "x.png")
