"""The page on hard cases and the table on robustness, from numbers made up here."""

from __future__ import annotations

import pytest
from a2rt_cli.figures import robustness
from a2rt_cli.report import numerics

UNITS = [
    {
        "key": "a2rt_wide",
        "title": "A²RT, wide",
        "unit": "a2rt",
        "config": "",
        "promises": True,
    },
    {
        "key": "aqb8_floor",
        "title": "AQB8, floor",
        "unit": "aqb8",
        "config": "",
        "promises": False,
    },
]


def cell(unit: str, verdict: str, **counts) -> dict:
    zero = {
        "rays": 100,
        "box_tests": 5,
        "qbox_tests": 500,
        "exact_hits": 200,
        "redundant": 0,
    }
    zero |= {"missed": 0, "lost": 0, "rounding_ties": 0, "escapes": 0}
    zero |= {"mechanisms": {}, "lost_by_mechanism": {}}
    return {"case": "flat", "unit": unit, "verdict": verdict, **zero, **counts}


def leak(unit: str, leaked: int) -> dict:
    counts = {"rays": 50, "hits": 50, "leaked": leaked, "farther": 0, "missed": 0}
    return {"mesh": "cube", "title": "Cube", "unit": unit, **counts}


@pytest.fixture
def found() -> dict:
    row = {"design": "a2rt wide", "promises": True, "dimension": "", "kind": "all"}
    row |= {"tests": 10, "exact_hits": 4, "missed": 0, "group_missed": 0, "escaped": 1}
    row |= {
        "escaped_missed": 0,
        "redundant": 2,
        "found_share": 1.0,
        "redundant_share": 0.25,
    }
    near = {"exponent": -17, "rays": 9, "study_percent": 5}
    near |= {"floor_percent": 7.6, "nearest_percent": 7.6}
    error = {
        "k": "0",
        "path": "tmin",
        "carry": "0",
        "worst_relative": "0",
        "mean_relative": "0",
    }
    error |= {"worst_relative_rounded": "0.0078", "mean_relative_rounded": "0.0026"}
    view = {
        "key": "v",
        "unit": "aqb8_floor",
        "title": "View",
        "what": "A dot.",
        "side": 2,
    }
    view |= {"hit_pixels": 2, "lost": 1, "farther": 0, "mechanism": "why"}
    view |= {"lost_by_mechanism": {"why": 1}}
    view |= {"shade": ["ff00", "ff00"], "kind": ["L.", ".."]}
    return {
        "units": UNITS,
        "cases": [
            {
                "key": "flat",
                "group": "Extents",
                "title": "Flat <groups>",
                "what": "Grids.",
            }
        ],
        "cells": [
            cell("a2rt_wide", "conservative", redundant=7, escapes=3),
            cell("aqb8_floor", "misses", missed=11, lost=4, mechanisms={"why": 11}),
        ],
        "watertight": [leak("a2rt_wide", 0), leak("aqb8_floor", 6)],
        "views": [view],
        "strata": {"rows": [row], "near_axis": [near]},
        "multiplier": {"compress": [error], "drop": [error]},
    }


def test_a_missing_cell_shows_counts_and_the_letter_of_its_mechanism(found):
    (row,) = numerics.matrix(found)
    kept, lost = row.cells
    assert (kept.symbol, kept.words, kept.escapes) == ("≥", "+7", "3 escapes")
    assert (lost.symbol, lost.words, lost.letters) == ("✕", "11 / 4", "a")
    assert numerics.mechanisms(found) == {"why": "a"}


def test_the_summary_tells_promises_from_failures(found):
    sentences = numerics.summary(found)
    assert "missed 0 boxes or rays in 1 hard cases" in sentences[0]
    assert "AQB8, floor misses in 1 of 1 cases: 4 of 100 rays" in sentences[1]
    assert "0 leak" in sentences[-1]


def test_the_page_is_self_contained_and_escapes_what_it_shows(found, tmp_path):
    numerics.write_pictures(found, tmp_path)
    text = numerics.write(found, tmp_path).read_text(encoding="utf-8")
    assert "Flat &lt;groups&gt;" in text
    assert "<b>a</b> <b>View</b>" in text  # the letter that the table of hard cases uses
    assert "data:image/png;base64," in text
    assert 'src="http' not in text and "<link" not in text
    assert numerics.link(tmp_path)[0] == "numerics.html"


def test_a_report_without_the_page_has_no_link(tmp_path):
    assert numerics.link(tmp_path) is None


def test_lost_pixels_are_orange(found):
    pixels = numerics._pixels(found["views"][0])
    assert tuple(pixels[0, 0]) == (213, 94, 0)
    assert pixels[1, 0, 0] == pixels[1, 0, 1] == pixels[1, 0, 2]


def cost(missed: int = 0, tests: int = 1000, escapes: int = 0) -> robustness.Cost:
    return robustness.Cost(missed, missed, 5, 100, tests, escapes, 1000)


def test_the_default_is_the_cheapest_design_that_promises_every_hit():
    total = {"wide": cost(tests=1010), "guard": cost(tests=1005, escapes=9)}
    words = robustness.verdict({**total, "literal": cost()})
    assert "wide costs least: it is the default" in words


def test_the_table_says_so_if_its_costs_speak_against_the_default():
    total = {"wide": cost(tests=1010, escapes=9), "guard": cost(tests=1005)}
    words = robustness.verdict({**total, "literal": cost(missed=3)})
    assert "guard costs least, but the default of a2rt is wide" in words


def test_a_design_that_missed_is_no_candidate():
    total = {"wide": cost(missed=1), "guard": cost(missed=2), "literal": cost()}
    assert "No design" in robustness.verdict(total)


def test_the_default_named_here_is_the_units():
    import tomllib

    from a2rt_cli.paths import CONFIGS

    unit = tomllib.loads((CONFIGS / "units" / "a2rt.toml").read_text(encoding="utf-8"))
    assert unit["precision"]["origin"] == robustness.DEFAULT
