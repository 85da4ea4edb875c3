"""The shape of the repository: rooms, file lengths, direction of dependencies."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from a2rt_cli.paths import ROOT

TOP_LEVEL = {
    "CMakeLists.txt",
    "README.md",
    "a2rt_core",
    "lumibench_configs",
    "scripts",
    "shaders",
    "tests",
    "vulkan_sim_patch",
}
LONGEST_FILE = 600
SOURCE_SUFFIXES = {".cpp", ".h", ".py", ".glsl", ".sv", ".svh", ".cmake", ".toml", ".sh"}

# What each room of a2rt_core may include besides itself.
MAY_INCLUDE = {
    "base": set(),
    "cli": set(),
    "capture": set(),
    "config": {"base"},
    "arith": {"base", "config"},
    "workload": {"base", "config", "capture"},
    "bvh": {"base", "config", "arith", "workload"},
    "rt": {"base", "config", "arith", "workload", "bvh", "capture"},
    "hard": {"base", "config", "arith", "workload", "bvh", "rt"},
    "timing": {"base", "config", "workload", "rt", "capture"},
    "energy": {"base", "config", "arith", "workload", "rt", "timing", "capture"},
}
INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]a2rt/(\w+)/', re.MULTILINE)


def room_of(path: Path) -> str | None:
    parts = path.relative_to(ROOT).parts
    if parts[:3] == ("a2rt_core", "include", "a2rt") and len(parts) > 4:
        return parts[3]
    if parts[:2] == ("a2rt_core", "src") and len(parts) > 3:
        return parts[2]
    return None


def test_the_top_level_holds_the_fixed_rooms_and_nothing_else(tracked):
    names = {path.relative_to(ROOT).parts[0] for path in tracked}
    assert {name for name in names if not name.startswith(".")} == TOP_LEVEL


def test_no_source_file_is_longer_than_the_limit(tracked):
    long = {}
    for path in tracked:
        if path.suffix in SOURCE_SUFFIXES or path.name == "CMakeLists.txt":
            lines = len(path.read_text(encoding="utf-8").splitlines())
            if lines >= LONGEST_FILE:
                long[str(path.relative_to(ROOT))] = lines
    assert not long


def test_rooms_include_only_what_lies_below_them(tracked):
    seen, wrong = set(), []
    for path in tracked:
        room = room_of(path)
        if room is None or path.suffix not in {".h", ".cpp"}:
            continue
        seen.add(room)
        assert room in MAY_INCLUDE, f"{path}: a new room; say in this test what it may include"
        for other in INCLUDE.findall(path.read_text(encoding="utf-8")):
            if other != room and other not in MAY_INCLUDE[room]:
                wrong.append(f"{path.relative_to(ROOT)} includes a2rt/{other}")
    assert seen
    assert not wrong


def test_the_layer_sees_the_capture_format_and_nothing_else_of_the_core(tracked):
    layer = [
        path
        for path in tracked
        if path.relative_to(ROOT).parts[0] == "vulkan_sim_patch" and path.suffix in {".h", ".cpp"}
    ]
    wrong = [
        f"{path.relative_to(ROOT)} includes a2rt/{other}"
        for path in layer
        for other in INCLUDE.findall(path.read_text(encoding="utf-8"))
        if other != "capture"
    ]
    assert not wrong


@pytest.mark.parametrize("target", ["timing", "arith"])
def test_the_rule_for_includes_would_catch_a_violation(target):
    text = f'#include "a2rt/{target}/x.h"\n'
    room = "rt" if target == "timing" else "timing"
    assert [o for o in INCLUDE.findall(text) if o not in MAY_INCLUDE[room]] == [target]


def test_the_layer_knows_every_environment_variable_of_the_project():
    """The layer reports unknown A2RT_ variables, so it must know those that are not its own."""
    reads = re.compile(r'(?:getenv\(|environ\.get\(|environ\[)\s*"(A2RT_[A-Z_]+)"')
    sets = re.compile(r'"(A2RT_[A-Z_]+)"(?::|\]? *=)')
    settings = (ROOT / "vulkan_sim_patch/layer/settings.cpp").read_text(encoding="utf-8")
    found = set()
    for folder in ("scripts", "a2rt_core", "shaders", "vulkan_sim_patch"):
        for path in (ROOT / folder).rglob("*"):
            if path.suffix in {".py", ".cpp", ".h"}:
                text = path.read_text(encoding="utf-8")
                found |= set(reads.findall(text)) | set(sets.findall(text))
    assert {"A2RT_CAPTURE", "A2RT_NO_SETUP", "A2RT_CONFIGS"} <= found
    assert {name for name in found if f'"{name}"' not in settings} == set()
