"""One region of one chunk: the answer combined with the take, within its bounds, then reach."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Bools, Doubles, Indices
from faceedit_app.core.controls import LIP_OPENING
from faceedit_app.editing.edits.settings import Mode
from faceedit_app.editing.solving.filters import smoothed
from faceedit_app.editing.solving.last_layer import Correction
from faceedit_app.editing.solving.parts import Part
from faceedit_app.editing.solving.reach import Goal, Reach
from faceedit_app.editing.solving.reach_frames import limited
from faceedit_app.editing.solving.region_request import RegionRequest
from faceedit_app.editing.solving.take_statistics import WAKES

Rows = slice | Indices
# (N, K) what the networks add to (preserve) or replace (resynthesize); and (N, K) by which the
# residual of the pose changes, see `residual.py`.
Answer = tuple[Doubles, Doubles]

# How much a calmed curve may miss what is missing for a moment only, as a share of that.
TWITCH = 1.0
# mm that all curves of a region may miss where all of them are asked to be calm.
CALM_MM = 0.25
# The take's own range is left, little by little, for a curve that misses its target by this much.
MISSING_MM = 0.2
# mm by which lips have to close until a frown may not rise at all.
_CLOSING_MM = 0.5
_CLOSE, _JAW = ARKIT_INDEX["mouthClose"], ARKIT_INDEX["jawOpen"]
# How far the jaw may go, as a weight, for curves that a take's channels answer only in part.
_JAW_PAYS = 0.15


class Combining:
    """Computes the weights of one region.

    Args:
        part: the region.
        shut: mm between the take's closed lips.
        quick: frames of standard deviation of the Gaussian that divides slow from quick.
    """

    def __init__(self, part: Part, shut: float, quick: float) -> None:
        self._part, self._shut, self._quick = part, shut, quick
        self._correction = Correction()
        self._lips = part.own.index(LIP_OPENING) if LIP_OPENING in part.own else None
        jaw = np.flatnonzero(np.isin(part.have_columns, [_JAW, _CLOSE]))
        self._others = [i for i in range(len(part.own)) if i != self._lips]
        self._jaw = None if part.is_complete or self._lips is None else jaw
        self._ready: tuple[RegionRequest, _Known] | None = None

    def prepare(self, weights: Doubles, asked: RegionRequest) -> None:
        """Compute what needs no answer, while other cores compute the networks'."""
        self._ready = asked, self._known_before(weights[:, self._part.have_columns], asked)

    def __call__(self, weights: Doubles, asked: RegionRequest, answer: Answer) -> Doubles:
        """(N, K) weights of the channels that the take has.

        Args:
            weights: (N, 52) as tracked, and as solved for regions before this one.
            asked: what is asked for.
            answer: what the networks answer to it.
        """
        part = self._part
        result, columns = weights.copy(order="K"), part.have_columns
        old = result[:, columns]
        ready, self._ready = self._ready, None
        if ready is not None and ready[0] is asked and np.array_equal(ready[1].old, old):
            known = ready[1]
        else:
            known = self._known_before(old, asked)
        room = self._combine(result, asked, answer, known)
        if part.reach is not None and asked.settings.reach > 0:
            held = asked.hold.any(axis=1)
            # All rows as a slice, the usual case, are not copied.
            where = slice(None) if held.all() else np.flatnonzero(held)
            if held.any():
                self._go_on(part.reach, result, asked, (known.least, known.most, room), where)
        return result[:, columns]

    def _known_before(self, old: Doubles, asked: RegionRequest) -> _Known:
        """What is known of the result before the networks have answered; `old` as in `_Known`."""
        part, added = self._part, None
        rest = bounds = None
        if asked.settings.mode is Mode.PRESERVE:
            if asked.layer is not None:
                added = self._correction.change(asked.layer, asked.before, asked.slow)
            if part.reach is not None:
                quick = asked.settings.reach * (part.quick.T @ asked.quick.T).T
                added = quick if added is None else added + quick
            rest = part.at_rest(old)
            bounds = part.bounds(np.maximum(part.beyond(asked.wanted, asked.hold), asked.unlike))
        return _Known(old, self._least(old, asked), self._most(old, asked), added, rest, bounds)

    def _least(self, tracked: Doubles, asked: RegionRequest) -> Doubles:
        """(N, K) the smallest weights that any answer may give; see `_jaw_pays`."""
        if self._jaw is None:
            return _endless(tracked.shape, -1.0)
        least = np.full(tracked.shape, -np.inf, order="F")
        least[:, self._jaw] = tracked[:, self._jaw] - self._jaw_pays(asked)
        return least

    def _jaw_pays(self, asked: RegionRequest) -> Doubles:
        """(N, 1) how far the jaw may go where the opening of the mouth is not asked for.

        Where the channels are missing that answer a curve, such as those that purse the lips, the
        rest of it must not come from an opening mouth.
        """
        free = asked.hold[:, self._lips] if self._lips is not None else np.zeros(len(asked.hold))
        return np.maximum(_JAW_PAYS, free)[:, None]

    def _most(self, tracked: Doubles, asked: RegionRequest) -> Doubles:
        """(N, K) the largest weights that any answer may give.

        That is 1; a tracked value above it is reduced only as the edit fades in. And lips that
        are asked to close do not frown, unless the corners of the mouth are asked for as well.
        """
        part = self._part
        beyond = np.maximum(tracked - 1.0, 0.0)
        most: Doubles = 1.0 + beyond * (1.0 - part.of_take(asked.influence))
        if self._jaw is not None:
            pays = self._jaw_pays(asked)
            most[:, self._jaw] = np.minimum(most[:, self._jaw], tracked[:, self._jaw] + pays)
        if self._lips is not None and len(part.frowns) and asked.settings.mode is Mode.PRESERVE:
            closing = (asked.tracked - asked.wanted)[:, self._lips] / _CLOSING_MM
            alone = ~(asked.hold[:, self._others] > 0).any(axis=1)
            firm = limited(closing) * alone
            frowns = tracked[:, part.frowns]
            most[:, part.frowns] = np.maximum(
                frowns, most[:, part.frowns] - firm[:, None] * (most[:, part.frowns] - frowns)
            )
        return most

    def _combine(
        self, weights: Doubles, asked: RegionRequest, answered: Answer, known: _Known
    ) -> Doubles:
        """Combine the networks' answer with the weights (N, 52), in place.

        Returns:
            (N, K) how much further channels may rise without leaving their rest.
        """
        part, old = self._part, known.old
        influence, (answer, exchange) = part.of_take(asked.influence), answered
        room = _endless(old.shape, 1.0)
        if known.rest is not None and known.bounds is not None:
            unlike = asked.unlike[:, None]
            answer = part.whole(answer, unlike)
            if known.added is not None:
                answer += known.added
            answer += exchange
            answer[:, part.idle] *= unlike
            awake, room = _awake(part.of_take(answer), known.rest)
            lower, upper = known.bounds
            within = np.maximum(old + awake, np.minimum(old, lower))
            within = np.minimum(within, np.maximum(old, upper))
            answer = old + influence * (within - old)
        else:
            answer = part.of_take(answer)
        least = np.maximum(np.minimum(old, 0.0), known.least)
        new = np.minimum(np.maximum(answer, least), known.most)
        slack = np.maximum(weights[:, _CLOSE] - weights[:, _JAW], 0.0)
        weights[:, part.have_columns] = np.where(influence > 0, new, old)
        if "mouthClose" in part.region.channels:
            _couple(weights, slack, influence.max(axis=1) > 0)
        return room

    def _go_on(
        self,
        reach: Reach,
        weights: Doubles,
        asked: RegionRequest,
        limits: tuple[Doubles, Doubles, Doubles],
        where: Rows,
    ) -> None:
        """Bring the region's own controls the rest of the way to what was asked for, in place.

        Args:
            limits: (N, K) each: the smallest and the largest weights that any answer may give, and
                how much channels may rise without leaving their rest.
            where: the frames.
        """
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
        found[:, columns] = aim.solve(reach, columns, part.bounds(beyond), naturalness, quiet)
        reached = part.lengths(part.vectors(found))
        aims = goal.targets_from(np.maximum(aim.lengths, 0.0))
        missing = np.abs(aims - reached) - MISSING_MM - goal.tolerance
        missing = limited(np.where(goal.asked, missing * goal.firm, 0.0).max(axis=1))
        if asked.calm.any():
            missing *= 1.0 - calm.max(axis=1, initial=0.0)
        asleep = (quiet < aim.most).any(axis=1)
        rest = np.flatnonzero(missing > np.where(asleep, 0.0, np.minimum(aim.share, beyond)))
        if len(rest):
            # What the take does not show, others do; and what is at rest leaves it.
            bounds = part.bounds(np.maximum(beyond, missing)[rest])
            more = replace(aim, share=np.maximum(aim.share, missing)).at(rest)
            found[np.ix_(rest, columns)] = more.solve(
                reach, columns, bounds, naturalness, more.most
            )
        weights[where] = found

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
            limits: (N, K) each, see `_go_on`.
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
        missing = asked.hold * (asked.wanted - lengths)
        passing: Doubles = asked.calm * (missing - smoothed(missing, self._quick))
        return passing

    def _are_closures(self, wanted: Doubles, asked: Bools) -> Bools:
        """(N,) the frames on which the lips are asked to shut."""
        if self._lips is None:
            return np.zeros(len(wanted), np.bool_)
        closures: Bools = asked[:, self._lips] & (wanted[:, self._lips] <= self._shut + 0.01)
        return closures


@dataclass(frozen=True)
class _Known:
    """What is known of a region's result before the networks have answered, on N frames.

    Attributes:
        old: (N, K) the weights of the channels that the take has.
        least, most: (N, K) the smallest and the largest that any answer may give.
        added: (N, K') what the take's last layer and quick movement add to the answer.
        rest: (N, K) in 0..1, how far each channel is at rest.
        bounds: the smallest and the largest weights of an answer like the take, (N, K) or (1, K)
            each. As `added` and `rest`, None to resynthesize.
    """

    old: Doubles
    least: Doubles
    most: Doubles
    added: Doubles | None
    rest: Doubles | None
    bounds: tuple[Doubles, Doubles] | None


def _awake(change: Doubles, rest: Doubles) -> tuple[Doubles, Doubles]:
    """What a change (N, K) leaves at rest, of channels that are at rest by `rest` (N, K).

    Trackers leave a channel at exactly its smallest weight until it really moves. An answer
    that stirs all of them a little would not look like the take.

    Returns:
        The change of channels that leave their rest; and how much further each may rise.
    """
    awake = np.maximum(change - WAKES * rest, np.minimum(change, 0.0))
    return awake, np.where(rest > 0, np.maximum(awake, 0.0) + (1.0 - rest), np.inf)


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


@lru_cache(maxsize=8)
def _endless(shape: tuple[int, ...], sign: float) -> Doubles:
    """(N, K) no limit: infinity, or minus infinity; shared, and never changed."""
    endless = np.full(shape, sign * np.inf, order="F")
    endless.flags.writeable = False
    return endless


def _couple(weights: Doubles, slack: Doubles, where: Bools) -> None:
    """Keep mouthClose <= jawOpen, in place: mouthClose is a corrective, which tears any rig alone.

    Args:
        weights: (N, 52).
        slack: (N,) by how much the take itself exceeds this, which is allowed.
        where: (N,) the frames.
    """
    limit = np.minimum(weights[:, _CLOSE], weights[:, _JAW] + slack)
    weights[where, _CLOSE] = limit[where]
