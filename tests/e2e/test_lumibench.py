"""LumiBench's runs by name: the real scene where it is, its stand-in where it is not."""

from __future__ import annotations

import json

from conftest import A2rt

FEW = ("--size", "24x24", "--spp", "1", "--units", "baseline", "--gpu", "none", "--audit", "0")


def compared(a2rt: A2rt, run: str, **env: str) -> tuple[dict, str]:
    reply = a2rt("compare", run, *FEW, "-o", "out", **env)
    assert reply.returncode == 0, reply.stdout + reply.stderr
    (found,) = json.loads((a2rt.folder / "out" / "results.json").read_text(encoding="utf-8"))
    return found, reply.stdout + reply.stderr


def test_a_run_whose_scene_is_absent_is_drawn_by_its_stand_in_and_says_so(a2rt, tmp_path):
    found, said = compared(a2rt, "lumi:bath_sh", A2RT_SCENES=str(tmp_path / "none"))
    assert found["workload"]["name"] == "cornell-for-bath_sh"
    assert found["workload"]["workload"] == "sh"
    assert found["workload"]["options"]["effects"].startswith("diffuse,mirror,rough,emission")
    assert "not on this machine: cornell stands in" in said and "it lacks sky" in said
    page = (a2rt.folder / "out" / "report.html").read_text(encoding="utf-8")
    assert "cornell stands in" in page


def test_a_run_whose_scene_is_here_is_the_scene_itself(a2rt, real_scene):
    found, said = compared(a2rt, "lumi:ship_ao", A2RT_SCENES=str(real_scene.parent))
    assert found["workload"]["name"] == "ship_ao"
    assert found["workload"]["triangles"] == 6255
    assert "stands in" not in said


def test_scenes_lists_what_can_be_named_with_and_without_the_real_files(a2rt, tmp_path):
    without = a2rt("scenes", "--json", A2RT_SCENES=str(tmp_path / "none"))
    rows = {row["scene"]: row["here"] for row in json.loads(without.stdout)}
    assert rows["cornell"] == "embedded" and rows["ship"] == "no: forest-for-ship"
    (tmp_path / "ship.glb").write_bytes(b"not looked at")
    found = a2rt("scenes", "--json", A2RT_SCENES=str(tmp_path))
    rows = {row["scene"]: row["here"] for row in json.loads(found.stdout)}
    assert rows["ship"] == "file" and rows["car"] == "no: forest-for-car"
    assert a2rt.ok("scenes", "--lumibench").count("lumi:") == 46


def test_an_unknown_run_is_refused_with_where_the_known_ones_are(a2rt):
    assert "a2rt scenes" in a2rt.refused("compare", "lumi:nothing_sh", *FEW)
