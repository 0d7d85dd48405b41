"""How sure the tracker was of each frame of a take."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

import numpy as np

from faceedit_app.core.arrays import Doubles
from faceedit_app.core.errors import FileError
from faceedit_app.formats.take import Take
from faceedit_app.tracking.drawing import ENDING


def confidence_of(take: Take) -> Doubles | None:
    """(T,) 0..1 for the frames of a take; None if nothing says so.

    Takes of before the column `Confidence` have it only in the file of their landmarks.
    """
    if take.clip.confidence is not None:
        return take.clip.confidence.astype(np.float64)
    path = take.path.with_name(take.path.stem + ENDING)
    try:
        facts = path.stat()
    except OSError:
        return None
    kept = _kept(path, facts.st_mtime_ns, facts.st_size)
    return kept if kept is not None and len(kept) == len(take.clip) else None


@lru_cache(maxsize=4)
def _kept(path: Path, _changed: int, _size: int) -> Doubles | None:
    """(n,) the confidence of the frames that are no gaps."""
    from faceedit_app.tracking.landmark_file import read_landmarks
    from faceedit_app.tracking.landmarker import SURE

    try:
        confidence = read_landmarks(path).confidence
    except FileError:  # the take is complete without it
        return None
    kept: Doubles = np.asarray(confidence)[confidence >= SURE]
    return kept
