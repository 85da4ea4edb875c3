"""How much of the machine a command needs ready."""

from __future__ import annotations

import enum


class Need(enum.IntEnum):
    """Each level includes the ones before it, but sweeps and tests do not include each other."""

    NOTHING = 0
    PYTHON = 1  # the pinned Python packages
    ENGINE = 2  # the C++ programs and the Vulkan driver
    TESTS = 3  # the tests and the linters they call
    SWEEP = 4  # workflow engine and optimiser (not the tests)
    SLOW_TESTS = 5  # the tests, and the compiler of the fuzzers

    @property
    def tests(self) -> bool:
        return self in (Need.TESTS, Need.SLOW_TESTS)

    def includes(self, other: Need) -> bool:
        return self >= other and (self.tests or not other.tests)
