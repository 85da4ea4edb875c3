"""What schedulers, RT units and lanes did with their cycles, in words, and what that bounds.

The engine's reasons (time.stalls of a result; a2rt_core/include/a2rt/timing/attribution.h) are
gathered into the few a reader can tell apart. Each group adds up to all cycles of its part.
"""

from __future__ import annotations

from dataclasses import dataclass

from a2rt_cli import formats, results
from a2rt_cli.results import Result

IDLE = "no warp"
# part -> reason of the engine -> words
WORDS = {
    "rt_unit": {
        "test": "testing",
        "fetch": "sending requests to L1",
        "bank_busy": "turned away by L1",
        "mshr_full": "turned away by L1",
        "wait_memory": "waiting for data",
        "wait_shader": "waiting for shaders",
        "idle": IDLE,
    },
    "scheduler": {
        "issue_alu": "issuing",
        "issue_sfu": "issuing",
        "issue_memory": "issuing",
        "issue_trace": "issuing",
        "wait_dependency": "waiting for a result",
        "wait_memory": "waiting for loads",
        "wait_lsu": "load/store queue full",
        "wait_rt_slot": "waiting for a place in the RT unit",
        "wait_rt_unit": "warps are being traced",
        "no_warp": IDLE,
    },
    "rt_lane": {
        "test": "in a tester, or queued for one",
        "fetch": "waiting for its data",
        "shader": "candidate is judged on the SM",
        "done": "ray done, warp is not",
        "inactive": "no ray",
    },
}
COLOURS = {
    "testing": "#0072b2",
    "in a tester, or queued for one": "#0072b2",
    "issuing": "#0072b2",
    "sending requests to L1": "#009e73",
    "warps are being traced": "#009e73",
    "turned away by L1": "#d55e00",
    "load/store queue full": "#d55e00",
    "waiting for data": "#e69f00",
    "waiting for its data": "#e69f00",
    "waiting for loads": "#e69f00",
    "waiting for shaders": "#cc79a7",
    "candidate is judged on the SM": "#cc79a7",
    "waiting for a place in the RT unit": "#cc79a7",
    "waiting for a result": "#56b4e9",
    "ray done, warp is not": "#9aa3b2",
    "no ray": "#dde2ea",
    IDLE: "#dde2ea",
}
OTHER = "#f0e442"


def shares(result: Result, part: str) -> dict[str, float]:
    """Words -> share of the cycles of all instances of `part`; empty if the run has no timing."""
    reasons = results.get(result, f"time.stalls.{part}", {})
    total = sum(reasons.values())
    out: dict[str, float] = {}
    for reason, cycles in reasons.items():
        words = WORDS[part].get(reason, reason.replace("_", " "))
        out[words] = out.get(words, 0.0) + (cycles / total if total else 0.0)
    return out


def colour(words: str) -> str:
    return COLOURS.get(words, OTHER)


@dataclass(frozen=True)
class Bound:
    """What the RT units did most, and the testers' part, as shares of the cycles with a warp."""

    what: str
    share: float
    testing: float
    busiest: str  # tester
    utilisation: float
    idle: float  # share of all cycles


def bound(result: Result) -> Bound | None:
    found = shares(result, "rt_unit")
    idle = found.pop(IDLE, 0.0)
    busy = sum(found.values())
    if busy <= 0:
        return None
    what = max(found, key=lambda words: found[words])
    testers = results.get(result, "time.testers", {})
    used = {name: one.get("utilisation", 0.0) for name, one in testers.items()}
    busiest = max(used, key=lambda name: used[name], default="")
    return Bound(
        what,
        found[what] / busy,
        found.get("testing", 0.0) / busy,
        busiest,
        used.get(busiest, 0.0),
        idle,
    )


def bound_words(result: Result) -> str:
    """A table cell: what an RT unit with work does most."""
    found = bound(result)
    return formats.NOTHING if found is None else f"{found.what} ({formats.percent(found.share, 0)})"
