"""Programs that a2rt starts end with it."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest
from a2rt_cli.process import ProgramFailed, _ends_with_us, run_logged


def test_a_program_runs_under_the_process_that_asked_for_it(tmp_path: Path):
    run_logged(["touch", str(tmp_path / "made")], tmp_path / "log", what="touch")
    assert (tmp_path / "made").exists()


def test_a_failing_program_keeps_its_own_status(tmp_path: Path):
    with pytest.raises(ProgramFailed) as failed:
        run_logged(["sh", "-c", "exit 7"], tmp_path / "log", what="it")
    assert failed.value.status == 7


@pytest.mark.skipif(shutil.which("setpriv") is None, reason="there is no setpriv here")
def test_a_program_whose_asker_died_while_it_started_does_nothing(tmp_path: Path):
    """The moment between fork and the request to end with us: the parent is another already."""
    command = _ends_with_us(["touch", str(tmp_path / "made")])
    other_parent = ["sh", "-c", '"$@"; exit 0', "sh", *command]
    subprocess.run(other_parent, check=True)
    assert not (tmp_path / "made").exists()
