"""Points of the Pareto scatter: every run of a sweep with what it costs and what it gets wrong."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from a2rt_cli import results
from a2rt_cli.results import Result

# Axes of the plot: key -> (words, how to write a value). The first of each is shown at first.
ACCURACY = {
    "redundant": ("redundant hits, share of true misses", "percent"),
    "lost": ("rays whose closest hit is lost", "count"),
    "flip": ("picture error (FLIP)", "small"),
    "rmse": ("picture error (RMSE)", "small"),
}
PRICE = {
    "cycles": ("cycles", "count"),
    "energy": ("energy, pJ", "count"),
    "bytes": ("node bytes asked of L1", "count"),
    "area": ("area of one quantized tester, µm²", "count"),
}


def front(points: Sequence[tuple[float, float]]) -> set[int]:
    """Indices of points that no other beats in both coordinates (smaller is better)."""
    order = sorted(range(len(points)), key=lambda i: points[i])
    found, best = set(), float("inf")
    for index in order:
        if points[index][1] < best:
            found.add(index)
            best = points[index][1]
    return found


def _short(override: str) -> str:
    """ "precision.box_bits=6" as "box_bits 6"."""
    key, _, value = override.partition("=")
    name = key.split(".")[-1]
    return f"{name.replace('_', ' ')} {value.strip(chr(34))}"


def label(one: Result) -> str:
    changes = one.get("overrides", [])
    unit = results.unit_name(one)
    return f"{unit}: {', '.join(map(_short, changes))}" if changes else unit


def _row(one: Result) -> dict[str, Any]:
    picture = one.get("picture") or {}
    redundant = results.redundant_share(one)
    if redundant is None and results.unit_name(one) == results.BASELINE:
        redundant = 0.0  # no quantized test, so none is redundant
    return {
        "workload": results.workload_name(one),
        "unit": results.unit_name(one),
        "label": label(one),
        "default": not one.get("overrides"),
        "redundant": redundant,
        "lost": results.lost_hits(one),
        "flip": picture.get("flip"),
        "rmse": picture.get("rmse"),
        "cycles": results.get(one, "time.cycles"),
        "energy": results.get(one, "energy.total_pj"),
        "bytes": results.node_bytes(one),
        "area": results.get(one, "area.tester.um2"),
        "picture": picture.get("file"),
        "difference": picture.get("difference"),
        "changed": picture.get("changed_pixels"),
        "passes": picture.get("passes"),
    }


def points(found: Sequence[Result]) -> list[dict[str, Any]]:
    """One row a run; None where a run has no such number."""
    return [_row(one) for one in found]


def axes(rows: Sequence[dict[str, Any]]) -> dict[str, dict[str, list[str]]]:
    """The axes that the runs have numbers for: {"x": {key: [words, kind]}, "y": ...}."""

    def present(known: dict[str, tuple[str, str]]) -> dict[str, list[str]]:
        return {
            key: list(words)
            for key, words in known.items()
            if any(row[key] is not None for row in rows)
        }

    return {"x": present(ACCURACY), "y": present(PRICE)}
