"""The frames that fills give to gaps: rows of the file that lost the face, and have one again."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Floats
from faceedit_app.core.clip import Clip
from faceedit_app.formats.take import LostRows, RowsBetween


@dataclass(frozen=True, eq=False)
class FilledFrames(RowsBetween):
    """The rows with a face as frames that are shown; `weights` are (M, 52), as exported.

    Attributes:
        controls: (M, C) mm.
    """

    controls: Floats


def filled_frames(
    clip: Clip, lost: LostRows | None, rows: Floats | None, measure: Callable[[Floats], Floats]
) -> FilledFrames | None:
    """The frames of rows (L, K) with a face; NaN = without. None if there are none.

    Args:
        clip: the take's, whose channels the rows have.
        lost: where the rows lie.
        measure: (M, C) mm of weights (M, 52).
    """
    if lost is None or rows is None:
        return None
    found = lost.with_faces(rows, clip)
    if not len(found):
        return None
    weights = np.zeros((len(found), len(ARKIT_INDEX)), np.float32)
    weights[:, [ARKIT_INDEX[channel] for channel in clip.channels]] = found.weights
    return FilledFrames(weights, found.times, found.before, found.share, measure(weights))
