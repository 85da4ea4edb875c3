"""Sweeps: they run, resume after being killed, search within a budget, plan for a cluster."""

from __future__ import annotations

import json
import os
import subprocess
import time
from pathlib import Path

import pytest
from a2rt_cli import experiment
from a2rt_cli.engine.capture import Captured
from a2rt_cli.paths import BUILD, SCRIPTS
from a2rt_cli.sweep import plan, search

snakemake = pytest.importorskip("snakemake", reason="scripts/requirements-sweep.txt is missing")

TINY = """title = "tiny"
scenes = ["cornell"]
workloads = ["pt"]
size = [16, 16]
spp = 1
units = ["baseline", "a2rt"]
audit = 100
pictures = true

[[knob]]
title = "Box bits"
unit = "a2rt"
key = "precision.box_bits"
values = [6, 8]
default = 8
"""


@pytest.fixture
def tiny(a2rt) -> Path:
    path = a2rt.folder / "tiny.toml"
    path.write_text(TINY, encoding="utf-8")
    return path


def test_a_sweep_runs_each_point_once_and_writes_a_page_that_works(a2rt, tiny):
    a2rt.ok("sweep", tiny, "-o", "out")
    found = json.loads((a2rt.folder / "out" / "results.json").read_text(encoding="utf-8"))
    # The default of a knob is the unit as configured: baseline, a2rt, a2rt with 6 bits.
    assert len(found) == 3
    points = sorted((a2rt.folder / "out" / "points").glob("*.json"))
    stamps = [path.stat().st_mtime_ns for path in points]
    a2rt.ok("sweep", tiny, "-o", "out")
    assert [path.stat().st_mtime_ns for path in points] == stamps

    page = (a2rt.folder / "out" / "report.html").read_text(encoding="utf-8")
    assert "precision.box_bits" in page and "data:image/png;base64," in page


def test_a_killed_sweep_goes_on_and_repeats_nothing(a2rt, tiny):
    psutil = pytest.importorskip("psutil")
    command = [
        str(SCRIPTS / "a2rt"),
        "sweep",
        str(tiny),
        "-o",
        "out",
        "--parallel",
        "1",
    ]
    env = {**os.environ, "A2RT_NO_SETUP": "1", "A2RT_BUILD_DIR": str(BUILD)}
    running = subprocess.Popen(command, cwd=a2rt.folder, env=env, stderr=subprocess.DEVNULL)
    points = a2rt.folder / "out" / "points"
    deadline = time.monotonic() + 120
    while not list(points.glob("*.json")):
        assert time.monotonic() < deadline and running.poll() is None
        time.sleep(0.02)
    for child in [*psutil.Process(running.pid).children(recursive=True), running]:
        child.kill()
    running.wait()
    before = {path: path.stat().st_mtime_ns for path in points.glob("*.json")}
    for path in before:
        json.loads(path.read_text(encoding="utf-8"))
    a2rt.ok("sweep", tiny, "-o", "out")
    assert len(list(points.glob("*.json"))) == 3
    assert {path: path.stat().st_mtime_ns for path in before} == before
    assert not list((a2rt.folder / "out").rglob(".*.partial*"))


SEARCH = """
[search]
unit = "a2rt"
minimise = "time.cycles"
most_lost_hits = 0
most_extra_redundant = 0.01

[search.space]
"precision.box_bits" = [4, 8, 12]
"""


def test_the_search_stays_within_its_budget_and_goes_on_where_it_was(a2rt, tiny):
    bytes_instead = SEARCH.replace("time.cycles", "memory.by_kind.sub_node.bytes")
    tiny.write_text(TINY + bytes_instead, encoding="utf-8")
    a2rt.ok("sweep", tiny, "--search", "--trials", "4", "-o", "out")
    said = a2rt.ok("sweep", tiny, "--search", "--trials", "6", "-o", "out")
    summary = json.loads((a2rt.folder / "out" / "search.json").read_text(encoding="utf-8"))
    assert len(summary["trials"]) == 6
    limit = summary["default"]["redundant"] * 1.01
    within = [trial for trial in summary["trials"] if trial["within_budget"]]
    for trial in summary["trials"]:
        assert trial["within_budget"] == (trial["redundant"] <= limit and trial["lost"] == 0)
    # 4 bits are the cheapest in bytes, but let through more than the budget allows.
    assert summary["best"]["cost"] == min(trial["cost"] for trial in within)
    assert summary["best"]["parameters"]["precision.box_bits"] != 4
    assert "within the budget" in said


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("audit = 100", "audit = 200"),
        ('units = ["baseline"', 'gpu = "mobile"\nunits = ["baseline"'),
        ("most_lost_hits = 0", "most_lost_hits = 3"),
        ("[4, 8, 12]", "[4, 8, 10]"),
    ],
)
def test_trials_of_another_question_are_another_study(tmp_path, before, after):
    def name(text: str) -> str:
        path = tmp_path / "asked.toml"
        path.write_text(text, encoding="utf-8")
        one = experiment.load(path)
        return search.study_name(one, one.search, [Captured("w", Path("w.h5"), "key")])

    assert before in TINY + SEARCH
    assert name(TINY + SEARCH) == name(TINY + SEARCH)
    assert name((TINY + SEARCH).replace(before, after)) != name(TINY + SEARCH)


def test_an_edit_of_the_unit_is_new_points(tiny, tmp_path):
    def names(unit: str) -> set[str]:
        unit_file = tmp_path / "unit.toml"
        unit_file.write_text(unit, encoding="utf-8")
        tiny.write_text(TINY.replace('"a2rt"]', f'"{unit_file}"]'), encoding="utf-8")
        return {point.name for point in plan.make(experiment.load(tiny)).points}

    before = names('inherits = "a2rt"\n')
    after = names('inherits = "a2rt"\n[precision]\nbox_bits = 9\n')
    kept = before & after
    assert len(kept) == len(before) - 1


def test_a_missing_point_is_run_again(a2rt, tiny):
    a2rt.ok("sweep", tiny, "-o", "out")
    points = sorted((a2rt.folder / "out" / "points").glob("*.json"))
    points[0].unlink()
    kept = points[1].stat().st_mtime_ns
    a2rt.ok("sweep", tiny, "-o", "out")
    assert points[0].is_file()
    assert points[1].stat().st_mtime_ns == kept


def test_the_slurm_profile_plans_the_experiment(a2rt):
    said = a2rt.ok("sweep", "price-of-accuracy", "--profile", "slurm", "--dry-run", "-o", "out")
    assert "dry run" in said
    assert not (a2rt.folder / "out" / "points").exists()


def test_an_unknown_profile_is_refused(a2rt, tiny):
    reply = a2rt("sweep", tiny, "--profile", "no-such-profile", "--dry-run", "-o", "out")
    assert reply.returncode == 2
    assert "no-such-profile" in reply.stderr


def finished(folder: Path) -> set[str]:
    return {path.stem for path in (folder / "out" / "points").glob("*.json")}


def test_another_size_is_another_sweep_in_the_same_folder(a2rt, tiny):
    a2rt.ok("sweep", tiny, "-o", "out")
    before = finished(a2rt.folder)
    a2rt.ok("sweep", tiny, "--size", "24x16", "-o", "out")
    found = json.loads((a2rt.folder / "out" / "results.json").read_text(encoding="utf-8"))
    assert {one["workload"]["options"]["width"] for one in found} == {24}
    assert len(finished(a2rt.folder) - before) == len(found) == len(before)


def test_a_dry_run_leaves_the_plan_of_the_folder_alone_and_counts_what_is_there(a2rt, tiny):
    a2rt.ok("sweep", tiny, "-o", "out")
    planned = (a2rt.folder / "out" / "plan.json").read_bytes()
    assert "3 points planned, 3 of them are there already" in a2rt.ok(
        "sweep", tiny, "--dry-run", "-o", "out"
    )
    tiny.write_text(TINY.replace("[6, 8]", "[6, 7, 8]"), encoding="utf-8")
    said = a2rt.ok("sweep", tiny, "--dry-run", "-o", "out")
    assert "4 points planned, 3 of them are there already" in said
    assert (a2rt.folder / "out" / "plan.json").read_bytes() == planned


def test_a_second_sweep_into_a_folder_leaves_the_plan_of_the_first_alone(a2rt, tiny):
    from a2rt_cli.files import exclusive

    with exclusive(a2rt.folder / "out"):
        reply = a2rt("sweep", tiny, "-o", "out")
    assert reply.returncode == 2 and "another a2rt is writing there" in reply.stderr
    assert not (a2rt.folder / "out" / "plan.json").exists()
