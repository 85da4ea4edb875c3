"""The report's arithmetic: shares, comparisons, axes. Numbers here are made up and checkable."""

from __future__ import annotations

import re

import pytest
from a2rt_cli import results, tables
from a2rt_cli.figures import fig8
from a2rt_cli.report import charts, gap, measures, plots, sections, stalls, words


def run(unit: str, cycles: int, comparison: str = "same-count", **more) -> dict:
    area = comparison == results.SAME_AREA
    mark = results.AREA_MARK if area else ""
    return {
        "workload": {"name": "w", "rays": 1},
        "unit": {"name": unit},
        "label": unit + mark,
        "functional": not area,
        "gpu": {"comparison": comparison},
        "time": {"cycles": cycles},
        "energy": {"total_pj": cycles / 2},
        "area": {"box_testers_um2": 5.0 if area or unit == "a2rt" else 9.0, "reference_um2": 5.0},
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


SAMPLE = {"fraction": 0.1, "cycles": 1000, "cycles_low": 900, "cycles_high": 1100}


def test_a_samples_cycles_are_extrapolated_marked_and_its_energy_is_blank(both):
    sampled = [{**one, "sample": SAMPLE} for one in both if one["functional"]]
    assert [measures.cycles(one) for one in sampled] == [1000] * 3
    assert tables.time_columns(sampled)[:3] == [
        "unit",
        "cycles, extrapolated",
        "speedup, extrapolated",
    ]
    assert tables.time_rows(sampled, results.SAME_COUNT)[0][:4] == [
        "baseline",
        "1,000",
        "1.00×",
        "–",
    ]
    said = words.summary(sampled)
    assert words.SAMPLED in said and not any(
        "energy" in one for one in said if one != words.SAMPLED
    )
    assert any("extrapolated" in tile.text for tile in sections.tiles(sampled))
    # A sample that was refused is a full run.
    whole = {**both[0], "sample": {"fraction": 1.0, "cycles": 100}}
    assert measures.energy(whole) == 50 and tables.time_columns([whole])[1] == "cycles"


def ours_of(found: list[dict]) -> dict[str, str]:
    return {row[0]: row[2] for row in sections.paper_table(found).rows}


def test_a_variant_stands_for_its_unit_and_the_page_says_so(both):
    changed = [
        run("baseline", 100),
        {**run("a2rt", 40), "label": "a2rt precision.box_bits=6"},
    ]
    assert ours_of(changed)["Speedup of A²RT over the baseline"] == "2.50×"
    assert "a2rt precision.box_bits=6" in sections.paper_table(changed).note
    assert any(
        "a2rt precision.box_bits=6 is 2.50 times as fast" in one for one in words.summary(changed)
    )
    assert any("a2rt precision.box_bits=6" in tile.text for tile in sections.tiles(changed))
    # Beside the unit as configured, a variant is only itself; of several, none stands for the unit.
    assert measures.pick([*both, changed[1]], "a2rt") == both[2]
    other = {**changed[1], "label": "a2rt precision.box_bits=5"}
    assert measures.pick([*changed, other], "a2rt") is None


def test_runs_of_the_same_area_alone_fill_the_whole_page():
    found = [
        {**run(unit, n, "same-area"), "functional": True}
        for unit, n in (("baseline", 200), ("a2rt", 50))
    ]
    assert ours_of(found)["Speedup of A²RT over the baseline"] == "4.00×"
    assert "in the same area" in sections.paper_table(found).note
    assert any(
        "with testers of the same area it is 4.00 times" in one for one in words.summary(found)
    )
    assert any("same area" in tile.text for tile in sections.tiles(found))


def with_loss(lost: dict[str, int]) -> list[dict]:
    """Workload "kept" where nobody loses a hit, and "w" where units lose as many as said."""
    speeds = {"baseline": 100, "aqb8": 50, "a2rt": 50}
    match = {unit: {"driver_match": {"lost": lost.get(unit, 0)}} for unit in speeds}
    found = [run(unit, n, **match[unit]) for unit, n in speeds.items()]
    kept = {"workload": {"name": "kept", "rays": 1}, "driver_match": {"lost": 0}}
    return found + [run(unit, 100, **kept) for unit in speeds]


def test_a_speedup_that_counts_lost_hits_stands_beside_one_that_does_not():
    found = with_loss({"aqb8": 3})
    assert any(
        "is 1.41 times as fast (is 1.00 times as fast where neither" in s
        for s in words.summary(found)
    )
    text = fig8._table(found)
    assert re.search(r"w +aqb8 +3 ", text) and re.search(
        r"no lost hits: 1 of 2 +aqb8 .* 1\.00×", text
    )
    assert re.search(r"no lost hits: 2 of 2 +a2rt .* 1\.41×", text)
    rows = fig8._paper_rows(found)
    over = {row["what"]: row["ours"] for row in rows if row["id"] == "fig8.speedup_aqb8"}
    assert over[
        "Speedup of A²RT over AQB8, same number, where neither loses a hit (1 of 2)"
    ] == pytest.approx(1)
    assert not any("neither" in tile.text for tile in sections.tiles(found))
    assert any("neither" in tile.text for tile in sections.tiles(with_loss({"a2rt": 1})))


def test_the_papers_means_of_figure_8_are_the_numbers_it_prints():
    means = fig8.paper_means()
    assert means["speedup"] == {"baseline": 1.0, "aqb8": pytest.approx(2.29 / 1.57), "a2rt": 2.29}
    assert means["energy"]["aqb8"] == pytest.approx(0.4551 / 0.8179)


def test_rays_whose_hit_is_unknown_are_not_among_those_compared():
    one = run("a2rt", 1, driver_match={"equal": 6, "unknown": 4, "lost": 0})
    one["workload"]["rays"] = 10
    (said,) = words.accuracy_sentences([one])
    assert "on 6 rays" in said and "4 more rays" in said


def test_numbers_of_random_boxes_are_not_on_pages_of_scenes(both):
    table = sections.paper_table(both)
    assert not any("Missed hits" in row[0] or "Fig. 6" in row[-1] for row in table.rows)
    means = {row[0]: row[3] for row in table.rows}
    assert means["Speedup of A²RT over the baseline"] == "geometric mean"
    assert means["BVH data, share of the L1 data cache"] == "arithmetic mean"
    assert "with the same number of box testers" in table.note


def test_the_bound_of_free_testers_is_that_of_the_run_that_tests_most():
    def timed(name: str, test: int) -> dict:
        reasons = {"test": test, "wait_memory": 100 - test}
        time = {"cycles": 100, "stalls": {"rt_unit": reasons}, "testers": {}}
        return run("a2rt", 100, time=time, workload={"name": name, "rays": 1})

    said = gap.sentences([timed("one", 10), timed("two", 50)])[0]
    assert "30 %" in said and "50 %, would be 2.00 times as fast" in said


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


def test_a_unit_without_a_colour_of_its_own_never_has_anothers():
    others = {charts.unit_colour("mine", index) for index in range(20)}
    assert others.isdisjoint(charts.UNIT_COLOURS.values()) and len(others) == 8
    assert fig8._colour(["mine", "a2rt"], "mine") != fig8._colour(["mine", "a2rt"], "a2rt")
