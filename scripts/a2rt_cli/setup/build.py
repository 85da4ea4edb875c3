"""The CMake build."""

from __future__ import annotations

import contextlib
import re
import shutil
from pathlib import Path

from a2rt_cli import console
from a2rt_cli.errors import UserError
from a2rt_cli.paths import BUILD, LOGS, ROOT, venv_python
from a2rt_cli.process import run_logged

# What the commands other than `test` run; building only these keeps the first call short.
ENGINE_TARGETS = ("a2rt_core/all", "vulkan_sim_patch/all", "shaders/all")
_REMEDY = (
    "if the log names a missing package, run scripts/a2rt doctor; if the tree was changed, mend "
    "the compiler's error; otherwise remove the folder build and run the command again"
)
_NINJA_STEP = re.compile(r"^\[(\d+)/(\d+)\]\s*(.*)$")


def _cache_value(name: str) -> str | None:
    cache = BUILD / "CMakeCache.txt"
    if not cache.exists():
        return None
    match = re.search(rf"^{name}:[A-Z]+=(.*)$", cache.read_text(encoding="utf-8"), re.MULTILINE)
    return match[1] if match else None


def _configured(tests: bool) -> bool:
    if not (BUILD / "build.ninja").exists() or _cache_value("CMAKE_HOME_DIRECTORY") != str(ROOT):
        return False
    return not tests or (
        _cache_value("A2RT_BUILD_TESTS") == "ON"
        and _cache_value("A2RT_PYTHON") == str(venv_python())
    )


def configure(tests: bool) -> None:
    if shutil.which("cmake") is None or shutil.which("ninja") is None:
        raise UserError("cmake or ninja is missing", "run: scripts/a2rt doctor")
    if _cache_value("CMAKE_HOME_DIRECTORY") not in (None, str(ROOT)):
        # A build folder that was moved or copied with the tree cannot be reconfigured in place.
        for name in ("CMakeCache.txt", "build.ninja"):
            (BUILD / name).unlink(missing_ok=True)
        shutil.rmtree(BUILD / "CMakeFiles", ignore_errors=True)
    command = ["cmake", "-S", str(ROOT), "-B", str(BUILD), "-G", "Ninja"]
    command += ["-DCMAKE_BUILD_TYPE=Release", "-DA2RT_TOGETHER=ON"]
    if tests:
        command += ["-DA2RT_BUILD_TESTS=ON", f"-DA2RT_PYTHON={venv_python()}"]
    run_logged(command, LOGS / "setup-build.log", what="configuring the build", remedy=_REMEDY)


def ensure(tests: bool) -> None:
    """Configures and builds what is out of date; says nothing when nothing is."""
    log = LOGS / "setup-build.log"
    targets = () if tests else ENGINE_TARGETS
    title = "Building the tests" if tests else "Building the simulator"
    log.parent.mkdir(parents=True, exist_ok=True)
    log.write_text("", encoding="utf-8")
    with contextlib.ExitStack() as stack:
        shown: console.Step | None = None

        def follow(line: str) -> None:
            # Ninja looks for new files first, every time; a dry run of it would stop there and
            # never say that all is up to date.
            nonlocal shown
            match = _NINJA_STEP.match(line)
            if match is None or match[3].startswith("Re-checking globbed"):
                return
            if shown is None:
                shown = stack.enter_context(console.step(title))
            shown.update(int(match[1]) / int(match[2]), match[3][-50:])

        if not _configured(tests):
            shown = stack.enter_context(console.step(title))
            shown.update(0.0, "cmake")
            configure(tests)
        run_logged(
            ["ninja", "-C", str(BUILD), *targets],
            log,
            what="the build",
            remedy=_REMEDY,
            on_line=follow,
        )


def find_program(name: str) -> Path | None:
    """A built program, wherever its room puts it."""
    for folder in (
        BUILD / "a2rt_core" / "tools",
        BUILD / "shaders",
        BUILD / "vulkan_sim_patch",
        BUILD / "bin",
    ):
        if (folder / name).is_file():
            return folder / name
    return next((p for p in sorted(BUILD.glob(f"*/**/{name}")) if p.is_file()), None)
