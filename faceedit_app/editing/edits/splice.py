"""Splices: time that is cut out of a take or inserted into it, which makes it shorter or longer.

A splice begins and ends on frames, so that the other frames keep their weights to the bit. Around
a cut both sides are mixed; before inserted time the face comes to rest, and after it sets off.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from faceedit_app.core.arrays import Doubles, Floats, Indices, Times
from faceedit_app.core.clip import Clip
from faceedit_app.core.errors import FaceEditError
from faceedit_app.core.resample import interpolate
from faceedit_app.editing.edits.clock import CROSSFADE
from faceedit_app.formats.converting import timecodes_at
from faceedit_app.formats.gaps import find_gaps

LONGEST_INSERT = 600.0  # seconds
_EASE = 0.15  # seconds in which the face comes to rest, and in which it sets off


@dataclass(frozen=True)
class Splice:
    """Time that is cut out, or inserted.

    Attributes:
        start, end: seconds of the take that are cut out; the same if nothing is.
        seconds: inserted at `start`, in which the face rests; 0 if something is cut out.
    """

    start: float
    end: float
    seconds: float = 0.0


@dataclass(frozen=True)
class Piece:
    """A stretch of the take that stays.

    Attributes:
        first, stop: its frames.
        start, end: its seconds of the take.
        later: seconds by which it is shown later than in the take; below 0, earlier.
    """

    first: int
    stop: int
    start: float
    end: float
    later: float

    @property
    def shown(self) -> float:
        """When it begins to be shown, seconds of the spliced take."""
        return self.start + self.later

    @property
    def length(self) -> float:
        """Its seconds."""
        return self.end - self.start


@dataclass(frozen=True)
class Spliced:
    """A take with splices.

    Attributes:
        clip: the shorter or longer clip.
        pieces: what stays of the take, in order; the first and the last may be empty.
    """

    clip: Clip
    pieces: tuple[Piece, ...]

    def at(self, times: Times) -> Times:
        """(N,) when moments (N,) of the take are shown; what is cut out has the time of the cut."""
        found = times + self.pieces[0].later
        for piece in self.pieces:
            later = np.minimum(times, piece.end) + piece.later
            found = np.where(times >= piece.start, later, np.minimum(found, piece.shown))
        last = self.pieces[-1]
        return np.where(times > last.end, times + last.later, found)

    def moments(self, times: Times) -> Doubles:
        """(N,) seconds of the take that are shown at `times` (N,).

        In inserted time it is the moment before it.
        """
        found = times - self.pieces[0].later
        for piece in self.pieces:
            moment = np.minimum(times - piece.later, piece.end)
            found = np.where(times >= piece.shown, moment, found)
        return found


def splice(clip: Clip, splices: Sequence[Splice]) -> Spliced:
    """Cut time out of a clip, or insert time.

    Args:
        clip: the clip, with its edits.
        splices: in any order; all times are those of the clip.

    Raises:
        FaceEditError: one lies outside the take, two overlap, or nothing is left.
    """
    pieces = _pieces(clip, sorted(splices, key=lambda one: (one.start, one.end)))
    frames, times = _frames(clip, pieces)
    mixed = _mixed(pieces, times)
    weights, turns = clip.weights[frames], clip.rotations
    weights[mixed.rows] = _lips_before_jaw(clip, mixed.of(clip, clip.weights))
    rotations = None
    if turns is not None:
        rotations = turns[frames]
        rotations[mixed.rows] = mixed.of(clip, np.unwrap(turns.astype(np.float64), axis=0))
    made = replace(
        clip,
        weights=weights,
        times=times,
        gaps=find_gaps(times, clip.rate),
        timecodes=timecodes_at(clip.timecodes, times) if clip.timecodes else None,
        rotations=rotations,
        confidence=None if clip.confidence is None else clip.confidence[frames],
    )
    return Spliced(made, pieces)


# --- what stays ----------------------------------------------------------------------------------


def _pieces(clip: Clip, splices: Sequence[Splice]) -> tuple[Piece, ...]:
    if not splices:
        raise FaceEditError("Nothing is cut out or inserted")
    first, later, pieces = 0, 0.0, []
    for one in splices:
        _check(clip, one)
        stop, again = _frame(clip, one.start), _frame(clip, one.end)
        if stop < first:
            raise FaceEditError(f"What is changed at {one.start:g} s is cut out already")
        pieces.append(_piece(clip, first, stop, later))
        if one.seconds:
            later += max(round(one.seconds * clip.rate), 1) / clip.rate
        else:
            again = min(max(again, stop + 1), len(clip))
            later -= _second(clip, again) - _second(clip, stop)
        first = again
    pieces.append(_piece(clip, first, len(clip), later))
    if all(piece.first == piece.stop for piece in pieces):
        raise FaceEditError("Nothing would be left of the take; cut out less")
    return tuple(pieces)


def _check(clip: Clip, one: Splice) -> None:
    last = clip.duration
    if one.start > one.end or (one.start == one.end and not one.seconds):
        raise FaceEditError(f"What is cut out or inserted at {one.start:g} s must be over 0 s long")
    if one.end > last + 1e-6 or one.start < 0:
        what = f"{one.start:g} to {one.end:g} s" if one.end != one.start else f"{one.start:g} s"
        raise FaceEditError(f"{what} is outside the take: it lasts from 0 to {last:.2f} s")
    if not 0.0 <= one.seconds <= LONGEST_INSERT:
        raise FaceEditError(f"Up to {LONGEST_INSERT:.0f} s can be inserted")


def _frame(clip: Clip, seconds: float) -> int:
    """The frame at a time; after the last one, their number."""
    after = seconds > float(clip.times[-1]) + 0.5 / clip.rate
    return len(clip) if after else clip.frame_at(seconds)


def _second(clip: Clip, frame: int) -> float:
    return float(clip.times[frame]) if frame < len(clip) else clip.duration


def _piece(clip: Clip, first: int, stop: int, later: float) -> Piece:
    return Piece(first, stop, _second(clip, first), _second(clip, stop), later)


def _frames(clip: Clip, pieces: Sequence[Piece]) -> tuple[Indices, Times]:
    """(N,) each: the frames of the take that are shown, also in inserted time, and when."""
    frames, times = [], []
    for piece, later in zip(pieces, [*pieces[1:], None], strict=True):
        frames.append(np.arange(piece.first, piece.stop))
        times.append(clip.times[piece.first : piece.stop] + piece.later)
        if later is not None:
            begin = piece.end + piece.later
            count = round((later.shown - begin) * clip.rate)
            frames.append(np.full(count, min(piece.stop, len(clip) - 1)))
            times.append(begin + np.arange(count) / clip.rate)
    return np.concatenate(frames), np.concatenate(times)


# --- where pieces meet ---------------------------------------------------------------------------


@dataclass(frozen=True)
class _Mixed:
    """The frames near the joints, which are made of others.

    Attributes:
        rows: (M,) their numbers in the spliced take.
        first, second: (M,) seconds of the take that they are made of.
        share: (M,) 0..1 of the second.
    """

    rows: Indices
    first: Doubles
    second: Doubles
    share: Doubles

    def of(self, clip: Clip, values: Floats | Doubles) -> Doubles:
        """(M, K) from the values (T, K) of the take."""
        found = interpolate(clip.times, values, self.first)
        others = interpolate(clip.times, values, self.second)
        return found + self.share[:, None] * (others - found)


def _mixed(pieces: Sequence[Piece], times: Times) -> _Mixed:
    first = np.full(len(times), np.nan)
    second, share = first.copy(), np.zeros(len(times))
    for number, (before, after) in enumerate(pairwise(pieces)):
        # Neighbouring joints share the piece between them: what they change does not overlap.
        left = before.length if number == 0 else 0.5 * before.length
        right = after.length if number == len(pieces) - 2 else 0.5 * after.length
        at, rest = before.end + before.later, after.shown - before.end - before.later
        apart, inserted = times - at, rest > 1e-6
        half = min(left, right, *((_EASE, 0.5 * rest) if inserted else (CROSSFADE,)))
        if half <= 0:
            continue
        near = (apart > -half) & (apart < rest + half)
        moved = apart[near]
        if inserted:
            first[near] = second[near] = before.end + _resting(moved, rest, half)
        else:
            first[near], second[near] = before.end + moved, after.start + moved
            along = 0.5 + 0.5 * moved / half
            share[near] = along * along * (3.0 - 2.0 * along)
    rows = np.flatnonzero(~np.isnan(first))
    return _Mixed(rows, first[rows], second[rows], share[rows])


def _resting(apart: Doubles, rest: float, half: float) -> Doubles:
    """(M,) seconds of the take, from where it rests, at times from the beginning of the rest.

    The face slows down evenly over `2 * half`, rests, and sets off in the same way.
    """
    slowing = np.clip(apart + half, 0.0, 2.0 * half)
    setting_off = np.clip(apart - rest + half, 0.0, 2.0 * half)
    moment: Doubles = slowing - half - (slowing * slowing - setting_off * setting_off) / (4 * half)
    return moment


def _lips_before_jaw(clip: Clip, weights: Doubles) -> Doubles:
    """Weights between frames, with lips that close no more beyond the jaw than on the take's."""
    names = list(clip.channels)
    if "mouthClose" in names and "jawOpen" in names:
        close, jaw = names.index("mouthClose"), names.index("jawOpen")
        excess = max(float((clip.weights[:, close] - clip.weights[:, jaw]).max()), 0.0)
        weights[:, close] = np.minimum(weights[:, close], weights[:, jaw] + excess)
    return weights
