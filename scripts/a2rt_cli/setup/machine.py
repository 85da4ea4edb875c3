"""Brings the machine to what a command needs. A prepared machine costs a few file hashes."""

from __future__ import annotations

import json
import os
import sys
import threading
from collections.abc import Callable
from pathlib import Path

from a2rt_cli import console
from a2rt_cli.errors import UserError
from a2rt_cli.files import hash_file, hash_values, write_json
from a2rt_cli.paths import BUILD, venv_python
from a2rt_cli.setup import build, debian, driver, python_env
from a2rt_cli.setup.needs import Need

_STAMP = BUILD / "setup.json"


def _packages_key() -> str:
    """Changes when the package list, the release or the set of installed packages' driver does."""
    icd = driver.icd_file()
    release = Path("/etc/os-release")
    return hash_values(
        hash_file(debian.PACKAGE_FILE),
        hash_file(release) if release.exists() else "",
        hash_file(icd) if icd else "",
    )


def _stamps() -> dict[str, str]:
    try:
        return json.loads(_STAMP.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}


def _packages_stamp(need: Need) -> str:
    if need is Need.SLOW_TESTS:
        return "slow_test_packages"
    return "test_packages" if need.tests else "packages"


def _ensure_packages(need: Need) -> None:
    stamp, key = _packages_stamp(need), _packages_key()
    if _stamps().get(stamp) == key:
        return
    missing = debian.missing_packages(need)
    if missing:
        console.note(f"Packages to install: {' '.join(package.name for package in missing)}")
        with console.step("Installing packages") as shown:
            debian.install(missing, shown.update)
        left = debian.missing_packages(need)
        if left:
            raise UserError(
                f"still missing after the installation: {', '.join(p.name for p in left)}",
                "run: scripts/a2rt doctor",
            )
    with console.step("Checking the Vulkan driver"):
        found = driver.probe()
        if found is None or not found.ray_tracing:
            have = "no lavapipe driver answers" if found is None else f"{found.version} is too old"
            raise UserError(
                f"the Vulkan driver has no ray-tracing pipelines: {have}",
                "lavapipe of Mesa 25.0 or later is needed (package mesa-vulkan-drivers; on "
                "Debian 12 from bookworm-backports); run: scripts/a2rt doctor",
            )
    # The installation may have changed what the key is made of.
    write_json(_STAMP, {**_stamps(), stamp: _packages_key()})


class _Background:
    """Work whose outcome is asked for later; an error is raised then, where it is asked for."""

    def __init__(self, work: Callable[[], None]):
        self._error: BaseException | None = None
        self._thread = threading.Thread(target=self._run, args=(work,), daemon=True)
        self._thread.start()

    def _run(self, work: Callable[[], None]) -> None:
        try:
            work()
        except BaseException as error:
            self._error = error

    def finish(self) -> None:
        self._thread.join()
        if self._error is not None:
            raise self._error


def _install_python(need: Need) -> None:
    with console.step("Installing the Python environment") as shown:
        python_env.create(need, shown.update)


def _continue_in_environment() -> None:
    """From here on the pinned packages are needed: goes on in the environment's interpreter."""
    if not python_env.check_running_from():
        sys.stdout.flush()
        sys.stderr.flush()
        os.execv(venv_python(), [str(venv_python()), "-m", "a2rt_cli", *sys.argv[1:]])


def prepare(need: Need) -> None:
    """Makes `need` true or raises UserError. Prints nothing on a machine that is ready."""
    _ensure_packages(need)
    if need >= Need.ENGINE and not need.tests and python_env.missing(need):
        # The compiler needs the processors and the installation mostly waits: both at once. The
        # tests' build is left out because it asks the environment's interpreter.
        environment = _Background(lambda: python_env.create(need, lambda *_: None))
        build.ensure(tests=False)
        with console.step("Installing the Python environment"):
            environment.finish()
    elif python_env.missing(need):
        _install_python(need)
    _continue_in_environment()
    if need >= Need.ENGINE:
        build.ensure(tests=need.tests)
