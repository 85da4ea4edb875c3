"""Parts of the page that other modules may add; absent ones leave no trace.

report/savings.py   section(found, folder, effects) -> safe HTML: what the scenes did not need, and
                    what that saved
report/numerics.py  link(folder) -> (relative href, one sentence) or None: the numerics page
"""

from __future__ import annotations

import importlib
import importlib.util
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

from a2rt_cli.results import Result


def _module(name: str) -> ModuleType | None:
    full = f"a2rt_cli.report.{name}"
    return importlib.import_module(full) if importlib.util.find_spec(full) else None


def savings(found: Sequence[Result], folder: Path, effects: dict[str, Any]) -> str:
    module = _module("savings")
    return module.section(found, folder, effects) if module else ""


def numerics_link(folder: Path) -> tuple[str, str] | None:
    module = _module("numerics")
    return module.link(folder) if module and hasattr(module, "link") else None
