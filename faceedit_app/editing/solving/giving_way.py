"""How far what was not asked for gives way to what was.

Reach meets what edits ask for, and holds the other curves as firmly as `TakeRegion.free` says.
Where the channels that the take uses cannot do both, others may help, as for a curve that is not
met. And no face lowers its lip by 3 mm while its lips stay together: where nothing helps, the lips
part by as much as the lip was asked to move, and the lip goes as far as that takes it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from faceedit_app.core.arrays import Doubles
from faceedit_app.editing.solving.reach import HELD_MM, Goal

# The take's own range is left, little by little, for a curve that misses its target by this much,
# and for one that gives way by this many times what it may.
_MISSING_MM, _TIMES = 0.2, 2.0
# mm: how softly at most what cannot be met together is asked for.
_SOFTEST_MM = 1.0
# mm by which an answer may make lips pass each other.
PASSING_MM = 0.5


def missing(goal: Goal, targets: Doubles, reached: Doubles, rising: Doubles) -> Doubles:
    """(N,) in 0..1: how far the take is to be left for what other faces do.

    Args:
        goal: what was asked for.
        targets, reached: (N, C) mm, where curves should be and where they are.
        rising: (N, C) mm by which curves that were not asked for rise with those that were.
    """
    away = np.abs(targets - reached) - goal.tolerance
    asked = (away - _MISSING_MM) * goal.firm
    others = np.maximum(reached - targets - rising, targets - reached) - _TIMES * goal.free
    lacking = np.where(goal.asked, asked, others - goal.tolerance).max(axis=1)
    most: Doubles = lacking.clip(0.0, 1.0)
    return most


def contradictions(goal: Goal, targets: Doubles, reached: Doubles) -> Doubles:
    """(N, C) mm by which curves that were asked for together miss what cannot be met together.

    Args:
        goal: what was asked for.
        targets, reached: (N, C) mm, where curves should be and where they are.
    """
    together = goal.asked.sum(axis=1, keepdims=True) > 1
    away = (np.abs(targets - reached) - goal.tolerance - _MISSING_MM) * goal.firm
    missed: Doubles = np.where(goal.asked & together, np.clip(away, 0.0, _SOFTEST_MM), 0.0)
    return missed


def kept(parted: Doubles, asked: Doubles, firm: Doubles, naturalness: float) -> Doubles:
    """(N,) in 0..1: the share of an answer that parts or shuts lips no farther than was asked.

    Args:
        parted: (N,) mm by which the opening of the mouth changes although nobody asked for it.
        asked: (N,) mm, the farthest that another curve was asked to move.
        firm: (N,) in 0..1, how firmly the opening is asked for.
        naturalness: 1 keeps to it, 0 does not.
    """
    may = (HELD_MM + asked) / naturalness if naturalness > 0 else np.inf
    share = np.minimum(1.0, may / np.maximum(np.abs(parted), 1e-9))
    soft: Doubles = share + firm * (1.0 - share)
    return soft


def unpassed(before: Doubles, after: Doubles) -> Doubles:
    """(N,) in 0..1: the share of an answer up to which lips do not pass each other.

    Args:
        before, after: (N,) mm, how high one lip is above the other.
    """
    lowest = np.minimum(before, 0.0) - PASSING_MM
    share: Doubles = (before - lowest) / np.maximum(before - after, 1e-9)
    return np.where(after < lowest, np.minimum(share, 1.0), 1.0)


def firmness(change: Doubles, hold: Doubles, leaders: Sequence[int]) -> Doubles:
    """(N, C) in 0..1, how firmly changes of curves are given, see `Expectation.expected`.

    Args:
        change: (N, C) mm; that of companions is given as firmly as what they follow.
        hold: (N, C) in 0..1, how firmly curves are asked for.
        leaders: positions of the curves that others follow.
    """
    firmest = hold.max(axis=1, keepdims=True, initial=0.0)
    firm: Doubles = hold / np.where(firmest > 0, firmest, 1.0)
    follows = (change != 0) & (hold <= 0)
    if follows.any():
        leading = firm[:, leaders].max(axis=1, keepdims=True, initial=0.0)
        firm = np.where(follows, np.where(leading > 0, leading, 1.0), firm)
    return firm
