"""Curves that follow an edited one although nobody asked: their companions.

Lifting a mouth corner while the mouth keeps its width is a frown, not a smile; nobody who drags
the corner up means that. So the width follows the corners, and the corners the width, by what is
most probable given what the edit changes and with all others held (the mean of a Gaussian over the
region's controls, conditioned on the rest). Everything else stays where it was.

Each edit brings its own companions, and they are part of what is asked for from then on: a later
edit scales, smooths or resets them as it does all else. A curve that the user has put somewhere is
*claimed* and follows no more. One-click expressions (`Company.ALONG`) take the lips along as well,
and neither claim nor heed claims, so that any of them after any other still is a face.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from faceedit_app.core.arrays import Doubles, Indices
from faceedit_app.core.regions import CONTROL_INDEX
from faceedit_app.editing.edits.edit import Company, Edit, Op

# (leaders, followers): followers move with their leaders, jointly.
COMPANIONS: tuple[tuple[tuple[str, ...], tuple[str, ...]], ...] = (
    (("left_corner", "right_corner"), ("mouth_width",)),
    (("mouth_width",), ("left_corner", "right_corner")),
)
# They follow too where the edit is an expression: a smile with the lips held still is half a frown.
LIPS = ("upper_lip", "lower_lip")
# Variance in mm² that is not the region's: keeps nearly redundant controls apart.
JITTER = 0.01
# They change the shape of a curve and do not put it anywhere.
_SHAPING = (Op.SCALE, Op.SMOOTH, Op.RESET)


@dataclass(frozen=True)
class _Group:
    """Leaders and followers by name, and columns among the eight controls.

    Attributes:
        given: (G,) of all that is not a follower.
        gain: (G, F): how far followers go for a millimetre of each.
    """

    leaders: frozenset[str]
    followers: tuple[str, ...]
    given: Indices
    gain: Doubles

    @classmethod
    def of(
        cls,
        leaders: Sequence[str],
        followers: tuple[str, ...],
        controls: Sequence[str],
        covariance: Doubles,
    ) -> _Group:
        """See `Companions`."""
        free = [controls.index(name) for name in followers]
        given = [i for i in range(len(controls)) if i not in free]
        known = covariance[np.ix_(given, given)] + JITTER * np.eye(len(given))
        gain = np.asarray(np.linalg.solve(known, covariance[np.ix_(given, free)]), np.float64)
        columns = np.array([CONTROL_INDEX[controls[i]] for i in given], np.intp)
        return cls(frozenset(leaders), followers, columns, gain)


class Companions:
    """Who follows whom in a region, and how far.

    Args:
        controls: ids of the region's C controls.
        covariance: (C, C) mm² of those controls in real performances.
    """

    def __init__(self, controls: Sequence[str], covariance: Doubles) -> None:
        known = [pair for pair in COMPANIONS if {*pair[0], *pair[1]} <= {*controls}]
        lips = tuple(name for name in LIPS if name in controls)
        self._groups = {
            company: tuple(
                _Group.of(leaders, followers + more, controls, covariance)
                for leaders, followers in known
            )
            for company, more in ((Company.YIELD, ()), (Company.ALONG, lips))
        }

    def leads(self, edit: Edit) -> bool:
        """Whether something may follow an edit."""
        named = {*edit.controls}
        return edit.companions is not Company.STAY and any(
            group.leaders & named and not {*group.followers} <= named
            for group in self._groups[edit.companions]
        )

    def claims(self, edit: Edit) -> list[int]:
        """The columns that an edit puts somewhere: they follow no other curve any more."""
        if edit.companions is not Company.YIELD or edit.op in _SHAPING:
            return []
        named = {*edit.controls}
        return [
            CONTROL_INDEX[name]
            for group in self._groups[Company.YIELD]
            for name in group.followers
            if name in named and not group.leaders & named
        ]

    def follow(self, edit: Edit, change: Doubles, claimed: Doubles) -> Doubles:
        """How far curves go along with an edit.

        Args:
            change: (N, 8) mm by which the edit changed the curves that it names.
            claimed: (N, 8) in 0..1: how firmly the user has put each curve where it is.

        Returns:
            (N, 8) mm to be added; 0 for the curves that it names.
        """
        added = np.zeros_like(change)
        named = {*edit.controls}
        for group in self._groups[edit.companions]:
            free = [name not in named for name in group.followers]
            if not group.leaders & named or not any(free):
                continue
            columns = [CONTROL_INDEX[n] for n, f in zip(group.followers, free, strict=True) if f]
            way = change[:, group.given] @ group.gain[:, free]
            if edit.companions is Company.YIELD:
                way *= 1.0 - claimed[:, columns]
            added[:, columns] = way
        return added
