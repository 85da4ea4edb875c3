"""The command line: every command explains itself, also before anything is installed."""

from __future__ import annotations

import re
import subprocess
import sys

import pytest
from a2rt_cli import app
from a2rt_cli.paths import ROOT, SCRIPTS
from a2rt_cli.setup.needs import Need

DESIGNED = {
    "bench",
    "capture",
    "compare",
    "demo",
    "doctor",
    "inspect",
    "render",
    "report",
    "reproduce",
    "simulate",
    "sweep",
    "test",
}


def bare_help(*words: str) -> subprocess.CompletedProcess:
    """Help from an interpreter without any installed package."""
    code = "import sys; from a2rt_cli.app import main; sys.exit(main(sys.argv[1:]))"
    return subprocess.run(
        [sys.executable, "-S", "-c", code, *words],
        env={"PYTHONPATH": str(SCRIPTS), "PATH": "/usr/bin:/bin", "PYTHONDONTWRITEBYTECODE": "1"},
        capture_output=True,
        text=True,
        check=False,
    )


def test_every_designed_command_exists():
    assert set(app.command_names()) >= DESIGNED


@pytest.mark.parametrize("name", app.command_names())
def test_help_shows_examples_and_needs_no_installed_package(name):
    reply = bare_help(name, "--help")
    assert reply.returncode == 0, reply.stderr
    assert "Examples:" in reply.stdout
    examples = reply.stdout.split("Examples:")[1]
    assert f"scripts/a2rt {name}" in examples


@pytest.mark.parametrize("name", app.command_names())
def test_every_example_parses(name):
    module = app.load(name)
    lines = [line.strip() for line in module.EXAMPLES.splitlines() if line.strip()]
    assert lines
    parser = app.build_parser()
    for line in lines:
        command = re.split(r"\s{2,}", line)[0].split()
        assert command[0] == "scripts/a2rt", line
        parser.parse_args(command[1:])


@pytest.mark.parametrize("name", app.command_names())
def test_every_command_says_what_it_needs(name):
    need = app.load(name).NEED
    assert callable(need) or isinstance(need, Need)


def test_an_unknown_command_is_refused_with_status_2():
    reply = bare_help("no-such-command")
    assert reply.returncode == 2
    assert "no-such-command" in reply.stderr


def readme_commands() -> list[str]:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    blocks = re.findall(r"^```sh\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    lines = [line.split("  #")[0].strip() for block in blocks for line in block.splitlines()]
    return [line for line in lines if line and not line.startswith("#")]


def test_the_readme_shows_the_two_commands():
    assert {"./scripts/a2rt demo", "./scripts/a2rt test"} <= set(readme_commands())


def test_every_command_of_the_readme_parses():
    ours = [line for line in readme_commands() if "scripts/a2rt" in line]
    assert ours
    parser = app.build_parser()
    for line in ours:
        words = line.split()
        start = next(i for i, word in enumerate(words) if word.endswith("scripts/a2rt"))
        parser.parse_args(words[start + 1 :])


def test_every_path_the_readme_names_exists():
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    named = set(
        re.findall(
            r"`((?:a2rt_core|lumibench_configs|scripts|shaders|tests|"
            r"vulkan_sim_patch)/[\w./-]*)`",
            text,
        )
    )
    named = {path for path in named if "NAME" not in path}
    assert named
    assert not [path for path in sorted(named) if not (ROOT / path).exists()]


def lab_commands() -> list[str]:
    lines = []
    for lab in sorted((SCRIPTS / "labs").glob("*.md")):
        blocks = re.findall(r"^```sh\n(.*?)^```", lab.read_text(encoding="utf-8"), re.M | re.S)
        lines += [line for block in blocks for line in block.splitlines() if line.strip()]
    return lines


def test_every_command_of_the_labs_parses():
    lines = lab_commands()
    assert len(lines) > 10
    parser = app.build_parser()
    for line in lines:
        words = line.split()
        assert words[0] == "scripts/a2rt", line
        parser.parse_args(words[1:])


def test_the_list_of_labs_names_every_lab():
    listed = set(re.findall(r"\(([\w-]+\.md)\)", (SCRIPTS / "labs/README.md").read_text("utf-8")))
    assert listed == {path.name for path in (SCRIPTS / "labs").glob("*.md")} - {"README.md"}
