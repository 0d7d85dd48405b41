"""One region of one chunk: the answer combined with the take, within its bounds, then reach."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Doubles
from faceedit_app.core.controls import LIP_OPENING
from faceedit_app.editing.edits.settings import Mode
from faceedit_app.editing.solving.coupling import couple, room_of_close
from faceedit_app.editing.solving.last_layer import Correction
from faceedit_app.editing.solving.reach_frames import limited
from faceedit_app.editing.solving.reaching import Reaching
from faceedit_app.editing.solving.region_request import RegionRequest
from faceedit_app.editing.solving.take_regions import TakeRegion
from faceedit_app.editing.solving.take_statistics import WAKES

# (N, K) what the networks add to (preserve) or replace (resynthesize); and (N, K) by which the
# residual of the pose changes, see `residual.py`.
Answer = tuple[Doubles, Doubles]

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

    def __init__(self, part: TakeRegion, shut: float, quick: float) -> None:
        self._part = part
        self._correction = Correction()
        self._lips = part.own.index(LIP_OPENING) if LIP_OPENING in part.own else None
        jaw = np.flatnonzero(np.isin(part.have_columns, [_JAW, _CLOSE]))
        self._jaw = None if part.is_complete or self._lips is None else jaw
        reach = part.reach
        self._reaching = Reaching(part, reach, self._lips, shut, quick) if reach else None
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
        if self._reaching is not None and asked.settings.reach > 0 and asked.hold.any():
            self._reaching(result, asked, (known.least, known.most, room), old)
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
        are asked to close or to move do not frown, unless the corners of the mouth are asked for
        as well.
        """
        part = self._part
        beyond = np.maximum(tracked - 1.0, 0.0)
        most: Doubles = 1.0 + beyond * (1.0 - part.of_take(asked.influence))
        if self._jaw is not None:
            pays = self._jaw_pays(asked)
            most[:, self._jaw] = np.minimum(most[:, self._jaw], tracked[:, self._jaw] + pays)
        if self._lips is not None and len(part.frowns) and asked.settings.mode is Mode.PRESERVE:
            frowns, firm = tracked[:, part.frowns], self._calm_corners(asked, self._lips)
            most[:, part.frowns] = np.maximum(
                frowns, most[:, part.frowns] - firm[:, None] * (most[:, part.frowns] - frowns)
            )
        return most

    def _calm_corners(self, asked: RegionRequest, opening: int) -> Doubles:
        """(N,) in 0..1, how far a request is only for lips to close, or for single lips to move.

        Args:
            opening: the position of the mouth's opening among its own controls.
        """
        shuts = limited((asked.tracked - asked.wanted)[:, opening] / _CLOSING_MM)
        firm = np.zeros(len(shuts))
        for named, share in (([opening], shuts), (self._part.lips, np.ones(len(shuts)))):
            mine = asked.hold[:, named].max(axis=1, initial=0.0)
            others = np.delete(asked.hold, named, axis=1).max(axis=1, initial=0.0)
            alone = limited(1.0 - others / np.maximum(mine, 1e-9))
            firm = np.maximum(firm, np.where(mine > 0, share * alone, 0.0))
        return firm

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
        slack = room_of_close(weights)
        weights[:, part.have_columns] = np.where(influence > 0, new, old)
        if "mouthClose" in part.region.channels:
            couple(weights, slack, influence.max(axis=1) > 0)
        return room


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


@lru_cache(maxsize=8)
def _endless(shape: tuple[int, ...], sign: float) -> Doubles:
    """(N, K) no limit: infinity, or minus infinity; shared, and never changed."""
    endless = np.full(shape, sign * np.inf, order="F")
    endless.flags.writeable = False
    return endless
