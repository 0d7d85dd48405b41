"""Check sizes before memory is allocated, so that a small file cannot ask for much of it."""

from __future__ import annotations

import stat
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from faceedit_app.core.errors import FileError, reason_of

LARGEST_FILE = 1 << 30  # bytes
_FARTHEST = 1e9  # units of a file; no head is larger
MOST_VERTICES = 6_000_000
MOST_TRIANGLES = 6_000_000
MOST_PARTS = 2_000
MOST_TARGETS = 4_000
# All displacements together: 52 targets of a scan with 2 million triangles take 0.6e9.
MOST_TARGET_BYTES = 1_500_000_000


class Damaged(ValueError):
    """A file contradicts itself; the text, a phrase, goes into a `FileError`."""


def read_file(path: Path, largest: int = LARGEST_FILE) -> bytes:
    """The content of a regular file.

    Raises:
        FileError: it is missing, not a regular file (a pipe may never end), or too large.
    """
    try:
        status = path.stat()
        if not stat.S_ISREG(status.st_mode):
            raise FileError(path, "is not a regular file", "choose a character file")
        if status.st_size > largest:
            size, most = status.st_size >> 20, largest >> 20
            raise FileError(path, f"has {size} MB, more than {most}", "export a smaller one")
        return path.read_bytes()
    except OSError as error:
        reason = reason_of(error)
        raise FileError(path, f"cannot be read ({reason})", "check the path") from error
    except ValueError as error:  # a path with a zero character
        raise FileError(path, "is not a path", "check the path") from error


def whole(value: Any, what: str, most: int, least: int = 0) -> int:
    """A whole number from a file, within bounds.

    Raises:
        Damaged: it is not a whole number, or out of bounds.
    """
    if isinstance(value, bool) or not isinstance(value, int):
        raise Damaged(f"{what} is not a whole number")
    if not least <= value <= most:
        raise Damaged(f"{what} is {str(value)[:20]}, it must be from {least} to {most}")
    return value


def finite(array: NDArray[Any], what: str) -> NDArray[Any]:
    """Check that an array holds only plausible numbers, and return it.

    Raises:
        Damaged: a number is NaN, infinite or far too large.
    """
    # NaN and infinity show in the minimum and the maximum.
    if array.size and not (array.min() > -_FARTHEST and array.max() < _FARTHEST):
        if not np.isfinite(array).all():
            raise Damaged(f"{what} are not numbers")
        largest = float(max(-array.min(), array.max()))
        raise Damaged(f"{what} are too large, up to {largest:.0e}")
    return array


def indices_within(faces: NDArray[Any], count: int) -> NDArray[np.int32]:
    """(F, 3) int32 triangles of a mesh with `count` vertices.

    Raises:
        Damaged: a triangle names a vertex that does not exist.
    """
    if faces.size and not (faces.min() >= 0 and faces.max() < count):
        raise Damaged("a triangle names a vertex that does not exist")
    return np.ascontiguousarray(faces, np.int32)


def check_targets(vertices: Sequence[int], targets: Sequence[int]) -> None:
    """Check that the displacements of all parts fit into memory.

    Args:
        vertices, targets: the numbers of each part.

    Raises:
        Damaged: they do not.
    """
    if len(vertices) > MOST_PARTS:
        raise Damaged(f"{len(vertices)} meshes are more than {MOST_PARTS}")
    if sum(vertices) > MOST_VERTICES:
        raise Damaged(f"{sum(vertices)} vertices are more than {MOST_VERTICES}")
    size = sum(12 * v * t for v, t in zip(vertices, targets, strict=True))
    if size > MOST_TARGET_BYTES:
        raise Damaged(
            f"its morph targets take {size >> 20} MB, more than {MOST_TARGET_BYTES >> 20}"
        )
