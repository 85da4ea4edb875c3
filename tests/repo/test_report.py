"""The report's arithmetic: shares, comparisons, axes. Numbers here are made up and checkable."""

from __future__ import annotations

import re

import pytest
from a2rt_cli import results, tables
from a2rt_cli.report import measures, plots, stalls


def run(unit: str, cycles: int, comparison: str = "same-count", **more) -> dict:
    mark = results.AREA_MARK if comparison == "same-area" else ""
    return {
        "workload": {"name": "w", "rays": 1},
        "unit": {"name": unit},
        "label": unit + mark,
        "functional": comparison == "same-count",
        "gpu": {"comparison": comparison},
        "time": {"cycles": cycles},
        "energy": {"total_pj": cycles / 2},
        "area": {"box_testers_um2": 5.0, "reference_um2": 5.0},
        **more,
    }


@pytest.fixture
def both() -> list[dict]:
    return [
        run("baseline", 100),
        run("aqb8", 80),
        run("a2rt", 50),
        run("baseline", 200, "same-area"),
        run("aqb8", 90, "same-area"),
    ]


def test_each_comparison_takes_its_own_runs_and_a2rt_counts_in_both(both):
    count = measures.ratios(both, "a2rt", "baseline", measures.cycles)
    area = measures.ratios(both, "a2rt", "baseline", measures.cycles, results.SAME_AREA)
    assert count == {"w": 0.5} and area == {"w": 0.25}
    assert measures.ratios(both, "aqb8", "baseline", measures.cycles, results.SAME_AREA) == {
        "w": 0.45
    }


def test_the_tables_show_one_row_per_unit_and_comparison(both):
    assert [row[0] for row in tables.accuracy_rows(both)] == ["baseline", "aqb8", "a2rt"]
    rows = tables.time_rows(both, results.SAME_AREA)
    assert [row[:3] for row in rows] == [
        ["baseline", "200", "1.00×"],
        ["aqb8", "90", "2.22×"],
        ["a2rt", "50", "4.00×"],
    ]


def test_a_unit_that_takes_more_area_than_a2rt_is_no_run_of_the_same_area():
    large = run("a2rt", 50, area={"box_testers_um2": 6.0, "reference_um2": 5.0})
    assert not results.in_comparison(large, results.SAME_AREA)


def test_shares_of_stalls_add_up_to_one_and_gather_reasons():
    reasons = {"test": 10, "bank_busy": 20, "mshr_full": 20, "wait_memory": 30, "idle": 20}
    one = run("a2rt", 100, time={"cycles": 100, "stalls": {"rt_unit": reasons}, "testers": {}})
    found = stalls.shares(one, "rt_unit")
    assert sum(found.values()) == pytest.approx(1)
    assert found["turned away by L1"] == pytest.approx(0.4)
    bound = stalls.bound(one)
    assert bound.what == "turned away by L1" and bound.share == pytest.approx(0.5)
    assert bound.testing == pytest.approx(0.125) and bound.idle == pytest.approx(0.2)


def test_a_run_without_cycles_has_no_bound():
    assert stalls.bound_words({"unit": {"name": "a2rt"}}) == "–"


@pytest.mark.parametrize("most", [0.03, 0.9, 1, 7, 31.9, 32, 999, 271_246])
def test_axes_have_round_steps_and_hold_the_largest_value(most):
    ticks = plots.nice_ticks(most)
    assert ticks[0] == 0 and most <= ticks[-1] <= 2.6 * most
    assert 3 <= len(ticks) <= 9


def test_a_histogram_draws_one_column_a_share():
    svg = plots.histogram(["1", "2"], {"a2rt": [0.25, 0.75], "aqb8": [1.0, 0.0]}, "t", "x")
    heights = [float(h) for h in re.findall(r'height="([\d.]+)" fill', svg)]
    assert heights[1] == pytest.approx(3 * heights[0], rel=0.01)
    assert "a2rt: 75.0%" in svg
