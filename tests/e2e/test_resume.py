"""Killed outright at any moment, a comparison leaves whole results and goes on from them."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from a2rt_cli.paths import BUILD, SCRIPTS
from conftest import SMALL

WORDS = ["compare", "cornell", "spheres", *SMALL, "--audit", "100", "-o", "out"]
RUNS = 10  # two scenes, three units, and two of them again with A2RT's area
LONGEST = 300.0  # seconds until a moment has to come, on a busy machine


def finished_runs(folder: Path) -> dict[Path, int]:
    """Result files of single runs and when they were written."""
    found = (folder / "out" / ".cache" / "runs").glob("*/*.json")
    return {path: path.stat().st_mtime_ns for path in found if not path.name.startswith(".")}


def captures(folder: Path) -> list[Path]:
    return list((folder / "out" / ".cache" / "captures").glob("*/capture.json"))


def capturing(folder: Path) -> bool:
    return any((folder / "out" / ".cache" / "captures").glob(".capture-*/raw/*"))


MOMENTS: dict[str, Callable[[Path], bool]] = {
    "while the command starts": lambda folder: True,
    "while a scene is being captured": capturing,
    "after the first capture": lambda folder: len(captures(folder)) >= 1,
    "after the first run": lambda folder: len(finished_runs(folder)) >= 1,
    "in the middle of the runs": lambda folder: len(finished_runs(folder)) >= RUNS // 2,
    "shortly before the end": lambda folder: len(finished_runs(folder)) >= RUNS - 1,
}


def kill_at(folder: Path, moment: Callable[[Path], bool]) -> None:
    child = subprocess.Popen(
        [str(SCRIPTS / "a2rt"), *WORDS],
        cwd=folder,
        env={**os.environ, "A2RT_NO_SETUP": "1", "A2RT_BUILD_DIR": str(BUILD)},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    end = time.monotonic() + LONGEST
    while not moment(folder) and child.poll() is None:
        assert time.monotonic() < end, "the moment never came"
        time.sleep(0.01)
    child.send_signal(signal.SIGKILL)
    child.wait()


def left_running(folder: Path) -> list[str]:
    """Processes that still work in `folder`, those just forked included."""
    found = []
    for entry in Path("/proc").glob("[0-9]*/cmdline"):
        try:
            words = entry.read_bytes().replace(b"\0", b" ").decode(errors="replace")
            place = (entry.parent / "cwd").readlink()
        except OSError:
            continue  # ended meanwhile
        if place == folder:
            found.append(words)
    return found


def whole(path: Path) -> bool:
    json.loads(path.read_text(encoding="utf-8"))
    return True


def results_that_users_see(folder: Path) -> list[Path]:
    """Everything but scratch, whose names start with a dot and which the next call removes."""
    out = folder / "out"
    scratch = (".run-", ".capture-")
    return [
        path
        for path in out.rglob("*.json")
        if ".partial" not in path.name
        and not any(part.startswith(scratch) for part in path.relative_to(out).parts)
    ]


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory) -> list[dict]:
    from conftest import A2rt

    folder = tmp_path_factory.mktemp("undisturbed")
    A2rt(folder).ok(*WORDS)
    return json.loads((folder / "out" / "results.json").read_text(encoding="utf-8"))


def test_killed_at_any_moment_it_resumes_without_damage_or_repetition(a2rt, undisturbed):
    for name, moment in MOMENTS.items():
        before = finished_runs(a2rt.folder)
        kill_at(a2rt.folder, moment)
        after = finished_runs(a2rt.folder)
        assert all(whole(path) for path in results_that_users_see(a2rt.folder)), name
        assert {path: after[path] for path in before} == before, f"{name}: a run was repeated"
        end = time.monotonic() + 20
        while left_running(a2rt.folder) and time.monotonic() < end:
            time.sleep(0.05)
        assert left_running(a2rt.folder) == [], name
    before = finished_runs(a2rt.folder)
    assert before, "no moment came after a finished run"
    a2rt.ok(*WORDS)
    after = finished_runs(a2rt.folder)
    assert len(after) == RUNS
    assert {path: after[path] for path in before} == before
    found = json.loads((a2rt.folder / "out" / "results.json").read_text(encoding="utf-8"))
    for one, other in zip(found, undisturbed, strict=True):
        assert one["label"] == other["label"]
        for key in ("accuracy", "driver_match", "memory", "energy"):
            assert one.get(key) == other.get(key)
        assert one["time"]["cycles"] == other["time"]["cycles"]
    scratch = [p for p in (a2rt.folder / "out").rglob(".*") if ".partial" in p.name]
    scratch += list((a2rt.folder / "out").rglob(".run-*"))
    assert scratch == []
