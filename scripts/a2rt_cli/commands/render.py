"""Draw a glTF scene with the Vulkan workload program, as the driver or as an RT unit would.

With --unit the unit's decisions are injected into the running program, which is re-run until no
ray's decision changes: the picture is the one the unit would draw, secondary rays included.
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path

from a2rt_cli import options
from a2rt_cli.setup.needs import Need

EXAMPLES = """  scripts/a2rt render cornell -o cornell.png
  scripts/a2rt render scene.glb --workload ao --size 640x360 --spp 4 -o ao.png
  scripts/a2rt render forest --unit aqb8 -o aqb8.png
  scripts/a2rt render spheres --capture spheres.h5 -o spheres.png
"""
NEED = Need.ENGINE


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("scene", metavar="SCENE", help="embedded scene, .glb or .gltf file")
    options.add_render(parser)
    parser.add_argument("--unit", metavar="U", help="draw what this RT unit would draw")
    options.add_overrides(parser)
    parser.add_argument(
        "--passes", type=int, default=12, metavar="N", help="at most so many runs with --unit (12)"
    )
    parser.add_argument("--capture", metavar="w.h5", help="also write the workload file")
    parser.add_argument("-o", "--output", metavar="x.png", help="picture (SCENE.png)")


def run(args: argparse.Namespace) -> int:
    from a2rt_cli import console
    from a2rt_cli.engine import core, scenes
    from a2rt_cli.errors import UserError
    from a2rt_cli.paths import shown

    scene = scenes.find(args.scene)
    target = Path(args.output or f"{scene.name}.png")
    if target.suffix.lower() != ".png":
        raise UserError(f"{target}: pictures are PNG", "give -o a name that ends in .png")
    if args.overrides and not args.unit:
        raise UserError("--set changes a unit, but there is no --unit", "add --unit a2rt")
    if args.unit:
        core.check_unit(args.unit, args.overrides)
    if scene.note:
        console.note(f"  {scene.note}")
    with console.step(f"Drawing {scene.name}") as step:
        if args.unit is None and args.capture is None:
            summary = _plain(scene, args, target, step)
        else:
            summary = _captured(scene, args, target, step)
    print(f"{shown(target)}: {summary.pop('words')}")
    from a2rt_cli.files import write_json

    write_json(target.with_suffix(".json"), summary)
    return 0


def _plain(scene, args: argparse.Namespace, target: Path, step) -> dict:
    from a2rt_cli.engine import renderer
    from a2rt_cli.files import replacing

    with replacing(target) as temporary:
        drawn = scene.drawn_with(options.render_options(args))
        renderer.render(scene, drawn, temporary, under_layer=False, shown=step)
    return {"words": "drawn by the driver", "scene": scene.name, "unit": None}


def _captured(scene, args: argparse.Namespace, target: Path, step) -> dict:
    import shutil

    from a2rt_cli.engine import capture, pictures, verdict_loop
    from a2rt_cli.files import replacing

    with tempfile.TemporaryDirectory(prefix=".capture-", dir=_folder(target)) as cache:
        render = options.render_options(args)
        captured = capture.from_scene(scene, render, Path(cache), shown=step)
        summary = {"scene": scene.name, "unit": args.unit, "options": render.as_dict()}
        if args.unit is None:
            with replacing(target) as temporary:
                shutil.copyfile(captured.picture, temporary)
            words = "drawn by the driver"
        else:
            outcome = verdict_loop.draw(
                captured,
                args.unit,
                target,
                overrides=tuple(args.overrides),
                max_passes=args.passes,
                shown=step,
            )
            measured = pictures.compare(captured.picture, target)
            end = "converged" if outcome.converged else f"NOT converged after {args.passes}"
            words = (
                f"drawn as {args.unit} would: {outcome.passes} passes, {end}; "
                f"{measured.changed_pixels} of {measured.pixels} pixels differ from the driver's"
            )
            summary.update(measured.as_dict())
            summary.update(passes=outcome.passes, converged=outcome.converged)
            summary["overridden_rays"] = outcome.overridden_rays
        if args.capture:
            with replacing(Path(args.capture)) as temporary:
                shutil.copyfile(captured.file, temporary)
            words += f"; workload in {args.capture}"
    return {"words": words, **summary}


def _folder(target: Path) -> Path:
    target.parent.mkdir(parents=True, exist_ok=True)
    return target.parent
