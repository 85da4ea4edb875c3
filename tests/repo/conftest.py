"""What the repository tests look at: the committed files."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from a2rt_cli.paths import ROOT


@pytest.fixture(scope="session")
def tracked() -> list[Path]:
    """Files of the repository. Others, e.g. the log of whoever runs the tests, are not its own."""
    reply = subprocess.run(
        # The clone may belong to another user than the one who runs the tests.
        ["git", "-c", "safe.directory=*", "ls-files"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    found = [ROOT / line for line in reply.stdout.splitlines()]
    files = [path for path in found if path.is_file()]
    assert files, "git lists no file"
    return files
