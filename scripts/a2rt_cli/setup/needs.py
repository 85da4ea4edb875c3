"""How much of the machine a command needs ready."""

from __future__ import annotations

import enum


class Need(enum.IntEnum):
    """Each level includes the ones before it."""

    NOTHING = 0
    PYTHON = 1  # the pinned Python packages
    ENGINE = 2  # the C++ programs and the Vulkan driver
    TESTS = 3  # the tests and the linters they call
    SWEEP = 4  # workflow engine and optimiser (not the tests)
