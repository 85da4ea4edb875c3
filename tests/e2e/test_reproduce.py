"""The paper's figures: drawn, with the paper's numbers and the gap in words beside ours."""

from __future__ import annotations

import json
import shutil

import pytest

pictures = pytest.importorskip("a2rt_cli.engine.pictures")


def test_figure_8_has_both_comparisons_the_papers_numbers_and_the_gap_in_words(a2rt):
    words = ("fig8", "fig2", "--scenes", "cornell", "--size", "16x16")
    said = a2rt.ok("reproduce", *words, "-o", "out")
    assert "Speedup of A²RT over the baseline, same area" in said
    assert "The gap, as measured" in said and "waiting for" in said
    folder = a2rt.folder / "out" / "fig8"
    for comparison in ("same-count", "same-area"):
        drawn = pictures.load(folder / f"fig8-{comparison}.png")
        assert drawn.shape[1] > 1000 and drawn.std() > 20
    numbers = json.loads((folder / "fig8.json").read_text(encoding="utf-8"))
    assert len(numbers["paper"]) >= 8
    assert all(row["ours"] and row["paper"] for row in numbers["paper"])
    found = json.loads((folder / "results.json").read_text(encoding="utf-8"))
    assert {one["workload"]["workload"] for one in found} == {"pt", "sh", "ao"}
    assert len(found) == 3 * 5
    # Figure 2 needs runs that figure 8 has made: nothing is simulated twice.
    shares = json.loads((a2rt.folder / "out/fig2/fig2.json").read_text(encoding="utf-8"))["paper"]
    assert len(shares) == 5 and all(0 < row["ours"] < 1 for row in shares)
    runs = (a2rt.folder / "out" / ".cache" / "runs").glob("*/*.json")
    assert len(list(runs)) == len(found)


def test_table_2_says_what_is_published_and_what_is_estimated(a2rt):
    said = a2rt.ok("reproduce", "table2", "-o", "out")
    assert "QBOX           published    120" in said
    assert "TRI            estimated     24" in said
    assert "copied right" in said and "1.26" in said
    # The unit's origins are wider than the paper's: its tester is larger than the published one.
    assert "published row" in said and "row simulated" in said and "58.34 %" in said


def test_the_direction_map_and_the_tester_are_those_of_the_users_configuration(a2rt, monkeypatch):
    from a2rt_cli.engine import core
    from a2rt_cli.paths import CONFIGS

    folder = shutil.copytree(CONFIGS, a2rt.folder / "configs")
    monkeypatch.setenv("A2RT_CONFIGS", str(folder))

    def measured() -> tuple[dict, dict]:
        found = core.direction_map(["a2rt", "a2rt-literal"], 2, 20_000, a2rt.folder / "map.json")
        return found, core.tester("a2rt")

    wide, wide_tester = measured()
    file = folder / "units" / "a2rt.toml"
    file.write_text(file.read_text("utf-8").replace('"wide"', '"literal"'), encoding="utf-8")
    literal, literal_tester = measured()
    assert wide["units"]["a2rt"] != wide["units"]["a2rt-literal"]
    assert literal["units"]["a2rt"] == literal["units"]["a2rt-literal"]
    assert [one["precision"]["a2rt"]["origin"] for one in (wide, literal)] == ["wide", "literal"]
    assert wide_tester["scale"] > 1 and literal_tester["scale"] == 1


def test_figure_7_takes_the_shared_tree_once_and_prints_its_parts(a2rt):
    words = ("fig7", "--scenes", "cornell", "--size", "16x16")
    said = a2rt.ok("reproduce", *words, "-o", "out")
    assert "tree, shared" in said and "without the tree that both share" in said
    numbers = json.loads((a2rt.folder / "out/fig7/fig7.json").read_text(encoding="utf-8"))
    (build,) = numbers["builds"]
    assert build["tree"] > 0 and set(build["classify"]) == {"aqb8", "a2rt"}
    assert pictures.load(a2rt.folder / "out" / "fig7" / "fig7.png").std() > 20


def test_the_two_models_of_the_machine_are_run_on_the_same_rays_and_agree(a2rt):
    a2rt.ok("reproduce", "models", "--scenes", "cornell", "--size", "64x64", "-o", "out")
    folder = a2rt.folder / "out" / "models"
    rows = json.loads((folder / "models.json").read_text(encoding="utf-8"))["models"]
    assert [row["unit"] for row in rows] == ["baseline", "aqb8", "a2rt"]
    for row in rows:
        queued, reserved = row["queued"]["cycles"], row["reserved"]["cycles"]
        assert row["error"] == pytest.approx(reserved / queued - 1)
        assert 0 < abs(row["error"]) < 0.1
    found = json.loads((folder / "results.json").read_text(encoding="utf-8"))
    changes = [one["gpu"]["changes"] for one in found]
    assert changes == [["model=queued"], ["model=reserved"]] * 3
    asked = [one["memory"]["rt_unit"]["sectors_wanted"] for one in found]
    assert asked[0::2] == asked[1::2]
    assert pictures.load(folder / "models.png").std() > 20


def test_the_error_of_sampling_is_against_a_full_run(a2rt):
    said = a2rt.ok("reproduce", "sampling", "--scenes", "cornell", "--size", "64x64", "-o", "out")
    file = a2rt.folder / "out/sampling/sampling.json"
    rows = json.loads(file.read_text(encoding="utf-8"))["samples"]
    checked = [row for row in rows if row.get("full_cycles")]
    for row in checked:
        error = (row["cycles"] - row["full_cycles"]) / row["full_cycles"]
        assert row["error"] == pytest.approx(error, abs=1e-9)
    assert checked or "No sample" in said
