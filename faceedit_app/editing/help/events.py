"""Blinks and lip closures in a take: where they are, when they begin and end, whether they close.

All of it works on curves in millimetres, frame axis first, and takes some milliseconds for ten
minutes at 60 frames a second.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Doubles, Times
from faceedit_app.core.controls import CONTROL_INDEX, LIDS, LIP_OPENING
from faceedit_app.editing.solving.filters import peaks

LID_COLUMNS = [CONTROL_INDEX[lid] for lid in LIDS]
OPENING = CONTROL_INDEX[LIP_OPENING]

# A blink takes 0.3 to 0.4 s in all, and is this wide at half its depth at most (VanderWerf et
# al. 2003); lids that follow the gaze down take longer.
BLINK_WIDTH = 0.4  # seconds
BLINK_DEPTH = 0.25  # of the open eye; less is a flutter or the gaze
SHUT = 0.2  # of the open eye: with less between the lids an eye looks closed
CLOSURE_DEPTH = 1.5  # mm that the lips come together for a closure
CLOSURE_WIDTH = 0.4  # seconds at half its depth
PRESSED = 0.05  # by how much pressed and rolled lips exceed what they are otherwise
APART = 1.5  # mm beyond the take's own closed lips at which they visibly do not meet
NEARLY = (0.4, 5.0)  # lips nearly met within this share of the way to wide open, and mm
_LONGEST = 1.5  # seconds around a dip that are looked at
_BEFORE, _AFTER = 0.2, 0.4  # seconds within which a flank ends


@dataclass(frozen=True)
class Dip:
    """A curve that goes down and comes back.

    Attributes:
        frame: where it is lowest.
        start, end: seconds at which it begins to go down and is back.
        time: seconds of `frame`.
        level: mm at `frame`.
        depth: mm below the lower of its two surroundings.
    """

    frame: int
    start: float
    end: float
    time: float
    level: float
    depth: float


def dips(times: Times, curve: Doubles, rate: float, depth: float, width: float) -> list[Dip]:
    """The places where a curve goes down and back.

    Args:
        times: (T,) seconds.
        curve: (T,) mm.
        rate: frames per second.
        depth: mm that it goes down at least.
        width: seconds at half depth that it takes at most.
    """
    if len(curve) < 3:
        return []
    # A blink of the first or last frames has no shoulder on one side: give it one.
    padded = np.concatenate([[curve.max()], curve, [curve.max()]])
    found = peaks(-padded, depth, width * rate, int(_LONGEST * rate))
    return [_dip(times, curve, rate, peak - 1, deep) for peak, deep in found]


def _dip(times: Times, curve: Doubles, rate: float, frame: int, depth: float) -> Dip:
    """A dip with the ends of its flanks: nine tenths of the way up on either side."""
    low = curve[frame]
    before = curve[max(frame - round(_BEFORE * rate), 0) : frame + 1][::-1]
    after = curve[frame : frame + round(_AFTER * rate) + 1]
    first, last = (
        int(np.argmax(side >= low + 0.9 * (side.max() - low))) for side in (before, after)
    )
    first, last = frame - first, frame + last
    return Dip(
        frame,
        float(times[first]),
        float(times[last]),
        float(times[frame]),
        float(curve[frame]),
        depth,
    )


def open_eyes(lids: Doubles) -> float:
    """Millimetres between the lids of open eyes in a take, from one or more curves (T, ...)."""
    wide = float(np.percentile(lids, 95))
    eyes = lids[lids > 0.4 * wide]
    return float(np.median(eyes)) if len(eyes) else wide


def blinks(times: Times, controls: Doubles, rate: float) -> list[Dip]:
    """All blinks, the incomplete ones too: controls (T, C) mm."""
    both = controls[:, LID_COLUMNS].mean(axis=1)
    return dips(times, both, rate, BLINK_DEPTH * max(open_eyes(both), 0.1), BLINK_WIDTH)


def closed_lips(controls: Doubles) -> float:
    """Millimetres between the inner lips of a closed mouth in a take: controls (T, C) mm."""
    return float(np.percentile(controls[:, OPENING], 2))


def missed_closures(times: Times, controls: Doubles, weights: Doubles, rate: float) -> list[Dip]:
    """Where lips pressed, as for /p b m/, and yet stayed apart.

    The opening alone does not tell an unmet /m/ from an /f/, in which the lower lip meets the
    teeth. Lips that close press and roll in, the upper one too, and it is not raised.

    Args:
        times: (T,) seconds.
        controls: (T, C) mm.
        weights: (T, 52) in ARKit order.
        rate: frames per second.
    """
    opening, closed = controls[:, OPENING], closed_lips(controls)
    wide = float(np.percentile(opening, 95))
    nearly = closed + min(NEARLY[0] * (wide - closed), NEARLY[1])
    pressed = _pressed(weights)
    usual = float(np.median(pressed))
    return [
        dip
        for dip in dips(times, opening, rate, CLOSURE_DEPTH, CLOSURE_WIDTH)
        if closed + APART < dip.level < nearly
        and float(pressed[_around(dip.frame, rate)].max()) > usual + PRESSED
    ]


def _pressed(weights: Doubles) -> Doubles:
    """(T,) how much the lips press on each other."""
    press = weights[:, [ARKIT_INDEX["mouthPressLeft"], ARKIT_INDEX["mouthPressRight"]]].mean(axis=1)
    raised = weights[:, [ARKIT_INDEX["mouthUpperUpLeft"], ARKIT_INDEX["mouthUpperUpRight"]]]
    pressed: Doubles = press + weights[:, ARKIT_INDEX["mouthRollUpper"]] - raised.mean(axis=1)
    return pressed


def _around(frame: int, rate: float) -> slice:
    near = max(round(0.03 * rate), 1)
    return slice(max(frame - near, 0), frame + near + 1)
