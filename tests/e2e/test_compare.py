"""Comparing units: results that hold together, a page that stands alone, runs that resume."""

from __future__ import annotations

import csv
import json
import re
from pathlib import Path

import jsonschema
from a2rt_cli.paths import SCRIPTS
from conftest import SMALL

SCHEMA = SCRIPTS / "a2rt_cli" / "schema" / "result.schema.json"


def results_of(folder: Path) -> list[dict]:
    return json.loads((folder / "results.json").read_text(encoding="utf-8"))


def of_unit(folder: Path, unit: str) -> dict:
    return next(one for one in results_of(folder) if one["label"] == unit)


LABELS = ["baseline", "aqb8", "a2rt", "baseline (same area)", "aqb8 (same area)"]


def test_results_keep_to_their_schema(compared):
    schema = json.loads(SCHEMA.read_text(encoding="utf-8"))
    found = results_of(compared)
    assert [one["label"] for one in found] == LABELS
    for one in found:
        jsonschema.validate(one, schema)


def test_every_cycle_of_an_rt_unit_is_accounted_for(compared):
    for one in results_of(compared):
        cycles, sms = one["time"]["cycles"], one["gpu"]["sms"]
        assert sum(one["time"]["stalls"]["rt_unit"].values()) == cycles * sms


def test_both_comparisons_are_made_and_a2rt_is_the_same_in_both(compared):
    said = {one["label"]: one["gpu"]["comparison"] for one in results_of(compared)}
    assert said["baseline (same area)"] == said["aqb8 (same area)"] == "same-area"
    assert said["baseline"] == said["aqb8"] == said["a2rt"] == "same-count"
    area = of_unit(compared, "a2rt")["area"]
    assert area["box_testers_um2"] <= area["reference_um2"]
    # Whole testers rarely fill the area to the last square micrometre.
    for label in ("baseline (same area)", "aqb8 (same area)"):
        area = of_unit(compared, label)["area"]
        assert 0.97 * area["reference_um2"] < area["box_testers_um2"] <= area["reference_um2"]


def test_cycles_of_every_pixel_are_kept_and_drawn(compared):
    import numpy as np

    for unit in ("baseline", "aqb8", "a2rt"):
        one = of_unit(compared, unit)
        cycles = np.load(compared / one["heatmap"])
        assert cycles.shape == (32, 32) and cycles.max() > 0
    page = (compared / "report.html").read_text(encoding="utf-8")
    assert page.count("cycles per pixel of cornell") == 3
    for words in ("waiting for data", "Warps in the RT units, over time", "Cycles per ray"):
        assert words in page


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
    assert [row["label"] for row in rows] == LABELS
    assert int(rows[0]["workload.rays"]) == results_of(compared)[0]["workload"]["rays"]


def test_report_is_one_file_that_needs_no_network(compared):
    page = (compared / "report.html").read_text(encoding="utf-8")
    outside = re.findall(r"""(?:src|href)\s*=\s*["'](?!data:|#)([^"']+)""", page)
    assert outside == []
    assert "url(" not in page
    assert page.count("data:image/png;base64,") >= 4
    assert "A²RT" in page and "lost hits" in page


def test_a_finished_comparison_is_not_run_again(a2rt):
    words = ("compare", "cornell", *SMALL, "--units", "baseline", "--gpu", "none", "-o", "out")
    a2rt.ok(*words)
    runs = sorted((a2rt.folder / "out" / ".cache" / "runs").rglob("*.json"))
    stamps = [path.stat().st_mtime_ns for path in runs]
    reply = a2rt(*words)
    assert reply.returncode == 0
    assert "simulations" not in reply.stderr
    assert [path.stat().st_mtime_ns for path in runs] == stamps


def test_two_comparisons_do_not_write_into_one_folder(a2rt):
    import fcntl

    (a2rt.folder / "out").mkdir()
    with (a2rt.folder / "out" / ".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        message = a2rt.refused("compare", "cornell", *SMALL, "-o", "out")
    assert "another a2rt is writing there" in message
