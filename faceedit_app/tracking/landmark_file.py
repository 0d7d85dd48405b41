"""The landmarks of a take, kept beside it to be drawn over its film."""

from __future__ import annotations

import io
import zipfile
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from faceedit_app.core.arrays import Doubles, Indices
from faceedit_app.core.atomic import begins_with, write_keeping
from faceedit_app.core.errors import FileError
from faceedit_app.tracking.drawing import DRAWN, ENDING
from faceedit_app.tracking.landmarker import LANDMARKS, SURE

if TYPE_CHECKING:
    from faceedit_app.tracking.tracker import Tracked

_PART = 16.0  # of a pixel, the exactness that is kept
_NONE = np.iinfo(np.int16).min
_LARGEST = 256 << 20  # bytes


@dataclass(frozen=True)
class StoredLandmarks:
    """Landmarks of F pictures.

    Attributes:
        film: the name of the film.
        size: width and height of its pictures, pixels.
        points: (F, n, 2) pixels; NaN where there is no face.
        confidence: (F,) 0..1.
        rows: (478,) the row of each landmark in `points`, -1 if it is not kept.
    """

    film: str
    size: tuple[int, int]
    points: Doubles
    confidence: Doubles
    rows: Indices

    def at(self, index: int) -> Doubles | None:
        """(478, 2) shares of the width and height in a picture, NaN where unknown.

        None if the picture shows no face, or is a gap: there they would be guesses.
        """
        if not 0 <= index < len(self.points) or not np.isfinite(self.points[index, 0, 0]):
            return None
        if self.confidence[index] < SURE:
            return None
        places = np.full((LANDMARKS, 2), np.nan)
        kept = self.rows >= 0
        places[kept] = self.points[index, self.rows[kept]] / self.size
        return places


def beside(take: Path) -> Path:
    """The file that belongs to a take."""
    return take.with_name(take.stem + ENDING)


def files_of(take: Path) -> list[Path]:
    """The files that tracking writes for a take."""
    return [take, beside(take)]


def write_landmarks(tracked: Tracked, take: Path) -> Path | None:
    """Write the landmarks beside a take.

    Returns:
        The copy that was kept of a file that holds none; None if there was none.

    Raises:
        FileError: the file cannot be written.
    """
    film = tracked.landmarks
    points = film.points[:, list(DRAWN), :2] * _PART
    known = np.isfinite(points)
    stored = np.where(known, np.clip(np.nan_to_num(points), -32_000, 32_000), _NONE)
    memory = io.BytesIO()
    np.savez_compressed(
        memory,
        film=np.array(film.path.name),
        size=np.array(film.size),
        numbers=np.array(DRAWN, np.int16),
        points=np.round(stored).astype(np.int16),
        confidence=np.round(255 * tracked.confidence).astype(np.uint8),
    )
    return write_keeping(beside(take), memory.getvalue(), begins_with(b"PK"))  # an NPZ is a ZIP


def read_landmarks(path: Path) -> StoredLandmarks:
    """Read the landmarks of a take.

    Raises:
        FileError: it is something else, or damaged.
    """
    try:
        with zipfile.ZipFile(path) as archive:
            if sum(entry.file_size for entry in archive.infolist()) > _LARGEST:
                raise ValueError
        with np.load(path, allow_pickle=False) as stored:
            numbers, points = stored["numbers"].astype(np.intp), stored["points"]
            film, size = str(stored["film"]), stored["size"].astype(int).tolist()
            confidence = stored["confidence"] / 255.0
        if points.shape != (len(confidence), len(numbers), 2) or len(size) != 2 or min(size) < 1:
            raise ValueError
        rows = np.full(LANDMARKS, -1, np.intp)
        if numbers.min() < 0:
            raise ValueError
        rows[numbers] = np.arange(len(numbers))
    except Exception as error:  # zipfile, zlib and numpy raise all kinds
        raise FileError(path, "does not hold landmarks", "track the film again") from error
    places = np.where(points == _NONE, np.nan, points / _PART)
    return StoredLandmarks(film, (size[0], size[1]), places, confidence, rows)
