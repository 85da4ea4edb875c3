"""The Vulkan driver the shaders run on: lavapipe with ray-tracing pipelines (Mesa 25.0+)."""

from __future__ import annotations

import json
import os
import platform
import re
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

_ICD_FOLDERS = (Path("/usr/share/vulkan/icd.d"), Path("/usr/local/share/vulkan/icd.d"))
# Where the linker looks for a library named without a folder, that of this machine first.
_LIBRARY_FOLDERS = tuple(
    folder
    for place in (Path("/usr/local/lib"), Path("/usr/lib"))
    for folder in (place / f"{platform.machine()}-linux-gnu", place)
)


@dataclass(frozen=True)
class Driver:
    icd: Path
    name: str  # e.g. "llvmpipe (LLVM 15.0.6, 256 bits)"
    version: str  # e.g. "Mesa 25.0.7"
    ray_tracing: bool


def icd_file() -> Path | None:
    """lavapipe's manifest; the one for this machine's architecture if there are several."""
    found = [path for folder in _ICD_FOLDERS for path in sorted(folder.glob("lvp_icd*.json"))]
    own = [path for path in found if platform.machine() in path.name]
    return (own or found or [None])[0]


def files() -> list[Path]:
    """lavapipe's manifest and library: another Mesa may find other hits."""
    icd = icd_file()
    if icd is None:
        return []
    named = json.loads(icd.read_text(encoding="utf-8"))["ICD"]["library_path"]
    places = (icd.parent,) if "/" in named else _LIBRARY_FOLDERS
    return [icd, *[place / named for place in places if (place / named).is_file()][:1]]


def environment(icd: Path) -> dict[str, str]:
    """Variables that make the loader use only lavapipe, whatever else is installed."""
    # VK_ICD_FILENAMES for loaders before 1.3.207, VK_DRIVER_FILES for later ones.
    return {"VK_ICD_FILENAMES": str(icd), "VK_DRIVER_FILES": str(icd)}


def probe() -> Driver | None:
    """Asks the driver itself; None if there is none or it does not answer."""
    icd = icd_file()
    if icd is None or shutil.which("vulkaninfo") is None:
        return None
    try:
        reply = subprocess.run(
            ["vulkaninfo"],
            env={**os.environ, **environment(icd)},
            capture_output=True,
            text=True,
            errors="replace",
            timeout=120,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return None
    name = re.search(r"deviceName\s*=\s*(.+)", reply.stdout)
    info = re.search(r"driverInfo\s*=\s*(.+)", reply.stdout)
    if name is None:
        return None
    return Driver(
        icd,
        name[1].strip(),
        info[1].strip() if info else "unknown",
        "VK_KHR_ray_tracing_pipeline" in reply.stdout,
    )
