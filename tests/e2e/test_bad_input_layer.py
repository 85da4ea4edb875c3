"""Programs under the layer that end badly: a clear message, no workload file."""

from __future__ import annotations

from a2rt_cli.paths import BUILD

PROGRAMS = BUILD / "tests" / "vulkan" / "a2rt_vulkan_programs"


def test_a_vulkan_program_that_dies_midway_leaves_no_workload_file(a2rt):
    message = a2rt.refused("capture", "w.h5", "--", PROGRAMS, "crash", "/dev/null")
    assert "SIGKILL" in message


def test_on_a_full_disk_the_message_names_the_file_and_the_remedy(a2rt):
    message = a2rt.refused("capture", "w.h5", "--", PROGRAMS, "full_disk", "/dev/null")
    assert "records.bin.part" in message and "free space there" in message


def test_a_foreign_program_is_captured_whole(a2rt):
    printed = a2rt.ok("capture", "w.h5", "--", PROGRAMS, "any_hit", "/dev/null")
    assert "rays of a2rt_vulkan_programs" in printed
    assert (a2rt.folder / "w.h5").is_file()
