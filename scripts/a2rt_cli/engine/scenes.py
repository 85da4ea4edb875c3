"""What a user may name as a scene: an embedded one, a glTF file, or one of the configurations.

lumibench_configs/scenes/NAME.toml says where a scene comes from. A real scene that is not on this
machine is stood in for by an embedded one, drawn with the real scene's effects only; the stand-in
has a name of its own, so that no result can be taken for the real scene's.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

from a2rt_cli.config_table import Table
from a2rt_cli.engine.renderer import RenderOptions
from a2rt_cli.errors import UserError
from a2rt_cli.files import hash_file, hash_values
from a2rt_cli.paths import CONFIGS, SHARED_SCENES, config_folder

FOLDER = CONFIGS / "scenes"
_SUFFIXES = (".glb", ".gltf")


@dataclass(frozen=True)
class SceneConfig:
    """One file of lumibench_configs/scenes."""

    name: str
    title: str
    credit: str
    features: tuple[str, ...]  # effects of shaders/effects that the scene calls for
    embedded: str = ""
    file: str = ""  # a glTF file in $A2RT_SCENES; empty: not distributable as glTF
    stand_in: str = ""  # embedded scene drawn where the file is absent
    lumibench: str = ""  # LumiBench's name of the scene
    number: int = 0  # its number in LumiBench's scene list
    runs: tuple[str, ...] = ()  # workloads of LumiBench's standard runs
    complete: bool = True
    triangles: int = 0

    def path(self) -> Path | None:
        """The scene's file, if it is on this machine."""
        path = SHARED_SCENES / self.file
        return path if self.file and path.is_file() else None


@dataclass(frozen=True)
class Scene:
    name: str
    argument: str  # what a2rt-render is given
    path: Path | None  # None: embedded
    note: str = ""  # what a reader of a result must know: a stand-in, a partial scene
    features: tuple[str, ...] | None = None  # draw with these effects only

    def content_key(self) -> str:
        """Hash of everything the scene is made of, buffers and images beside it included."""
        if self.path is None:
            return hash_values("embedded", self.argument)
        return hash_values([hash_file(path) for path in (self.path, *_companions(self.path))])

    def drawn_with(self, options: RenderOptions) -> RenderOptions:
        """A stand-in is drawn with the real scene's effects; those asked for go before."""
        if self.features is None or options.effects != "auto":
            return options
        effects = [*self.features, *_workload_effects(options.workload)]
        return replace(options, effects=",".join(dict.fromkeys(effects)))


@cache
def configs() -> dict[str, SceneConfig]:
    return {path.stem: _load(path) for path in sorted(FOLDER.glob("*.toml"))}


def _load(path: Path) -> SceneConfig:
    table = Table.read(path)
    config = SceneConfig(
        name=path.stem,
        title=table.get("title", str),
        credit=table.get("credit", str),
        features=tuple(table.get("features", list)),
        embedded=table.get("embedded", str, ""),
        file=table.get("file", str, ""),
        stand_in=table.get("stand_in", str, ""),
        lumibench=table.get("lumibench", str, ""),
        number=table.get("lumibench_number", int, 0),
        runs=tuple(table.get("runs", list, [])),
        complete=table.get("complete", bool, True),
        triangles=table.get("triangles", int, 0),
    )
    table.reject_unknown()
    shown = dict.fromkeys(one for effects in _workloads().values() for one in effects)
    for feature in config.features:
        table.known("features", feature, shown, "effect of a workload")
    for run in config.runs:
        table.known("runs", run, _workloads(), "workload")
    if not config.embedded and not config.stand_in:
        raise UserError(
            f"{path}: {config.name} has neither a scene of its own nor a stand-in",
            'add embedded = "NAME", or file = "NAME.glb" and stand_in = "NAME"',
        )
    if not config.embedded:
        table.known("stand_in", config.stand_in, _embedded_names(), "embedded scene")
    return config


@cache
def _workloads() -> dict[str, list[str]]:
    """Workload -> effects it can show; the project's own, as the scenes' configurations are."""
    files = sorted((CONFIGS / "workloads").glob("*.toml"))
    return {file.stem: Table.read(file).get("effects", list, []) for file in files}


@cache
def _embedded_names() -> tuple[str, ...]:
    """Read before the scenes are: each of the others names one of them."""
    files = sorted(FOLDER.glob("*.toml"))
    return tuple(file.stem for file in files if Table.read(file).get("embedded", str, ""))


def embedded() -> tuple[str, ...]:
    """Names of the scenes that a2rt-render makes itself."""
    return tuple(name for name, config in configs().items() if config.embedded)


def _workload_effects(workload: str) -> list[str]:
    """Effects that a workload brings whatever the scene: its shadow or occlusion rays."""
    path = config_folder("workloads") / f"{workload}.toml"
    if not path.is_file():
        return []
    sampling = Table.read(path).get("sampling", dict, {})
    found = ["shadow", "soft-shadow"] if sampling.get("shadow_rays") else []
    return [*found, "ao"] if sampling.get("ao_rays") else found


def _companions(path: Path) -> list[Path]:
    """Files a .gltf refers to; a .glb carries its own."""
    if path.suffix != ".gltf":
        return []
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
        parts = [*document.get("buffers", []), *document.get("images", [])]
        uris = [part.get("uri", "") for part in parts]
    except (ValueError, AttributeError):
        return []  # a2rt-render reports what is wrong with the file
    files = [path.parent / uri for uri in uris if uri and not uri.startswith("data:")]
    return [file for file in files if file.is_file()]


def is_workload_file(text: str) -> bool:
    return text.endswith((".h5", ".hdf5"))


def find(text: str) -> Scene:
    path = Path(text)
    if path.suffix in _SUFFIXES:
        if not path.is_file():
            raise UserError(f"{text}: no such file", _choices())
        return Scene(path.stem, str(path.resolve()), path.resolve(), _partial(path))
    if text in configs():
        return _configured(configs()[text])
    for suffix in _SUFFIXES:
        shared = SHARED_SCENES / f"{text}{suffix}"
        if shared.is_file():
            return Scene(text, str(shared.resolve()), shared.resolve())
    raise UserError(f"{text}: not a scene", _choices())


def _configured(config: SceneConfig) -> Scene:
    if config.embedded:
        return Scene(config.name, config.embedded, None)
    path = config.path()
    if path is not None:
        return Scene(config.name, str(path.resolve()), path.resolve(), _partial(path))
    return Scene(
        f"{config.stand_in}-for-{config.name}",
        configs()[config.stand_in].embedded,
        None,
        _stand_in_words(config),
        tuple(one for one in config.features if one in configs()[config.stand_in].features),
    )


def _stand_in_words(config: SceneConfig) -> str:
    theirs = configs()[config.stand_in].features
    same = ", ".join(one for one in config.features if one in theirs)
    words = f"{config.title} is not on this machine: {config.stand_in} stands in, with {same} only"
    lacking = [one for one in config.features if one not in theirs]
    return words + (f"; it lacks {', '.join(lacking)}" if lacking else "")


def _partial(path: Path) -> str:
    """Scenes that lack part of their published geometry are called so wherever they appear."""
    for config in configs().values():
        if config.file == path.name and not config.complete:
            return config.title
    return ""


def _choices() -> str:
    present = [one.name for one in configs().values() if one.path() is not None]
    names = ", ".join([*embedded(), *present])
    return f"name a .glb or .gltf file, or one of: {names}; `a2rt scenes` lists all"
