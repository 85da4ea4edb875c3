"""A table as the templates take it: cells are text already."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass
class Table:
    columns: list[str]
    rows: list[list[str]]
    note: str = ""
