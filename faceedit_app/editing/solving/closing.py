"""Close lips and lids on the user's character where they are closed on FaceEdit's own.

Distances measured on the user's character become goals of reach: where lips or lids are closed on
ours and open on theirs, the smallest believable change of the weights closes them, while our own
controls stay about the same. The goal fades as ours opens, so that nothing jumps; where both are
closed, or both open, the weights stay unchanged bit for bit.

The goals are heights: they are linear in the weights and say which vertex is above. With plain
distances, the shortest way for two vertices at different depths would be through each other.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from faceedit_app.characters.closure import ARE_LIPS, CLOSING, SHUT, Openings
from faceedit_app.core.arkit import ARKIT_CHANNELS, ARKIT_INDEX
from faceedit_app.core.arrays import Doubles, Floats
from faceedit_app.core.controls import CONTROL_INDEX, control_named
from faceedit_app.core.levels import Levels
from faceedit_app.core.regions import REGIONS, Region
from faceedit_app.core.rig import Distances, Rig
from faceedit_app.editing.solving.reach import Goal, Reach

# Height of the gap that is left, mm: lips keep clear of each other, lids just meet.
_LEFT = np.where(ARE_LIPS, 0.1, -0.1)
_OF_OURS = np.where(ARE_LIPS, 0.06, 0.0)  # plus this share of the gap on ours
# Lips that meet may differ in depth by this much more than at rest, mm; the goal for depth has
# this share of the precision of the goal for height.
_IN_FRONT, _DEPTH = 0.1, 0.6
# In units of what counts as closed: if ours is this open, there is no goal for theirs.
_LET_GO = 2.5
_ITERATIONS = 8  # the goals of two characters take longer to meet
_NEEDED = 0.05  # mm; smaller gaps are left
_LEVELLED_PASSES = 4  # for a character with its own strength by channel
_VARIANCE = 0.04  # of a channel without a model
# Added to a model's: it knows how channels vary together on our character, not on theirs.
_MORE_VARIANCE = 0.02
# Of reach. Lips that are farther apart on theirs than on ours need a longer change than an edit
# may make; half way, they would still be open.
_NATURALNESS = 0.5


class Closing:
    """Closes lips and lids on the user's character.

    Args:
        ours: the character that the controls are measured on.
        theirs: the user's character.
        channels: the channels that may change, because the take has them.
        covariances: (K, K) of the channels in performances, by region.
    """

    def __init__(
        self,
        ours: Rig,
        theirs: Rig,
        channels: frozenset[str] = frozenset(ARKIT_CHANNELS),
        covariances: Mapping[str, Doubles] | None = None,
    ) -> None:
        self.ours, self.theirs = Openings.of(ours), Openings.of(theirs)
        may = channels if "jawOpen" in channels else channels - {"mouthClose"}
        covariances = covariances or {}
        parts = (
            _Part(region, ours, self.theirs, may, covariances.get(region.id)) for region in REGIONS
        )
        self._parts = [part for part in parts if part.rows.size and part.columns.size]

    def __call__(
        self, weights: Floats, share: Doubles | Mapping[str, Doubles] | None = None
    ) -> Floats:
        """(T, 52) weights with lips and lids closed; other frames are unchanged.

        Args:
            share: (T,) in 0..1, how far to close each frame, for all regions or by region, of
                which those left out stay as they are; None = all the way.
        """
        ours = self.ours.measure(weights)
        closed = weights.copy()
        for part in self._parts:
            mine = share.get(part.region) if isinstance(share, Mapping) else share
            if mine is None and share is not None:
                continue
            part.close(closed, ours[:, part.rows], 1.0 if mine is None else mine[:, None])
        return closed


class _Part:
    """One region: its own controls on our character, and the closures on theirs.

    Attributes:
        region: its id.
        rows: (R,) the entries of `CLOSING` that its channels close.
        columns: (K,) its channels that may change, among the 52.
    """

    def __init__(
        self,
        region: Region,
        ours: Rig,
        theirs: Openings,
        may: frozenset[str],
        covariance: Doubles | None,
    ) -> None:
        self.region, self._levels = region.id, theirs.levels
        mine = [control_named(name).region == region.id for name in CLOSING]
        self.rows = np.flatnonzero(theirs.has & mine)
        have = [i for i, channel in enumerate(region.channels) if channel in may]
        names = [region.channels[i] for i in have]
        self.columns = np.array([ARKIT_INDEX[name] for name in names], np.intp)
        if not self.rows.size or not self.columns.size:
            return
        own = [CONTROL_INDEX[name] for name in region.own if name not in ours.missing_controls]
        self._own = ours.arkit_distances.select(own)
        self._heights = _along(theirs.distances.select(self.rows), 1)
        self._lips = np.flatnonzero(ARE_LIPS[self.rows])
        self._depths = _along(theirs.distances.select(self.rows[self._lips]), 2)
        self._touching = np.where(
            ARE_LIPS[self.rows], np.minimum(_rest(self._heights), theirs.touching[self.rows]), 0.0
        )
        unit = np.eye(len(region.channels))
        prior = _VARIANCE * unit if covariance is None else covariance + _MORE_VARIANCE * unit
        coupled = None
        if {"mouthClose", "jawOpen"} <= set(names):
            coupled = (names.index("mouthClose"), names.index("jawOpen"))
        goals = _joined(
            self._own,
            _levelled(self._heights, theirs.levels),
            _scaled(_levelled(self._depths, theirs.levels), _DEPTH),
        )
        self._linear = goals.select(np.arange(len(own), len(goals.offsets)))
        self._reach = Reach(
            goals,
            self.columns,
            prior[np.ix_(have, have)],
            coupled,
            iterations=_ITERATIONS,
            gain=0.0,
            by_height=False,
        )

    def close(self, weights: Floats, ours: Doubles, share: Doubles | float) -> None:
        """Close (T, 52) weights as far as possible, in place.

        Args:
            ours: (T, R) mm, the gaps of `rows` on our character.
            share: (T, 1) in 0..1, how far to close.
        """
        wanted = _LEFT[self.rows] + _OF_OURS[self.rows] * ours
        firmness = share * _fading(ours / SHUT[self.rows])
        present = self._own.measure(weights).astype(np.float64)
        shown = self._levels.applied(weights)
        heights, depths = self._heights.signed(shown), self._depths.measure(shown)
        goal = heights + firmness * (self._touching + wanted - heights)
        in_front = np.minimum(depths, _rest(self._depths) + _IN_FRONT)
        goal_depth = depths + firmness[:, self._lips] * (in_front - depths)
        # Reach sees how strongly the character answers without its soft limits: what it missed
        # because of them is asked for again.
        for _ in range(_LEVELLED_PASSES if self._levels else 1):
            self._approach(weights, present, goal, goal_depth)

    def _approach(
        self, weights: Floats, present: Doubles, goal: Doubles, goal_depth: Doubles
    ) -> None:
        """Bring (T, 52) weights nearer to their goals, in place.

        Args:
            present: (T, C) mm, our own controls, which stay about the same.
            goal, goal_depth: mm, the heights (T, R) and the depths of lips at most.
        """
        shown = self._levels.applied(weights)
        heights, depths = self._heights.signed(shown), self._depths.measure(shown)
        high, deep = heights - goal > _NEEDED, depths - goal_depth > _NEEDED
        # What brings lips together must not part them in depth, and the other way round.
        high[:, self._lips] |= deep
        asked = np.hstack((high, high[:, self._lips]))
        where = np.flatnonzero(asked.any(axis=1))
        if not len(where):
            return
        here, mine = weights[where].astype(np.float64), present[where]
        asked = np.hstack((np.zeros(mine.shape, np.bool_), asked[where]))
        targets = np.hstack((goal[where], _DEPTH * np.minimum(depths[where], goal_depth[where])))
        if self._levels:
            true = np.hstack((heights[where], _DEPTH * depths[where]))
            targets += self._linear.signed(weights[where]) - true
        wanted = Goal(np.hstack((mine, targets)), np.where(asked, 1.0, 0.0), asked)
        upper = np.maximum(here[:, self.columns], 1.0)
        found = self._reach(here, wanted, upper, _NATURALNESS)
        weights[np.ix_(where, self.columns)] = found.astype(np.float32)


def _along(distances: Distances, axis: int) -> Distances:
    """The distances along one axis; those along Y are negative once a pair has passed."""
    unit = np.zeros(3, np.float32)
    unit[axis] = 1.0
    shuts = np.full(len(distances.shuts), axis == 1)
    return Distances(distances.offsets * unit, distances.gradients * unit, shuts)


def _levelled(distances: Distances, levels: Levels) -> Distances:
    """Distances of weights as the character shows them, as a function of weights without limits."""
    gradients = distances.gradients
    moved = np.einsum("k,kcx->cx", levels.offsets, gradients)
    return replace(
        distances,
        offsets=distances.offsets + moved,
        gradients=gradients * levels.factors[:, None, None],
    )


def _scaled(distances: Distances, by: float) -> Distances:
    scale = np.float32(by)
    return Distances(distances.offsets * scale, distances.gradients * scale, distances.shuts)


def _rest(distances: Distances) -> Doubles:
    """(C,) mm with no weights."""
    rest: Doubles = np.linalg.norm(distances.offsets, axis=1).astype(np.float64)
    return rest


def _joined(*all_: Distances) -> Distances:
    """The distances of several characters, as functions of the same weights."""
    return Distances(
        np.concatenate([one.offsets for one in all_]),
        np.concatenate([one.gradients for one in all_], axis=1),
        np.concatenate([one.shuts for one in all_]),
    )


def _fading(openness: Doubles) -> Doubles:
    """1 while closed (openness up to 1), then smoothly down to 0 at `_LET_GO`."""
    t = np.clip((_LET_GO - openness) / (_LET_GO - 1.0), 0.0, 1.0)
    fading: Doubles = t * t * (3.0 - 2.0 * t)
    return fading
