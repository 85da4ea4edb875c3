"""The sourced table of energies and areas (a2rt_core/energy_tables), as the scripts read it."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path

from a2rt_cli.errors import UserError
from a2rt_cli.paths import ROOT

FILE = ROOT / "a2rt_core" / "energy_tables" / "12nm.csv"


@dataclass(frozen=True)
class Row:
    """One action of a component; area and leakage stand on a component's first row."""

    component: str
    action: str
    energy_pj: float
    area_um2: float
    leak_uw: float
    clock_ns: float
    note: str  # synthesised, published or estimated
    source: str

    @property
    def power_mw(self) -> float:
        """One action a cycle, leakage included."""
        return self.energy_pj / self.clock_ns + self.leak_uw / 1000


def first_rows(path: Path = FILE) -> dict[str, Row]:
    """Component -> its first row."""
    out: dict[str, Row] = {}
    with path.open(encoding="utf-8", newline="") as stream:
        for entry in csv.DictReader(line for line in stream if not line.startswith("#")):
            row = Row(
                entry["component"],
                entry["action"],
                float(entry["energy_pj"]),
                float(entry["area_um2"]),
                float(entry["leak_uw"]),
                float(entry["clock_ns"]),
                entry["note"],
                entry["source"],
            )
            out.setdefault(row.component, row)
    if not out:
        raise UserError(f"{path}: no rows", "restore the file from the repository")
    return out
