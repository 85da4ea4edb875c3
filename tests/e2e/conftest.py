"""Runs a2rt as a user does, in a folder of the test's own."""

from __future__ import annotations

import os
import subprocess
from dataclasses import dataclass
from pathlib import Path

import pytest
from a2rt_cli.paths import BUILD, SCRIPTS, SHARED_SCENES

SMALL = ("--size", "32x32", "--spp", "1")


@dataclass(frozen=True)
class A2rt:
    folder: Path

    def __call__(self, *words: object, **env: str) -> subprocess.CompletedProcess:
        return subprocess.run(
            [str(SCRIPTS / "a2rt"), *map(str, words)],
            cwd=self.folder,
            env={**os.environ, "A2RT_NO_SETUP": "1", "A2RT_BUILD_DIR": str(BUILD), **env},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=600,
            check=False,
        )

    def ok(self, *words: object) -> str:
        reply = self(*words)
        assert reply.returncode == 0, reply.stdout + reply.stderr
        return reply.stdout

    def refused(self, *words: object, status: int = 2) -> str:
        """Ends with `status`, one clear message and no traceback; returns the message."""
        before = sorted(self.folder.rglob("*"))
        reply = self(*words)
        assert reply.returncode == status, reply.stdout + reply.stderr
        assert "Traceback" not in reply.stderr
        assert "error" in reply.stderr
        left = [p for p in sorted(self.folder.rglob("*")) if p.is_file() and p not in before]
        assert [p for p in left if p.name != ".lock"] == []
        return reply.stderr


@pytest.fixture
def a2rt(tmp_path: Path) -> A2rt:
    return A2rt(tmp_path)


@pytest.fixture(scope="session")
def compared(tmp_path_factory) -> Path:
    """One small comparison that several tests look at."""
    folder = tmp_path_factory.mktemp("compared")
    A2rt(folder).ok("compare", "cornell", *SMALL, "--audit", "200", "-o", "out")
    return folder / "out"


@pytest.fixture
def real_scene() -> Path:
    path = SHARED_SCENES / "ship.glb"
    if not path.is_file():
        pytest.skip(f"the real scenes are not in {SHARED_SCENES}")
    return path
