"""What `a2rt doctor` looks at: each check says what was found and the command that mends it."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass

from a2rt_cli.errors import UserError
from a2rt_cli.paths import SHARED_SCENES
from a2rt_cli.setup import build, debian, driver, python_env
from a2rt_cli.setup.needs import Need

# What the build makes, by the names CMake gives them.
PROGRAMS = ("a2rt-core", "a2rt-render", "libVkLayer_a2rt_capture.so")


@dataclass(frozen=True)
class Finding:
    what: str
    state: str  # "ok", "missing" or "optional"
    found: str
    remedy: str = ""

    def as_dict(self) -> dict[str, str]:
        return asdict(self)


def _version(program: str) -> str:
    reply = subprocess.run([program, "--version"], capture_output=True, text=True, check=False)
    return (reply.stdout or reply.stderr).splitlines()[0] if reply.returncode == 0 else "?"


def _packages() -> Iterator[Finding]:
    missing = debian.missing_packages()
    if not missing:
        yield Finding("Debian packages", "ok", f"{len(debian.wanted_packages())} installed")
        return
    names = ", ".join(
        package.name + (f" (≥ {package.least})" if package.least else "") for package in missing
    )
    try:
        suite = "bookworm-backports" if debian.codename() == "bookworm" else None
        commands = [["apt-get", "update"], *debian.install_commands(missing, suite)]
        remedy = " && ".join(" ".join(command) for command in commands) + "   (as root)"
        if suite and debian.backports_stanza(debian.read_sources(), "bookworm"):
            remedy = "scripts/a2rt demo   (adds bookworm-backports first); or by hand: " + remedy
    except UserError as error:
        remedy = error.remedy
    yield Finding("Debian packages", "missing", names, remedy)


def _test_packages() -> Iterator[Finding]:
    for need, title in (
        (Need.TESTS, "Debian packages of the tests"),
        (Need.SLOW_TESTS, "Debian packages of the slow tests"),
    ):
        names = " ".join(
            package.name for package in debian.missing_packages(need) if package.least_need is need
        )
        if names:
            yield Finding(title, "optional", f"missing: {names}", f"apt-get install {names}")
        else:
            yield Finding(title, "ok", "installed")


def _compilers() -> Iterator[Finding]:
    for program in ("g++", "cmake", "ninja", "glslangValidator"):
        if shutil.which(program):
            yield Finding(program, "ok", _version(program))
        else:
            yield Finding(program, "missing", "not found", "see the line Debian packages")


def _driver() -> Iterator[Finding]:
    found = driver.probe()
    remedy = "install mesa-vulkan-drivers 25.0 or later and vulkan-tools (see Debian packages)"
    if found is None:
        yield Finding("Vulkan driver", "missing", "no lavapipe driver answers", remedy)
    elif not found.ray_tracing:
        text = f"{found.version}: no VK_KHR_ray_tracing_pipeline"
        yield Finding("Vulkan driver", "missing", text, remedy)
    else:
        yield Finding("Vulkan driver", "ok", f"{found.version}, {found.name}, {found.icd}")


def _python() -> Iterator[Finding]:
    for need, title, state in (
        (Need.PYTHON, "Python packages", "missing"),
        (Need.TESTS, "Python packages of the tests", "optional"),
        (Need.SWEEP, "Python packages of sweeps", "optional"),
    ):
        files = python_env.missing(need)
        if not files:
            yield Finding(title, "ok", "as pinned")
            continue
        names = " ".join(f"-r scripts/{path.name}" for path in files)
        remedy = f"python3 -m venv .venv && .venv/bin/pip install {names}"
        yield Finding(title, state, "not installed as pinned", remedy)


def _programs() -> Iterator[Finding]:
    for name in PROGRAMS:
        path = build.find_program(name)
        if path:
            yield Finding(name, "ok", str(path))
        else:
            remedy = "scripts/a2rt demo   (builds it; log in build/logs/setup-build.log)"
            yield Finding(name, "missing", "not built", remedy)


def _scenes() -> Iterator[Finding]:
    names = sorted(path.stem for path in SHARED_SCENES.glob("*.glb"))
    if names:
        yield Finding("Real scenes", "ok", f"{', '.join(names)} in {SHARED_SCENES}")
    else:
        yield Finding(
            "Real scenes",
            "optional",
            f"none in {SHARED_SCENES}",
            "set A2RT_SCENES to a folder of .glb files; the embedded scenes need none",
        )


CHECKS: tuple[Callable[[], Iterator[Finding]], ...] = (
    _packages,
    _test_packages,
    _compilers,
    _driver,
    _python,
    _programs,
    _scenes,
)


def examine() -> list[Finding]:
    return [finding for check in CHECKS for finding in check()]
