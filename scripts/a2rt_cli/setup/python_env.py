"""The pinned Python environment in .venv."""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

from a2rt_cli.errors import UserError
from a2rt_cli.files import hash_file, write_text
from a2rt_cli.paths import LOGS, SCRIPTS, VENV, venv_python
from a2rt_cli.process import run_logged
from a2rt_cli.setup.needs import Need

_REMEDY = "check the network, then run the command again; `scripts/a2rt doctor` shows what is there"


def requirement_files(need: Need) -> list[Path]:
    """Requirement files of a need; the heavy ones only where a command calls for them."""
    files = [SCRIPTS / "requirements.txt"]
    if need.tests:
        files.append(SCRIPTS / "requirements-dev.txt")
    if need.tests or need is Need.SWEEP:
        files.append(SCRIPTS / "requirements-sweep.txt")
    return files


def _stamp(requirements: Path) -> Path:
    return VENV / f".{requirements.stem}.installed"


def missing(need: Need) -> list[Path]:
    """Requirement files that are not installed as they stand."""
    if not venv_python().exists():
        return requirement_files(need)
    return [
        path
        for path in requirement_files(need)
        if not _stamp(path).exists() or _stamp(path).read_text().strip() != hash_file(path)
    ]


def _base_python() -> str:
    """Debian's own Python where there is one: python3-venv belongs to it."""
    system = Path("/usr/bin/python3")
    return str(system) if system.exists() else sys.executable


def create(need: Need, say) -> None:
    log = LOGS / "setup-python.log"
    if not venv_python().exists():
        say(0.0, "creating .venv")
        shutil.rmtree(VENV, ignore_errors=True)
        run_logged(
            [_base_python(), "-m", "venv", str(VENV)],
            log,
            what="creating the Python environment",
            remedy="install the package python3-venv, then run the command again",
        )
    files = missing(need)
    for index, path in enumerate(files):
        done = 0

        def follow(line: str, base: int = index, total: int = len(files)) -> None:
            nonlocal done
            if line.startswith("Collecting "):
                done += 1
                # The number of packages is not known before pip resolved them: approach 1.
                say((base + 1 - 0.93**done) / total, line[:60])

        run_logged(
            [str(venv_python()), "-m", "pip", "install", "--no-input", "-r", str(path)],
            log,
            what=f"installing {path.name}",
            remedy=_REMEDY,
            on_line=follow,
        )
        write_text(_stamp(path), hash_file(path) + "\n")


def check_running_from(python: str = sys.executable) -> bool:
    """Whether the running interpreter is the environment's."""
    try:
        return Path(python).parent.samefile(venv_python().parent)
    except OSError:
        return False


def require_present() -> None:
    if not venv_python().exists():
        raise UserError("the Python environment is missing", "run: scripts/a2rt doctor")
