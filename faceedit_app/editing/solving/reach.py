"""Reach: the smallest believable change of weights that brings controls to what was asked for.

The networks answer an edit with a believable face near what was asked for; reach goes the rest of
the way. Of all weight changes that do so, it finds the most probable one under the covariance of
the region's channels in performances: a maximum a posteriori estimate with a Gaussian prior, by
damped Gauss-Newton on the rig's distances, with the bounds as an active set.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from faceedit_app.core.arrays import Bools, Doubles, Indices
from faceedit_app.core.rig import Distances
from faceedit_app.editing.solving.reach_frames import Frames, Reached, at, limited, solved

Rows = slice | Indices  # some frames of a request

ITERATIONS = 4
# Shorter steps, tried if a full one leads farther away.
STEPS = np.array([0.6, 0.3, 0.1, 0.0])
# A frame is done if its weights moved by no more than this: the next step would be a small part of
# that, far too small to see.
SETTLED = 2e-3
# It is also done if its controls are at their targets: one that was asked for, within 0.016 mm.
MET = 0.1
# Or if a step has brought it this little nearer, as a share of what was left.
GAIN = 0.1
# Precision of controls that were asked for, and how much the others may give way, mm: those that
# are held, those that are held but for what moves them by itself, and the rest.
ASKED_MM = 0.05
HELD_MM = 0.4
PARTED_MM = 0.7
FREE_MM = 1.5
# mm that a control may lack before the search is repeated from the other side.
MISSED_MM = 1.0
# mm: lids that a tracker has closed too far are parted in full only if they are to be this open.
APART_MM = 1.0
# mm by which lids that are to shut pass each other.
PASSING_MM = 0.1
# The longest change that still counts as natural, in standard deviations of the prior.
NATURAL_LENGTH = 4.0


@dataclass(frozen=True)
class Goal:
    """Where the controls of one region should go, on N frames.

    Attributes:
        targets: (N, C), mm.
        strength: (N, C) or (N, 1) in 0..1, how far to go from the present length to the target.
        asked: (N, C) bool, whether the user asked for this control; the others stay near their
            targets and give way.
        tolerance: (N, C) mm that a control may miss its target by, added to what all may.
        firm: (N, C) in 0..1, how firmly a control is asked for beside the firmest of its frame:
            one whose edit only begins gives way to one whose edit acts in full.
        free: (N, C) mm by which a control that was not asked for may give way.
    """

    targets: Doubles
    strength: Doubles
    asked: Bools
    tolerance: Doubles | float = 0.0
    firm: Doubles | float = 1.0
    free: Doubles | float = FREE_MM

    @property
    def noise(self) -> Doubles:
        """(N, C) mm², how exactly each target has to be met."""
        noise = np.where(self.asked, ASKED_MM**2, np.square(self.free))
        if not isinstance(self.firm, float):
            soft = self.asked & (self.firm < 1.0)
            free = self.free if isinstance(self.free, float) else self.free[soft]
            noise[soft] = (free * (ASKED_MM / free) ** self.firm[soft]) ** 2
        return noise + np.square(self.tolerance)

    def targets_from(self, lengths: Doubles) -> Doubles:
        """(N, C) mm where to go from present lengths."""
        return lengths + self.strength * (self.targets - lengths)

    def at(self, rows: Indices) -> Goal:
        """The goal on some of the frames."""
        tolerance, firm, free = (
            value if isinstance(value, float) else value[rows]
            for value in (self.tolerance, self.firm, self.free)
        )
        return Goal(
            self.targets[rows], self.strength[rows], self.asked[rows], tolerance, firm, free
        )


class Reach:
    """Brings the controls of one region to a goal, each frame by itself.

    It is fastest with arrays that lie column by column in memory.

    Args:
        distances: the region's C controls as a function of all 52 weights.
        channels: (K,) columns that may change.
        covariance: (K, K) of the channels in performances.
        coupled: positions (a, b) in `channels` with weight a <= weight b (mouthClose, jawOpen).
        natural: (K, K) by which the length of a change is judged; None = `covariance`. A take
            that hardly moves is not a face that can hardly move.
        wide: (K, K) covariance for changes that `covariance` does not know; None = `covariance`.
    """

    def __init__(
        self,
        distances: Distances,
        channels: Indices,
        covariance: Doubles,
        coupled: tuple[int, int] | None = None,
        natural: Doubles | None = None,
        wide: Doubles | None = None,
    ) -> None:
        self._distances, self._channels = distances, channels
        self._covariance, self._coupled = covariance, coupled
        self._more = None if wide is None else wide - covariance
        natural = covariance if natural is None else natural
        gradients = distances.gradients[channels].astype(np.float64)  # (K, C, 3)
        self._moves = np.ascontiguousarray(gradients.T.reshape(-1, len(channels)))  # (3 C, K)
        self._slopes = np.ascontiguousarray(gradients.transpose(1, 2, 0))  # (C, 3, K)
        self._spreads = self._slopes @ covariance
        shuts = distances.shuts & distances.gradients[:, :, ::2].any(axis=(0, 2))
        lids = np.flatnonzero(shuts)
        self._upwards = np.where(distances.offsets[lids, 1] < 0, -1.0, 1.0)
        # All of them as a slice are not copied.
        self._lids: Rows | None = None if not len(lids) else lids
        if len(lids) == len(shuts):
            self._lids = slice(None)
        self._precision = np.linalg.inv(natural + 1e-6 * np.eye(len(natural)))

    def __call__(
        self,
        weights: Doubles,
        goal: Goal,
        upper: Doubles,
        naturalness: float = 1.0,
        lower: Doubles | None = None,
        exempt: Bools | None = None,
        share: Doubles | None = None,
        vectors: Doubles | None = None,
        lengths: Doubles | None = None,
    ) -> Doubles:
        """The new weights (N, K) of the channels.

        Args:
            weights: (N, 52) present weights, of which those of `channels` may change.
            goal: see `Goal`.
            upper, lower: (N, K) largest and smallest allowed weights; by default, the smallest
                is 0. A weight that is beyond a bound already may stay there.
            naturalness: 1 limits the length of the change to `NATURAL_LENGTH`, 0 does not.
            exempt: (N,) frames whose change may have any length; None = none of them.
            share: (N,) in 0..1, how far the wide covariance takes the place of the other.
            vectors: (N, C, 3) mm, of the distances of `weights`; None = not known.
            lengths: (N, C) mm, those of the vectors, see `Distances.lengths`; None = not known.
        """
        start = weights[:, self._channels]
        vectors = np.asfortranarray(
            self._distances.vectors(weights) if vectors is None else vectors
        )
        if lengths is None:
            lengths = np.asfortranarray(self._distances.lengths(vectors))
        targets = goal.targets_from(np.maximum(lengths, 0.0))
        if self._distances.may_pass:  # such vertices come apart little by little
            targets += np.minimum(lengths, 0.0) * limited(1.0 - targets / APART_MM)
        lower = np.minimum(start, 0.0 if lower is None else lower)
        longest = NATURAL_LENGTH / naturalness if naturalness > 0 else np.inf
        limit = np.full(len(start), longest)
        if exempt is not None:
            limit[exempt] = np.inf
        share = np.zeros(len(start)) if share is None else share
        frames = Frames(start, lower, upper, vectors, targets, goal.noise, limit, share)
        change, lengths = self._search(frames, lengths)
        # Pressed lips may have passed each other: opening them then begins with what seems to
        # close them.
        missed = np.flatnonzero(np.any(goal.asked & (targets - lengths > MISSED_MM), axis=1))
        if len(missed):
            those = frames.at(missed)
            other, there = self._search(those, passed=True)
            better = those.cost(there) < those.cost(lengths[missed])
            change[missed[better]] = other[better]
        # Rounding leaves weights such as -1e-17.
        return np.minimum(np.maximum(start + change, frames.lower), np.maximum(start, upper))

    def _search(
        self, frames: Frames, lengths: Doubles | None = None, passed: bool = False
    ) -> tuple[Doubles, Doubles]:
        """The change of the channels (N, K), and the resulting lengths (N, C), mm.

        Args:
            lengths: (N, C) mm, those of the vectors that it starts from; None = not known.
            passed: start as if each pair of vertices had passed each other.
        """
        found, there = frames.start, frames.targets  # until the first step has been taken
        rows: Indices | None = None  # the frames that are not done yet; None = all
        change, frozen = np.zeros_like(frames.start), np.zeros_like(frames.start, np.bool_)
        here = self._place(frames, frames.vectors, lengths)
        for iteration in range(ITERATIONS):
            directions, wanted = self._linear(frames, here, passed and iteration == 0)
            aim = self._step(frames, directions, wanted, change, frozen)
            aim *= self._shortening(aim, frames.limit)
            allowed, stopped = frames.bounded(aim, self._coupled)
            stopped |= frozen
            before = here.costs
            new, here = self._line_search(frames, here, change, allowed)
            if rows is None:
                found, there = new, here.lengths
            else:
                found[rows], there[rows] = new, here.lengths
            going = here.costs > MET
            if iteration:  # bounds show in the first step, and are kept to from the second
                going &= here.costs < (1.0 - GAIN) * before
            if not going.any():
                break
            moving = (np.abs(new - change) > SETTLED) | (stopped != frozen)
            left = np.flatnonzero(going & moving.any(axis=1))
            if not len(left):
                break
            change, frozen = new, stopped
            if len(left) < len(going):
                rows = left if rows is None else rows[left]
                frames, here = frames.at(left), here.at(left)
                change, frozen = at(change, left), at(frozen, left)
        return found, np.maximum(there, 0.0)

    def _place(self, frames: Frames, vectors: Doubles, lengths: Doubles | None = None) -> Reached:
        found: Doubles = self._distances.lengths(vectors) if lengths is None else lengths
        if found.ndim == 2:
            found = np.asfortranarray(found)
        return Reached(vectors, found, frames.cost(found))

    def _linear(self, frames: Frames, here: Reached, passed: bool) -> tuple[Doubles, Doubles]:
        """What the controls do near a place.

        Returns:
            (N, C, 3) the directions in which they grow, and (N, C) mm, by how much a change from
            the start should move them.
        """
        directions = self._distances.directions(here.vectors, here.lengths, passed)
        wanted = frames.targets - here.lengths
        if self._lids is not None and not passed:
            self._by_height(directions, wanted, frames.targets, here.vectors, self._lids)
        if here.vectors is not frames.vectors:  # else nothing has changed yet
            wanted += ((here.vectors - frames.vectors) * directions).sum(axis=2)
        return directions, wanted

    def _by_height(
        self, directions: Doubles, wanted: Doubles, targets: Doubles, vectors: Doubles, lids: Rows
    ) -> None:
        """Have lids shut by their height alone, in place.

        One lid lies half a millimetre behind the other, and cannot come nearer. Where they nearly
        meet, the direction between them is that depth; eyes that are held shut would shake.

        Args:
            directions: (N, C, 3), of which those of lids become upright.
            wanted: (N, C) mm, of which those of lids become heights.
            targets: (N, C) mm.
            vectors: (N, C, 3) mm.
            lids: which controls are those of lids.
        """
        upwards = self._upwards
        asked, across = targets[:, lids], vectors[:, lids]
        height = across[..., 1] * upwards
        depth = np.maximum(np.hypot(across[..., 0], across[..., 2]), 1e-6)
        tall = np.sqrt(np.maximum(asked**2 - depth**2, 0.0))
        tall -= PASSING_MM * limited(1.0 - asked / depth)
        tall = np.where(asked > 0, tall, np.minimum(height, -PASSING_MM))
        wanted[:, lids] = tall - height
        directions[:, lids] = 0.0
        directions[:, lids, 1] = upwards

    def _step(
        self, frames: Frames, directions: Doubles, wanted: Doubles, change: Doubles, frozen: Bools
    ) -> Doubles:
        """(N, K) the most probable change that moves the controls as wanted.

        Args:
            frames: what is known of them.
            directions, wanted: see `_linear`.
            change: (N, K), so far.
            frozen: (N, K) channels that keep theirs.
        """
        by_control = directions.transpose(1, 0, 2)
        slopes = by_control @ self._slopes  # (C, N, K)
        rest, held = wanted, change
        if are_some := bool(frozen.any()):
            held = np.where(frozen, change, 0.0)
            rest = wanted - (self._moved(held) * directions).sum(axis=2)
            np.copyto(slopes, 0.0, where=np.ascontiguousarray(frozen))
            flat = slopes.reshape(-1, slopes.shape[2])
            spread = (flat @ self._covariance).reshape(slopes.shape)
        else:
            spread = by_control @ self._spreads
        if self._more is not None and frames.share.any():
            wide = np.flatnonzero(frames.share)
            spread[:, wide] += frames.share[wide, None] * (slopes[:, wide] @ self._more)
        spread = spread.transpose(1, 0, 2)
        system = spread @ slopes.transpose(1, 2, 0)  # (N, C, C)
        size = system.shape[1]
        system.reshape(-1, size * size)[:, :: size + 1] += frames.noise
        pull = solved(system, rest)
        moved = np.asfortranarray((pull[:, None] @ spread)[:, 0])
        if are_some:
            np.copyto(moved, held, where=frozen)
        return moved

    def _moved(self, change: Doubles) -> Doubles:
        """(N, C, 3) mm by which a change (N, K) moves the vectors."""
        count = len(self._slopes)
        by: Doubles = (self._moves @ change.T).reshape(3, count, len(change))
        return by.T

    def _shortening(self, change: Doubles, limit: Doubles) -> Doubles:
        """(N, 1) factors that limit the length of each frame's change."""
        length = np.sqrt(((change @ self._precision) * change).sum(axis=1))
        factor: Doubles = np.minimum(1.0, limit / np.maximum(length, 1e-9))[:, None]
        return factor

    def _line_search(
        self, frames: Frames, here: Reached, old: Doubles, new: Doubles
    ) -> tuple[Doubles, Reached]:
        """The step from `old` to `new`, shortened for each frame until it leads nearer.

        A full step can move a pair of vertices through each other, where the distance grows
        again. Vectors are linear in the weights, so those of shorter steps are interpolated.

        Returns:
            The change (N, K), and its result.
        """
        there = self._place(frames, frames.vectors + self._moved(new))
        worse = np.flatnonzero(there.costs > here.costs)
        if len(worse):
            before = at(here.vectors, worse)
            trials = before + STEPS[:, None, None, None] * (at(there.vectors, worse) - before)
            tried = self._place(frames.at(worse), trials)
            best = tried.costs.argmin(axis=0), np.arange(len(worse))
            step = STEPS[best[0]][:, None]
            new[worse] = old[worse] + step * (new[worse] - old[worse])
            there.put(worse, tried, best)
        return new, there
