"""Pictures: differences, amplified so that an eye can find them, and their measures."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path

from a2rt_cli.errors import UserError
from a2rt_cli.files import replacing

# Differences are drawn this many times stronger; the report says so beside the picture.
AMPLIFY = 8


@dataclass(frozen=True)
class Difference:
    pixels: int
    changed_pixels: int
    rmse: float  # over the three channels, in [0, 1]
    max_error: float  # largest change of one channel, in [0, 1]
    flip: float  # mean LDR-FLIP, in [0, 1]: what an eye sees at 67 pixels per degree

    def as_dict(self) -> dict[str, float]:
        return asdict(self)


def load(path: Path):
    """A picture as an array (height, width, 3) of bytes."""
    import numpy as np
    from PIL import Image, UnidentifiedImageError

    try:
        with Image.open(path) as image:
            return np.asarray(image.convert("RGB"))
    except (OSError, UnidentifiedImageError) as error:
        raise UserError(f"{path}: not a readable picture ({error})") from error


def _flip(reference, other) -> float:
    """Mean FLIP of two byte pictures (Andersson et al., HPG 2020), by its authors' evaluator."""
    import flip_evaluator
    import numpy as np

    pair = [(picture / 255.0).astype(np.float32) for picture in (reference, other)]
    _, mean, _ = flip_evaluator.evaluate(*pair, "LDR", applyMagma=False)
    return float(mean)


def compare(reference: Path, other: Path) -> Difference:
    """Raises UserError where a picture is unreadable or the sizes differ."""
    import numpy as np

    a, b = load(reference), load(other)
    if a.shape != b.shape:
        raise UserError(f"{other}: {b.shape[1]}x{b.shape[0]}, but {reference} is not")
    delta = np.abs(a.astype(np.int16) - b.astype(np.int16))
    changed = int(np.count_nonzero(delta.max(axis=2)))
    return Difference(
        pixels=int(a.shape[0] * a.shape[1]),
        changed_pixels=changed,
        rmse=float(np.sqrt(np.mean((delta / 255.0) ** 2))),
        max_error=float(delta.max() / 255.0),
        # Equal pictures need no evaluator, whose import takes longer than the comparison.
        flip=_flip(a, b) if changed else 0.0,
    )


def draw_difference(reference: Path, other: Path, target: Path) -> None:
    """Changed pixels in orange on a dim grey copy; the stronger the change the brighter.

    Each changed pixel gets a fainter ring, or a single one would be lost to the eye. Orange on grey
    is told apart by every kind of colour vision, and in print.
    """
    import numpy as np
    from PIL import Image

    a, b = load(reference).astype(np.float32), load(other).astype(np.float32)
    delta = np.abs(a - b).max(axis=2)
    grey = 40.0 + 0.35 * a.mean(axis=2)
    out = np.repeat(grey[:, :, None], 3, axis=2)
    weight = np.where(delta > 0, np.clip(0.45 + AMPLIFY * delta / 255.0, 0, 1), 0)
    ring = np.pad(weight, 1)
    rows, columns = weight.shape
    around = [ring[y : y + rows, x : x + columns] for y in range(3) for x in range(3)]
    weight = np.maximum(weight, 0.4 * np.maximum.reduce(around))[:, :, None]
    orange = np.array([255.0, 149.0, 0.0], dtype=np.float32)
    out = out * (1 - weight) + orange * weight
    with replacing(target) as temporary:
        Image.fromarray(out.clip(0, 255).astype(np.uint8)).save(temporary, format="PNG")
