"""One unit on many machines: a table, a picture, and the cycles of single runs."""

from __future__ import annotations

import json

from conftest import SMALL


def test_every_machine_has_the_cycles_of_a_run_of_its_own_and_a_bar(a2rt):
    a2rt.ok("render", "cornell", *SMALL, "--capture", "w.h5", "-o", "w.png")
    words = ("--vary", "rt.warps=2,4", "--vary", "model=queued,reserved", "-o", "v.json")
    said = a2rt.ok("vary", "w.h5", "--unit", "a2rt", *words)
    found = json.loads((a2rt.folder / "v.json").read_text(encoding="utf-8"))
    assert [one["set"]["rt.warps"] for one in found["runs"]] == ["2", "2", "4", "4"]
    for one in found["runs"]:
        assert f"{one['time']['cycles']:,}" in said
    a2rt.ok("simulate", "w.h5", "--unit", "a2rt", "--set", "rt.warps=2", "-o", "one.json")
    alone = json.loads((a2rt.folder / "one.json").read_text(encoding="utf-8"))
    assert found["runs"][0]["time"]["cycles"] == alone["time"]["cycles"]
    assert (a2rt.folder / "v.png").read_bytes().startswith(b"\x89PNG")


def test_a_parameter_of_the_unit_is_refused_and_leaves_nothing(a2rt):
    a2rt.ok("render", "cornell", *SMALL, "--capture", "w.h5", "-o", "w.png")
    words = ("--unit", "a2rt", "--vary", "precision.box_bits=6,8", "-o", "v.json")
    assert "is no parameter of the machine" in a2rt.refused("vary", "w.h5", *words)
