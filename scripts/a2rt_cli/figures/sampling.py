"""No figure of the paper: how far cycles extrapolated from a sample of the warps are off.

Every run simulates the sample and all warps, on the same rays.
"""

from __future__ import annotations

from a2rt_cli import console, plotting, results, tables
from a2rt_cli.figures import Context, Drawn

TITLE = "error of sampled simulations against full ones (ours, not the paper's)"
NAME = "sampling"


def draw(context: Context) -> Drawn:
    found = context.runs()
    rows = tables.sample_rows(found)
    errors = [
        abs(error) for one in found if (error := results.get(one, "sample.error")) is not None
    ]
    inside = [one for one in found if _inside(one)]
    refused = [one for one in found if results.get(one, "sample.error") is None]
    text = console.table(tables.SAMPLE_COLUMNS, rows, left=2)
    if errors:
        text += (
            f"\n\nLargest error {max(errors):.1%}, mean {sum(errors) / len(errors):.1%}; the full "
            f"run lies in the 95 % interval in {len(inside)} of {len(errors)} runs."
        )
    for one in refused:
        text += f"\nNo sample of {results.workload_name(one)} with {results.label(one)}: "
        why = results.get(one, "sample.whole_because") or one.get("time_missing")
        text += why or "too few warps"
    numbers = [
        {"workload": results.workload_name(one), "unit": results.label(one), **one["sample"]}
        for one in found
        if one.get("sample")
    ]
    return Drawn(text, [plotting.write_numbers(context.out, NAME, [], samples=numbers)])


def _inside(one) -> bool:
    sample = one.get("sample") or {}
    full = sample.get("full_cycles")
    return full is not None and sample["cycles_low"] <= full <= sample["cycles_high"]
