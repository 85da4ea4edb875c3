"""No figure of the paper: what the model without queues errs, and the host's time that it saves.

Every unit is simulated in both models of the machine, on the same rays. Times are of the processor,
measured when a run is made; a run that is found again keeps the time it took.
"""

from __future__ import annotations

from a2rt_cli import comparison, console, formats, options, plotting, results
from a2rt_cli.engine.runs import RunSpec
from a2rt_cli.errors import UserError
from a2rt_cli.figures import Context, Drawn
from a2rt_cli.report import charts

TITLE = 'what `model = "reserved"` errs against queues, and what it saves (ours, not the paper\'s)'
NAME = "models"
_MODELS = ("queued", "reserved")
_COLUMNS = ("workload", "unit", "queued", "reserved", "off", "rays/s", "rays/s", "gain")


def draw(context: Context) -> Drawn:
    rows = [_row(*pair) for pair in _pairs(_runs(context))]
    cells = [
        (
            row["workload"],
            row["unit"],
            formats.count(row["queued"]["cycles"]),
            formats.count(row["reserved"]["cycles"]),
            f"{row['error']:+.1%}",
            formats.count(row["queued"]["rays_per_second"]),
            formats.count(row["reserved"]["rays_per_second"]),
            formats.factor(row["gain"]),
        )
        for row in rows
    ]
    largest = max(rows, key=lambda row: abs(row["error"]))
    mean = sum(abs(row["error"]) for row in rows) / len(rows)
    text = console.table(_COLUMNS, cells, left=2)
    text += (
        f"\n\nCycles off by {mean:.1%} in the mean, at most {abs(largest['error']):.1%} "
        f"({largest['workload']}, {largest['unit']}). Simulated {_span(rows)} as fast."
    )
    files = [*_draw(rows, context), plotting.write_numbers(context.out, NAME, [], models=rows)]
    return Drawn(text, files)


def _runs(context: Context) -> list[results.Result]:
    experiment = context.experiment
    if experiment.gpu is None:
        raise UserError(f"{experiment.file}: name a gpu; the simulations need one")
    specs = [
        RunSpec(unit, experiment.gpu, (f"model={model}",), 0, picture=False, functional=False)
        for unit in experiment.units
        for model in _MODELS
    ]
    return comparison.compare(
        experiment.items(),
        specs,
        context.out,
        parallel=context.parallel,
        command=options.command_line(),
        cache=context.cache,
    )


def _pairs(found: list[results.Result]) -> list[tuple[results.Result, results.Result]]:
    queued, reserved = found[0::2], found[1::2]
    return list(zip(queued, reserved, strict=True))


def _row(queued: results.Result, reserved: results.Result) -> dict:
    row: dict = {"workload": results.workload_name(queued), "unit": results.label(queued)}
    for model, one in zip(_MODELS, (queued, reserved), strict=True):
        row[model] = {
            "cycles": results.get(one, "time.cycles"),
            "rays_per_second": results.get(one, "provenance.rays_per_second"),
        }
    row["error"] = row["reserved"]["cycles"] / row["queued"]["cycles"] - 1
    row["gain"] = row["reserved"]["rays_per_second"] / row["queued"]["rays_per_second"]
    return row


def _span(rows: list[dict]) -> str:
    gains = [row["gain"] for row in rows]
    return f"{formats.factor(min(gains))} to {formats.factor(max(gains))}"


def _draw(rows: list[dict], context: Context) -> list:
    figure, (errors, gains) = plotting.new(12, 3.8, 2)
    names = list(dict.fromkeys(row["workload"] for row in rows))
    units = list(dict.fromkeys(row["unit"] for row in rows))
    width = 0.8 / len(units)
    for index, unit in enumerate(units):
        of_unit = {row["workload"]: row for row in rows if row["unit"] == unit}
        spots = [i + (index - (len(units) - 1) / 2) * width for i in range(len(names))]
        look = {"width": width * 0.92, "color": charts.unit_colour(unit, index)}
        errors.bar(spots, [100 * of_unit[name]["error"] for name in names], label=unit, **look)
        gains.bar(spots, [of_unit[name]["gain"] for name in names], **look)
    errors.axhline(0, color="#1a2230", linewidth=0.8)
    gains.axhline(1, color="#1a2230", linewidth=0.8)
    errors.set_ylabel("cycles off, %")
    gains.set_ylabel("times as fast")
    for axes in (errors, gains):
        axes.set_xticks(range(len(names)), names)
    errors.set_title("ways reserved ahead instead of queues", loc="left")
    figure.legend(loc="outside lower center", ncols=len(units))
    return plotting.save(figure, context.out, NAME)
