"""Numbers as people read them. None is shown as a dash, never as zero."""

from __future__ import annotations

import math

NOTHING = "–"
_BYTES = ("B", "KB", "MB", "GB", "TB")


def count(value: float | None) -> str:
    return NOTHING if value is None else f"{int(value):,}"


def size(value: float | None) -> str:
    if value is None:
        return NOTHING
    power = 0
    while value >= 1000 and power < len(_BYTES) - 1:
        value /= 1000
        power += 1
    return f"{value:.0f} {_BYTES[power]}" if power == 0 else f"{value:.2f} {_BYTES[power]}"


def percent(value: float | None, digits: int = 1) -> str:
    if value is None:
        return NOTHING
    if 0 < abs(value) < 0.5 * 10 ** (-digits - 2):
        return f"{value * 100:.1e} %"
    return f"{value * 100:.{digits}f} %"


def factor(value: float | None) -> str:
    return NOTHING if value is None else f"{value:.2f}×"


def energy(picojoule: float | None) -> str:
    if picojoule is None:
        return NOTHING
    for scale, unit in ((1e12, "J"), (1e9, "mJ"), (1e6, "µJ"), (1e3, "nJ")):
        if picojoule >= scale:
            return f"{picojoule / scale:.3g} {unit}"
    return f"{picojoule:.3g} pJ"


def small(value: float | None) -> str:
    return NOTHING if value is None else f"{value:.3g}"


def of_kind(value: float | None, kind: str) -> str:
    """A number of lumibench_configs/paper.toml by its `kind`."""
    writers = {"share": lambda v: percent(v, 2), "ratio": lambda v: percent(v, 2)}
    writers |= {"factor": factor, "count": count}
    return writers[kind](value)


def geometric_mean(values: list[float]) -> float | None:
    """Mean of ratios; None of nothing."""
    good = [value for value in values if value > 0]
    if not good or len(good) != len(values):
        return None
    return math.exp(sum(math.log(value) for value in good) / len(good))
