"""The table of what a scene saves by not needing every effect."""

from __future__ import annotations

from typing import Any

from a2rt_cli import savings_table


def _run(compiled: float, captured: float, simulated: float, stages: int) -> dict[str, Any]:
    return {
        "stages": ["s"] * stages,
        "rays": 10,
        "cycles": 1000,
        "compile_seconds": compiled,
        "capture_seconds": captured,
        "capture_bytes": 4096,
        "simulate_seconds": simulated,
    }


def test_capture_and_simulation_are_also_summed_for_auto_and_all() -> None:
    row = {
        "scene": "cornell",
        "workload": "pt",
        "auto": _run(1, 2, 3, 4),
        "all": _run(3, 6, 4, 8),
        "pictures_identical": True,
        "rays_differ_in": [],
        "results_differ_in": [],
    }
    cells = dict(zip(savings_table.COLUMNS, savings_table.cells(row), strict=True))
    assert cells["stages"] == "4 / 8"
    assert cells["capture s"] == "2.00 / 6.00 (33 %)"
    assert cells["simulate s"] == "3.00 / 4.00 (75 %)"
    assert cells["both s"] == "5.00 / 10.00 (50 %)"
    assert cells["picture"] == "identical"
