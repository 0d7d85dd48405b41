"""Close lips and lids on the user's character where they are closed on FaceEdit's own.

Where lips or lids are closed on ours and open on theirs, the most probable change of the weights
closes them, while our own controls stay about the same. The closing fades as ours opens, and has
one answer that moves little if the frame does (`within_bounds.py`), so that nothing jumps; where
both are closed, or both open, the weights stay unchanged bit for bit.

What is wanted are heights: they are linear in the weights and say which vertex is above. With plain
distances, the shortest way for two vertices at different depths would be through each other.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from faceedit_app.characters.closure import ARE_LIPS, CLOSING, SHUT, Openings
from faceedit_app.core.arkit import ARKIT_CHANNELS, ARKIT_INDEX
from faceedit_app.core.arrays import Bools, Doubles, Floats
from faceedit_app.core.controls import CONTROL_IDS, CONTROL_INDEX, control_named
from faceedit_app.core.regions import REGIONS, Region
from faceedit_app.core.rig import Distances, Rig
from faceedit_app.editing.solving.reach import ASKED_MM, FREE_MM, NATURAL_LENGTH
from faceedit_app.editing.solving.within_bounds import Squares

# Height of the gap that is left, mm: lips keep clear of each other, lids just meet.
_LEFT = np.where(ARE_LIPS, 0.1, -0.1)
_OF_OURS = np.where(ARE_LIPS, 0.06, 0.0)  # plus this share of the gap on ours
# Lips that meet may differ in depth by this much more than at rest, mm; the goal for depth is met
# less exactly than the one for height, mm.
_IN_FRONT, _DEPTH_MM = 0.1, 0.08
# In units of what counts as closed: if ours is this open, there is no goal for theirs.
_LET_GO = 2.5
_NEEDED = 0.05  # mm; smaller gaps are left
_LEVELLED_PASSES = 4  # for a character with its own strength by channel
_VARIANCE = 0.04  # of a channel without a model
# Added to a model's: it knows how channels vary together on our character, not on theirs.
_MORE_VARIANCE = 0.02
# Standard deviations. Lips that are farther apart on theirs than on ours need a longer change than
# an edit may make; half way, they would still be open.
_LONGEST = 2.0 * NATURAL_LENGTH


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

    All of them are linear in the weights or nearly so, so that frames that are alike close alike.

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
        self._precision = np.linalg.inv(prior[np.ix_(have, have)])
        # Channels as sums of what may change freely: a jaw that carries mouthClose with it.
        self._sums = np.eye(len(names))
        self._jaw: tuple[int, int] | None = None
        if {"mouthClose", "jawOpen"} <= set(names):
            self._jaw = names.index("mouthClose"), names.index("jawOpen")
            self._sums[self._jaw[1], self._jaw[0]] = 1.0
        upwards = np.where(self._heights.offsets[:, 1] < 0, -1.0, 1.0)
        sloping = (self._heights.gradients[..., 1] * upwards, self._depths.gradients[..., 2])
        factors = theirs.levels.factors[:, None]
        self._sloping = (np.hstack(sloping) * factors)[self.columns].T  # (R + L, K)
        self._touch = [control_named(CONTROL_IDS[row]).closes is not None for row in own]

    def close(self, weights: Floats, ours: Doubles, share: Doubles | float) -> None:
        """Close (T, 52) weights as far as possible, in place.

        Args:
            ours: (T, R) mm, the gaps of `rows` on our character.
            share: (T, 1) in 0..1, how far to close.
        """
        left = self._touching + _LEFT[self.rows] + _OF_OURS[self.rows] * ours
        firmness = share * _fading(ours / SHUT[self.rows])
        heights, depths = self._gaps(weights)
        front = _rest(self._depths) + _IN_FRONT
        lower = -firmness * np.maximum(heights - left, 0.0)
        nearer = firmness[:, self._lips] * (np.clip(depths, -front, front) - depths)
        high, deep = lower < -_NEEDED, np.abs(nearer) > _NEEDED
        # What brings lips together must not part them in depth, and the other way round.
        high[:, self._lips] |= deep
        where = np.flatnonzero(high.any(axis=1))
        if len(where):
            asked = np.hstack((high, high[:, self._lips]))[where]
            change = np.hstack((lower, nearer))[where]
            weights[np.ix_(where, self.columns)] = self._moved(weights[where], change, asked)

    def _moved(self, weights: Floats, change: Doubles, asked: Bools) -> Floats:
        """(N, K) the weights of the channels that change heights and depths as wanted.

        Args:
            weights: (N, 52).
            change: (N, R + L) mm.
            asked: (N, R + L) which of the changes are asked for; the others do not count.
        """
        start = weights[:, self.columns].astype(np.float64)
        own = self._own_slopes(weights)
        count, kept = own.shape[:2]
        slopes = np.empty((count, kept + asked.shape[1], len(self.columns)))
        slopes[:, :kept], slopes[:, kept:] = own, self._sloping
        free = np.full((count, kept), FREE_MM)
        near = np.append(np.full(len(self.rows), ASKED_MM), np.full(len(self._lips), _DEPTH_MM))
        noise = np.square(np.hstack((free, np.where(asked, near, FREE_MM))))
        change = np.where(asked, change, 0.0)
        before = np.hstack(self._gaps(weights))
        wanted = np.hstack((np.zeros((count, kept)), change))
        moved = weights.copy()
        # The slopes know a character's strength by channel without its soft limits: what was
        # missed because of them is asked for again.
        for _ in range(_LEVELLED_PASSES if self._levels else 1):
            found = self._most_probable(start, slopes, wanted, noise)
            moved[:, self.columns] = (start + found).astype(np.float32)
            if self._levels:
                wanted[:, kept:] += change - (np.hstack(self._gaps(moved)) - before)
        return moved[:, self.columns]

    def _most_probable(
        self, start: Doubles, slopes: Doubles, wanted: Doubles, noise: Doubles
    ) -> Doubles:
        """(N, K) the smallest believable change of the channels; see `Squares.of`."""
        lower, upper = np.minimum(-start, 0.0), np.maximum(1.0 - start, 0.0)
        if self._jaw is not None:
            close, jaw = self._jaw  # the jaw may not fall behind mouthClose, if it does not already
            lower[:, jaw] = np.minimum(start[:, close] - start[:, jaw], 0.0)
        squares = Squares.of(
            self._sums.T @ self._precision @ self._sums,
            slopes @ self._sums,
            wanted,
            noise,
            (lower, upper),
        )
        change = squares.least() @ self._sums.T
        length = np.sqrt(((change @ self._precision) * change).sum(axis=1, keepdims=True))
        change *= np.minimum(1.0, _LONGEST / np.maximum(length, 1e-9))
        inside: Doubles = np.clip(start + change, 0.0, np.maximum(start, 1.0)) - start
        return inside

    def _gaps(self, weights: Floats) -> tuple[Doubles, Doubles]:
        """Of (N, 52) weights, (N, R) mm the heights, and (N, L) the depths between the lips."""
        shown = self._levels.applied(weights)
        return (
            self._heights.signed(shown).astype(np.float64),
            self._depths.vectors(shown)[..., 2].astype(np.float64),
        )

    def _own_slopes(self, weights: Floats) -> Doubles:
        """(N, C, K) mm by which the channels move our own controls.

        Of those that touch at 0 the height counts: their direction turns about as they shut.
        """
        vectors = self._own.vectors(weights).astype(np.float64)
        lengths = np.linalg.norm(vectors, axis=2, keepdims=True)
        along = vectors / np.maximum(lengths, 1e-6)
        along[:, self._touch] = [0.0, 1.0, 0.0]
        gradients = self._own.gradients[self.columns].astype(np.float64)
        slopes: Doubles = np.einsum("ncx,kcx->nck", along, gradients)
        return slopes


def _along(distances: Distances, axis: int) -> Distances:
    """The distances along one axis; those along Y are negative once a pair has passed."""
    unit = np.zeros(3, np.float32)
    unit[axis] = 1.0
    shuts = np.full(len(distances.shuts), axis == 1)
    return Distances(distances.offsets * unit, distances.gradients * unit, shuts)


def _rest(distances: Distances) -> Doubles:
    """(C,) mm with no weights."""
    rest: Doubles = np.linalg.norm(distances.offsets, axis=1).astype(np.float64)
    return rest


def _fading(openness: Doubles) -> Doubles:
    """1 while closed (openness up to 1), then smoothly down to 0 at `_LET_GO`."""
    t = np.clip((_LET_GO - openness) / (_LET_GO - 1.0), 0.0, 1.0)
    fading: Doubles = t * t * (3.0 - 2.0 * t)
    return fading
