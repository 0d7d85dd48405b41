"""Fill: a stretch of a take made from the take's own motion, so that it joins both sides.

Other stretches of the take (*donors*) are put in its place. They are chosen like the units of
concatenative speech synthesis (Hunt and Black, "Unit selection in a concatenative speech synthesis
system using a large speech database", 1996): by how alike the motion around them is, by how well
they follow a guide, and by how well they join. What is left between them and the ends fades as an
offset of value and velocity, like the transitions of games (Bollo, "Inertialization", GDC 2018).

A fill depends on the take as tracked, on the edit, and on earlier fills that touch it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Bools, Doubles, Floats, Indices, Times
from faceedit_app.core.clip import Clip

CONTEXT = 0.25  # seconds on either side that have to be like those of a donor
_SAMPLES = 4  # frames of the context that are compared
_FADE, _EASE = 0.8, 0.2  # seconds in which an offset of value, or of velocity, fades
_PIECE = 0.8  # seconds of a donor that follows a guide
_SHORTEST = 0.25  # seconds of a donor
_FROZEN = 0.15  # seconds; trackers that lose a face repeat its last frame
_NEAREST = 20_000  # frames around the stretch in which donors are looked for
_BEST = 24  # donors of each piece that are tried with those before and after
_APART = 0.3  # seconds between the donors of two variations
_SPEED = 0.1  # seconds: a velocity counts like the way made in so much time
_GUIDE = 0.3  # the weight of a guide against how alike the motion around is


@dataclass(frozen=True)
class Stretch:
    """What has to be filled.

    Attributes:
        first, stop: the frames, `stop` excluded.
        before, after: (N, 52) weights of up to `CONTEXT` seconds before and after it.
        seed: which variation; 0 is the best.
        guide: (2, P) seconds and mm of mouth opening that donors should have; None = any.
    """

    first: int
    stop: int
    before: Floats
    after: Floats
    seed: int = 0
    guide: Doubles | None = None


class Filling:
    """Fills stretches of one take.

    Args:
        clip: its times, rate and gaps.
        tracked: (T, 52) in ARKit order.
        opening: (T,) mm, the mouth opening.
    """

    def __init__(self, clip: Clip, tracked: Floats, opening: Floats) -> None:
        self._times, self._rate = clip.times, clip.rate
        self._weights = tracked
        self._speed = (_SPEED * clip.rate) ** 2
        self._opening = opening.astype(np.float64)
        self._broken = _broken(clip, tracked)
        self._low, self._high = tracked.min(axis=0), tracked.max(axis=0)
        excess = tracked[:, ARKIT_INDEX["mouthClose"]] - tracked[:, ARKIT_INDEX["jawOpen"]]
        self._excess = float(max(excess.max(), 0.0))

    @property
    def context(self) -> int:
        """Frames on either side that a fill depends on."""
        return max(round(CONTEXT * self._rate), 2)

    def fill(self, stretch: Stretch) -> Doubles:
        """(N, 52) weights for the frames of a stretch.

        A take without any other motion gives a smooth way from one end to the other; a stretch
        that is the whole take stays as it is.
        """
        if not len(stretch.before) and not len(stretch.after):
            return self._weights[stretch.first : stretch.stop].astype(np.float64)
        steps = self._steps(stretch)
        content = self._made(stretch, int(steps[-1]))
        frames: Doubles = content[steps[:-1]]
        return frames

    def between(self, stretch: Stretch, seconds: Times) -> Doubles:
        """(N, 52) weights at any times (N,) within a stretch that has frames on a side."""
        steps = self._steps(stretch)
        start = self._times[stretch.first] - float(steps[0]) / self._rate
        at = np.round((seconds - start) * self._rate).astype(np.intp)
        content = self._made(stretch, int(steps[-1]))
        frames: Doubles = content[np.clip(at, 0, len(content) - 1)]
        return frames

    def _made(self, stretch: Stretch, length: int) -> Doubles:
        """(M + 1, 52) weights on every step of 1 / rate, both ends included."""
        pieces = self._pieces(stretch, length)
        if pieces is None:
            content = _way(stretch, length)
        else:
            content = _joined(self._weights, pieces, self._rate)
        start = pieces[0][0] if pieces is not None else None
        end = pieces[-1][0] + int(np.diff(pieces[-1][1:])[0]) if pieces is not None else None
        self._meet(content, stretch, start, end)
        result: Doubles = np.clip(content, self._low, self._high)
        close, jaw = ARKIT_INDEX["mouthClose"], ARKIT_INDEX["jawOpen"]
        result[:, close] = np.minimum(result[:, close], result[:, jaw] + self._excess)
        return result

    def _steps(self, stretch: Stretch) -> Indices:
        """(N + 1,) steps of 1 / rate from the frame before a stretch: its frames, then its end."""
        first = stretch.first - 1
        times = self._times[max(first, 0) : stretch.stop + 1]
        if first < 0:
            times = np.concatenate([[times[0] - 1.0 / self._rate], times])
        if stretch.stop == len(self._times):
            times = np.append(times, times[-1] + 1.0 / self._rate)
        steps = np.maximum(np.round((times - times[0]) * self._rate).astype(np.intp), 0)
        return np.maximum.accumulate(steps[1:])

    # --- choosing donors ---------------------------------------------------------------------

    def _pieces(self, stretch: Stretch, length: int) -> list[tuple[int, int, int]] | None:
        """Donors as (first frame, first step, last step), in order; None without any."""
        shortest = max(round(_SHORTEST * self._rate), 1)
        seconds = length / self._rate
        count = max(round(seconds / _PIECE), 1) if stretch.guide is not None else 1
        while True:
            cuts = np.linspace(0, length, count + 1).round().astype(np.intp)
            valid = [self._valid(stretch, int(size)) for size in np.diff(cuts)]
            if all(starts.any() for starts in valid):
                return self._chosen(stretch, cuts, valid)
            if length // (2 * count) < shortest:
                return None
            count *= 2

    def _valid(self, stretch: Stretch, size: int) -> Bools:
        """(T,) whether the `size` steps from each frame are unbroken motion outside a stretch."""
        count = len(self._weights)
        bad = np.concatenate([[0], np.cumsum(self._broken)])
        starts = np.arange(count)
        ends = starts + size
        # One step more on either side gives the velocity there.
        first, last = np.maximum(starts - 1, 0), np.minimum(ends + 1, count - 1)
        valid = (ends < count) & (bad[last] - bad[first] == 0)
        valid &= (ends < stretch.first - 1) | (starts > stretch.stop)
        middle, half = (stretch.first + stretch.stop) // 2, _NEAREST // 2
        near: Bools = valid & (starts >= middle - half) & (ends <= middle + half)
        return near if near.any() else valid

    def _chosen(
        self, stretch: Stretch, cuts: Indices, valid: list[Bools]
    ) -> list[tuple[int, int, int]]:
        """The best donors; a later variation uses none near those of an earlier one."""
        costs = self._costs(stretch, cuts)
        apart = max(round(_APART * self._rate), 1)
        free = [starts.copy() for starts in valid]
        for left in range(stretch.seed, -1, -1):
            if not all(starts.any() for starts in free):
                free = [starts.copy() for starts in valid]  # all are used: begin again
            found = self._best(cuts, costs, free)
            if left:
                for starts, start in zip(free, found, strict=True):
                    starts[max(start - apart, 0) : start + apart + 1] = False
        sizes = zip(cuts[:-1].tolist(), cuts[1:].tolist(), strict=True)
        return [(start, *size) for start, size in zip(found, sizes, strict=True)]

    def _costs(self, stretch: Stretch, cuts: Indices) -> list[Doubles]:
        """(T,) for each piece: how badly a donor from each frame suits it by itself."""
        count = len(self._weights)
        costs = [np.zeros(count) for _ in cuts[1:]]
        if stretch.guide is not None:
            start = self._times[stretch.first] - 1.0 / self._rate
            spread = float(self._opening.var()) + 1e-3
            for i, cost in enumerate(costs):
                at = start + np.arange(cuts[i], cuts[i + 1] + 1) / self._rate
                away = _misses(self._opening, np.interp(at, *stretch.guide))
                cost[: len(away)] += _GUIDE * (cuts[i + 1] - cuts[i]) / cuts[-1] * away / spread
        places = np.linspace(0, self.context - 1, _SAMPLES).round().astype(np.intp)
        frames = np.arange(count)
        moves = np.diff(self._weights, axis=0, prepend=self._weights[:1]).astype(np.float64)
        if len(stretch.before):
            speed = stretch.before[-1].astype(np.float64) - stretch.before[-2:][0]
            costs[0] += self._speed * np.square(moves - speed).sum(axis=1)
            for back in places[places < len(stretch.before)]:
                away = self._away(stretch.before[-1 - back])
                costs[0] += away[np.maximum(frames - back, 0)] / _SAMPLES
        if len(stretch.after):
            size = int(cuts[-1] - cuts[-2])
            speed = stretch.after[:2][-1].astype(np.float64) - stretch.after[0]
            away = self._speed * np.square(moves - speed).sum(axis=1)
            costs[-1] += away[np.minimum(frames + size + 1, count - 1)]
            for on in places[places < len(stretch.after)]:
                away = self._away(stretch.after[on])
                costs[-1] += away[np.minimum(frames + size + on, count - 1)] / _SAMPLES
        # The last bits of a sum depend on the processor; a choice must not.
        return [cost.round(6) for cost in costs]

    def _away(self, pose: Floats) -> Doubles:
        """(T,) squared distance of each frame from a pose."""
        away: Doubles = np.square(self._weights - pose, dtype=np.float64).sum(axis=1)
        return away

    def _best(self, cuts: Indices, costs: list[Doubles], free: list[Bools]) -> list[int]:
        """The first frame of each donor: the cheapest path (Viterbi)."""
        tried = [
            starts[np.argsort(cost[starts], kind="stable")[:_BEST]]
            for starts, cost in zip(map(np.flatnonzero, free), costs, strict=True)
        ]
        total = costs[0][tried[0]]
        back: list[Indices] = []
        for i in range(1, len(costs)):
            ends = tried[i - 1] + int(cuts[i] - cuts[i - 1])
            join = np.zeros((len(ends), len(tried[i])))
            for on in (-1, 0):
                one = self._weights[ends + on].astype(np.float64)
                other = self._weights[np.maximum(tried[i] + on, 0)].astype(np.float64)
                join += 0.5 * np.square(one[:, None] - other[None]).sum(axis=2).round(6)
            paths = total[:, None] + join
            back.append(paths.argmin(axis=0))
            total = paths.min(axis=0) + costs[i][tried[i]]
        at = int(total.argmin())
        found = [int(tried[-1][at])]
        for starts, came in zip(tried[-2::-1], back[::-1], strict=True):
            at = int(came[at])
            found.append(int(starts[at]))
        return found[::-1]

    # --- the ends ----------------------------------------------------------------------------

    def _meet(self, content: Doubles, stretch: Stretch, start: int | None, end: int | None) -> None:
        """Let content (M + 1, 52) begin and end like what surrounds it, in place.

        Args:
            start, end: the donor's frames at both ends; None = content at rest.
        """
        steps = np.arange(len(content), dtype=np.float64)
        fade, ease = self._lengths(len(content) - 1)
        weights = self._weights
        if len(stretch.before):
            speed = 0.0 if start is None else weights[start] - weights[max(start - 1, 0)]
            wanted = stretch.before[-1] - stretch.before[-2:][0]
            value = stretch.before[-1] - content[0]
            first = _offset(steps, value, wanted - speed, fade, ease)
        if len(stretch.after):
            stop = len(weights) - 1
            speed = 0.0 if end is None else weights[min(end + 1, stop)] - weights[end]
            wanted = stretch.after[:2][-1] - stretch.after[0]
            value = stretch.after[0] - content[-1]
            last = _offset(steps[::-1], value, -(wanted - speed), fade, ease)
            content += last
        if len(stretch.before):
            content += first

    def _lengths(self, length: int) -> tuple[float, float]:
        """Steps in which an offset of value and one of velocity fade in a piece of some steps."""
        fade = min(_FADE * self._rate, float(length))
        return max(fade, 1.0), max(min(_EASE * self._rate, 0.5 * length), 1.0)


def _broken(clip: Clip, weights: Floats) -> Bools:
    """(T,) whether no motion leads from a frame to the next: a gap, or a face that is lost."""
    still = np.append((np.diff(weights, axis=0) == 0).all(axis=1), False)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], still, [False]]).astype(np.int8)))
    for first, stop in edges.reshape(-1, 2).tolist():
        # When the face is found again, it jumps.
        still[first : stop + 1] = stop - first >= _FROZEN * clip.rate
    still[[gap.frame for gap in clip.gaps]] = True
    return still


def _misses(curve: Doubles, guide: Doubles) -> Doubles:
    """(T - N + 1,) mean squared difference of each part of a curve (T,) from a guide (N,)."""
    if len(curve) < len(guide):
        return np.zeros(0)
    squares = np.concatenate([[0.0], np.cumsum(curve**2)])
    own = squares[len(guide) :] - squares[: -len(guide)]
    both = np.correlate(curve, guide, "valid")
    misses: Doubles = (own - 2.0 * both + float((guide**2).sum())) / len(guide)
    return np.maximum(misses, 0.0)


def _way(stretch: Stretch, length: int) -> Doubles:
    """(M + 1, 52): smoothly from one end to the other, or still if there is only one."""
    ends = (stretch.before[-1:], stretch.after[:1])
    first, last = (ends[i] if len(ends[i]) else ends[1 - i] for i in (0, 1))
    share = 1.0 - _fading(np.linspace(0.0, 1.0, length + 1))[:, None]
    way: Doubles = first + share * (last.astype(np.float64) - first)
    return way


def _joined(weights: Floats, pieces: Sequence[tuple[int, int, int]], rate: float) -> Doubles:
    """(M + 1, 52) the donors one after the other; where two join, each goes half the way."""
    out = np.zeros((pieces[-1][2] + 1, weights.shape[1]))
    for i, (start, first, last) in enumerate(pieces):
        size = last - first
        content = weights[start : start + size + 1].astype(np.float64)
        steps = np.arange(size + 1, dtype=np.float64)
        half = max(0.5 * size, 1.0)
        fade, ease = min(_FADE * rate, half), max(min(_EASE * rate, half), 1.0)
        gaps = []
        if i > 0:
            gaps.append((_between(weights, pieces[i - 1], start), steps, 0.5))
        if i + 1 < len(pieces):
            gaps.append((_between(weights, pieces[i], pieces[i + 1][0]), steps[::-1], -0.5))
        for (value, speed), away, sign in gaps:
            direction = 1.0 if sign > 0 else -1.0
            content += _offset(away, sign * value, direction * sign * speed, fade, ease)
        out[first : last + 1] = content
    return out


def _between(weights: Floats, piece: tuple[int, int, int], start: int) -> tuple[Doubles, Doubles]:
    """(52,) each: by how much a piece's end exceeds the next one's start, in value and velocity."""
    end = piece[0] + piece[2] - piece[1]
    value = weights[end].astype(np.float64) - weights[start]
    before = weights[max(start - 1, 0)]
    speed = (weights[end].astype(np.float64) - weights[max(end - 1, 0)]) - (weights[start] - before)
    return value, speed


def _fading(share: Doubles) -> Doubles:
    """1 at 0, 0 from 1 on, with no velocity or acceleration at either."""
    left = 1.0 - np.minimum(share, 1.0)
    fading: Doubles = left**3 * (10.0 - 15.0 * left + 6.0 * left**2)
    return fading


def _offset(steps: Doubles, value: Doubles, speed: Doubles, fade: float, ease: float) -> Doubles:
    """(M, 52): an offset that begins with a value and a velocity per step and fades.

    Args:
        steps: (M,) from where it begins.
        value, speed: (52,).
        fade, ease: steps in which the value and the velocity fade.
    """
    slowing = steps * np.square(np.maximum(1.0 - np.square(steps / ease), 0.0))
    offset: Doubles = _fading(steps / fade)[:, None] * value + slowing[:, None] * speed
    return offset


def fill_frames(times: Times, span: tuple[float, float]) -> tuple[int, int]:
    """The frames within a time range: the first, and the one after the last."""
    first, stop = np.searchsorted(times, (span[0] - 1e-9, span[1] + 1e-9)).tolist()
    return first, stop
