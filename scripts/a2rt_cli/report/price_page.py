"""The page of a sweep: price list, Pareto scatter with pictures, one-more-bit tables."""

from __future__ import annotations

from pathlib import Path

from a2rt_cli import formats, results
from a2rt_cli.errors import UserError
from a2rt_cli.experiment import Experiment
from a2rt_cli.files import write_text
from a2rt_cli.report import charts, price, sections
from a2rt_cli.report.sections import Table

_TEMPLATES = Path(__file__).resolve().parent
_PRICE_COLUMNS = ["value", "lost hits", "missed boxes", "redundant", "picture RMSE"]
_PRICE_COLUMNS += ["cycles", "node bytes", "energy"]
_STEP_COLUMNS = ["step", "redundant", "lost hits", "cycles", "node bytes", "energy"]


def _price_table(rows: list[price.Price]) -> Table:
    cells = []
    for row in rows:
        paid = row.cost
        cells.append(
            [
                f"{row.value}{' (default)' if row.is_default else ''}",
                formats.count(paid.lost_hits),
                formats.count(paid.missed),
                formats.percent(paid.redundant, 2),
                formats.small(paid.rmse),
                formats.percent(paid.cycles, 2),
                formats.percent(paid.node_bytes, 2),
                formats.percent(paid.energy, 2),
            ]
        )
    return Table(_PRICE_COLUMNS, cells)


def _pictures(folder: Path, rows: list[dict]) -> dict[str, str]:
    """Every picture once, by the name the points use."""
    names = {row[key] for row in rows for key in ("picture", "difference") if row[key]}
    return {
        name: sections.data_uri(folder / name)
        for name in sorted(names)
        if (folder / name).is_file()
    }


def write(folder: Path, experiment: Experiment) -> Path:
    import jinja2

    found = results.load(folder)
    if not found:
        raise UserError(f"{folder}: no finished point", "run the sweep first")
    prices = price.price_list(experiment, found)
    rows = price.scatter(found)
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(_TEMPLATES),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    units = list(dict.fromkeys(row["unit"] for row in rows))
    text = environment.get_template("price.html.j2").render(
        title=experiment.title,
        workloads=list(results.by_workload(found)),
        runs=len(found),
        sentences=price.sentences(prices),
        knobs=[
            {
                "title": group[0].knob.title,
                "key": f"{group[0].knob.unit}.{group[0].knob.key}",
                "prices": _price_table(group),
                "steps": Table(_STEP_COLUMNS, price.one_more_bit(group)),
            }
            for group in prices
        ],
        colours={unit: charts.unit_colour(unit, i) for i, unit in enumerate(units)},
        points=price.script_json(rows),
        pictures=price.script_json(_pictures(folder, rows)),
        paper=sections.paper_table(found),
        provenance=sections.provenance(found),
        timed=any(row["axis"] == "cycles" for row in rows),
    )
    target = folder / "report.html"
    write_text(target, text)
    return target
