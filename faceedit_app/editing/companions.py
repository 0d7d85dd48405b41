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

# (leaders, followers): followers move with their leaders, jointly.
COMPANIONS: tuple[tuple[tuple[str, ...], tuple[str, ...]], ...] = (
    (("left_corner", "right_corner"), ("mouth_width",)),
    (("mouth_width",), ("left_corner", "right_corner")),
)
# Variance in mm² that is not the region's: keeps nearly redundant controls apart.
JITTER = 0.01


def follow(change: Array, hold: Array, controls: Sequence[str], covariance: Array) -> Array:
    """Let companions follow the edited controls of a region, frame by frame.

    Args:
        change: (N, 8) mm: asked-for minus tracked controls.
        hold: (N, 8) in 0..1: how firmly the user asks for each control; a follower that is asked
            for itself follows the less.
        controls: ids of the region's C controls.
        covariance: (C, C) mm² of those controls in real performances.

    Returns:
        (N, 8) mm: `change`, and the companions' own.
    """
    result = change.copy()
    for leaders, followers in COMPANIONS:
        if not set(followers) <= set(controls):
            continue
        lead, free = _positions(leaders, controls), _positions(followers, controls)
        rest = np.setdiff1d(np.arange(len(controls)), np.concatenate([lead, free]))
        given = np.concatenate([lead, rest])
        known = covariance[np.ix_(given, given)] + JITTER * np.eye(len(given))
        gain = np.linalg.solve(known, covariance[np.ix_(given, free)])
        columns = np.array([CONTROL_INDEX[c] for c in controls], np.intp)
        # The rest of the mouth has its say where a leader is edited, and fades in with it.
        said = change[:, columns[given]]
        said[:, len(lead) :] *= hold[:, columns[lead]].max(axis=1, keepdims=True)
        result[:, columns[free]] += (1.0 - hold[:, columns[free]]) * (said @ gain)
    return result


def _positions(names: Sequence[str], controls: Sequence[str]) -> NDArray[np.intp]:
    return np.array([controls.index(name) for name in names], np.intp)
