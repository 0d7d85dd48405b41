"""Open a take of any format, and export it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from faceedit_app.core.arrays import Floats
from faceedit_app.core.atomic import write_keeping
from faceedit_app.core.errors import FileError
from faceedit_app.formats.encodings import as_utf8, recoded
from faceedit_app.formats.files import read_bytes
from faceedit_app.formats.rates import exact_rate
from faceedit_app.formats.registry import is_take, recognise
from faceedit_app.formats.take import FillableSource, RotatingSource, SureSource, Take

_LOWEST_RATE, _HIGHEST_RATE = 1.0, 1000.0


def open_take(path: Path | str, fps: float | None = None) -> Take:
    """Open a take; the format is recognised by the content, not by the name.

    Args:
        path: the file.
        fps: frames per second; needed if the file does not give them, else it replaces its own.

    Raises:
        RateNeeded: the file does not give its frame rate, and `fps` is None.
        FileError: it is not a take, or is damaged.
    """
    path = Path(path)
    if fps is not None:
        fps = checked_rate(path, fps)
    content, encoding = as_utf8(read_bytes(path))
    form = recognise(path, content)
    return recoded(replace(form.read(path, content, fps), kind=form.name), encoding)


def checked_rate(path: Path, fps: float) -> float:
    """The exact rate for a frame rate that the user gave: 29.97 stands for 30000 / 1001.

    Raises:
        FileError: it cannot be a frame rate.
    """
    if not _LOWEST_RATE <= fps <= _HIGHEST_RATE:
        raise FileError(path, f"cannot have {fps:g} frames per second", "give 1 to 1000")
    return exact_rate(fps)


def write_take(
    path: Path | str,
    take: Take,
    weights: Floats,
    rotations: Floats | None = None,
    confidence: Floats | None = None,
) -> Path | None:
    """Export a take with other weights (T, K), in the format of its source.

    Rotations, (T, 9), and confidence, (T,), as in `Clip`, are those of the take if they are None.

    The file is replaced as a whole, so exporting over the source itself is safe.

    Returns:
        The copy that was kept of a file that was no take; None if there was none.

    Raises:
        FileError: the file cannot be written, or a weight is not a finite number.
    """
    content = encoded_take(path, take, weights, None, rotations, confidence)
    return write_keeping(path, content, is_take)


def encoded_take(
    path: Path | str,
    take: Take,
    weights: Floats,
    found: Floats | None = None,
    rotations: Floats | None = None,
    confidence: Floats | None = None,
) -> bytes:
    """What `write_take` writes.

    Args:
        path: for messages.
        take: the take.
        weights: (T, K).
        found: (L, K) for its `lost_rows`; a row of NaN stays without a face.
        rotations: (T, 9) as in `Clip.rotations`; None = those of the take.
        confidence: (T,) as in `Clip.confidence`; None = that of the take.

    Raises:
        FileError: a weight is not a finite number.
    """
    if weights.shape != take.clip.weights.shape:
        raise ValueError(f"weights {weights.shape} for a clip {take.clip.weights.shape}")
    wrong = np.argwhere(~np.isfinite(weights))
    if len(wrong):
        frame, channel = int(wrong[0, 0]), take.clip.channels[int(wrong[0, 1])]
        raise FileError(
            path,
            f"was not written: {channel} at frame {frame} is not a number",
            "undo the last edit and export again",
        )
    source, tracked = take.source, take.clip.rotations
    if rotations is not None and tracked is not None and isinstance(source, RotatingSource):
        source = source.rotated(tracked, rotations)
    sure = take.clip.confidence
    if confidence is not None and sure is not None and isinstance(source, SureSource):
        source = source.as_sure(sure, confidence)
    if found is not None and isinstance(source, FillableSource):
        source = source.with_faces(found)
    return source.encode(take.clip.weights, weights.astype(np.float32))
