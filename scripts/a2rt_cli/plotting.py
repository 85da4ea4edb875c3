"""Figures for print: one look, PNG and SVG, and the paper's numbers as text beside them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from a2rt_cli import console, formats
from a2rt_cli.files import replacing, write_json
from a2rt_cli.report import measures
from a2rt_cli.results import Result

DPI = 160


def new(width: float = 8.0, height: float = 4.0, columns: int = 1):
    """A figure and its axes in the project's look."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    plt.rcParams.update(
        {
            "font.size": 10,
            "font.family": "DejaVu Sans",
            "axes.spines.top": False,
            "axes.spines.right": False,
            "axes.axisbelow": True,
            "axes.grid": True,
            "axes.grid.axis": "y",
            "grid.color": "#dde2ea",
            "legend.frameon": False,
            "svg.hashsalt": "a2rt",  # the same figure gives the same file
        }
    )
    return plt.subplots(1, columns, figsize=(width, height), layout="constrained")


def save(figure, out: Path, name: str) -> list[Path]:
    import matplotlib.pyplot as plt

    files = []
    for form in ("png", "svg"):
        target = out / f"{name}.{form}"
        with replacing(target) as temporary:
            metadata = {"Date": None} if form == "svg" else None
            figure.savefig(temporary, format=form, dpi=DPI, metadata=metadata)
        files.append(target)
    plt.close(figure)
    return files


def beside(figure_id: str, found: Sequence[Result]) -> list[dict[str, object]]:
    """The paper's numbers of one figure with ours."""
    rows = []
    for number in measures.paper_numbers():
        if number.figure == figure_id:
            value = measures.ours(number, found)
            rows.append(
                {
                    "id": number.id,
                    "what": number.what,
                    "paper": number.value,
                    "ours": value,
                    "how": measures.how(number),
                    "kind": number.kind,
                    "source": number.source,
                }
            )
    return rows


def beside_text(rows: Sequence[dict]) -> str:
    cells = []
    for row in rows:
        ours = formats.of_kind(row["ours"], row["kind"])
        gap = formats.NOTHING
        if row["ours"] is not None and row["paper"]:
            gap = f"{row['ours'] / row['paper']:.2f} × the paper's"
        paper = formats.of_kind(row["paper"], row["kind"])
        cells.append((row["what"], paper, ours, gap, row["how"]))
    return console.table(("quantity", "paper", "ours", "gap", "ours is"), cells)


def write_numbers(out: Path, name: str, paper: Sequence[dict], **more: object) -> Path:
    target = out / f"{name}.json"
    write_json(target, {"paper": list(paper), **more})
    return target
