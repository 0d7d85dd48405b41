"""Decoded pictures as arrays."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from faceedit_app.core.arrays import Pixels

if TYPE_CHECKING:
    from av import VideoFrame

_EIGHT = 8  # pixels that FFmpeg converts at once


def pixels_of(frame: VideoFrame, width: int, height: int) -> Pixels:
    """(height, width, 4) BGRA of a decoded picture, scaled."""
    from av.video.reformatter import Interpolation

    how = Interpolation.BILINEAR
    if width % _EIGHT:
        # FFmpeg's quick way leaves the last pixels of such rows as the memory was.
        how |= Interpolation.ACCURATE_RND
    # With several threads FFmpeg 8 corrupts pixels at the borders of their slices.
    scaled = frame.reformat(width=width, height=height, format="bgra", interpolation=how, threads=1)
    return np.asarray(scaled.to_ndarray(), np.uint8)
