"""One job of the sweep's workflow: `python -m a2rt_cli.sweep.worker PLAN capture|point NAME`."""

from __future__ import annotations

import sys
from dataclasses import asdict
from pathlib import Path

from a2rt_cli import console
from a2rt_cli.engine import capture, runs
from a2rt_cli.engine.capture import Captured
from a2rt_cli.errors import EXIT_USER, UserError
from a2rt_cli.files import read_json, write_json
from a2rt_cli.sweep import plan


def make_capture(planned: plan.Plan, out: Path, name: str) -> None:
    """Leaves OUT/captures/NAME.json, which says where the workload file is."""
    scene, options = plan.capture_item(planned, name)
    found = capture.from_scene(scene, options, out / ".cache" / "captures", name=name)
    record = {"file": str(found.file), "key": found.key, "picture": str(found.picture)}
    write_json(out / "captures" / f"{name}.json", record)


def make_point(planned: plan.Plan, out: Path, name: str) -> None:
    point = next(point for point in planned.points if point.name == name)
    record = read_json(out / "captures" / f"{point.capture}.json")
    scene, options = plan.capture_item(planned, point.capture)
    captured = Captured(
        point.capture,
        Path(record["file"]),
        record["key"],
        scene,
        options,
        Path(record["picture"]),
    )
    target = out / "points" / f"{name}.json"
    result = runs.execute(captured, point.spec, target, out / "pictures")
    write_json(target, {**result, "point": asdict(point)})


def main(argv: list[str]) -> int:
    path, kind, name = argv
    planned, out = plan.read(Path(path)), Path(path).parent
    try:
        {"capture": make_capture, "point": make_point}[kind](planned, out, name)
    except UserError as error:
        console.note("\n".join(error.lines()))
        return EXIT_USER
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
