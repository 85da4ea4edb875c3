"""Runs a plan with Snakemake: locally, or on a cluster through a profile."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

from a2rt_cli import console
from a2rt_cli.errors import UserError
from a2rt_cli.experiment import Experiment
from a2rt_cli.paths import LOGS, SCRIPTS, venv_python
from a2rt_cli.process import run_logged
from a2rt_cli.sweep import plan as plans
from a2rt_cli.sweep.plan import Plan
from a2rt_cli.sweep.worker import FINISHED

_FOLDER = SCRIPTS / "workflow"


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


def dry_run(one: Experiment, out: Path, parallel: int, profile: str | None) -> None:
    """Says what a sweep into `out` would do, without a trace there: another may be running."""
    with tempfile.TemporaryDirectory() as folder:
        planned = plans.write(one, Path(folder))
        words = command(Path(folder), parallel, True, profile)
        status = subprocess.run([*words, "--quiet", "rules"], env=_env(), check=False).returncode
    if status:
        sys.exit(status)
    kept = len(planned.points) - len(plans.unfinished(planned, out))
    there = f", {kept} of them are there already" if kept else ""
    print(f"dry run: nothing was started ({len(planned.points)} points planned{there})")


def _env() -> dict[str, str]:
    return {**os.environ, "A2RT_NO_SETUP": "1", "PYTHONPATH": str(SCRIPTS)}


def run(plan: Plan, out: Path, parallel: int, profile: str | None) -> None:
    """Runs what is missing of `plan`, whose file is in `out`; the caller holds the folder."""
    log = LOGS / "sweep.log"
    log.parent.mkdir(parents=True, exist_ok=True)
    log.write_text("", encoding="utf-8")
    todo = plans.unfinished(plan, out)
    _forget_markers(plan, out, todo)
    kept = len(plan.points) - len(todo)
    title = f"Running {len(todo)} points" + (f" ({kept} are there already)" if kept else "")
    finished = 0
    with console.step(title) as shown:

        def follow(line: str) -> None:
            nonlocal finished
            if line.startswith(FINISHED):
                finished += 1
                shown.update(finished / len(todo), f"{finished} of {len(todo)}")

        run_logged(
            command(out, parallel, False, profile),
            log,
            what="the sweep",
            remedy="mend what the log names, then run the same command: finished points are kept",
            env=_env(),
            on_line=follow,
        )


def _forget_markers(plan: Plan, out: Path, todo: list[plans.Point]) -> None:
    """A batch with a missing point is not done, whatever its marker says."""
    missing = {point.name for point in todo}
    for name, points in plan.batches().items():
        if missing & {point.name for point in points}:
            (out / "batches" / f"{name}.done").unlink(missing_ok=True)
