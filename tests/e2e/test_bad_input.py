"""Bad input: a clear message, a failing status, nothing half-written."""

from __future__ import annotations

import json

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
    assert "foreign.h5" in message


def test_a_malformed_scene_is_refused_by_name(a2rt):
    (a2rt.folder / "bad.gltf").write_text("{ this is not glTF", encoding="utf-8")
    message = a2rt.refused("render", "bad.gltf", *SMALL, "-o", "x.png")
    assert "bad.gltf" in message


def test_an_empty_scene_is_refused(a2rt):
    text = json.dumps({"asset": {"version": "2.0"}, "scenes": [{"nodes": []}], "scene": 0})
    (a2rt.folder / "empty.gltf").write_text(text, encoding="utf-8")
    a2rt.refused("render", "empty.gltf", *SMALL, "-o", "x.png")


def test_a_program_that_is_not_vulkan_leaves_no_workload_file(a2rt):
    message = a2rt.refused("capture", "w.h5", "--", "/bin/true")
    assert "without a ray-tracing capture" in message


def test_a_program_that_crashes_leaves_no_workload_file(a2rt):
    message = a2rt.refused("capture", "w.h5", "--", "/bin/sh", "-c", "kill -SEGV $$")
    assert "SIGSEGV" in message and "without the layer" in message


def test_a_program_that_does_not_exist_is_refused(a2rt):
    message = a2rt.refused("capture", "w.h5", "--", "no-such-program")
    assert "no-such-program" in message


def test_an_unknown_parameter_is_refused(a2rt):
    a2rt.ok("render", "cornell", *SMALL, "--capture", "w.h5", "-o", "x.png")
    words = ("compare", "w.h5", "--units", "a2rt", "--set", "precision.box_bots=6", "-o", "out")
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


@pytest.mark.parametrize("size", ["0x4", "12", "axb", "4x-1"])
def test_an_impossible_size_is_refused(a2rt, size):
    a2rt.refused("render", "cornell", f"--size={size}", "-o", "x.png")
