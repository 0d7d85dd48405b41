"""Find blinks and lip closures in a take, and measure whether they close.

Curves are in millimetres, frame axis first. Ten minutes at 60 frames a second take some
milliseconds.
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

# A blink takes 0.3 to 0.4 s and is at most this wide at half its depth (VanderWerf et al. 2003);
# lids that follow the gaze down take longer.
BLINK_WIDTH = 0.4  # seconds
BLINK_DEPTH = 0.25  # of the eye opening; anything less is a flutter or the gaze
STILL = 0.8  # of the eye opening; a lid that stays above does not blink
SHUT = 0.2  # of the eye opening; an eye that is less open looks closed
CLOSURE_DEPTH = 1.5  # mm by which lips approach each other for a closure
CLOSURE_WIDTH = 0.4  # seconds at half its depth
PRESSED = 0.05  # weight by which pressed and rolled lips exceed their usual level
# mm more than the take's closed lips: visibly apart, and apart for a movement as if to close.
APART, HARDLY_APART = 1.5, 1.0
MOST_OF_THE_WAY = 0.3  # a closure leaves at most this share of the way that the lips have come
RAISED = 0.02  # weight by which an upper lip is raised, as for /f/
NEARLY = (0.4, 5.0)  # lips nearly met if no farther apart than this share of wide open, and mm
_LONGEST = 1.5  # seconds around a dip that are examined
_BEFORE, _AFTER = 0.2, 0.4  # seconds; the longest flanks


@dataclass(frozen=True)
class Dip:
    """A place where a curve goes down and comes back.

    Attributes:
        frame: the lowest frame.
        start, end: seconds; when it begins to go down, and when it is back.
        time: the time of `frame`, seconds.
        level: the curve at `frame`, mm.
        depth: mm below the lower of its two surroundings.
    """

    frame: int
    start: float
    end: float
    time: float
    level: float
    depth: float


def dips(times: Times, curve: Doubles, rate: float, depth: float, width: float) -> list[Dip]:
    """The dips of a curve, in order of time.

    Args:
        times: (T,) seconds.
        curve: (T,) mm.
        rate: frames per second.
        depth: the least depth, mm.
        width: the greatest width at half depth, seconds.
    """
    if len(curve) < 3:
        return []
    # A blink at the start or the end has a shoulder on one side only: add the other one.
    padded = np.concatenate([[curve.max()], curve, [curve.max()]])
    found = peaks(-padded, depth, width * rate, int(_LONGEST * rate))
    return [_dip(times, curve, rate, peak - 1, deep) for peak, deep in found]


def _dip(times: Times, curve: Doubles, rate: float, frame: int, depth: float) -> Dip:
    """The dip at a frame; its flanks end nine tenths of the way up on either side."""
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
    """The usual opening of open eyes in a take, mm, from one or more curves (T, ...)."""
    wide = float(np.percentile(lids, 95))
    eyes = lids[lids > 0.4 * wide]
    return float(np.median(eyes)) if len(eyes) else wide


def blinks(times: Times, controls: Doubles, rate: float, usual: float) -> list[Dip]:
    """All blinks, incomplete ones included.

    Args:
        times: (T,) seconds.
        controls: (T, C) mm.
        rate: frames per second.
        usual: mm, the usual opening of both eyes, in the mean.
    """
    both = controls[:, LID_COLUMNS].mean(axis=1)
    return dips(times, both, rate, BLINK_DEPTH * max(usual, 0.1), BLINK_WIDTH)


def closed_lips(controls: Doubles) -> float:
    """The mouth opening of closed lips in a take, mm, from controls (T, C), mm."""
    return float(np.percentile(controls[:, OPENING], 2))


def pressing(weights: Doubles) -> Doubles:
    """(T,) how much the lips are pressed together, from weights (T, 52)."""
    press = weights[:, [ARKIT_INDEX["mouthPressLeft"], ARKIT_INDEX["mouthPressRight"]]].mean(axis=1)
    raised = weights[:, [ARKIT_INDEX["mouthUpperUpLeft"], ARKIT_INDEX["mouthUpperUpRight"]]]
    pressed: Doubles = press + weights[:, ARKIT_INDEX["mouthRollUpper"]] - raised.mean(axis=1)
    return pressed


def lip_dips(
    times: Times, controls: Doubles, pressed: Doubles, rate: float
) -> list[tuple[Dip, float]]:
    """Where lips approach each other as for a closure, and how much they are pressed there.

    Args:
        times: (T,) seconds.
        controls: (T, C) mm.
        pressed: (T,) of `pressing`, less what is usual.
        rate: frames per second.
    """
    return [
        (dip, float(pressed[_around(dip.frame, rate)].max()))
        for dip in dips(times, controls[:, OPENING], rate, CLOSURE_DEPTH, CLOSURE_WIDTH)
    ]


def _around(frame: int, rate: float) -> slice:
    near = max(round(0.03 * rate), 1)
    return slice(max(frame - near, 0), frame + near + 1)
