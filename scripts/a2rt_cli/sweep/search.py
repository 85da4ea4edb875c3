"""Finds the cheapest configuration within an accuracy budget, with Optuna.

Every trial is a run like any other: it is kept by its hash, and the study is a database in the
results' folder, so a killed search goes on where it was.
"""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

from a2rt_cli import comparison, console, formats, results
from a2rt_cli.engine import capture, runs, scenes
from a2rt_cli.engine.capture import Captured
from a2rt_cli.engine.runs import RunSpec
from a2rt_cli.errors import UserError
from a2rt_cli.experiment import Experiment, Search
from a2rt_cli.files import exclusive, hash_values, write_json
from a2rt_cli.sweep import plan

SEED = 1


def _captures(one: Experiment, out: Path) -> list[Captured]:
    found = []
    for item in one.items():
        with console.step(f"Capturing {item.name}") as shown:
            scene = scenes.find(item.text)
            cache = out / ".cache" / "captures"
            found.append(
                capture.from_scene(scene, item.options, cache, name=item.name, shown=shown)
            )
    return found


def _measure(
    one: Experiment, captured: list[Captured], overrides: tuple[str, ...], out: Path, parallel: int
) -> dict[str, float]:
    """Sums over the captures: what is minimised, lost hits, redundant hits per true miss."""
    assert one.search is not None
    spec = RunSpec(one.search.unit, one.gpu, overrides, one.audit, picture=False)
    jobs = comparison.jobs_of(captured, [spec], out / ".cache" / "runs")
    found = comparison.run_all(jobs, out / "pictures", parallel, quiet=True)
    costs = [results.get(result, one.search.minimise) for result in found]
    lost = [results.lost_hits(result) for result in found]
    redundant = [results.redundant_share(result) for result in found]
    if any(value is None for value in (*costs, *lost, *redundant)):
        raise UserError(
            f"{one.file}: a run has no {one.search.minimise}, lost hits or redundant hits",
            "search.minimise needs a gpu for time.* and energy.*; audit must not be 0",
        )
    return {
        "cost": formats.geometric_mean([float(c) for c in costs]) or 0.0,
        "lost": float(sum(lost)),
        "redundant": sum(redundant) / len(redundant),
    }


def run(one: Experiment, out: Path, trials: int, parallel: int) -> dict[str, Any]:
    """Returns {default, best, trials, ...}; also in OUT/search.json."""
    if one.search is None:
        raise UserError(f"{one.file}: no [search] table", "add one; see price-of-accuracy.toml")
    with exclusive(out):
        captured = _captures(one, out)
        default = _measure(one, captured, (), out, parallel)
        study = _study(one, one.search, out, captured)
        # A trial that was running when the search was killed has no value and is made up for.
        left = max(0, trials - sum(1 for trial in study.trials if trial.values))
        with console.step(f"Searching, {left} of {trials} trials to go") as shown:
            for index in range(left):
                trial = study.ask()
                overrides = _choose(trial, one.search)
                measured = _measure(one, captured, overrides, out, parallel)
                _tell(study, trial, one.search, measured, default)
                shown.update((index + 1) / left, f"cost {measured['cost']:.4g}")
    summary = _summary(study, one.search, default)
    write_json(out / "search.json", summary)
    return summary


def _choose(trial, search: Search) -> tuple[str, ...]:
    return tuple(
        plan.override(key, trial.suggest_categorical(key, list(values)))
        for key, values in search.space.items()
    )


def study_name(one: Experiment, search: Search, captured: list[Captured]) -> str:
    """Trials are comparable if all that decides their results is equal, the budget included."""
    spec = RunSpec(search.unit, one.gpu, (), one.audit, picture=False)
    results_of = [runs.run_key(drawn, spec) for drawn in captured]
    budget = [search.most_lost_hits, search.most_extra_redundant]
    return hash_values(results_of, list(search.space.items()), search.minimise, budget)[:12]


def _study(one: Experiment, search: Search, out: Path, captured: list[Captured]):
    import optuna

    optuna.logging.set_verbosity(optuna.logging.WARNING)
    name = study_name(one, search, captured)
    study = optuna.create_study(
        study_name=name,
        storage=f"sqlite:///{(out / 'search.db').resolve()}",
        load_if_exists=True,
        direction="minimize",
    )
    # Constraints are an "experimental" argument of the pinned version, which does not change.
    warnings.simplefilter("ignore", optuna.exceptions.ExperimentalWarning)
    study.sampler = optuna.samplers.TPESampler(
        # Not the same draws again when a search goes on where it was.
        seed=SEED + len(study.trials),
        constraints_func=lambda trial: trial.user_attrs["constraints"],
    )
    return study


def _tell(study, trial, search: Search, measured: dict, default: dict) -> None:
    trial.set_user_attr("constraints", _over(search, measured, default))
    trial.set_user_attr("measured", measured)
    study.tell(trial, measured["cost"])


def _over(search: Search, measured: dict, default: dict) -> list[float]:
    """By how much each limit of the budget is exceeded; at most 0 where it is kept."""
    most_redundant = default["redundant"] * (1 + search.most_extra_redundant)
    return [measured["lost"] - search.most_lost_hits, measured["redundant"] - most_redundant]


def _summary(study, search: Search, default: dict) -> dict[str, Any]:
    trials = [
        {
            "parameters": trial.params,
            **trial.user_attrs["measured"],
            "within_budget": max(_over(search, trial.user_attrs["measured"], default)) <= 0,
        }
        for trial in study.trials
        if trial.values
    ]
    within = [trial for trial in trials if trial["within_budget"]]
    return {
        "default": default,
        "best": min(within, key=lambda trial: trial["cost"], default=None),
        "trials": trials,
    }


def _trial_rows(summary: dict[str, Any], most: int = 8) -> list[tuple[str, ...]]:
    """The cheapest different configurations tried, best first."""
    different = {tuple(trial["parameters"].items()): trial for trial in summary["trials"]}
    order = sorted(different.values(), key=lambda trial: trial["cost"])
    return [
        (
            ", ".join(f"{key.split('.')[-1]} {value}" for key, value in one["parameters"].items()),
            f"{one['cost'] / summary['default']['cost']:.4f} ×",
            f"{one['lost']:.0f}",
            formats.percent(one["redundant"], 2),
            "yes" if one["within_budget"] else "no",
        )
        for one in order[:most]
    ]


def print_best(one: Experiment, summary: dict[str, Any]) -> None:
    assert one.search is not None
    best, default, trials = summary["best"], summary["default"], summary["trials"]
    within = sum(trial["within_budget"] for trial in trials)
    tried = f"{within} of {len(trials)} tried are within the budget"
    console.heading(f"The cheapest by {one.search.minimise}, against the default")
    columns = ("configuration", "cost", "lost hits", "redundant", "within budget")
    print(console.table(columns, _trial_rows(summary)))
    if best is None:
        print(f"No configuration tried is within the budget ({tried}).")
        return
    console.heading(f"Best {one.search.unit} by {one.search.minimise} ({tried})")
    rows = [(key, str(value)) for key, value in best["parameters"].items()]
    rows.append((one.search.minimise, f"{best['cost'] / default['cost']:.4f} × the default's"))
    rows.append(("lost hits", f"{best['lost']:.0f} (default {default['lost']:.0f})"))
    shares = (formats.percent(best["redundant"], 2), formats.percent(default["redundant"], 2))
    rows.append(("redundant", f"{shares[0]} (default {shares[1]})"))
    print(console.table(("parameter", "value"), rows, left=2))
