"""LumiBench's standard runs by name: `lumi:ship_sh` is the scene ship with shadow rays.

A run is a scene of lumibench_configs/scenes times a workload of lumibench_configs/workloads, at
LumiBench's size and with the workload's own samples. A pattern such as `lumi:*_ao` names several.
"""

from __future__ import annotations

import fnmatch
from dataclasses import dataclass

from a2rt_cli.config_table import Table
from a2rt_cli.engine import scenes
from a2rt_cli.engine.renderer import RenderOptions
from a2rt_cli.engine.scenes import SceneConfig
from a2rt_cli.errors import UserError
from a2rt_cli.paths import config_folder

PREFIX = "lumi:"
SIZE = (128, 128)  # of every standard run
# LumiBench logs its any-hit path tracing as CHSNT_PT.
_LABELS = {"anyhit": "PT"}


@dataclass(frozen=True)
class LumiRun:
    scene: SceneConfig
    workload: str

    @property
    def name(self) -> str:
        return f"{self.scene.name}_{self.workload}"

    @property
    def label(self) -> str:
        """LumiBench's own name of the workload."""
        return _LABELS.get(self.workload, self.workload.upper())

    @property
    def rays(self) -> str:
        """Samples and rays of the workload, as its configuration states them."""
        sampling = Table.read(config_folder("workloads") / f"{self.workload}.toml").get(
            "sampling", dict
        )
        words = [f"{sampling['samples']} spp"]
        for key in ("max_bounces", "shadow_rays", "ao_rays"):
            if key in sampling:
                words.append(f"{sampling[key]} {key.replace('max_', '').replace('_', ' ')}")
        return ", ".join(words)


def is_run(text: str) -> bool:
    return text.startswith(PREFIX)


def options_of(run: LumiRun) -> RenderOptions:
    return RenderOptions(run.workload, *SIZE)


def all_runs() -> list[LumiRun]:
    ordered = sorted(scenes.configs().values(), key=lambda one: one.number)
    return [LumiRun(scene, workload) for scene in ordered for workload in scene.runs]


def find(text: str) -> list[LumiRun]:
    """The runs that `lumi:NAME` or a pattern names; `lumi:all` is all of them."""
    pattern = text.removeprefix(PREFIX).lower()
    pattern = "*" if pattern == "all" else pattern
    found = [run for run in all_runs() if fnmatch.fnmatchcase(run.name, pattern)]
    if not found:
        raise UserError(
            f"{text}: no such LumiBench run", "`a2rt scenes --lumibench` lists them all"
        )
    return found
