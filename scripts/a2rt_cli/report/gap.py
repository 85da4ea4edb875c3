"""Why our speedup and energy differ from the paper's, in words that the results support.

Every sentence is a measurement of the runs at hand or a configured number; none is a guess at what
the paper's authors did.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from a2rt_cli import formats, results
from a2rt_cli.report import measures, stalls
from a2rt_cli.results import Result


def sentences(found: Sequence[Result]) -> list[str]:
    timed = [one for one in found if results.is_timed(one) and stalls.bound(one)]
    out = []
    for unit in ("baseline", "a2rt"):
        chosen = measures.runs_of(timed, unit)
        if chosen:
            out.append(_bound(unit, chosen))
    out += _traffic(timed)
    out += _boxes(timed)
    out += _latencies(timed)
    out += _losses(timed)
    return out


def _mean(values: Sequence[float]) -> float:
    return sum(values) / len(values)


def _without(share: float) -> str:
    """How many times as fast a run is without this share of its cycles."""
    return f"{1 / (1 - share):.2f} times" if share < 1 else "any number of times"


def _bound(unit: str, chosen: Sequence[Result]) -> str:
    bounds = [bound for one in chosen if (bound := stalls.bound(one))]
    what, times = Counter(bound.what for bound in bounds).most_common(1)[0]
    testing = [bound.testing for bound in bounds]
    used = max(bound.utilisation for bound in bounds)
    text = (
        f"{unit}: in {times} of {len(bounds)} runs an RT unit that has a warp spends most cycles "
        f"{what}; in {formats.percent(_mean(testing), 0)} of such cycles, on average, it has no "
        "request to send and its testers are at work. Testers that took no time would save at most "
        f"about these: the run that has most of them, {formats.percent(max(testing), 0)}, would be "
        f"{_without(max(testing))} as fast. "
        f"No kind of tester is busy in more than {formats.percent(used)} of cycles"
    )
    inside = [results.get(one, "time.shares.rt_time") for one in chosen]
    known = [share for share in inside if share is not None]
    if known:
        text += f"; warps spend {formats.percent(_mean(known), 0)} of their time in the RT unit"
    return text + "."


def _traffic(timed: Sequence[Result]) -> list[str]:
    parts = []
    for level, name in (("l1", "L1"), ("l2", "L2"), ("dram", "DRAM")):
        share = measures.mean_ratio(
            timed, "a2rt", "baseline", lambda one, at=level: results.get(one, _bytes(at))
        )
        if share is not None:
            parts.append(f"{formats.percent(share, 0)} at {name}")
    if not parts:
        return []
    text = f"Of the baseline's bytes A²RT moves {', '.join(parts)}, all kinds of data together"
    dram = [results.get(one, "time.utilisation.dram_bus", 0.0) for one in timed]
    text += f"; the DRAM bus is at most {formats.percent(max(dram))} busy in any run"
    return [text + "."]


def _bytes(level: str) -> str:
    return f"memory.levels.{level}.bytes"


def _boxes(timed: Sequence[Result]) -> list[str]:
    """More tests are the price of coarser boxes; they eat part of the gain."""

    def tests(one: Result) -> int:
        return sum(results.get(one, f"events.{kind}", 0) for kind in ("box_test", "qbox_test"))

    def triangles(one: Result) -> int:
        return results.get(one, "events.triangle_test", 0)

    timed = results.primary(timed)
    boxes = measures.mean_ratio(timed, "a2rt", "baseline", tests)
    leaves = measures.mean_ratio(timed, "a2rt", "baseline", triangles)
    if boxes is None or leaves is None:
        return []
    text = (
        f"A²RT tests {formats.percent(boxes, 0)} as many boxes and {formats.percent(leaves, 0)} "
        "as many triangles as the baseline"
    )
    if max(boxes, leaves) > 1:
        text += ": more tests are the price of its coarser boxes, which smaller nodes and testers "
        text += "have to win back"
    return [text + "."]


def _losses(timed: Sequence[Result]) -> list[str]:
    """A unit that loses hits skips work: its speed there is not earned."""
    out = []
    for unit in ("aqb8", "a2rt"):
        chosen = measures.runs_of(results.primary(timed), unit)
        lost = {results.workload_name(one): (results.lost_hits(one) or 0, one) for one in chosen}
        worst = sorted(lost.items(), key=lambda item: -item[1][0])[:4]
        named = [
            f"{count:,} of {formats.count(one['workload'].get('rays'))} on {name}"
            for name, (count, one) in worst
            if count
        ]
        if named:
            out.append(
                f"{unit} loses closest hits: {', '.join(named)}. Work that is not done because a "
                "hit is missed also makes a unit faster; such speedups are no gain."
            )
    return out


def _latencies(timed: Sequence[Result]) -> list[str]:
    for one in timed:
        if results.unit_name(one) == "a2rt":
            box = results.get(one, "time.testers.box.latency")
            qbox = results.get(one, "time.testers.qbox.latency")
            clock = results.get(one, "gpu.core_mhz")
            if box and qbox and clock:
                return [
                    f"Configured here: all units run at {clock:g} MHz; a BOX test takes {box} "
                    f"cycles and a QBOX test {qbox}. The paper also credits a shorter critical "
                    "path, which a common clock does not give to any unit."
                ]
    return []
