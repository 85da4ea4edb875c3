"""Drawing: pictures from the driver and from units, captures beside them, effects in a table."""

from __future__ import annotations

import json

import pytest
from conftest import SMALL

pictures = pytest.importorskip("a2rt_cli.engine.pictures")


def test_render_draws_a_picture_of_the_size_asked_for(a2rt):
    a2rt.ok("render", "cornell", "--size", "40x24", "--spp", "1", "-o", "x.png")
    assert pictures.load(a2rt.folder / "x.png").shape == (24, 40, 3)


def test_the_picture_under_the_layer_is_the_one_without_it(a2rt):
    a2rt.ok("render", "cornell", *SMALL, "-o", "plain.png")
    a2rt.ok("render", "cornell", *SMALL, "--capture", "w.h5", "-o", "captured.png")
    difference = pictures.compare(a2rt.folder / "plain.png", a2rt.folder / "captured.png")
    assert difference.changed_pixels == 0


def test_a_conservative_unit_draws_the_drivers_picture(a2rt):
    a2rt.ok("render", "cornell", *SMALL, "-o", "driver.png")
    a2rt.ok("render", "cornell", *SMALL, "--unit", "a2rt", "-o", "unit.png")
    difference = pictures.compare(a2rt.folder / "driver.png", a2rt.folder / "unit.png")
    assert difference.changed_pixels == 0
    said = json.loads((a2rt.folder / "unit.json").read_text(encoding="utf-8"))
    assert said["converged"] is True


def test_capture_of_a_scene_can_be_inspected_and_compared(a2rt):
    a2rt.ok("render", "cornell", *SMALL, "--capture", "w.h5", "-o", "x.png")
    said = json.loads(a2rt.ok("inspect", "w.h5", "--json"))
    assert said
    a2rt.ok("compare", "w.h5", "--units", "baseline,a2rt", "--gpu", "none", "-o", "out")
    found = json.loads((a2rt.folder / "out" / "results.json").read_text(encoding="utf-8"))
    assert [one["unit"]["name"] for one in found] == ["baseline", "a2rt"]


def test_inspect_says_what_calls_for_an_effect_and_what_was_left_out(a2rt):
    table = json.loads(a2rt.ok("inspect", "cornell", "--json"))
    effects = {effect["name"]: effect for effect in table["effects"]}
    assert effects["refraction"]["needed"] and effects["refraction"]["called_for_by"]
    assert not effects["alpha"]["built"] and effects["alpha"]["why"]


def test_a_real_scene_can_be_drawn(a2rt, real_scene):
    a2rt.ok("render", real_scene, *SMALL, "-o", "ship.png")
    assert pictures.load(a2rt.folder / "ship.png").std() > 1
