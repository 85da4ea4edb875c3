"""Effects follow the file: what one edit adds or removes in pipeline, capture and machine."""

from __future__ import annotations

import json
import os
import subprocess
from typing import Any

import gltf_scene
import pytest
from a2rt_cli.engine import programs
from a2rt_cli.paths import BUILD
from conftest import SMALL, A2rt

CANDIDATE_PATH = "any-hit candidate path"


class Run:
    """One state of the file, seen through every command that analyses it."""

    def __init__(self, a2rt: A2rt, document: dict[str, Any], name: str):
        file = gltf_scene.write(document, a2rt.folder / f"{name}.gltf")
        self.table = json.loads(a2rt.ok("inspect", file, "--json"))
        a2rt.ok("render", file, *SMALL, "--capture", f"{name}.h5", "-o", f"{name}.png")
        self.capture = json.loads(a2rt.ok("inspect", f"{name}.h5", "--json"))
        a2rt.ok("simulate", f"{name}.h5", "--unit", "a2rt", "-o", f"{name}-result.json")
        result = (a2rt.folder / f"{name}-result.json").read_text(encoding="utf-8")
        self.result = json.loads(result)
        numbers = a2rt.folder / f"{name}-statistics.json"
        count = [programs.program("a2rt-render"), file, *SMALL, "--count-rays", "-q"]
        subprocess.run(
            [*count, "--json", numbers], env={**os.environ, **programs.lavapipe()}, check=True
        )
        self.statistics = json.loads(numbers.read_text(encoding="utf-8"))

    def built(self) -> set[str]:
        return {effect["name"] for effect in self.table["effects"] if effect["built"]}

    def ray_kinds(self) -> set[str]:
        return {kind for kind, count in self.statistics["rays"].items() if count > 0}

    def pipeline(self) -> set[str]:
        return set(self.statistics["pipeline"]["stages"])

    def captured_stages(self) -> set[str]:
        return {stage["stage"] for stage in self.capture["stages"]}

    def parts(self) -> set[str]:
        simulated = {p["part"] for p in self.result["parts"] if p["instantiated"]}
        assert simulated == {p["part"] for p in self.capture["parts"] if p["instantiated"]}
        return simulated


@pytest.fixture(scope="module")
def plain(tmp_path_factory) -> Run:
    return Run(A2rt(tmp_path_factory.mktemp("plain")), gltf_scene.three_plates(), "plain")


def test_turning_one_material_to_glass_adds_exactly_refraction_and_its_rays(a2rt, plain):
    document = gltf_scene.three_plates()
    gltf_scene.turn_to_glass(document, "pane")
    glass = Run(a2rt, document, "glass")
    assert glass.built() - plain.built() == {"refraction"}
    assert plain.built() - glass.built() == set()
    refraction = next(e for e in glass.table["effects"] if e["name"] == "refraction")
    assert refraction["called_for_by"] == ["material pane"]
    # A surface that transmits also reflects: both kinds of rays are refraction's.
    assert glass.ray_kinds() - plain.ray_kinds() <= {"refraction", "reflection"}
    assert glass.statistics["rays"]["refraction"] > 0 == plain.statistics["rays"]["refraction"]
    # Its rays need no stage and no part of the machine that other rays do not.
    assert glass.pipeline() == plain.pipeline()
    assert glass.parts() == plain.parts()


def test_removing_the_last_mask_removes_the_any_hit_path_everywhere(a2rt, plain):
    document = gltf_scene.three_plates()
    gltf_scene.material(document, "leaf")["alphaMode"] = "OPAQUE"
    opaque = Run(a2rt, document, "opaque")
    assert plain.built() - opaque.built() == {"alpha"}
    assert opaque.built() - plain.built() == set()
    assert plain.pipeline() - opaque.pipeline() == {"alpha.rahit"}
    assert plain.captured_stages() - opaque.captured_stages() == {"any_hit"}
    assert plain.capture["rays"]["candidates"] > 0 == opaque.capture["rays"]["candidates"]
    assert plain.parts() - opaque.parts() == {CANDIDATE_PATH}
    assert opaque.parts() - plain.parts() == set()


def test_one_identity_placement_leaves_the_transform_unit_out(a2rt, plain):
    assert "transform unit" not in plain.parts()
    document = gltf_scene.three_plates()
    document["nodes"][1]["mesh"] = 2  # the leaf's mesh is now placed twice
    shared = Run(a2rt, document, "shared")
    assert shared.built() - plain.built() == {"instancing"}
    assert shared.parts() - plain.parts() == {"transform unit"}


def test_all_effects_change_neither_picture_nor_cycles(a2rt):
    file = gltf_scene.write(gltf_scene.three_plates(), a2rt.folder / "plates.gltf")
    row = json.loads(a2rt.ok("inspect", file, "--compare-effects", *SMALL, "--json", "-o", "kept"))
    assert row["pictures_identical"]
    assert row["rays_differ_in"] == row["results_differ_in"] == []
    assert row["auto"]["cycles"] == row["all"]["cycles"]
    assert set(row["auto"]["parts"]) < set(row["all"]["parts"])
    assert len(row["auto"]["stages"]) < len(row["all"]["stages"])
    assert json.loads((a2rt.folder / "kept" / "savings.json").read_text(encoding="utf-8")) == [row]


def test_a_list_of_effects_says_what_the_picture_lacks(a2rt):
    said = a2rt.ok("inspect", "cornell", "--effects", "diffuse,emission,soft-shadow,normals")
    assert "The picture lacks: mirror, rough, refraction." in said


# What the foreign programs of tests/vulkan call for: stages of their pipelines, effects, parts of
# the machine.
TRACE = {"raygen", "closest_hit", "miss"}
MOVED = {"transform", "instancing"}
PLAIN = {"closest_hit", "triangles"}
FOREIGN = {
    "any_hit": (
        TRACE | {"any_hit"},
        PLAIN | MOVED | {"any_hit"},
        {CANDIDATE_PATH, "transform unit", "triangle tester"},
    ),
    "callable": (
        TRACE | {"callable"},
        PLAIN | {"callable"},
        {"callable calls", "triangle tester"},
    ),
    "procedural": (
        TRACE | {"any_hit", "intersection"},
        PLAIN | MOVED | {"any_hit", "procedural"},
        {CANDIDATE_PATH, "intersection-shader path", "transform unit", "triangle tester"},
    ),
    "hit_groups": (TRACE, PLAIN | MOVED, {"transform unit", "triangle tester"}),
    "recursion": (
        TRACE,
        PLAIN | MOVED | {"recursion", "secondary_rays", "first_hit", "opacity_flags"},
        {"call stack", "first-hit exit", "opacity logic", "transform unit", "triangle tester"},
    ),
    "query_compute": (
        {"compute"},
        PLAIN | MOVED | {"any_hit", "ray_query"},
        {CANDIDATE_PATH, "inline traversal", "transform unit", "triangle tester"},
    ),
    "update": (
        TRACE,
        PLAIN | MOVED | {"several_frames", "dynamic_geometry"},
        {"transform unit", "triangle tester"},
    ),
    "instances": (
        TRACE,
        PLAIN | MOVED | {"dynamic_geometry", "face_culling", "masks", "secondary_rays"},
        {"facing test", "mask test", "transform unit", "triangle tester"},
    ),
}


@pytest.mark.parametrize("name", FOREIGN)
def test_a_foreign_program_is_analysed_by_its_pipelines_rays_and_structures(a2rt, name):
    program = BUILD / "tests" / "vulkan" / "a2rt_vulkan_programs"
    a2rt.ok("capture", "w.h5", "--", program, name, "picture.ppm")
    found = json.loads(a2rt.ok("inspect", "w.h5", "--json"))
    stages, effects, parts = FOREIGN[name]
    assert {stage["stage"] for stage in found["stages"] if stage["segments"] > 0} == stages
    assert {effect["name"] for effect in found["effects"] if effect["built"]} == effects
    assert {part["part"] for part in found["parts"] if part["instantiated"]} == parts
    for effect in found["effects"]:
        assert effect["called_for_by"] if effect["built"] else effect["why"]


def test_the_report_says_what_a_scene_did_not_need_and_how_to_measure_the_saving(compared):
    page = (compared / "report.html").read_text(encoding="utf-8")
    section = page[page.index('<section id="savings">') :]
    section = section[: section.index("</section>")]
    assert "alpha" in section and "procedural" in section
    assert "inspect cornell --compare-effects" in section
