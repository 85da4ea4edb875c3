"""What the page shows, as plain data for the template: no HTML here but the charts' SVG."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from a2rt_cli import formats, results, tables
from a2rt_cli.engine.pictures import AMPLIFY
from a2rt_cli.report import charts, extras, measures, time_spent, words
from a2rt_cli.report.table import Table
from a2rt_cli.results import Result

MATCH_NOTE = (
    "Tie: same distance, another primitive. Tmin self-hit: the ray starts on the surface it hits. "
    "Edge: within rounding of a triangle's edge. Driver's box loss: lavapipe's own box test at a "
    "box's corner skips the hit. Unknown: the program does not look at this hit, so the capture "
    "has none. Lost: none of these, and the unit has no hit, or a farther one. Other: none of "
    "these, and the unit has a nearer hit."
)


@dataclass
class Tile:
    value: str
    text: str


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
    times: list[tuple[str, Table]] = field(default_factory=list)  # per comparison
    note: str = ""
    shots: list[Shot] = field(default_factory=list)
    effects: Table | None = None
    effects_summary: str = ""


def data_uri(path: Path) -> str:
    return "data:image/png;base64," + base64.b64encode(path.read_bytes()).decode("ascii")


def tiles(found: Sequence[Result]) -> list[Tile]:
    """The few numbers that a reader should leave with."""
    a2rt = _called(found, "a2rt", "A²RT")
    out = []
    lost = measures.runs_of(results.primary(found), "a2rt")
    counts = [results.lost_hits(one) for one in lost]
    if counts and all(value is not None for value in counts):
        rays = sum(measures.compared_rays(one) for one in lost)
        text = f"of the driver's hits lost by {a2rt}, on {formats.count(rays)} rays"
        out.append(Tile(formats.count(sum(counts)), text))
    for unit, title in (("a2rt", a2rt), ("aqb8", _called(found, "aqb8", "AQB8"))):
        share = measures.mean_ratio(found, unit, "baseline", results.node_bytes)
        if share is not None:
            out.append(Tile(formats.percent(share), f"of the baseline's node bytes, {title}"))
    return out + _speed_tiles(found, a2rt)


def _called(found: Sequence[Result], unit: str, title: str) -> str:
    """The unit's name, or the label of the variant that stands for it."""
    return next(iter(measures.variants(found, [unit])), title)


def _speed_tiles(found: Sequence[Result], a2rt: str) -> list[Tile]:
    def mean(among: Sequence[Result], value: Any) -> float | None:
        return measures.mean_ratio(among, "a2rt", "baseline", value)

    out = []
    area = measures.main_comparison(found) == results.SAME_AREA
    text = f"speed of {a2rt} against the baseline" + (", same area of testers" if area else "")
    text += ", extrapolated" if any(measures.is_sampled(one) for one in found) else ""
    faithful = measures.without_losses(found, ["a2rt", "baseline"])
    cycles, energy = mean(found, measures.cycles), mean(found, measures.energy)
    if cycles:
        out.append(Tile(formats.factor(1 / cycles), text))
        kept = mean(faithful, measures.cycles) if len(faithful) < len(found) else None
        if kept:
            out.append(Tile(formats.factor(1 / kept), f"{text}, where neither loses a hit"))
    if energy:
        out.append(Tile(formats.percent(energy), f"of the baseline's energy, {a2rt}"))
    return out


def paper_table(found: Sequence[Result]) -> Table:
    rows = []
    for number in measures.paper_numbers():
        if not number.ours:
            continue  # its own figure measures it, on something else than the scenes of a page
        value = measures.ours(number, found)
        mine = formats.of_kind(value, number.kind)
        if value is None:
            mine = "not measured here"
        rows.append([number.what, number.paper_text(), mine, measures.how(number), number.source])
    area = measures.main_comparison(found) == results.SAME_AREA
    note = (
        "The paper's numbers are averages over its own scenes and machine; ours are means over "
        "the workloads of this page, as each row says: geometric of ratios, arithmetic of shares. "
        f"All are taken {'in the same area' if area else 'with the same number'} of box testers. "
        "Nothing is tuned to meet the paper."
    )
    changed = measures.variants(found, ("baseline", "aqb8", "a2rt"))
    if changed:
        note += f" Not the units as configured, but: {', '.join(changed)}."
    return Table(["quantity", "paper", "ours", "ours is", "where in the paper"], rows, note)


def match_table(found: Sequence[Result]) -> Table | None:
    """How each unit's closest hits compare with the driver's, by category."""
    keys = tables.match_keys(found)
    if not keys:
        return None
    columns = ["workload", "unit", *[tables.MATCH_COLUMNS.get(key, key) for key in keys]]
    rows = [
        [
            results.workload_name(one),
            results.label(one),
            *[formats.count((one.get("driver_match") or {}).get(key)) for key in keys],
        ]
        for one in found
    ]
    return Table(columns, rows, MATCH_NOTE)


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
    asked = {kind for one in found for kind in results.get(one, "memory.by_kind", {})}
    kinds = [
        kind
        for kind in [*time_spent.TRAFFIC, *sorted(asked - set(time_spent.TRAFFIC))]
        if any(results.get(one, f"memory.by_kind.{kind}.bytes", 0) for one in found)
    ]
    if not kinds:
        return None
    named = {kind: time_spent.kind_words(kind) for kind in kinds}
    bars = [
        charts.Bar(
            results.workload_name(one),
            results.label(one),
            {named[kind][0]: results.get(one, f"memory.by_kind.{kind}.bytes", 0) for kind in kinds},
        )
        for one in found
        if results.get(one, "memory.by_kind")
    ]
    colours = dict(named.values())
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


def energy_bands(found: Sequence[Result]) -> Table | None:
    """The ledger's low and high sums, and how much of the middle rests on estimated rows."""
    rows = []
    for one in found:
        total = results.get(one, "energy.total_pj")
        if total:
            notes = results.get(one, "energy.by_note", {})
            dynamic = sum(notes.values()) or None
            rows.append(
                [
                    results.workload_name(one),
                    results.label(one),
                    *[formats.energy(results.get(one, f"energy.{k}_pj")) for k in ("low", "high")],
                    formats.energy(total),
                    formats.percent(results.ratio(results.get(one, "energy.leakage_pj"), total)),
                    formats.percent(results.ratio(notes.get("estimated", 0.0), dynamic)),
                ]
            )
    if not rows:
        return None
    columns = ["workload", "unit", "low", "high", "middle", "leakage", "dynamic from estimates"]
    note = (
        "Low and high take every row of the energy table at its lower and upper bound. The last "
        "column is the share of the dynamic energy whose row is an estimate, not a published "
        "number; a2rt_core/energy_tables/SOURCES.md says how each was made."
    )
    return Table(columns, rows, note)


def sample_table(found: Sequence[Result]) -> Table | None:
    """Runs whose cycles were extrapolated from a part of the warps."""
    rows = tables.sample_rows(found)
    return Table(tables.SAMPLE_COLUMNS, rows, tables.SAMPLE_NOTE) if rows else None


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
    gpu = group[0].get("gpu")
    if gpu:
        detail += f"; machine: {', '.join([gpu['name'], *gpu.get('changes', [])])}"
    section = WorkloadSection(
        name,
        detail,
        Table(tables.ACCURACY_COLUMNS, tables.accuracy_rows(group)),
        [
            (
                tables.COMPARISON_WORDS[one],
                Table(tables.time_columns(group), tables.time_rows(group, one)),
            )
            for one in tables.comparisons_of(group)
        ],
        workload.get("note", ""),
        _shots(results.primary(group), folder),
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
    main = results.primary(found)
    whole = [one for one in main if not measures.is_sampled(one)]
    return {
        "summary": words.summary(found),
        "tiles": tiles(found),
        "workloads": workload_sections(found, folder, effects),
        "match": match_table(main),
        "accuracy": accuracy_table(main),
        "traffic": traffic_chart(main),
        "time": time_spent.sections(found, folder),
        "energy": parts_chart(whole, "energy.by_component", formats.energy, "Energy by part"),
        "energy_bands": energy_bands(whole),
        "samples": sample_table(main),
        "sampled": words.SAMPLED if len(whole) < len(main) else "",
        "lost_note": tables.LOST_NOTE,
        "paper": paper_table(found),
        "savings": extras.savings(found, folder, effects),
        "numerics": extras.numerics_link(folder),
        "provenance": provenance(found),
        "command": next((one["provenance"].get("a2rt", "") for one in found), ""),
        "amplify": AMPLIFY,
    }
