"""Where things are. Every other module asks here, so that a moved folder is one edit."""

from __future__ import annotations

import os
from pathlib import Path

SCRIPTS = Path(__file__).resolve().parents[1]
ROOT = SCRIPTS.parent
CONFIGS = ROOT / "lumibench_configs"
VENV = ROOT / ".venv"
# Developers who keep several builds name another folder; users never need to.
BUILD = Path(os.environ.get("A2RT_BUILD_DIR", ROOT / "build")).resolve()
LOGS = BUILD / "logs"
# Real scenes, when they lie beside the project.
SHARED_SCENES = Path(os.environ.get("A2RT_SCENES", ROOT.parent / "shared" / "scenes"))


# What the programs look up in $A2RT_CONFIGS, if it is set.
_PROGRAMS_READ = ("units", "gpus", "workloads")


def config_folder(kind: str) -> Path:
    """Folder of the configurations of a kind, the one that the programs read."""
    chosen = os.environ.get("A2RT_CONFIGS") if kind in _PROGRAMS_READ else None
    return (Path(chosen) if chosen else CONFIGS) / kind


def venv_python() -> Path:
    return VENV / "bin" / "python"


def shown(path: Path) -> str:
    """`path` as a user would type it from here."""
    try:
        return str(path.resolve().relative_to(Path.cwd()))
    except ValueError:
        return str(path)
