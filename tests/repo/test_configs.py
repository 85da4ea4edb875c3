"""Configuration files: all parse, every unit is tested, every figure has its experiment."""

from __future__ import annotations

import subprocess
import tomllib
from pathlib import Path

import pytest
from a2rt_cli import experiment, figures
from a2rt_cli.errors import UserError
from a2rt_cli.paths import CONFIGS, ROOT
from a2rt_cli.report import measures
from a2rt_cli.setup import build

ALL = sorted(CONFIGS.rglob("*.toml"))
EXPERIMENTS = sorted((CONFIGS / "experiments").glob("*.toml"))


@pytest.mark.parametrize("path", ALL, ids=lambda p: str(p.relative_to(CONFIGS)))
def test_every_configuration_is_toml(path: Path):
    tomllib.loads(path.read_text(encoding="utf-8"))


@pytest.mark.parametrize("path", EXPERIMENTS, ids=lambda p: p.stem)
def test_every_experiment_loads_and_names_known_units(path: Path):
    loaded = experiment.load(path)
    known = {p.stem for p in (CONFIGS / "units").glob("*.toml")}
    named = set(loaded.units) | {knob.unit for knob in loaded.knobs}
    assert named <= known


def test_every_figure_has_its_experiment():
    assert set(figures.names()) <= {path.stem for path in EXPERIMENTS}


def test_every_registered_unit_is_held_to_its_promise():
    """tests/unit/rt takes the units from their registry, so that a new one needs no edit there."""
    text = (ROOT / "tests/unit/rt/units_test.cpp").read_text(encoding="utf-8")
    assert "AnyUnit, testing::ValuesIn(unit_registry().names())" in text


def test_every_unit_configuration_belongs_to_a_registered_unit():
    core = build.find_program("a2rt-core")
    if core is None:
        pytest.skip("a2rt-core is not built")
    for path in (CONFIGS / "units").glob("*.toml"):
        reply = subprocess.run([core, "units", path], capture_output=True, text=True, check=False)
        assert reply.returncode == 0, reply.stderr


def test_the_default_of_every_knob_is_what_the_unit_uses():
    """A price list counts its steps from the default: a stale one would price the wrong step."""
    core = build.find_program("a2rt-core")
    if core is None:
        pytest.skip("a2rt-core is not built")
    checked = 0
    for path in EXPERIMENTS:
        for knob in experiment.load(path).knobs:
            reply = subprocess.run([core, "units", knob.unit], capture_output=True, text=True)
            assert reply.returncode == 0, reply.stderr
            used = dict(line.split()[:2] for line in reply.stdout.splitlines())
            assert used[knob.key].strip('"') == str(knob.default), f"{path.name}: {knob.key}"
            assert knob.default in knob.values
            checked += 1
    assert checked > 0


def test_every_number_of_the_paper_has_a_known_measure_and_a_source():
    numbers = measures.paper_numbers()
    assert numbers
    for number in numbers:
        assert number.source
        assert not number.ours or number.ours in measures.MEASURES
        assert number.paper_text()


def test_a_misspelt_key_of_an_experiment_is_refused_with_its_place(tmp_path):
    path = tmp_path / "bad.toml"
    path.write_text('title = "x"\nscenes = ["cornell"]\nsizes = [3, 4]\n', encoding="utf-8")
    with pytest.raises(UserError, match=r"bad\.toml:3:1: unknown key sizes"):
        experiment.load(path)


def test_a_misspelt_key_of_a_knob_is_refused_with_its_place(tmp_path):
    path = tmp_path / "bad.toml"
    knob = '[[knob]]\ntitle = "t"\nkey = "k"\nvalues = [1]\ndefault = 1\n  unti = "a2rt"\n'
    path.write_text(f'title = "x"\nscenes = ["cornell"]\n{knob}', encoding="utf-8")
    with pytest.raises(UserError, match=r"bad\.toml:8:3: unknown key knob.unti"):
        experiment.load(path)
