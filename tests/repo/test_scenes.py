"""Scenes by name: real ones where their files are, embedded stand-ins where they are not."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest
from a2rt_cli import comparison
from a2rt_cli.engine import lumibench, scenes
from a2rt_cli.engine.renderer import RenderOptions
from a2rt_cli.errors import UserError
from a2rt_cli.paths import CONFIGS

EFFECT_SOURCE = Path(CONFIGS.parent / "shaders/effects/effect.cpp").read_text(encoding="utf-8")


@pytest.fixture
def no_real_scenes(monkeypatch, tmp_path):
    monkeypatch.setattr(scenes, "SHARED_SCENES", tmp_path)
    return tmp_path


def test_every_scene_configuration_loads_and_credits_its_source():
    assert {"cornell", "spheres", "forest", "torture"} <= set(scenes.embedded())
    assert all(config.credit and config.features for config in scenes.configs().values())


def test_every_feature_of_a_scene_is_an_effect_of_the_workload_program():
    for config in scenes.configs().values():
        for feature in config.features:
            assert f'"{feature}"' in EFFECT_SOURCE, f"{config.name}: {feature}"


def test_a_stand_in_has_the_features_of_the_scene_or_says_what_it_lacks(no_real_scenes):
    for config in scenes.configs().values():
        if config.embedded:
            continue
        scene = scenes.find(config.name)
        lacking = set(config.features) - set(scenes.configs()[config.stand_in].features)
        assert set(scene.features) == set(config.features) - lacking
        assert all(feature in scene.note.split("lacks")[-1] for feature in lacking)
        # Sky over a closed room is the one feature that no embedded scene shares.
        assert lacking <= {"sky"}, config.name


def test_without_its_file_a_scene_is_stood_in_for_under_another_name(no_real_scenes):
    scene = scenes.find("ship")
    assert scene.path is None and scene.argument == "forest"
    assert scene.name == "forest-for-ship"
    assert "not on this machine" in scene.note
    assert scene.drawn_with(RenderOptions("pt")).effects == "diffuse,sky"
    assert scene.drawn_with(RenderOptions("ao")).effects == "diffuse,sky,ao"


def test_with_its_file_a_scene_is_itself(no_real_scenes):
    (no_real_scenes / "ship.glb").write_bytes(b"not looked at")
    scene = scenes.find("ship")
    assert scene.name == "ship" and scene.path == (no_real_scenes / "ship.glb").resolve()
    assert scene.note == ""
    assert scene.drawn_with(RenderOptions("pt")).effects == "auto"


def test_a_partial_scene_is_called_partial(no_real_scenes):
    (no_real_scenes / "car.glb").write_bytes(b"not looked at")
    assert "partial" in scenes.find("car").note
    assert "partial" in scenes.find(str(no_real_scenes / "car.glb")).note


def test_effects_that_a_user_asks_for_go_before_the_stand_ins(no_real_scenes):
    asked = RenderOptions("pt", effects="diffuse")
    assert scenes.find("ship").drawn_with(asked).effects == "diffuse"


def test_lumibench_has_its_46_standard_runs():
    names = [run.name for run in lumibench.all_runs()]
    assert len(names) == len(set(names)) == 46
    by_workload = {w: sum(n.endswith(f"_{w}") for n in names) for w in ("pt", "sh", "ao", "anyhit")}
    assert by_workload == {"pt": 15, "sh": 15, "ao": 15, "anyhit": 1}


def test_lumibench_runs_have_its_sample_counts():
    def sampling(workload: str) -> dict:
        text = (CONFIGS / "workloads" / f"{workload}.toml").read_text(encoding="utf-8")
        return tomllib.loads(text)["sampling"]

    for run in lumibench.all_runs():
        assert sampling(run.workload)["samples"] == 2
        options = lumibench.options_of(run)
        assert (options.width, options.height, options.spp) == (128, 128, None)
    assert sampling("pt")["max_bounces"] == sampling("anyhit")["max_bounces"] == 16
    assert sampling("sh")["shadow_rays"] == 2
    assert sampling("ao")["ao_rays"] == 4


def test_a_pattern_names_several_lumibench_runs():
    assert [run.name for run in lumibench.find("lumi:ship_*")] == ["ship_pt", "ship_sh", "ship_ao"]
    assert len(lumibench.find("lumi:all")) == 46
    with pytest.raises(UserError, match="no such LumiBench run"):
        lumibench.find("lumi:ship_xx")


def test_a_lumibench_run_becomes_a_scene_with_its_workload(no_real_scenes):
    (item,) = comparison.items_of(["lumi:bath_sh"], RenderOptions())
    assert (item.text, item.options.workload) == ("bath", "sh")
    assert item.name == "cornell-for-bath_sh"
    with pytest.raises(UserError, match="names its workload"):
        comparison.items_of(["lumi:bath_sh"], RenderOptions("ao"))
