"""Renders the page."""

from __future__ import annotations

import json
from pathlib import Path

from a2rt_cli import results
from a2rt_cli.errors import UserError
from a2rt_cli.files import write_text
from a2rt_cli.report import sections
from a2rt_cli.report.template import fill


def write(folder: Path, target: Path | None = None) -> Path:
    """Writes the report of `folder`'s results into `target` (folder/report.html)."""
    found = results.load(folder)
    if not found:
        raise UserError(f"{folder}: results.json holds no run", "run the comparison again")
    target = target or folder / "report.html"
    write_text(target, fill("page.html.j2", **sections.everything(found, folder, _effects(folder))))
    return target


def _effects(folder: Path) -> dict:
    """Effect tables per workload, if the comparison drew scenes itself."""
    try:
        return json.loads((folder / "effects.json").read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
