"""Set-up: package sources are derived from the system's own, in both of apt's styles."""

from __future__ import annotations

import pytest
from a2rt_cli import app
from a2rt_cli.errors import UserError
from a2rt_cli.paths import SCRIPTS
from a2rt_cli.setup import build, checks, debian
from a2rt_cli.setup.needs import Need

DEB822 = """# a comment
Types: deb deb-src
URIs: http://mirror.example/debian
Suites: bookworm bookworm-updates
Components: main contrib
Signed-By: /usr/share/keyrings/debian-archive-keyring.gpg

Types: deb
URIs: http://mirror.example/debian-security
Suites: bookworm-security
Components: main
"""
ONE_LINE = """# a comment
deb [arch=amd64 signed-by=/etc/key.gpg] http://mirror.example/debian bookworm main contrib
deb-src http://mirror.example/debian bookworm main
"""


def test_backports_are_derived_from_a_deb822_source():
    stanza = debian.backports_stanza(debian.parse_deb822(DEB822), "bookworm")
    assert stanza == (
        "Types: deb\nURIs: http://mirror.example/debian\nSuites: bookworm-backports\n"
        "Components: main\nSigned-By: /usr/share/keyrings/debian-archive-keyring.gpg\n"
    )


def test_backports_are_derived_from_a_one_line_source():
    stanza = debian.backports_stanza(debian.parse_one_line(ONE_LINE), "bookworm")
    assert "URIs: http://mirror.example/debian\n" in stanza
    assert "Signed-By: /etc/key.gpg\n" in stanza


def test_no_source_is_added_where_backports_are_there_already():
    text = DEB822.replace("bookworm-updates", "bookworm-backports")
    assert debian.backports_stanza(debian.parse_deb822(text), "bookworm") is None


def test_a_disabled_source_does_not_count():
    text = DEB822.replace("Types: deb deb-src", "Enabled: no\nTypes: deb")
    with pytest.raises(UserError, match="no apt source offers bookworm main"):
        debian.backports_stanza(debian.parse_deb822(text), "bookworm")


@pytest.mark.parametrize(
    ("version", "least", "enough"),
    [
        ("25.0.7-2~bpo12+1", "25.0", True),
        ("22.3.6-1+deb12u1", "25.0", False),
        ("1:25.0-1", "25.0", True),
        ("24.9.9-1", "25.0", False),
    ],
)
def test_versions_are_compared_by_their_upstream_part(version, least, enough):
    assert debian.upstream_at_least(version, least) is enough


def test_only_the_driver_comes_from_backports():
    packages = debian.wanted_packages()
    assert [package.name for package in packages if package.backports] == ["mesa-vulkan-drivers"]
    names = [package.name for package in packages]
    assert names == list(dict.fromkeys(names))


@pytest.mark.parametrize(
    ("need", "chromium", "clang"),
    [
        (Need.PYTHON, False, False),
        (Need.ENGINE, False, False),
        (Need.SWEEP, False, False),
        (Need.TESTS, True, False),
        (Need.SLOW_TESTS, True, True),
    ],
)
def test_only_the_tests_install_a_browser_and_only_the_slow_ones_clang(need, chromium, clang):
    names = [package.name for package in debian.wanted_packages(need)]
    assert ("chromium" in names) is chromium
    assert ("clang" in names and "libclang-rt-dev" in names) is clang
    assert "cmake" in names


@pytest.mark.parametrize(
    ("words", "need"),
    [
        ([], Need.TESTS),
        (["--tier", "fast"], Need.TESTS),
        (["--tier", "slow"], Need.SLOW_TESTS),
        (["--tier", "all"], Need.SLOW_TESTS),
    ],
)
def test_the_tier_says_how_much_is_installed(words, need):
    arguments = app.build_parser().parse_args(["test", *words])
    assert arguments.module.NEED(arguments) is need


def test_install_commands_name_the_suite_only_for_the_driver():
    packages = [
        debian.Package("cmake"),
        debian.Package("mesa-vulkan-drivers", "25.0", True),
    ]
    plain, ported = debian.install_commands(packages, "bookworm-backports")
    assert plain[-1] == "cmake" and "-t" not in plain
    assert ported[-3:] == ["-t", "bookworm-backports", "mesa-vulkan-drivers"]
    (everything,) = debian.install_commands(packages, None)
    assert everything[-2:] == ["cmake", "mesa-vulkan-drivers"]


@pytest.mark.parametrize("path", sorted(SCRIPTS.glob("requirements*.txt")), ids=lambda p: p.name)
def test_every_python_package_is_pinned_to_one_version(path):
    lines = [line.split("#")[0].strip() for line in path.read_text(encoding="utf-8").splitlines()]
    loose = [line for line in lines if line and "==" not in line]
    assert not loose


def test_doctor_asks_for_what_the_build_makes():
    missing = [name for name in checks.PROGRAMS if build.find_program(name) is None]
    assert missing == []


@pytest.mark.parametrize(
    ("lines", "said"),
    [
        (["ninja: Entering directory", "[0/2] Re-checking globbed directories...", "no work"], ""),
        (["[0/2] Re-checking globbed directories...", "[1/1] Re-running CMake..."], "Building the"),
        (["[0/2] Re-checking globbed directories...", "[1/9] Building CXX x.o"], "Building the"),
    ],
)
def test_a_build_that_is_up_to_date_says_nothing(monkeypatch, capsys, tmp_path, lines, said):
    def ninja(command, log, *, on_line, **_):
        assert command[0] == "ninja"
        for line in lines:
            on_line(line)

    monkeypatch.setattr(build, "LOGS", tmp_path)
    monkeypatch.setattr(build, "_configured", lambda tests: True)
    monkeypatch.setattr(build, "run_logged", ninja)
    build.ensure(tests=False)
    shown = capsys.readouterr().err
    assert shown.strip().startswith(said) and bool(shown) == bool(said)
