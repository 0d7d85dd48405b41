"""Companions: curves that follow an edited curve although only that one was dragged.

A mouth corner that rises while the mouth keeps its width looks like a frown, not a smile. So the
width follows the corners, and the corners follow the width, by the most probable amount given what
the edit changes and with all others held (the mean of a Gaussian over the region's controls,
conditioned on the rest). All other curves stay. `Control.leads` says which curves follow which.

The companions' changes are part of what is asked for: a later edit scales, smooths or resets them
like any other change. A curve that the user has edited directly is *claimed* and no longer follows.
One-click expressions (`Company.ALONG`) take the lips along as well, and neither make nor respect
claims, so that any of them after any other still gives a believable face.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from faceedit_app.core.arrays import Doubles, Indices
from faceedit_app.core.controls import CONTROL_INDEX, control_named
from faceedit_app.editing.edits.edit import Company, Edit, Op

# Added variance, mm²: keeps nearly redundant controls apart.
JITTER = 0.01
# These change the shape of a curve without setting its value.
_SHAPING = (Op.SCALE, Op.SMOOTH, Op.RESET)


@dataclass(frozen=True)
class _Group:
    """Leaders and followers: their ids, and their columns among all controls.

    Attributes:
        given: (G,) the columns of all controls that do not follow.
        gain: (G, F) mm by which followers move for each millimetre of these.
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
    """Computes how far curves follow edits.

    Args:
        regions: for each region, the ids of its own C controls, and their covariance in
            performances, (C, C) mm².
    """

    def __init__(self, regions: Mapping[tuple[str, ...], Doubles]) -> None:
        self._groups: dict[Company, list[_Group]] = {Company.YIELD: [], Company.ALONG: []}
        for controls, covariance in regions.items():
            # A smile while the lips stay still looks half like a frown.
            expressive = tuple(name for name in controls if control_named(name).expressive)
            for leaders, followers in _leading(controls):
                for company, more in ((Company.YIELD, ()), (Company.ALONG, expressive)):
                    group = _Group.of(leaders, followers + more, controls, covariance)
                    self._groups[company].append(group)

    def leads(self, edit: Edit) -> bool:
        """Whether any curve may follow an edit."""
        if edit.op is Op.SMOOTH:  # shaking is no movement that others join in
            return False
        named = {*edit.controls}
        return edit.companions is not Company.STAY and any(
            group.leaders & named and not {*group.followers} <= named
            for group in self._groups[edit.companions]
        )

    def claims(self, edit: Edit) -> list[int]:
        """The columns that an edit claims: they no longer follow other curves."""
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
        """How far curves follow an edit.

        Args:
            change: (N, C) mm by which the edit changes its own curves.
            claimed: (N, C) in 0..1, how firmly each curve is claimed.

        Returns:
            (N, C) mm to add; 0 for the edit's own curves.
        """
        added = np.zeros_like(change)
        if not self.leads(edit):
            return added
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
    """Pairs (leaders, followers): controls with the same followers lead jointly.

    A control that leads alone comes last, so that it wins over joint leaders.
    """
    found = []
    for followers in dict.fromkeys(control_named(name).leads for name in controls):
        if followers and {*followers} <= {*controls}:
            leaders = tuple(c for c in controls if control_named(c).leads == followers)
            found.append((leaders, followers))
    return sorted(found, key=lambda pair: len(pair[0]), reverse=True)
