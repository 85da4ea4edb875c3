"""Cached results are found by all that decides them; an edit of any of it is a new result."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from a2rt_cli import energy_table
from a2rt_cli.engine import capture, keys, programs, runs, scenes
from a2rt_cli.engine.renderer import RenderOptions
from a2rt_cli.paths import CONFIGS
from a2rt_cli.setup import driver


@pytest.fixture
def configs(tmp_path, monkeypatch) -> Path:
    """A copy of the configurations that the programs are told to read."""
    folder = shutil.copytree(CONFIGS, tmp_path / "configs")
    monkeypatch.setenv("A2RT_CONFIGS", str(folder))
    monkeypatch.setattr(programs, "core_key", lambda: "core")
    monkeypatch.setattr(programs, "capture_key", lambda: "programs")
    return folder


def append(path: Path) -> None:
    path.write_text(path.read_text(encoding="utf-8") + "# edited\n", encoding="utf-8")


def run_key(unit: str = "aqb8") -> str:
    return runs.run_key(capture.Captured("w", Path("w.h5"), "rays"), runs.RunSpec(unit, "table1"))


@pytest.mark.parametrize("edited", ["units/aqb8.toml", "gpus/table1.toml", "units/a2rt.toml"])
def test_an_edit_of_what_a_run_reads_in_the_users_folder_is_a_new_run(configs, edited):
    before = run_key()
    append(configs / edited)
    assert run_key() != before


def test_an_edit_of_another_unit_is_not(configs):
    before = run_key()
    append(configs / "units" / "cwbvh.toml")
    assert run_key() == before


@pytest.mark.parametrize(("workload", "edited"), [("pt", "pt"), ("auto", "ao")])
def test_an_edit_of_a_workloads_settings_is_a_new_capture(configs, tmp_path, workload, edited):
    def place() -> Path:
        options = RenderOptions(workload)
        key = capture._key(scenes.find("cornell"), options)
        return capture._captured(scenes.find("cornell"), options, tmp_path, key, "").file

    before = place()
    append(configs / "workloads" / f"{edited}.toml")
    assert place() != before


def test_a_named_workload_does_not_depend_on_the_others(configs):
    before = keys.of_workload("pt")
    append(configs / "workloads" / "ao.toml")
    assert keys.of_workload("pt") == before


@pytest.fixture
def programs_of(tmp_path, monkeypatch):
    """Programs, energy table and driver that are files of the test's own."""
    for name in ("program", "table.csv", "lvp_icd.json", "lvp.so"):
        (tmp_path / name).write_text('{"ICD": {"library_path": "./lvp.so"}}', encoding="utf-8")
    monkeypatch.setattr(programs, "program", lambda name: tmp_path / "program")
    monkeypatch.setattr(programs, "layer_library", lambda: tmp_path / "program")
    monkeypatch.setattr(energy_table, "FILE", tmp_path / "table.csv")
    monkeypatch.setattr(driver, "icd_file", lambda: tmp_path / "lvp_icd.json")
    for key in (programs.core_key, programs.capture_key):
        key.cache_clear()
    yield tmp_path
    for key in (programs.core_key, programs.capture_key):
        key.cache_clear()


@pytest.mark.parametrize(
    ("key", "edited"),
    [("core_key", "table.csv"), ("capture_key", "lvp.so"), ("capture_key", "lvp_icd.json")],
)
def test_energies_and_the_driver_are_among_the_inputs(programs_of, key, edited):
    before = getattr(programs, key)()
    path = programs_of / edited
    path.write_text(path.read_text(encoding="utf-8") + "\n", encoding="utf-8")
    getattr(programs, key).cache_clear()
    assert getattr(programs, key)() != before
