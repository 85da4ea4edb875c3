"""Configurations that name what there is not: said with the place, before anything is drawn."""

from __future__ import annotations

import shutil

import pytest
from a2rt_cli.paths import CONFIGS
from conftest import SMALL

COMPARE = ("compare", "cornell", *SMALL, "-o", "out")
KNOWN_UNITS = "a2rt, a2rt-literal, aqb8, baseline"


def test_a_unit_file_that_names_an_unknown_unit_is_refused(a2rt):
    (a2rt.folder / "my.toml").write_text('\n unit = "nonsense"\n', encoding="utf-8")
    message = a2rt.refused(*COMPARE, "--units", "baseline,my.toml")
    assert 'my.toml:2:2: unit is "nonsense", must be one of ' + KNOWN_UNITS in message
    assert "Drawing" not in message
    (a2rt.folder / "your.toml").write_text("[tree]\nmax_leaf = 2\n", encoding="utf-8")
    message = a2rt.refused(*COMPARE, "--units", "your.toml")
    assert "your.toml: no RT unit is called 'your'" in message and KNOWN_UNITS in message


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--units", "nonsense"), KNOWN_UNITS),
        (("--gpu", "toaster"), "mobile, table1"),
        (("--set", "precision.box_bots=6", "--units", "a2rt"), "did you mean 'box_bits'"),
        (("--set", "rt.wraps=6"), "did you mean 'warps'"),
    ],
)
def test_what_is_misspelt_on_the_command_line_is_refused_before_drawing(a2rt, words, said):
    message = a2rt.refused(*COMPARE, *words)
    assert said in message and "Drawing" not in message


def test_a_machine_of_a_file_is_refused_with_its_place(a2rt):
    (a2rt.folder / "g.toml").write_text('[rt]\n  context = "heap"\n', encoding="utf-8")
    message = a2rt.refused(*COMPARE, "--gpu", "g.toml")
    assert "g.toml:2:" in message and "stack, refetch" in message


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ('[stages]\nray_generation = "dance"\n', "no shader 'dance.rgen'; known: ao.rgen"),
        ('[stages]\nmisses = ["path", "dance"]\n', "no shader 'dance.rmiss'; known: path.rmiss"),
    ],
)
def test_a_workload_that_names_an_unknown_shader_is_refused_with_its_place(
    a2rt, monkeypatch, line, said
):
    folder = shutil.copytree(CONFIGS, a2rt.folder / "configs")
    monkeypatch.setenv("A2RT_CONFIGS", str(folder))
    text = f'effects = ["diffuse"]\n{line}'
    if "misses" in line:
        text += 'ray_generation = "pt"\n'
    (folder / "workloads" / "mine.toml").write_text(text, encoding="utf-8")
    message = a2rt.refused("render", "cornell", *SMALL, "--workload", "mine", "-o", "x.png")
    assert "mine.toml:3:" in message and said in message and "shaders/glsl" in message


def test_a_workload_that_names_an_unknown_effect_is_refused_with_its_place(a2rt, monkeypatch):
    folder = shutil.copytree(CONFIGS, a2rt.folder / "configs")
    monkeypatch.setenv("A2RT_CONFIGS", str(folder))
    text = 'effects = ["diffuse", "sparkle"]\n[stages]\nray_generation = "pt"\n'
    (folder / "workloads" / "mine.toml").write_text(text, encoding="utf-8")
    message = a2rt.refused("render", "cornell", *SMALL, "--workload", "mine", "-o", "x.png")
    assert "mine.toml:1:" in message and "no effect 'sparkle'" in message
    assert "soft-shadow" in message


def test_a_knob_of_a_parameter_that_there_is_not_is_refused_with_its_place(a2rt):
    text = 'title = "x"\nscenes = ["cornell"]\n[[knob]]\ntitle = "t"\nkey = "precision.box_bots"\n'
    text += "values = [6, 8]\ndefault = 8\n"
    (a2rt.folder / "e.toml").write_text(text, encoding="utf-8")
    message = a2rt.refused("sweep", "e.toml", "--dry-run", "-o", "out")
    assert "e.toml:5:1: " in message and "did you mean 'box_bits'" in message
