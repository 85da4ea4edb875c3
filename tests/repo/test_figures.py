"""The figures' arithmetic: what stands beside the paper's numbers. Numbers here are made up."""

from __future__ import annotations

import pytest
from a2rt_cli import energy_table
from a2rt_cli.engine import core
from a2rt_cli.figures import fig6, fig7, table2


def built(unit: str, tree: float, classify: float, encode: float) -> dict:
    seconds = {"build_seconds": tree, "classify_seconds": classify, "encode_seconds": encode}
    return {"unit": unit, **seconds}


def test_units_of_one_tree_are_charged_the_same_time_for_it():
    # A busy moment met AQB8's first build; it is no property of AQB8.
    measured = [built("aqb8", 9.0, 3.0, 1.0), built("a2rt", 2.0, 0.5, 0.5)]
    measured += [built("aqb8", 2.0, 3.0, 1.0), built("a2rt", 2.0, 0.5, 0.5)]
    one = fig7.build_of("w", measured)
    assert one.tree == 2.0
    assert one.total("aqb8") == 6.0 and one.total("a2rt") == 3.0
    total, tree, own = fig7.build_rows([one])
    assert total["id"] == "fig7a.build" and total["paper"] == 0.3897
    assert total["ours"] == pytest.approx(0.5) and own["ours"] == pytest.approx(0.25)
    assert tree["ours"] == pytest.approx(2.5 / 5)
    text = fig7.build_table([one])
    assert "tree, shared" in text and "aqb8: classify" in text and "a2rt: encode" in text


def test_figure_6_says_which_origin_stands_beside_the_papers_numbers():
    precision = {
        "a2rt": {"origin": "wide", "origin_bits": 10},
        "a2rt-literal": {"origin": "literal", "origin_bits": 8},
    }
    rates = {
        "a2rt": {"redundant": 0.1, "missed_hits": 0},
        "a2rt-literal": {"redundant": 0.3, "missed_hits": 7},
        "aqb8": {"redundant": 0.2, "missed_hits": 5},
    }
    rows = fig6.paper_rows({"precision": precision}, rates)
    said = [(row["unit"], row["what"].split(", ", 1)[1], row["ours"]) for row in rows]
    assert said == [
        ("a2rt-literal", "origin UINT8, as the paper's", pytest.approx(1.5)),
        ("a2rt-literal", "origin UINT8, as the paper's", 7),
        ("a2rt", "origin of 10 bits, signed", pytest.approx(0.5)),
        ("a2rt", "origin of 10 bits, signed", 0),
    ]


def test_table_2_shows_the_tester_that_is_simulated_beside_the_published(monkeypatch):
    rows = energy_table.first_rows()
    published = rows["qbox_a2rt"]
    tester = {"scale": 2.0, "box_bits": 8, "origin_bits": 10, "origin": "wide"}
    tester |= {"area_um2": 2 * published.area_um2, "energy_pj": 2 * published.energy_pj}
    tester |= {"leak_uw": 2 * published.leak_uw, "note": "estimated", "source": "s"}
    monkeypatch.setattr(core, "tester", lambda unit: tester)
    simulated, words = table2._simulated(published)
    shares = {row["what"]: row["ours"] for row in table2._qbox(rows, simulated)}
    area = "Area of the QBOX computing part, A²RT against AQB8"
    assert shares[f"{area}, published row"] == pytest.approx(0.5834, abs=1e-4)
    assert shares[f"{area}, row simulated"] == pytest.approx(2 * 0.5834, abs=1e-3)
    assert "2.00 times the published" in words and "estimated" in words


def test_what_table_2_says_of_its_rows_follows_from_their_notes():
    rows = energy_table.first_rows()
    said = table2._said(rows)
    assert "QBOX, AQB8's QBOX: published" in said and "BOX, ray quantizer, TRI: estimated" in said
    from dataclasses import replace

    changed = {**rows, "triangle": replace(rows["triangle"], note="synthesised")}
    assert "TRI: synthesised, made from our own RTL" in table2._said(changed)
