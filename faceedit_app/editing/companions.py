"""Controls that follow an edited one although nobody asked: their companions.

Lifting a mouth corner while the mouth keeps its width is a frown, not a smile; nobody who drags
the corner up means that. So the width follows the corners, and the corners the width, by what is
most probable given the edited controls and with all others held (the mean of a Gaussian over the
region's controls, conditioned on the rest). Everything else stays where it was tracked.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from faceedit_app.core.regions import CONTROL_INDEX

Array = NDArray[np.float64]

COMPANIONS: dict[str, tuple[str, ...]] = {
    "left_corner": ("mouth_width",),
    "right_corner": ("mouth_width",),
    "mouth_width": ("left_corner", "right_corner"),
}
# Variance in mm² that is not the region's: keeps nearly redundant controls apart.
JITTER = 0.01


def follow(
    change: Array, edited: NDArray[np.bool_], controls: Sequence[str], covariance: Array
) -> Array:
    """Let companions follow the edited controls of a region.

    Args:
        change: (N, 8) mm: asked-for minus tracked controls.
        edited: (8,) bool: the controls that the user edited.
        controls: ids of the region's C controls.
        covariance: (C, C) mm² of those controls in real performances.

    Returns:
        (N, 8) mm: `change`, and the companions' own.
    """
    columns = np.array([CONTROL_INDEX[c] for c in controls], np.intp)
    followers = {
        companion
        for control in controls
        if edited[CONTROL_INDEX[control]]
        for companion in COMPANIONS.get(control, ())
        if not edited[CONTROL_INDEX[companion]]
    }
    if not followers:
        return change
    free = np.array([c in followers for c in controls])
    given = covariance[np.ix_(~free, ~free)] + JITTER * np.eye(int((~free).sum()))
    gain = np.linalg.solve(given, covariance[np.ix_(~free, free)])
    result = change.copy()
    result[:, columns[free]] += change[:, columns[~free]] @ gain
    return result
