"""From the networks' answer to what was asked for, in one region of one chunk.

Reach is asked within what the take shows; then, where that does not do, within what other faces do;
and where that does not either, for less.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Bools, Doubles, Indices
from faceedit_app.editing.edits.settings import Mode
from faceedit_app.editing.solving.coupling import couple, room_of_close
from faceedit_app.editing.solving.filters import smoothed
from faceedit_app.editing.solving.giving_way import (
    PASSING_MM,
    contradictions,
    kept,
    missing,
    unpassed,
)
from faceedit_app.editing.solving.reach import Goal, Reach, Rows
from faceedit_app.editing.solving.region_request import RegionRequest
from faceedit_app.editing.solving.take_regions import TakeRegion

# How much a calmed curve may miss what is missing for a moment only, as a share of that.
TWITCH = 1.0
# mm that all curves of a region may miss where all of them are asked to be calm.
CALM_MM = 0.25
# Contradictions are looked at over this many times the time that divides slow from quick; and mm
# below which they are none.
_SOFT, _SOFT_MM = 2.0, 0.01


class Reaching:
    """Brings the controls of one region the rest of the way.

    Args:
        part: the region.
        reach: its reach.
        lips: the position of the mouth's opening among its own controls, if it has that.
        shut: mm between the take's closed lips.
        quick: frames of standard deviation of the Gaussian that divides slow from quick.
    """

    def __init__(
        self, part: TakeRegion, reach: Reach, lips: int | None, shut: float, quick: float
    ) -> None:
        self._part, self._reach, self._lips = part, reach, lips
        self._shut, self._quick = shut, quick
        self._others = [i for i in range(len(part.own)) if i != lips]
        rest = part.vectors(np.zeros((1, len(ARKIT_INDEX))))[0, lips or 0, 1]
        self._upwards = -1.0 if rest < 0 else 1.0

    def __call__(
        self,
        weights: Doubles,
        asked: RegionRequest,
        limits: tuple[Doubles, Doubles, Doubles],
        old: Doubles,
    ) -> None:
        """Answer what is asked for, in place.

        Args:
            weights: (N, 52) as the networks answer.
            asked: what is asked for.
            limits: (N, K) each: the smallest and the largest weights that any answer may give, and
                how much channels may rise without leaving their rest.
            old: (N, K) the weights of the channels before that answer.
        """
        held = asked.hold.any(axis=1)
        # All rows as a slice, the usual case, are not copied.
        where = slice(None) if held.all() else np.flatnonzero(held)
        least, most, room = limits
        part, naturalness = self._part, asked.settings.naturalness
        columns = part.have_columns
        vectors = part.vectors(weights)
        lengths = part.signed(vectors)
        aim = self._aim(weights, asked, (least, most), where, vectors, lengths)
        goal, hold, calm = aim.goal, asked.hold[where], asked.calm[where]
        beyond = np.maximum(part.beyond(goal.targets, hold), aim.share)
        found = aim.here.copy(order="K")
        quiet = np.minimum(aim.most, aim.here[:, columns] + room[where])
        found[:, columns] = aim.solve(self._reach, columns, part.bounds(beyond), naturalness, quiet)
        reached = part.lengths(part.vectors(found))
        rising = self._rising(asked, where)
        aims = goal.targets_from(np.maximum(aim.lengths, 0.0))
        lacking = missing(goal, aims, reached, rising)
        if asked.calm.any():
            lacking *= 1.0 - calm.max(axis=1, initial=0.0)
        asleep = (quiet < aim.most).any(axis=1)
        rest = np.flatnonzero(lacking > np.where(asleep, 0.0, np.minimum(aim.share, beyond)))
        bounds = part.bounds(np.maximum(beyond, lacking))
        wider = replace(aim, share=np.maximum(aim.share, lacking))
        if len(rest):
            self._go_farther(found, wider, bounds, naturalness, rest)
        softer = (
            self._softer(found, wider, aims, len(weights), where) if lacking.any() else np.zeros(1)
        )
        if softer.any():
            goal = replace(goal, tolerance=goal.tolerance + softer)
            rest = np.flatnonzero(softer.max(axis=1) > _SOFT_MM)
            self._go_farther(found, replace(wider, goal=goal), bounds, naturalness, rest)
            self._without_jumps(found, aim.here, rest, np.where(goal.asked, aims, np.nan))
        self._keep_lips(found, asked, old, where)
        weights[where] = found

    def _rising(self, asked: RegionRequest, where: Rows) -> Doubles:
        """(N, C) mm by which curves rise with others: a lip that leaves the other parts them."""
        change = (asked.tracked - asked.wanted)[where] * (asked.hold[where] > 0)
        rising = np.zeros_like(change)
        if self._lips is not None:
            rising[:, self._lips] = change[:, self._part.lips].max(axis=1, initial=0.0)
        return rising

    def _go_farther(
        self,
        found: Doubles,
        aim: _Aim,
        bounds: tuple[Doubles, Doubles],
        naturalness: float,
        rows: Indices,
    ) -> None:
        """Answer some frames again, in place.

        What the take does not show, others do; and what is at rest leaves it.

        Args:
            found: (N, 52) the answer so far.
            bounds: (N, K) or (1, K) each.
            rows: the frames.
        """
        columns = self._part.have_columns
        lower, upper = (bound[rows] if len(bound) > 1 else bound for bound in bounds)
        those = aim.at(rows)
        again = those.solve(self._reach, columns, (lower, upper), naturalness, those.most)
        found[np.ix_(rows, columns)] = again

    def _softer(self, found: Doubles, aim: _Aim, aims: Doubles, count: int, where: Rows) -> Doubles:
        """(N, C) mm by which curves may miss what cannot be met together.

        Each frame would miss it in its own way, and weights would jump. What touches comes first:
        a closure is met, and what contradicts it gives way.

        Args:
            found: (N, 52) the answer so far, on the frames `where`.
            aims: (N, C) mm where its own controls should be.
            count: N', the number of all frames.
        """
        part, softer = self._part, np.zeros((count, aims.shape[1]))
        reached = part.lengths(part.vectors(found))
        softer[where] = contradictions(aim.goal, aims, reached)
        softer[:, part.expectation.held] = 0.0
        return smoothed(softer, _SOFT * self._quick)[where] if softer.any() else softer[where]

    def _without_jumps(self, found: Doubles, here: Doubles, rows: Indices, aims: Doubles) -> None:
        """Take single frames that differ from those around out of some frames, in place.

        Several faces may answer a contradiction nearly as well, and frames choose for themselves.
        A closure may last one frame, and stays.

        Args:
            found, here: (N, 52) the answer so far, and what it started from.
            rows: the frames.
            aims: (N, C) mm where its own controls should be; NaN where nobody asked.
        """
        columns, near = self._part.have_columns, round(self._quick)
        change = (found - here)[:, columns]
        padded = np.pad(change, ((near, near), (0, 0)), mode="edge")
        around = np.median(sliding_window_view(padded, 2 * near + 1, axis=0)[rows], axis=-1)
        start = here[np.ix_(rows, columns)]
        inside = np.clip(start + around, np.minimum(start, 0.0), np.maximum(start, 1.0))
        before = found[rows]
        found[np.ix_(rows, columns)] = inside
        if "mouthClose" in self._part.region.channels:
            couple(found, room_of_close(here), rows)
        if self._lips is not None:
            asked = aims[rows, self._lips]
            was, now = (self._opening(weights) for weights in (before, found[rows]))
            opens = now - asked > np.abs(was - asked) + _SOFT_MM
            found[rows[opens]] = before[opens]

    def _opening(self, weights: Doubles) -> Doubles:
        """(N,) mm, of the mouth."""
        return self._part.lengths(self._part.vectors(weights))[:, self._lips]

    def _keep_lips(self, found: Doubles, asked: RegionRequest, old: Doubles, where: Rows) -> None:
        """Take part of the answer back where lips would go too far, in place.

        Those that nobody asked for part or shut no farther than edits go, and none pass each other.

        Args:
            found: (N, 52) the answer.
            old: (N', K) the weights before it, on all frames.
            where: the frames of the answer.
        """
        lips, part = self._lips, self._part
        if lips is None or asked.settings.mode is not Mode.PRESERVE:
            return
        vectors, share = part.vectors(found), np.ones(len(found))
        hold, columns = asked.hold[where], part.have_columns
        if not (hold[:, lips] > 0).all():
            parted = part.lengths(vectors)[:, lips] - asked.wanted[where][:, lips]
            change = np.abs(asked.wanted - asked.tracked)[where] * (hold > 0)
            firm = hold[:, lips] / hold.max(axis=1)
            farthest = change[:, self._others].max(axis=1, initial=0.0)
            share = kept(parted, farthest, firm, asked.settings.naturalness)
        height = vectors[:, lips, 1] * self._upwards
        rows = np.flatnonzero((share < 1.0) | (height < -PASSING_MM))
        if len(rows):
            before, after = found[rows].copy(), found[np.ix_(rows, columns)]
            before[:, columns] = old[where][rows]
            start = part.vectors(before)[:, lips, 1] * self._upwards
            most = np.minimum(share[rows], unpassed(start, height[rows]))[:, None]
            tracked = before[:, columns]
            found[np.ix_(rows, columns)] = tracked + most * (after - tracked)

    def _aim(
        self,
        weights: Doubles,
        asked: RegionRequest,
        limits: tuple[Doubles, Doubles],
        where: Rows,
        vectors: Doubles,
        lengths: Doubles,
    ) -> _Aim:
        """What reach aims at on the frames `where`.

        Args:
            limits: (N, K) each, see `__call__`.
            vectors, lengths: (N, C, 3) and (N, C) mm, the region's own controls; see `Distances`.
        """
        hold, wanted, calm = asked.hold[where], asked.wanted[where], asked.calm[where]
        tolerance: Doubles | float = 0.0
        if asked.calm.any():
            passing = self._passing(asked, np.maximum(lengths, 0.0))[where]
            wanted = wanted - passing
            tolerance = np.maximum(TWITCH * np.abs(passing), CALM_MM * calm.min(axis=1)[:, None])
        mask = hold > 0
        firm: Doubles | float = 1.0
        # All go as far as the firmest; others are met less exactly.
        firmest = hold.max(axis=1, keepdims=True)
        if (mask & (hold < firmest)).any():
            firm = hold / firmest
        strength = asked.settings.reach * firmest
        return _Aim(
            here=weights[where],
            vectors=vectors[where],
            lengths=lengths[where],
            goal=Goal(wanted, strength, mask, tolerance, firm, self._part.free(hold / firmest)),
            still=self._part.of_take(asked.influence[where]) == 0,
            least=limits[0][where],
            most=limits[1][where],
            closed=self._are_closures(wanted, mask),
            share=asked.unlike[where],
        )

    def _passing(self, asked: RegionRequest, lengths: Doubles) -> Doubles:
        """(N, C) mm: how far calmed curves may miss what is missing for a moment only.

        Curves that are smoothed one by one are not always those of a face. Where they cannot be
        met together but by a twitch, they need not be.
        """
        lacking = asked.hold * (asked.wanted - lengths)
        passing: Doubles = asked.calm * (lacking - smoothed(lacking, self._quick))
        return passing

    def _are_closures(self, wanted: Doubles, asked: Bools) -> Bools:
        """(N,) the frames on which the lips are asked to shut."""
        if self._lips is None:
            return np.zeros(len(wanted), np.bool_)
        closures: Bools = asked[:, self._lips] & (wanted[:, self._lips] <= self._shut + 0.01)
        return closures


@dataclass(frozen=True)
class _Aim:
    """What reach starts from and aims at, on N frames.

    Attributes:
        here: (N, 52) weights.
        vectors, lengths: (N, C, 3) and (N, C) mm, of the region's own controls.
        goal: see `Goal`.
        still: (N, K) channels that no edit influences.
        least, most: (N, K) the smallest and largest weights that any answer may give.
        closed: (N,) frames on which the lips are asked to shut.
        share: (N,) in 0..1, how far the take is left for what other faces do.
    """

    here: Doubles
    vectors: Doubles
    lengths: Doubles
    goal: Goal
    still: Bools
    least: Doubles
    most: Doubles
    closed: Bools
    share: Doubles

    def at(self, rows: Indices) -> _Aim:
        """The aim on some of the frames."""
        start = self.here[rows], self.vectors[rows], self.lengths[rows], self.goal.at(rows)
        limits = self.still[rows], self.least[rows], self.most[rows]
        return _Aim(*start, *limits, self.closed[rows], self.share[rows])

    def solve(
        self,
        reach: Reach,
        columns: Indices,
        bounds: tuple[Doubles, Doubles],
        naturalness: float,
        most: Doubles,
    ) -> Doubles:
        """(N, K) the weights of `columns` that reach finds within bounds, (N, K) each.

        Args:
            most: (N, K) the largest weights; `self.most`, or less.
        """
        start = self.here[:, columns]
        lower = np.where(self.still, start, np.maximum(bounds[0], self.least))
        upper = np.where(self.still, start, np.minimum(bounds[1], most))
        known = self.closed, self.share, self.vectors, self.lengths
        return reach(self.here, self.goal, upper, naturalness, lower, *known)
