"""The page of a sweep: answers, what each bit buys and costs, Pareto scatter, price list."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from a2rt_cli import formats, results
from a2rt_cli.errors import UserError
from a2rt_cli.experiment import Experiment, Knob
from a2rt_cli.files import write_text
from a2rt_cli.report import charts, price, price_answers, price_charts, price_scatter, sections
from a2rt_cli.report.price import ALL, Found, Price
from a2rt_cli.report.price_answers import Answer, change
from a2rt_cli.report.sections import Table
from a2rt_cli.report.template import fill

_COLUMNS = ["value", "redundant", "lost hits", "missed boxes", "FLIP", "RMSE", "time"]
_COLUMNS += ["node bytes", "energy", "tester area, µm²"]


@dataclass(frozen=True)
class KnobView:
    """A knob as the page shows it, for one scope."""

    title: str
    key: str
    sentence: str
    chart: str
    table: Table


@dataclass(frozen=True)
class Heat:
    """One cell of the S_t x L_t map: `shade` 0 is the best time, 1 the worst."""

    text: str
    tip: str
    shade: float
    best: bool
    own: bool


@dataclass(frozen=True)
class View:
    """All of the page that changes with the scene."""

    scope: str
    answers: list[Answer]
    hero: KnobView | None
    steps: Table
    knobs: list[KnobView]
    heat_columns: list[str]
    heat_rows: list[tuple[str, list[Heat]]]


def _price_row(row: Price) -> list[str]:
    paid = row.cost
    return [
        f"{row.label}{' (default)' if row.is_default else ''}",
        formats.percent(paid.redundant, 2),
        formats.count(paid.lost_hits),
        formats.count(paid.missed),
        formats.small(paid.flip),
        formats.small(paid.rmse),
        change(paid.cycles, digits=2),
        change(paid.node_bytes, digits=2),
        change(paid.energy, digits=2),
        formats.count(paid.area),
    ]


def _knob_view(rows: Sequence[Price]) -> KnobView:
    knob = rows[0].knob
    return KnobView(
        knob.title,
        f"{knob.unit}: {knob.key}",
        price_answers.sentence(rows),
        price_charts.ladder(rows),
        Table(_COLUMNS, [_price_row(row) for row in rows]),
    )


def _own_values(experiment: Experiment, keys: Sequence[str], unit: str) -> dict[str, Any]:
    known: list[Knob] = [k for k in experiment.knobs if k.unit == unit]
    return {knob.key: knob.default for knob in known if knob.key in keys}


def _heat(experiment: Experiment, found: Found, scope: str):
    cells = price_answers.classification(experiment, found, scope)
    best = price_answers.best_cell(cells)
    if best is None:
        return [], []
    times = [cell.cost.cycles for cell in cells]
    spread = max(times) - best.cost.cycles or 1.0
    s_t, l_t = next(iter(cells)).values.keys()
    own = _own_values(experiment, (s_t, l_t), "a2rt")
    columns = sorted({cell.values[l_t] for cell in cells})
    rows: dict[float, list[Heat]] = {}
    for cell in sorted(cells, key=lambda cell: (cell.values[s_t], cell.values[l_t])):
        slower = cell.cost.cycles / best.cost.cycles - 1
        tip = (
            f"node bytes {change(cell.cost.node_bytes)}, energy {change(cell.cost.energy)}, "
            f"redundant {formats.percent(cell.cost.redundant, 2)}"
        )
        heat = Heat(
            f"+{slower * 100:.2f} %",
            tip,
            (cell.cost.cycles - best.cost.cycles) / spread,
            cell is best,
            cell.values == own,
        )
        rows.setdefault(cell.values[s_t], []).append(heat)
    return [f"{value:g}" for value in columns], [(f"{k:g}", v) for k, v in rows.items()]


def _view(experiment: Experiment, found: Found, scope: str) -> View:
    prices = price.price_list(experiment, found, scope)
    knobs = [_knob_view(rows) for rows in prices]
    bits = next((v for v in knobs if v.key == "a2rt: precision.box_bits"), None)
    steps = [step for rows in prices for step in price_answers.steps(rows)]
    heat_columns, heat_rows = _heat(experiment, found, scope)
    return View(
        scope,
        price_answers.answers(experiment, found, scope),
        bits or (knobs[0] if knobs else None),
        Table(price_answers.STEP_COLUMNS, steps),
        knobs,
        heat_columns,
        heat_rows,
    )


def _pictures(folder: Path, rows: Sequence[dict]) -> dict[str, str]:
    """Every picture once, by the name the points use."""
    names = {row[key] for row in rows for key in ("picture", "difference") if row[key]}
    names |= {f"pictures/{row['workload']}.driver.png" for row in rows}
    return {
        name: sections.data_uri(folder / name)
        for name in sorted(names)
        if (folder / name).is_file()
    }


def _lead(found: Sequence[results.Result]) -> str:
    rays = sum(int(group[0]["workload"]["rays"]) for group in results.by_workload(found).values())
    names = results.by_workload(found)
    size = (found[0]["workload"].get("options") or {}) if found else {}
    drawn = f" at {size['width']}×{size['height']}" if size.get("width") else ""
    return (
        f"{len(found)} runs on {formats.count(rays)} rays of {len(names)} scenes "
        f"({', '.join(names)}{drawn}). Everything is measured against the unit as configured, on "
        "the same rays."
    )


def write(folder: Path, experiment: Experiment, target: Path | None = None) -> Path:
    """Writes `target` (FOLDER/report.html), which needs no other file and no network."""
    raw = results.load(folder)
    if not raw:
        raise UserError(f"{folder}: no finished point", "run the sweep first")
    found = Found(raw)
    rows = price_scatter.points(raw)
    units = list(dict.fromkeys(row["unit"] for row in rows))
    text = fill(
        "price.html.j2",
        title=experiment.title,
        lead=_lead(raw),
        all_scope=ALL,
        views=[_view(experiment, found, scope) for scope in price.scopes(raw)],
        workloads=list(results.by_workload(raw)),
        colours={unit: charts.unit_colour(unit, i) for i, unit in enumerate(units)},
        points=price.script_json(rows),
        axes=price_scatter.axes(rows),
        pictures=price.script_json(_pictures(folder, rows)),
        paper=sections.paper_table(raw),
        provenance=sections.provenance(raw),
        timed=any(row["cycles"] is not None for row in rows),
    )
    target = target or folder / "report.html"
    write_text(target, text)
    return target
