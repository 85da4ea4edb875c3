"""Effects: what scenes save by composing pipeline, capture and machine from the effects in use.

Times are measured anew at every call; rows of scenes that a call leaves out are kept.
"""

from __future__ import annotations

from a2rt_cli import console, plotting, savings_table
from a2rt_cli.engine import savings, scenes
from a2rt_cli.errors import UserError
from a2rt_cli.figures import Context, Drawn

TITLE = "simulating only the effects a scene calls for, against all of them"
NAME = "effects"
_BARS = (("capture_seconds", "capture"), ("simulate_seconds", "simulation"))


def draw(context: Context) -> Drawn:
    unit, gpu = context.experiment.units[0], context.experiment.gpu
    if gpu is None:
        raise UserError(f"{context.experiment.file}: name a gpu; the simulations need one")
    rows = []
    for item in context.experiment.items():
        rows.append(savings.measure(scenes.find(item.text), item.options, unit, gpu, context.out))
        # Row by row: a killed run keeps what it has measured.
        numbers = savings_table.save(context.out, rows)
    files = [*_draw(rows, context), numbers]
    table = console.table(savings_table.COLUMNS, [savings_table.cells(row) for row in rows])
    said = "\n".join(savings_table.sentence(row) for row in rows)
    return Drawn(f"{table}\n\n{savings_table.NOTE}\n\n{said}", files)


def _draw(rows: list[dict], context: Context) -> list:
    figure, axes = plotting.new(9, 3.6)
    for index, (key, title) in enumerate(_BARS):
        spots = [i + (index - 0.5) * 0.38 for i in range(len(rows))]
        shares = [100 * row["auto"][key] / row["all"][key] for row in rows]
        axes.bar(spots, shares, 0.36, label=title, color=("#0072b2", "#e69f00")[index])
    axes.axhline(100, color="#1a2230", linewidth=0.8)
    axes.set_xticks(range(len(rows)), [row["scene"] for row in rows])
    axes.set_ylabel("auto, % of all")
    axes.set_title("processor time with the effects in use against all effects", loc="left")
    figure.legend(loc="outside lower center", ncols=2)
    return plotting.save(figure, context.out, NAME)
