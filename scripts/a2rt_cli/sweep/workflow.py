"""Runs a plan with Snakemake: locally, or on a cluster through a profile."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

from a2rt_cli import console
from a2rt_cli.errors import UserError
from a2rt_cli.paths import LOGS, SCRIPTS, venv_python
from a2rt_cli.process import run_logged
from a2rt_cli.sweep.plan import Plan

_FOLDER = SCRIPTS / "workflow"
_STEPS = re.compile(r"^(\d+) of (\d+) steps")


def _profile(text: str) -> Path:
    for folder in (_FOLDER / "profiles" / text, Path(text)):
        if (folder / "config.yaml").is_file():
            return folder
    known = sorted(path.parent.name for path in _FOLDER.glob("profiles/*/config.yaml"))
    raise UserError(f"{text}: no such profile", f"name a folder with config.yaml, or: {known}")


def command(out: Path, parallel: int, dry_run: bool, profile: str | None) -> list[str]:
    words = [str(venv_python()), "-m", "snakemake", "--snakefile", str(_FOLDER / "Snakefile")]
    words += ["--directory", str(out.resolve()), "--config", f"python={venv_python()}"]
    # A killed sweep leaves jobs marked incomplete; their results are whole or absent, so redo them.
    words += ["--rerun-incomplete", "--rerun-triggers", "mtime", "--nolock"]
    words += ["--profile", str(_profile(profile))] if profile else ["--cores", str(parallel)]
    return [*words, "--dry-run"] if dry_run else words


def run(plan: Plan, out: Path, parallel: int, *, dry_run: bool, profile: str | None) -> None:
    words = command(out, parallel, dry_run, profile)
    env = {**os.environ, "A2RT_NO_SETUP": "1", "PYTHONPATH": str(SCRIPTS)}
    if dry_run:
        status = subprocess.run([*words, "--quiet", "rules"], env=env, check=False).returncode
        if status:
            sys.exit(status)
        print(f"dry run: nothing was started ({len(plan.points)} points planned)")
        return
    log = LOGS / "sweep.log"
    log.parent.mkdir(parents=True, exist_ok=True)
    log.write_text("", encoding="utf-8")
    with console.step("Running the sweep") as shown:

        def follow(line: str) -> None:
            if match := _STEPS.match(line.strip()):
                shown.update(int(match[1]) / int(match[2]), line.strip())

        run_logged(
            words,
            log,
            what="the sweep",
            remedy="mend what the log names, then run the same command: finished points are kept",
            env=env,
            on_line=follow,
        )
