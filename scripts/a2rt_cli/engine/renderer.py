"""Runs a2rt-render, with or without the layer, and any other Vulkan program under it."""

from __future__ import annotations

import contextlib
import os
import re
import shutil
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from a2rt_cli import console
from a2rt_cli.engine import programs
from a2rt_cli.errors import UserError
from a2rt_cli.process import ProgramFailed

if TYPE_CHECKING:
    from a2rt_cli.engine.scenes import Scene

LAYER_NAME = "VK_LAYER_A2RT_capture"
# A program that fails for another reason than its input: shells report signals as 128 + n.
_SIGNAL_STATUS = 128


@dataclass(frozen=True)
class RenderOptions:
    workload: str = "auto"
    width: int = 128
    height: int = 128
    spp: int | None = None  # None: what the workload asks for
    seed: int = 1
    effects: str = "auto"

    def arguments(self) -> list[str]:
        words = ["--workload", self.workload, "--size", f"{self.width}x{self.height}"]
        if self.spp is not None:
            words += ["--spp", str(self.spp)]
        return [*words, "--seed", str(self.seed), "--effects", self.effects]

    def as_dict(self) -> dict[str, object]:
        return asdict(self)


def parse_size(text: str) -> tuple[int, int]:
    """ "1280x720" as (1280, 720); for argparse."""
    width, cross, height = text.lower().partition("x")
    if not (cross and width.isdigit() and height.isdigit() and int(width) and int(height)):
        raise ValueError(f"{text}: a size is WIDTHxHEIGHT, for example 128x128")
    return int(width), int(height)


def layer_environment(**settings: str | Path) -> dict[str, str]:
    """Variables that put our layer, and only lavapipe, under a Vulkan program."""
    folder = str(programs.layer_library().parent)
    # The loader looks for its explicit layers in VK_LAYER_PATH only; keep what the user has there.
    search = os.pathsep.join(filter(None, [folder, os.environ.get("VK_LAYER_PATH", "")]))
    layers = os.pathsep.join(filter(None, [LAYER_NAME, os.environ.get("VK_INSTANCE_LAYERS", "")]))
    return {
        **programs.lavapipe(),
        "VK_LAYER_PATH": search,
        "VK_INSTANCE_LAYERS": layers,
        **{name: str(value) for name, value in settings.items()},
    }


@contextlib.contextmanager
def scratch(beside: Path) -> Iterator[Path]:
    """A folder for a raw capture on the disk of the result; removed whatever happens."""
    beside.mkdir(parents=True, exist_ok=True)
    folder = Path(tempfile.mkdtemp(prefix=".capture-", dir=beside))
    try:
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def render(
    scene: Scene,
    options: RenderOptions,
    picture: Path,
    *,
    capture: Path | None = None,
    verdicts: Path | None = None,
    under_layer: bool = True,
    shown: console.Step | None = None,
    extra: Sequence[str] = (),
    environment: Mapping[str, str] | None = None,
) -> list[str]:
    """Draws a scene into `picture`; with `capture`, leaves a raw capture in that folder."""
    settings: dict[str, str | Path] = {}
    if capture is not None:
        settings["A2RT_CAPTURE"] = capture
    if verdicts is not None:
        settings["A2RT_VERDICTS"] = verdicts
    env = layer_environment(**settings) if under_layer else programs.lavapipe()
    env |= environment or {}
    command = [programs.program("a2rt-render"), scene.argument, *options.arguments()]
    command += ["-o", str(picture), *extra]
    log = programs.log_file(f"render-{scene.name}-{os.getpid()}")
    lines = programs.call(command, what=f"drawing {scene.name}", log=log, env=env, shown=shown)
    if capture is not None:
        require_capture(capture, "a2rt-render", log)
    return lines


def _layers_reason(log: Path) -> str:
    """Why the layer gave up a capture it had begun, in its own words, e.g. a full disk."""
    said = re.findall(r"^a2rt-layer: (cannot write .*)$", log.read_text("utf-8", "replace"), re.M)
    return str(said[0]) if said else ""


def require_capture(folder: Path, name: str, log: Path) -> None:
    """The layer renames manifest.bin into place last: without it there is no whole capture."""
    if not (folder / "manifest.bin").is_file():
        if reason := _layers_reason(log):
            raise UserError(f"{name} ran, but its rays could not be captured: {reason}", "", log)
        raise UserError(
            f"{name} ended without a ray-tracing capture",
            "is it a Vulkan program that traces rays (vkCmdTraceRays or ray queries), started "
            "with the arguments that make it do so? The log says what the layer saw",
            log,
        )


def capture_program(
    command: Sequence[str], folder: Path, shown: console.Step | None = None
) -> None:
    """Runs a foreign Vulkan program under the layer; raw capture into `folder`."""
    if shutil.which(command[0]) is None:
        found = Path(command[0]).is_file()
        what = "is a file, but no executable one" if found else "no such program"
        raise UserError(f"{command[0]}: {what}", "name an executable after `--`")
    name = Path(command[0]).name
    log = programs.log_file(f"capture-{name}-{os.getpid()}")
    env = layer_environment(A2RT_CAPTURE=folder)
    try:
        programs.call(command, what=f"{name} under the layer", log=log, env=env, shown=shown)
    except ProgramFailed as error:
        crashed = error.status < 0 or error.status > _SIGNAL_STATUS
        error.remedy = (
            "run it without the layer on the same driver to see whether it crashes alone; "
            "if it does not, please report the log"
            if crashed
            else "the program itself reported a failure; its last lines are above"
        )
        raise
    require_capture(folder, name, log)
