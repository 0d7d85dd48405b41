"""The frames that fills give to gaps: rows of the file that lost the face, and have one again."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Floats, Indices, Times
from faceedit_app.core.clip import Clip
from faceedit_app.formats.take import LostRows


@dataclass(frozen=True, eq=False)
class FilledFrames:
    """Frames that lie between those of a clip, in order of time.

    Attributes:
        times: (M,) seconds.
        before: (M,) the frame of the clip before each of them.
        share: (M,) where it lies between that one and the next, 0..1.
        weights: (M, 52) in ARKit order, as exported.
        controls: (M, C) mm.
    """

    times: Times
    before: Indices
    share: Times
    weights: Floats
    controls: Floats

    def __len__(self) -> int:
        return len(self.times)

    def between(self, values: Floats, number: int) -> Floats:
        """(K,) what lies between the values (T, K) of the frames around one, such as rotations."""
        frame, share = self.before[number], self.share[number]
        mixed: Floats = ((1 - share) * values[frame] + share * values[frame + 1]).astype(np.float32)
        return mixed


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
    return FilledFrames(found.times, found.before, found.share, weights, measure(weights))
