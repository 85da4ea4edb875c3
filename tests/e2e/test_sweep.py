"""Sweeps: they run, resume, plan for a cluster, and their page works in a browser."""

from __future__ import annotations

import html
import json
import re
import shutil
import subprocess
from pathlib import Path

import pytest

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


def dom_after_scripts(page: Path, profile: Path) -> str:
    """The page's DOM after its scripts ran, from a browser without network."""
    browser = shutil.which("chromium")
    if browser is None:
        pytest.skip("chromium is not installed")
    flags = "--headless --no-sandbox --disable-gpu --disable-quic --no-first-run "
    flags += "--disable-background-networking --disable-component-update --disable-sync"
    command = [browser, *flags.split(), f"--user-data-dir={profile}", "--dump-dom"]
    command += ["--virtual-time-budget=5000", page.resolve().as_uri()]
    reply = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    assert reply.returncode == 0, reply.stderr[-2000:]
    return reply.stdout


def test_a_sweep_runs_each_point_once_and_writes_a_page_that_works(a2rt, tiny):
    a2rt.ok("sweep", tiny, "-o", "out")
    found = json.loads((a2rt.folder / "out" / "results.json").read_text(encoding="utf-8"))
    # The default of a knob is the unit as configured: baseline, a2rt, a2rt with 6 bits.
    assert len(found) == 3
    points = sorted((a2rt.folder / "out" / "points").glob("*.json"))
    stamps = [path.stat().st_mtime_ns for path in points]
    a2rt.ok("sweep", tiny, "-o", "out")
    assert [path.stat().st_mtime_ns for path in points] == stamps

    dom = dom_after_scripts(a2rt.folder / "out" / "report.html", a2rt.folder / "profile")
    scatter = re.search(r'<svg id="scatter".*?</svg>', dom, re.DOTALL)
    assert scatter and scatter[0].count('class="point"') == 3
    assert "redundant hits" in html.unescape(scatter[0])


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
