"""What committed text must not contain, and how it must be formatted."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from a2rt_cli.paths import ROOT, SCRIPTS

TEXT_SUFFIXES = {
    "",
    ".cmake",
    ".cpp",
    ".csv",
    ".glsl",
    ".h",
    ".html",
    ".j2",
    ".json",
    ".md",
    ".py",
    ".rchit",
    ".rgen",
    ".sh",
    ".sv",
    ".toml",
    ".txt",
    ".yaml",
}
# Hosts of package registries, split so that this file does not hold them itself.
REGISTRY_HOSTS = [
    "deb.debian" + ".org",
    "pypi" + ".org",
    "pythonhosted" + ".org",
    "registry.npmjs" + ".org",
    "crates" + ".io",
    "proxy.golang" + ".org",
    "repo.maven" + ".apache.org",
    "repo1.maven" + ".org",
]
# Places of one machine; a reader has none of them.
MACHINE_PATH = re.compile(r"(?<![\w./-])/(work|home/\w+|root|Users/\w+)/[\w.]")


def text_files(tracked: list[Path]) -> list[Path]:
    return [path for path in tracked if path.suffix in TEXT_SUFFIXES]


def occurrences(files: list[Path], pattern: re.Pattern) -> list[str]:
    found = []
    for path in files:
        text = path.read_text(encoding="utf-8", errors="replace")
        for number, line in enumerate(text.splitlines(), 1):
            if pattern.search(line):
                found.append(f"{path.relative_to(ROOT)}:{number}: {line.strip()[:100]}")
    return found


def test_no_file_names_the_host_of_a_package_registry(tracked):
    pattern = re.compile("|".join(re.escape(host) for host in REGISTRY_HOSTS))
    assert pattern.search("see https://" + REGISTRY_HOSTS[0] + "/debian")
    assert not occurrences(text_files(tracked), pattern)


def test_no_file_names_a_place_on_the_machine_it_was_written_on(tracked):
    assert MACHINE_PATH.search("open /wor" + "k/x") and MACHINE_PATH.search("'/hom" + "e/me/x'")
    assert not occurrences(text_files(tracked), MACHINE_PATH)


def test_python_is_clean_by_ruff(tracked):
    files = [str(path) for path in tracked if path.suffix == ".py"]
    for mode in (["check"], ["format", "--check"]):
        command = [sys.executable, "-m", "ruff", *mode, "--no-cache"]
        command += ["--config", str(SCRIPTS / "pyproject.toml"), *files]
        reply = subprocess.run(command, capture_output=True, text=True, check=False)
        assert reply.returncode == 0, reply.stdout + reply.stderr


def test_cpp_is_clean_by_clang_format(tracked):
    tool = Path(sys.executable).parent / "clang-format"
    if not tool.exists() and not shutil.which("clang-format"):
        pytest.skip("clang-format of requirements-dev.txt is not installed")
    program = str(tool) if tool.exists() else "clang-format"
    files = [str(path) for path in tracked if path.suffix in {".cpp", ".h"}]
    command = [program, "--dry-run", "--Werror", "--style=file", *files]
    reply = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert reply.returncode == 0, reply.stderr[-3000:]


def test_the_launcher_is_valid_posix_shell():
    reply = subprocess.run(["sh", "-n", str(SCRIPTS / "a2rt")], capture_output=True, check=False)
    assert reply.returncode == 0
