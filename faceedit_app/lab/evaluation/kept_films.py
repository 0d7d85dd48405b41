"""What was seen in rendered films, kept: rendering takes much longer than fitting."""

from __future__ import annotations

import hashlib
import io
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np

from faceedit_app.core.atomic import write_atomically
from faceedit_app.core.rig import Rig
from faceedit_app.lab.evaluation.rendered_films import Conditions, Truth
from faceedit_app.tracking.film_landmarks import FilmLandmarks

_ARRAYS = ("times", "points", "probabilities", "colors", "lips")


class KeptFilms:
    """Landmarks of rendered films in a folder, by what the films show and how.

    What the renderer and the landmarker do is no part of that: if they change, take another folder.

    Args:
        folder: where they are kept; None = nowhere.
    """

    def __init__(self, folder: Path | None) -> None:
        self._folder = folder
        if folder is not None:
            folder.mkdir(parents=True, exist_ok=True)

    def of(
        self, rig: Rig, truth: Truth, how: Conditions, make: Callable[[], FilmLandmarks]
    ) -> FilmLandmarks:
        """The landmarks of a film; `make` renders and reads it, if that was not done before.

        Raises:
            FileError: they cannot be written.
        """
        if self._folder is None:
            return make()
        path = self._folder / f"{_name(rig, truth, how)}.npz"
        kept = _read(path)
        if kept is None:
            kept = make()
            memory = io.BytesIO()
            np.savez_compressed(
                memory,
                rate=np.array(kept.rate),
                size=np.array(kept.size),
                times=kept.times,
                points=kept.points,
                probabilities=kept.probabilities,
                colors=kept.colors,
                lips=np.zeros(0, np.uint8) if kept.lips is None else kept.lips,
            )
            write_atomically(path, memory.getvalue())
        return kept


def _name(rig: Rig, truth: Truth, how: Conditions) -> str:
    digest = hashlib.sha256(repr(how).encode())
    for values in (truth.weights, truth.times, rig.neutral, rig.deltas):
        digest.update(np.ascontiguousarray(values).tobytes())
    return digest.hexdigest()[:24]


def _read(path: Path) -> FilmLandmarks | None:
    """What is kept in a file; None if it is not there, or damaged."""
    try:
        with np.load(path, allow_pickle=False) as stored:
            times, points, probabilities, colors, lips = (stored[name] for name in _ARRAYS)
            rate, size = float(stored["rate"]), stored["size"].tolist()
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile):
        return None
    shape = size[0], size[1]
    return FilmLandmarks(
        path, times, rate, None, shape, points, probabilities, colors, lips if lips.size else None
    )
