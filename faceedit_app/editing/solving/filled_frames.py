"""The frames that fills give to gaps: rows of the file that lost the face, and have one again."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Floats, Times
from faceedit_app.core.clip import Clip
from faceedit_app.formats.take import LostRows, RowsBetween, have_faces


@dataclass(frozen=True, eq=False)
class FilledFrames(RowsBetween):
    """The rows with a face as frames that are shown; `weights` are (M, 52), as exported.

    Attributes:
        tracked: (M, C) mm, between those of the frames around the gap: nothing was tracked there.
        asked: (M, C) mm, what the fill and other edits ask for.
        controls: (M, C) mm, the face.
    """

    tracked: Floats
    asked: Floats
    controls: Floats


def filled_frames(
    clip: Clip,
    lost: LostRows,
    rows: Floats,
    asked: Floats,
    tracked: Floats,
    measure: Callable[[Floats], Floats],
) -> FilledFrames | None:
    """The frames of the rows with a face; None if there are none.

    Args:
        clip: the take's, whose channels the rows have.
        lost: where the rows lie.
        rows: (L, K) weights; NaN = without a face.
        asked: (L, C) mm, asked for there.
        tracked: (T, C) mm, of the take's own frames.
        measure: (M, C) mm of weights (M, 52).
    """
    found = lost.with_faces(rows, clip)
    if not len(found):
        return None
    weights = np.zeros((len(found), len(ARKIT_INDEX)), np.float32)
    weights[:, [ARKIT_INDEX[channel] for channel in clip.channels]] = found.weights
    return FilledFrames(
        weights,
        found.times,
        found.before,
        found.share,
        found.between(tracked),
        asked[have_faces(rows)],
        measure(weights),
    )


@dataclass(frozen=True, eq=False)
class AllFrames:
    """The N frames of a take and those that fills give to its gaps, in order of time.

    Attributes:
        clip: their weights in the take's channels, times and rate.
        weights: (N, 52) in ARKit order, with all edits.
        tracked, asked, achieved: (N, C) mm: the three curves of each plot.
    """

    clip: Clip
    weights: Floats
    tracked: Floats
    asked: Floats
    achieved: Floats

    @property
    def times(self) -> Times:
        """(N,) seconds."""
        return self.clip.times

    def with_filled(self, filled: FilledFrames | None) -> AllFrames:
        """These frames of a take with those that fills give to its gaps."""
        if filled is None:
            return self
        at, clip = filled.before + 1, self.clip
        weights = np.insert(self.weights, at, filled.weights, axis=0)
        return AllFrames(
            replace(
                clip,
                weights=weights[:, [ARKIT_INDEX[channel] for channel in clip.channels]],
                times=np.insert(clip.times, at, filled.times),
                gaps=(),
                timecodes=None,
                rotations=None,
                confidence=None,
            ),
            weights,
            np.insert(self.tracked, at, filled.tracked, axis=0),
            np.insert(self.asked, at, filled.asked, axis=0),
            np.insert(self.achieved, at, filled.controls, axis=0),
        )
