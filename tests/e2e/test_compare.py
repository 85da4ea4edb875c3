"""Comparing units: results that hold together, a page that stands alone, runs that resume."""

from __future__ import annotations

import csv
import json
import os
import re
import signal
import subprocess
import time
from pathlib import Path

import jsonschema
from a2rt_cli.paths import BUILD, SCRIPTS
from conftest import SMALL

SCHEMA = SCRIPTS / "a2rt_cli" / "schema" / "result.schema.json"


def results_of(folder: Path) -> list[dict]:
    return json.loads((folder / "results.json").read_text(encoding="utf-8"))


def of_unit(folder: Path, unit: str) -> dict:
    return next(one for one in results_of(folder) if one["unit"]["name"] == unit)


def test_results_keep_to_their_schema(compared):
    schema = json.loads(SCHEMA.read_text(encoding="utf-8"))
    found = results_of(compared)
    assert [one["unit"]["name"] for one in found] == ["baseline", "aqb8", "a2rt"]
    for one in found:
        jsonschema.validate(one, schema)


def test_all_units_see_the_same_rays(compared):
    found = results_of(compared)
    assert len({one["workload"]["rays"] for one in found}) == 1
    assert len({one["provenance"]["workload_key"] for one in found}) == 1
    assert found[0]["workload"]["rays"] >= 32 * 32


def test_conservative_units_lose_no_hit_and_draw_the_drivers_picture(compared):
    for unit in ("baseline", "a2rt"):
        one = of_unit(compared, unit)
        assert one["accuracy"]["missed_hits"] == 0
        assert one["driver_match"].get("lost", 0) == 0
        assert one["driver_match"].get("other", 0) == 0
        assert one["picture"]["changed_pixels"] == 0


def test_quantized_units_ask_for_fewer_node_bytes_than_the_baseline(compared):
    def node_bytes(unit: str) -> int:
        kinds = of_unit(compared, unit)["memory"]["by_kind"]
        names = ("node", "group_node", "sub_node", "anchor")
        return sum(kinds.get(name, {}).get("bytes", 0) for name in names)

    assert 0 < node_bytes("a2rt") < node_bytes("baseline")
    assert 0 < node_bytes("aqb8") < node_bytes("baseline")


def test_csv_holds_the_numbers_of_the_json(compared):
    with (compared / "results.csv").open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert [row["unit.name"] for row in rows] == ["baseline", "aqb8", "a2rt"]
    assert int(rows[0]["workload.rays"]) == results_of(compared)[0]["workload"]["rays"]


def test_report_is_one_file_that_needs_no_network(compared):
    page = (compared / "report.html").read_text(encoding="utf-8")
    outside = re.findall(r"""(?:src|href)\s*=\s*["'](?!data:|#)([^"']+)""", page)
    assert outside == []
    assert "url(" not in page
    assert page.count("data:image/png;base64,") >= 4
    assert "A²RT" in page and "lost hits" in page


def test_a_finished_comparison_is_not_run_again(a2rt):
    words = ("compare", "cornell", *SMALL, "--units", "baseline", "--audit", "0", "-o", "out")
    a2rt.ok(*words)
    runs = sorted((a2rt.folder / "out" / ".cache" / "runs").rglob("*.json"))
    stamps = [path.stat().st_mtime_ns for path in runs]
    reply = a2rt(*words)
    assert reply.returncode == 0
    assert "simulations" not in reply.stderr
    assert [path.stat().st_mtime_ns for path in runs] == stamps


def test_killed_at_any_moment_it_resumes_without_damage(a2rt):
    words = ["compare", "cornell", "spheres", *SMALL, "--audit", "200", "-o", "out"]
    env = {**os.environ, "A2RT_NO_SETUP": "1", "A2RT_BUILD_DIR": str(BUILD)}
    for seconds in (0.4, 1.5, 3.0):
        child = subprocess.Popen(
            [str(SCRIPTS / "a2rt"), *words],
            cwd=a2rt.folder,
            env=env,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        time.sleep(seconds)
        child.send_signal(signal.SIGKILL)
        child.wait()
        for path in (a2rt.folder / "out").rglob("*.json"):
            if not path.name.startswith("."):
                scratch = any(part.startswith((".run-", ".capture-")) for part in path.parts)
                assert scratch or json.loads(path.read_text(encoding="utf-8")) is not None
    a2rt.ok(*words)
    assert len(results_of(a2rt.folder / "out")) == 6
    left = [p for p in (a2rt.folder / "out").rglob(".*") if ".partial" in p.name]
    assert left == []


def test_two_comparisons_do_not_write_into_one_folder(a2rt):
    import fcntl

    (a2rt.folder / "out").mkdir()
    with (a2rt.folder / "out" / ".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        message = a2rt.refused("compare", "cornell", *SMALL, "-o", "out")
    assert "another a2rt is writing there" in message
