"""Files that are never half-written, and hashes that name their content."""

from __future__ import annotations

import contextlib
import fcntl
import hashlib
import json
import os
import shutil
import tempfile
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from a2rt_cli.errors import UserError

_CHUNK = 1 << 20


@contextlib.contextmanager
def replacing(target: Path) -> Iterator[Path]:
    """Yields a temporary path beside `target` that replaces it if the block succeeds.

    A reader sees the old file or the whole new one; a block that raises leaves no trace.
    """
    target.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(
        prefix=f".{target.stem}.", suffix=f".partial{target.suffix}", dir=target.parent
    )
    os.close(handle)
    temporary = Path(name)
    try:
        yield temporary
        temporary.chmod(0o644)
        temporary.replace(target)
    finally:
        temporary.unlink(missing_ok=True)


# Names of what a killed run may leave behind.
_LEFTOVERS = (".run-*", ".capture-*", ".*.partial*")


@contextlib.contextmanager
def exclusive(folder: Path) -> Iterator[None]:
    """Only one process writes into `folder` at a time; removes what a killed one left there."""
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / ".lock").open("w") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise UserError(
                f"{folder}: another a2rt is writing there", "wait for it, or choose another -o"
            ) from None
        for pattern in _LEFTOVERS:
            for path in folder.rglob(pattern):
                shutil.rmtree(path) if path.is_dir() else path.unlink()
        yield


def write_text(target: Path, text: str) -> None:
    with replacing(target) as temporary:
        temporary.write_text(text, encoding="utf-8")


def write_json(target: Path, value: Any) -> None:
    write_text(target, json.dumps(value, indent=1, sort_keys=False, allow_nan=False) + "\n")


def hash_file(path: Path) -> str:
    digest = hashlib.sha256()
    with path.open("rb") as stream:
        while chunk := stream.read(_CHUNK):
            digest.update(chunk)
    return digest.hexdigest()


def hash_values(*values: Any) -> str:
    """One hash of JSON-able values; equal values give equal hashes on every machine."""
    return hashlib.sha256(json.dumps(values, sort_keys=True).encode()).hexdigest()


def hash_files(paths: Iterable[Path]) -> str:
    return hash_values([(path.name, hash_file(path)) for path in sorted(paths)])


class HashCache:
    """Hashes of large files, remembered by size and modification time within one process."""

    def __init__(self) -> None:
        self._known: dict[tuple[str, int, int], str] = {}

    def of(self, path: Path) -> str:
        status = path.stat()
        key = (str(path.resolve()), status.st_size, status.st_mtime_ns)
        if key not in self._known:
            self._known[key] = hash_file(path)
        return self._known[key]


def read_json(path: Path) -> Any:
    """Raises UserError if the file is missing or not JSON."""
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise UserError(
            f"{path}: not readable as JSON ({error})", "run the command again"
        ) from error
