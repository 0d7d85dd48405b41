"""What of the landmarks is drawn over a film, in the colours of the curves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from faceedit_app.core.arrays import Doubles
from faceedit_app.core.controls import CONTROL_INDEX, CONTROLS, LIDS, LIP_OPENING
from faceedit_app.tracking.face_points import (
    CONTROL_PAIRS,
    LEFT_BROW,
    LEFT_LIDS,
    LOWER_INNER_LIP,
    LOWER_OUTER_LIP,
    NOSE,
    RIGHT_BROW,
    RIGHT_LIDS,
    UPPER_INNER_LIP,
    UPPER_OUTER_LIP,
)

ENDING = ".landmarks.npz"
"""Of the file beside a take that holds what is drawn, see `landmark_file.py`."""

_PLAIN = "#c8ccd4"
_LIP_COLOUR, _LID_COLOUR = (
    CONTROLS[CONTROL_INDEX[control]].color for control in (LIP_OPENING, LIDS[0])
)


@dataclass(frozen=True)
class LandmarkPath:
    """A run of landmarks to be joined.

    Attributes:
        landmarks: their numbers.
        color: as `#rrggbb`.
        is_control: whether it joins the two points of a control, which are marked.
    """

    landmarks: tuple[int, ...]
    color: str
    is_control: bool = False


STROKES: tuple[LandmarkPath, ...] = (
    *(LandmarkPath(run, _PLAIN) for run in (LEFT_BROW, RIGHT_BROW, NOSE)),
    *(
        LandmarkPath(run, _LIP_COLOUR)
        for run in (UPPER_OUTER_LIP, LOWER_OUTER_LIP, UPPER_INNER_LIP, LOWER_INNER_LIP)
    ),
    *(LandmarkPath(run, _LID_COLOUR) for run in (LEFT_LIDS, RIGHT_LIDS)),
    *(
        LandmarkPath(pair, CONTROLS[index].color, True)
        for index, pair in CONTROL_PAIRS.items()
        if index in (CONTROL_INDEX[LIP_OPENING], *(CONTROL_INDEX[lid] for lid in LIDS))
    ),
)

DRAWN: tuple[int, ...] = tuple(sorted({n for stroke in STROKES for n in stroke.landmarks}))
"""The landmarks that are drawn."""


def places_of(points: Doubles, stroke: LandmarkPath) -> Doubles:
    """(n, 2) of a stroke's landmarks among points (478, 2 or 3)."""
    places: Doubles = np.asarray(points)[list(stroke.landmarks), :2]
    return places
