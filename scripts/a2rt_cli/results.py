"""Result objects (schema/result.schema.json): reading them and the numbers people ask for."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from a2rt_cli.errors import UserError

Result = dict[str, Any]
SCHEMA_VERSION = 1
# Kinds of memory traffic that are box nodes of the tree, whatever the unit calls them.
NODE_KINDS = ("node", "group_node", "sub_node", "anchor")
BASELINE = "baseline"
# The two fair comparisons: equal numbers of box testers, or as many as fit into A2RT's area.
SAME_COUNT, SAME_AREA = "same-count", "same-area"
AREA_MARK = " (same area)"


def load(folder: Path) -> list[Result]:
    """The results of a comparison."""
    path = folder / "results.json"
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except (FileNotFoundError, NotADirectoryError):
        raise UserError(
            f"{folder}: no results.json there", "name a folder that `a2rt compare -o` wrote"
        ) from None
    except ValueError as error:
        raise UserError(f"{path}: not JSON ({error})", "run the comparison again") from error
    if not isinstance(found, list) or not all(isinstance(one, dict) for one in found):
        raise UserError(f"{path}: not a list of results", "run the comparison again")
    for one in found:
        if one.get("schema") != SCHEMA_VERSION:
            raise UserError(
                f"{path}: schema {one.get('schema')}, this a2rt reads {SCHEMA_VERSION}",
                "run the comparison again",
            )
    return found


def flatten(value: dict[str, Any], prefix: str = "") -> dict[str, Any]:
    out: dict[str, Any] = {}
    for key, item in value.items():
        name = f"{prefix}{key}"
        if isinstance(item, dict):
            out.update(flatten(item, f"{name}."))
        elif not isinstance(item, list):
            out[name] = item
    return out


def get(result: Result, dotted: str, default: Any = None) -> Any:
    """`get(r, "time.cycles")`; None and missing levels give `default`."""
    value: Any = result
    for key in dotted.split("."):
        if not isinstance(value, dict) or value.get(key) is None:
            return default
        value = value[key]
    return value


def unit_name(result: Result) -> str:
    return result["unit"]["name"]


def label(result: Result) -> str:
    return result.get("label") or unit_name(result)


def workload_name(result: Result) -> str:
    workload = result["workload"]
    return workload.get("name") or workload.get("scene") or workload.get("file") or "workload"


def primary(found: Sequence[Result]) -> list[Result]:
    """Without the second simulations of a unit (same area), which say nothing of accuracy."""
    return [one for one in found if one.get("functional", True)]


def is_timed(result: Result) -> bool:
    return get(result, "time.cycles") is not None


def has_area_of_a2rt(result: Result) -> bool:
    """True if the run's testers take the area of the configured A2RT's: it counts in both."""
    area, reference = (
        get(result, "area.box_testers_um2"),
        get(result, "area.reference_um2"),
    )
    return area is not None and reference is not None and math.isclose(area, reference)


def in_comparison(result: Result, comparison: str) -> bool:
    """Whether a run belongs to `same-count` or `same-area`; A2RT, the reference, to both."""
    made_for = get(result, "gpu.comparison", SAME_COUNT)
    if comparison == SAME_COUNT:
        return made_for != SAME_AREA
    return made_for == SAME_AREA or has_area_of_a2rt(result)


def of_comparison(found: Sequence[Result], comparison: str) -> list[Result]:
    return [one for one in found if in_comparison(one, comparison)]


def plain_label(result: Result) -> str:
    """The label without the mark of the second comparison."""
    return label(result).removesuffix(AREA_MARK)


def by_workload(found: Sequence[Result]) -> dict[str, list[Result]]:
    """Results grouped by workload, in order of first appearance."""
    groups: dict[str, list[Result]] = {}
    for result in found:
        groups.setdefault(workload_name(result), []).append(result)
    return groups


def baseline_of(group: Sequence[Result]) -> Result | None:
    return next((one for one in group if unit_name(one) == BASELINE), None)


def node_bytes(result: Result) -> int | None:
    kinds = get(result, "memory.by_kind")
    if kinds is None:
        return None
    return sum(int(kinds.get(kind, {}).get("bytes", 0)) for kind in NODE_KINDS)


def tree_bytes(result: Result) -> int | None:
    """Everything the unit asks of L1: nodes, triangles, boxes, instances, spilled stack."""
    kinds = get(result, "memory.by_kind")
    if kinds is None:
        return None
    return sum(int(kind.get("bytes", 0)) for name, kind in kinds.items() if name != "shader")


def ratio(value: float | None, base: float | None) -> float | None:
    if value is None or not base:
        return None
    return value / base


def lost_hits(result: Result) -> int | None:
    return get(result, "accuracy.lost_closest_hits", get(result, "driver_match.lost"))


def redundant_share(result: Result) -> float | None:
    """Redundant hits per quantized test whose exact box is missed, from the audited rays."""
    redundant = get(result, "accuracy.redundant_hits")
    tests = get(result, "accuracy.decided")
    exact = get(result, "accuracy.exact_hits")
    if redundant is None or not tests:
        return None
    misses = tests - (exact or 0)
    return redundant / misses if misses > 0 else None
