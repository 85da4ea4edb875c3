"""One job of the sweep's workflow: `python -m a2rt_cli.sweep.worker PLAN capture|batch NAME`."""

from __future__ import annotations

import sys
from pathlib import Path

from a2rt_cli import console
from a2rt_cli.engine import capture, runs
from a2rt_cli.engine.capture import Captured
from a2rt_cli.errors import EXIT_USER, UserError
from a2rt_cli.files import read_json, write_json
from a2rt_cli.sweep import plan

# Printed after every point; who starts the workflow follows its output for it.
FINISHED = "@point"


def make_capture(planned: plan.Plan, out: Path, name: str) -> None:
    """Leaves OUT/captures/NAME.json, which says where the workload file is."""
    called, scene, options = plan.capture_item(planned, name)
    found = capture.from_scene(scene, options, out / ".cache" / "captures", name=called)
    record = {"file": str(found.file), "key": found.key, "picture": str(found.picture)}
    write_json(out / "captures" / f"{name}.json", record)


def make_batch(planned: plan.Plan, out: Path, name: str) -> None:
    """Runs the points of a batch that are not there yet; each is written whole or not at all."""
    for point in planned.batches()[name]:
        if not plan.point_file(out, point).is_file():
            _make_point(planned, out, point)
            print(f"{FINISHED} {point.name}", flush=True)


def _make_point(planned: plan.Plan, out: Path, point: plan.Point) -> None:
    record = read_json(out / "captures" / f"{point.capture}.json")
    called, scene, options = plan.capture_item(planned, point.capture)
    captured = Captured(
        called,
        Path(record["file"]),
        record["key"],
        scene,
        options,
        Path(record["picture"]),
    )
    target = plan.point_file(out, point)
    runs.execute(captured, point.spec, target, out / "pictures")


def main(argv: list[str]) -> int:
    path, kind, name = argv
    planned, out = plan.read(Path(path)), Path(path).parent
    try:
        {"capture": make_capture, "batch": make_batch}[kind](planned, out, name)
    except UserError as error:
        console.note("\n".join(error.lines()))
        return EXIT_USER
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
