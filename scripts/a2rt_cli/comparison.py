"""Units side by side on the same rays: capture once, run what is not yet there, write results.

Killed at any moment it leaves only whole results behind, and the same call goes on from there.
"""

from __future__ import annotations

import contextlib
import csv
import io
import os
from collections.abc import Sequence
from concurrent.futures import Future, ThreadPoolExecutor, as_completed
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from a2rt_cli import console, process, results
from a2rt_cli.engine import capture, core, effects, lumibench, runs, scenes
from a2rt_cli.engine.capture import Captured
from a2rt_cli.engine.renderer import RenderOptions
from a2rt_cli.engine.runs import RunSpec
from a2rt_cli.errors import UserError
from a2rt_cli.files import exclusive, write_json, write_text

# Runs are single-threaded processes; two keep a small machine busy without starving it.
PARALLEL = 2


@dataclass(frozen=True)
class Item:
    """One thing to compare on: a scene to draw, or a workload file."""

    text: str
    options: RenderOptions
    name: str = ""


def items_of(texts: Sequence[str], options: RenderOptions) -> list[Item]:
    """What a user may compare on: scenes, workload files, LumiBench's runs by name or pattern."""
    out = []
    for text in texts:
        if not lumibench.is_run(text):
            out.append(Item(text, options))
            continue
        if options.workload != "auto":
            raise UserError(f"{text} names its workload", "leave --workload out")
        for run in lumibench.find(text):
            scene = scenes.find(run.scene.name)
            name = f"{scene.name}_{run.workload}"
            out.append(Item(run.scene.name, replace(options, workload=run.workload), name))
    return out


def capture_all(items: Sequence[Item], cache: Path) -> list[Captured]:
    """Every item as a workload file, drawn unless `cache` has it."""
    captured = []
    for item in items:
        if scenes.is_workload_file(item.text):
            captured.append(capture.from_file(Path(item.text)))
            continue
        scene = scenes.find(item.text)
        if scene.note:
            console.note(f"  {item.name or scene.name}: {scene.note}")
        known = capture.find_finished(scene, item.options, cache, name=item.name)
        if known is not None:
            captured.append(known)
            continue
        size = f"{item.options.width}x{item.options.height}"
        words = f"Drawing and capturing {item.name or scene.name} ({item.options.workload}, {size})"
        with console.step(words) as shown:
            captured.append(
                capture.from_scene(scene, item.options, cache, name=item.name, shown=shown)
            )
    names = [one.name for one in captured]
    return [
        one if names.count(one.name) == 1 else replace(one, name=f"{one.name}-{one.key[:6]}")
        for one in captured
    ]


@dataclass(frozen=True)
class Job:
    captured: Captured
    spec: RunSpec
    target: Path


def jobs_of(captured: Sequence[Captured], specs: Sequence[RunSpec], folder: Path) -> list[Job]:
    out = []
    for one in captured:
        for spec in specs:
            unit = Path(spec.unit).stem
            name = f"{unit}-{runs.run_key(one, spec)[:16]}.json"
            # By content, not by name: figures that call a workload differently share its runs.
            place = one.name if one.scene is None else one.file.parent.name
            out.append(Job(one, spec, folder / place / name))
    return out


def run_all(
    jobs: Sequence[Job], pictures: Path, parallel: int, quiet: bool = False
) -> list[dict[str, Any]]:
    """Results in the order of `jobs`. The first failure stops the rest and is raised."""
    finished = {job.target: runs.load_finished(job.target) for job in jobs}
    todo = [job for job in jobs if finished[job.target] is None]
    if not todo:
        return [finished[job.target] for job in jobs]  # type: ignore[misc]
    of_all = f" of {len(jobs)}" if len(todo) < len(jobs) else ""
    with contextlib.ExitStack() as stack:
        shown = None
        if not quiet:
            title = f"Running {len(todo)}{of_all} simulations"
            shown = stack.enter_context(console.step(title))
        pool = stack.enter_context(ThreadPoolExecutor(parallel))
        futures: dict[Future, Job] = {
            pool.submit(runs.execute, job.captured, job.spec, job.target, pictures): job
            for job in todo
        }
        try:
            for count, future in enumerate(as_completed(futures), 1):
                job = futures[future]
                finished[job.target] = future.result()
                if shown is not None:
                    shown.update(count / len(todo), f"{job.captured.name} × {job.spec.label()}")
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            process.end_all()
            raise
    return [finished[job.target] for job in jobs]  # type: ignore[misc]


def compare(
    items: Sequence[Item],
    specs: Sequence[RunSpec],
    out: Path,
    *,
    parallel: int = PARALLEL,
    command: str = "",
    cache: Path | None = None,
) -> list[dict[str, Any]]:
    """Runs every spec on every item; writes results.json, results.csv and pictures into `out`.

    Captures and finished runs are kept in `cache` (out/.cache), which several folders may share.
    """
    with contextlib.ExitStack() as locks:
        locks.enter_context(exclusive(out))
        if cache is not None:
            locks.enter_context(exclusive(cache))
        return _compare(items, specs, out, cache or out / ".cache", parallel, command)


def _compare(
    items: Sequence[Item],
    specs: Sequence[RunSpec],
    out: Path,
    cache: Path,
    parallel: int,
    command: str,
) -> list[dict[str, Any]]:
    _check(specs)
    captured = capture_all(items, cache / "captures")
    pictures = out / "pictures"
    for one in captured:
        if one.picture is not None:
            runs.driver_picture(one, pictures)
    jobs = jobs_of(captured, specs, cache / "runs")
    found = run_all(jobs, pictures, parallel)
    for job, result in zip(jobs, found, strict=True):
        result["provenance"]["a2rt"] = command
        result["workload"]["name"] = job.captured.name
        if job.spec.heatmap and runs.heatmap_file(job.target).is_file():
            result["heatmap"] = os.path.relpath(runs.heatmap_file(job.target), out)
    write_json(out / "results.json", found)
    write_json(out / "effects.json", {one.name: effects.of_captured(one) for one in captured})
    write_text(out / "results.csv", to_csv(found))
    return found


def _check(specs: Sequence[RunSpec]) -> None:
    """A misspelt unit, machine or parameter is found before minutes of drawing, not after."""
    for unit, overrides in dict.fromkeys((spec.unit, spec.unit_overrides()) for spec in specs):
        core.check_unit(unit, overrides)
    machines = dict.fromkeys((spec.gpu, spec.machine_overrides()) for spec in specs)
    for gpu, overrides in machines:
        if gpu is not None:
            core.check_gpu(gpu, overrides)


def to_csv(found: Sequence[dict[str, Any]]) -> str:
    """Every number of every result, one row a run; nested keys joined by dots."""
    rows = [results.flatten(result) for result in found]
    columns: list[str] = []
    for row in rows:
        columns += [key for key in row if key not in columns]
    stream = io.StringIO()
    writer = csv.DictWriter(stream, columns, lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return stream.getvalue()
