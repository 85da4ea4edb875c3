"""What the page shows, as plain data for the template: no HTML here but the charts' SVG."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from a2rt_cli import formats, results, tables
from a2rt_cli.engine.pictures import AMPLIFY
from a2rt_cli.report import charts, measures, words
from a2rt_cli.results import Result

KIND_WORDS = {
    "node": "FP32 nodes",
    "group_node": "group nodes",
    "sub_node": "sub / quantized nodes",
    "anchor": "anchor nodes",
    "triangle": "triangles",
    "aabb": "procedural boxes",
    "instance": "instances",
    "stack": "stack spills",
    "shader": "shader data",
}
MATCH_WORDS = {
    "equal": "equal to the driver's",
    "tie": "tie: same distance, another triangle",
    "tmin_self_hit": "self hit at tmin",
    "edge": "at an edge, within rounding",
    "driver_box_loss": "lost by the driver's own box test",
    "lost": "lost or changed by the unit",
    "other": "unexplained",
}


@dataclass
class Tile:
    value: str
    text: str


@dataclass
class Table:
    columns: list[str]
    rows: list[list[str]]
    note: str = ""


@dataclass
class Shot:
    title: str
    detail: str
    source: str  # data URI
    difference: str = ""


@dataclass
class WorkloadSection:
    name: str
    detail: str
    table: Table
    shots: list[Shot] = field(default_factory=list)
    effects: Table | None = None
    effects_summary: str = ""


def data_uri(path: Path) -> str:
    return "data:image/png;base64," + base64.b64encode(path.read_bytes()).decode("ascii")


def tiles(found: Sequence[Result]) -> list[Tile]:
    """The few numbers that a reader should leave with."""
    out = []
    lost = [one for one in found if measures.pick([one], "a2rt")]
    counts = [results.lost_hits(one) for one in lost]
    if counts and all(value is not None for value in counts):
        rays = sum(int(one["workload"]["rays"]) for one in lost)
        text = f"closest hits lost by A²RT, of {formats.count(rays)} rays"
        out.append(Tile(formats.count(sum(counts)), text))
    for unit, title in (("a2rt", "A²RT"), ("aqb8", "AQB8")):
        share = measures.mean_ratio(found, unit, "baseline", results.node_bytes)
        if share is not None:
            out.append(Tile(formats.percent(share), f"of the baseline's node bytes, {title}"))
    speed = measures.MEASURES["speedup_over_baseline"](found)
    if speed is not None:
        out.append(Tile(formats.factor(speed), "speed of A²RT against the baseline"))
        saved = measures.MEASURES["energy_vs_baseline"](found)
        if saved is not None:
            out.append(Tile(formats.percent(saved), "of the baseline's energy, A²RT"))
    return out


def paper_table(found: Sequence[Result]) -> Table:
    rows = []
    for number in measures.paper_numbers():
        value = measures.ours(number, found)
        mine = formats.of_kind(value, number.kind)
        if value is None:
            mine = "not measured here"
        rows.append([number.what, number.paper_text(), mine, number.source])
    note = (
        "The paper's numbers are averages over its own scenes and machine; ours are geometric "
        "means over the workloads of this page. Nothing is tuned to meet the paper."
    )
    return Table(["quantity", "paper", "ours", "where in the paper"], rows, note)


def match_table(found: Sequence[Result]) -> Table | None:
    """How each unit's closest hits compare with the driver's, by category."""
    categories = [key for key in MATCH_WORDS if any(key in _match(one) for one in found)]
    extra = {key for one in found for key in _match(one)} - set(MATCH_WORDS)
    categories += sorted(extra)
    if not categories:
        return None
    columns = ["workload", "unit", *[MATCH_WORDS.get(key, key) for key in categories]]
    rows = [
        [
            results.workload_name(one),
            results.label(one),
            *[formats.count(_match(one).get(key)) for key in categories],
        ]
        for one in found
    ]
    return Table(columns, rows)


def _match(result: Result) -> dict[str, int]:
    return result.get("driver_match") or {}


def accuracy_table(found: Sequence[Result]) -> Table | None:
    audited = [one for one in found if results.get(one, "accuracy.audited_rays")]
    if not audited:
        return None
    columns = ["workload", "unit", "audited rays", "quantized tests", "redundant", "share"]
    columns += ["missed", "escapes", "by what"]
    rows = []
    for one in audited:
        mechanisms = results.get(one, "accuracy.by_mechanism", {})
        named = ", ".join(f"{name} {count:,}" for name, count in mechanisms.items() if count)
        rows.append(
            [
                results.workload_name(one),
                results.label(one),
                formats.count(results.get(one, "accuracy.audited_rays")),
                formats.count(results.get(one, "accuracy.qbox_tests")),
                formats.count(results.get(one, "accuracy.redundant_hits")),
                formats.percent(results.redundant_share(one), 2),
                formats.count(results.get(one, "accuracy.missed_hits")),
                formats.count(results.get(one, "accuracy.escapes")),
                named or formats.NOTHING,
            ]
        )
    note = (
        "Every box decision of the audited rays is compared with exact rational arithmetic. "
        "Redundant: the unit enters a box the ray misses (costs time). Missed: it skips a box the "
        "ray meets (can cost the picture). Share: redundant hits per box that is truly missed."
    )
    return Table(columns, rows, note)


def traffic_chart(found: Sequence[Result]) -> tuple[str, str] | None:
    """(legend, SVG) of the bytes each unit asks of L1, by kind of data."""
    kinds = [
        kind
        for kind in KIND_WORDS
        if any(results.get(one, f"memory.by_kind.{kind}.bytes", 0) for one in found)
    ]
    if not kinds:
        return None
    colours = charts.series_colours([KIND_WORDS[kind] for kind in kinds])
    bars = [
        charts.Bar(
            results.workload_name(one),
            results.label(one),
            {
                KIND_WORDS[kind]: results.get(one, f"memory.by_kind.{kind}.bytes", 0)
                for kind in kinds
            },
        )
        for one in found
        if results.get(one, "memory.by_kind")
    ]
    chart = charts.stacked(bars, colours, formats.size, "Bytes asked of the L1 cache")
    return charts.legend(colours), chart


def parts_chart(found: Sequence[Result], dotted: str, write, title: str):
    """(legend, SVG) of a breakdown such as energy.by_component; None if no run has it."""
    have = [one for one in found if results.get(one, dotted)]
    if not have:
        return None
    names = list(dict.fromkeys(name for one in have for name in results.get(one, dotted)))
    colours = charts.series_colours([name.replace("_", " ") for name in names])
    bars = [
        charts.Bar(
            results.workload_name(one),
            results.label(one),
            {name.replace("_", " "): results.get(one, dotted).get(name, 0) for name in names},
        )
        for one in have
    ]
    return charts.legend(colours), charts.stacked(bars, colours, write, title)


def workload_sections(
    found: Sequence[Result], folder: Path, effects: dict[str, Any]
) -> list[WorkloadSection]:
    return [
        _workload_section(name, group, folder, effects.get(name))
        for name, group in results.by_workload(found).items()
    ]


def _workload_section(
    name: str, group: Sequence[Result], folder: Path, effects: dict[str, Any] | None
) -> WorkloadSection:
    workload = group[0]["workload"]
    numbers = [
        (workload.get("rays"), "rays"),
        (workload.get("triangles"), "triangles"),
        (workload.get("aabbs"), "procedural boxes"),
        (workload.get("instances"), "instances"),
    ]
    detail = ", ".join(f"{formats.count(n)} {what}" for n, what in numbers if n)
    if workload.get("workload"):
        detail += f"; shaders: {workload['workload']}"
    section = WorkloadSection(
        name, detail, Table(tables.columns_of(group), tables.rows_of(group)), _shots(group, folder)
    )
    if effects:
        section.effects, section.effects_summary = effects_table(effects)
    return section


def _shots(group: Sequence[Result], folder: Path) -> list[Shot]:
    name = results.workload_name(group[0])
    driver = folder / "pictures" / f"{name}.driver.png"
    if not driver.is_file():
        return []
    shots = [Shot("driver", "lavapipe's own picture", data_uri(driver))]
    for one in group:
        picture = one.get("picture")
        if not picture or not (folder / picture["file"]).is_file():
            continue
        changed = picture["changed_pixels"]
        detail = "the same picture"
        difference = ""
        if changed:
            detail = f"{changed:,} of {picture['pixels']:,} pixels differ"
            difference = data_uri(folder / picture["difference"])
        detail += f", {picture['passes']} pass{'es' if picture['passes'] > 1 else ''}"
        shots.append(
            Shot(results.label(one), detail, data_uri(folder / picture["file"]), difference)
        )
    return shots


def effects_table(effects: dict[str, Any]) -> tuple[Table, str]:
    """What the scene calls for, and what was left out because it does not."""
    rows, left_out = [], []
    for effect in effects.get("effects", []):
        needed = effect.get("needed")
        by = ", ".join(effect.get("called_for_by", [])) or formats.NOTHING
        if not needed:
            left_out.append(effect["name"])
        rows.append(
            [
                effect["name"],
                "yes" if effect.get("built", needed) else "left out",
                _cut(by),
                effect.get("rays") or formats.NOTHING,
                ", ".join(effect.get("stages", [])) or formats.NOTHING,
                effect.get("part") or formats.NOTHING,
            ]
        )
    summary = (
        f"This scene did not need: {', '.join(left_out)}." if left_out else "Every effect is used."
    )
    return Table(["effect", "built", "called for by", "rays", "stages", "part"], rows), summary


def _cut(text: str, most: int = 90) -> str:
    return text if len(text) <= most else text[: most - 1] + "…"


def provenance(found: Sequence[Result]) -> Table:
    rows = []
    for one in found:
        origin = one.get("provenance", {})
        rows.append(
            [
                results.workload_name(one),
                results.label(one),
                str(origin.get("version", formats.NOTHING)),
                str(origin.get("workload_key", ""))[:16] or formats.NOTHING,
                str(origin.get("command", formats.NOTHING)),
            ]
        )
    note = "The key is the hash of everything that decides the workload: scene, options, programs."
    return Table(["workload", "unit", "version", "workload key", "engine command"], rows, note)


def everything(found: Sequence[Result], folder: Path, effects: dict[str, Any]) -> dict[str, Any]:
    return {
        "summary": words.summary(found),
        "tiles": tiles(found),
        "workloads": workload_sections(found, folder, effects),
        "match": match_table(found),
        "accuracy": accuracy_table(found),
        "traffic": traffic_chart(found),
        "cycles": parts_chart(found, "time.by_part", lambda v: f"{v:,.0f}", "Cycles by part"),
        "energy": parts_chart(found, "energy.by_component", formats.energy, "Energy by part"),
        "timed": any(results.get(one, "time.cycles") is not None for one in found),
        "paper": paper_table(found),
        "provenance": provenance(found),
        "command": next((one["provenance"].get("a2rt", "") for one in found), ""),
        "amplify": AMPLIFY,
    }
