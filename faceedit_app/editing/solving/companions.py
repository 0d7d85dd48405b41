"""Curves that follow an edited one although nobody asked: their companions.

Lifting a mouth corner while the mouth keeps its width is a frown, not a smile; nobody who drags
the corner up means that. So the width follows the corners, and the corners the width, by what is
most probable given what the edit changes and with all others held (the mean of a Gaussian over the
region's controls, conditioned on the rest). Everything else stays where it was. The table of
controls says who leads whom.

Each edit brings its own companions, and they are part of what is asked for from then on: a later
edit scales, smooths or resets them as it does all else. A curve that the user has put somewhere is
*claimed* and follows no more. One-click expressions (`Company.ALONG`) take the lips along as well,
and neither claim nor heed claims, so that any of them after any other still is a face.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from faceedit_app.core.arrays import Doubles, Indices
from faceedit_app.core.controls import CONTROL_INDEX, control_named
from faceedit_app.editing.edits.edit import Company, Edit, Op

# Variance in mm² that is not the region's: keeps nearly redundant controls apart.
JITTER = 0.01
# They change the shape of a curve and do not put it anywhere.
_SHAPING = (Op.SCALE, Op.SMOOTH, Op.RESET)


@dataclass(frozen=True)
class _Group:
    """Leaders and followers by name, and columns among all controls.

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
    """Who follows whom, and how far.

    Args:
        regions: for each region, the ids of its own C controls and (C, C) mm², how they vary
            together in real performances.
    """

    def __init__(self, regions: Mapping[tuple[str, ...], Doubles]) -> None:
        self._groups: dict[Company, list[_Group]] = {Company.YIELD: [], Company.ALONG: []}
        for controls, covariance in regions.items():
            # A smile with the lips held still is half a frown.
            expressive = tuple(name for name in controls if control_named(name).expressive)
            for leaders, followers in _leading(controls):
                for company, more in ((Company.YIELD, ()), (Company.ALONG, expressive)):
                    group = _Group.of(leaders, followers + more, controls, covariance)
                    self._groups[company].append(group)

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
            change: (N, C) mm by which the edit changed the curves that it names.
            claimed: (N, C) in 0..1: how firmly the user has put each curve where it is.

        Returns:
            (N, C) mm to be added; 0 for the curves that it names.
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


def _leading(controls: Sequence[str]) -> list[tuple[tuple[str, ...], tuple[str, ...]]]:
    """(leaders, followers) among controls: those with the same followers lead them jointly.

    A control that leads alone comes last: what follows it and others too, follows it.
    """
    found = []
    for followers in dict.fromkeys(control_named(name).leads for name in controls):
        if followers and {*followers} <= {*controls}:
            leaders = tuple(c for c in controls if control_named(c).leads == followers)
            found.append((leaders, followers))
    return sorted(found, key=lambda pair: len(pair[0]), reverse=True)
