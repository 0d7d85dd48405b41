"""Splices: time that is cut out of a take or inserted into it, which makes it shorter or longer.

A splice begins and ends on frames, so that the other frames keep their weights to the bit. Around
a cut both sides are mixed; before inserted time the face comes to rest, and after it sets off.
In a gap it begins and ends where a lost frame would be, and nothing is mixed across a long gap.
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
from faceedit_app.formats.faceless import Faceless
from faceedit_app.formats.gaps import find_gaps

LONGEST_INSERT = 600.0  # seconds
_EASE = 0.15  # seconds in which the face comes to rest, and in which it sets off
_BRIDGED = CROSSFADE  # seconds of a gap across which frames are mixed as if there were none
_INSTANT = 1e-6  # seconds
_MISSED = 0.25  # frames


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
        has_rest: whether the face rests in time that is inserted before it; it has no face if not.
    """

    first: int
    stop: int
    start: float
    end: float
    later: float
    has_rest: bool = True

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
        notes: sentences about what gaps made different from what was wanted.
    """

    clip: Clip
    pieces: tuple[Piece, ...]
    notes: tuple[str, ...] = ()

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
            last = np.inf if piece is self.pieces[-1] else piece.end
            moment = np.minimum(times - piece.later, last)
            found = np.where(times >= piece.shown, moment, found)
        return found

    def without_face(self, rows: Faceless) -> Faceless:
        """The take's rows without a face that stay, at their new times.

        Time that is inserted where such a row lies has no face either: the row is repeated.
        """
        step = 1.0 / self.clip.rate
        found, later = list[Indices](), list[Times]()
        for number, piece in enumerate(self.pieces):
            if number and not piece.has_rest:
                end = self.pieces[number - 1].end
                begin = end + self.pieces[number - 1].later
                row = int(np.argmin(np.abs(rows.times - end)))
                is_there = abs(float(rows.times[row]) - end) < step
                count = round((piece.shown - begin) / step) if is_there else 0
                found.append(np.full(count, rows.rows[row]))
                later.append(np.asarray(begin + np.arange(count) * step, np.float64))
            # Rows may miss the places of frames slightly; those beyond all faces stay.
            start = piece.start - _MISSED * step if number else -np.inf
            stop = piece.end - _MISSED * step if piece is not self.pieces[-1] else np.inf
            here = (rows.times >= start) & (rows.times < stop)
            found.append(rows.rows[here])
            later.append(rows.times[here] + piece.later)
        return Faceless(np.concatenate(found), np.concatenate(later))


def splice(clip: Clip, splices: Sequence[Splice]) -> Spliced:
    """Cut time out of a clip, or insert time.

    Args:
        clip: the clip, with its edits.
        splices: in any order; all times are those of the clip.

    Raises:
        FaceEditError: one lies outside the take, two overlap, or nothing is left.
    """
    pieces, notes = _pieces(clip, sorted(splices, key=lambda one: (one.start, one.end)))
    frames, times = _frames(clip, pieces)
    mixed = _mixed(clip, pieces, times)
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
    return Spliced(made, pieces, notes)


# --- what stays ----------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Place:
    """Where a splice begins or ends.

    Attributes:
        frame: the first frame at this time or after it; the number of frames after the last one.
        second: of the take.
        gap: seconds of the gap that it lies in; 0 if it lies on a frame.
    """

    frame: int
    second: float
    gap: float = 0.0

    @property
    def has_face(self) -> bool:
        """Whether there is a face, if only one between those before and after a short gap."""
        return self.gap <= _BRIDGED


def _pieces(clip: Clip, splices: Sequence[Splice]) -> tuple[tuple[Piece, ...], tuple[str, ...]]:
    """What stays, and notes about it."""
    if not splices:
        raise FaceEditError("Nothing is cut out or inserted")
    begin, later, has_rest, pieces = _Place(0, 0.0), 0.0, True, list[Piece]()
    notes, is_first = [], True  # of what is shown
    for one in splices:
        _check(clip, one)
        stop, again = _place(clip, one.start), _place(clip, one.end)
        if stop.second < begin.second - _INSTANT:
            raise FaceEditError(f"What is changed at {one.start:g} s is cut out already")
        if not one.seconds:
            wanted = stop, again = stop, _later(clip, stop, again)
            is_first = is_first and stop.frame == begin.frame
            stop, again = _between_faces(clip, stop, again, is_first)
            if (stop, again) != wanted:
                notes.append(_cut_note(stop, again, is_first))
        if stop.second < begin.second - _INSTANT:
            raise FaceEditError(
                f"The face is lost from {begin.second:.2f} s to {one.start:g} s, where the take "
                "would end; cut that out too"
            )
        pieces.append(_piece(begin, stop, later, has_rest))
        if one.seconds:
            later += max(round(one.seconds * clip.rate), 1) / clip.rate
            if not stop.has_face:
                notes.append(f"the face is lost at {one.start:g} s: that gap is longer now")
        else:
            later -= again.second - stop.second
        begin, has_rest = again, stop.has_face
        is_first = is_first and not one.seconds
    pieces.append(_piece(begin, _on_frame(clip, len(clip)), later, has_rest))
    if all(piece.first == piece.stop for piece in pieces):
        raise FaceEditError("Nothing would be left of the take; cut out less")
    return tuple(pieces), tuple(notes)


def _between_faces(
    clip: Clip, stop: _Place, again: _Place, is_first: bool
) -> tuple[_Place, _Place]:
    """A cut after which the take neither begins nor ends in a gap, since no take can."""
    if is_first and again.gap:
        again = _on_frame(clip, again.frame)
    if stop.gap and again.frame == len(clip):
        stop = _Place(stop.frame, float(clip.times[stop.frame - 1]) + 1.0 / clip.rate, stop.gap)
    return stop, again


def _cut_note(stop: _Place, again: _Place, is_first: bool) -> str:
    where = "begin" if is_first else "end"
    return (
        f"the take would {where} where the face is lost, so {stop.second:.2f} to "
        f"{again.second:.2f} s is cut out"
    )


def _check(clip: Clip, one: Splice) -> None:
    last = clip.duration
    if one.start > one.end or (one.start == one.end and not one.seconds):
        raise FaceEditError(f"What is cut out or inserted at {one.start:g} s must be over 0 s long")
    if one.end > last + 1e-6 or one.start < 0:
        what = f"{one.start:g} to {one.end:g} s" if one.end != one.start else f"{one.start:g} s"
        raise FaceEditError(f"{what} is outside the take: it lasts from 0 to {last:.2f} s")
    if not 0.0 <= one.seconds <= LONGEST_INSERT:
        raise FaceEditError(f"Up to {LONGEST_INSERT:.0f} s can be inserted")


def _place(clip: Clip, seconds: float) -> _Place:
    """The frame nearest to a time, or where a lost frame would be."""
    after = int(np.searchsorted(clip.times, seconds))
    if any(gap.frame == after - 1 for gap in clip.gaps):
        before, following = float(clip.times[after - 1]), float(clip.times[after])
        number = round((seconds - before) * clip.rate)
        if 0 < number < round((following - before) * clip.rate):
            return _Place(after, before + number / clip.rate, following - before)
    is_end = seconds > float(clip.times[-1]) + 0.5 / clip.rate
    return _on_frame(clip, len(clip) if is_end else clip.frame_at(seconds))


def _on_frame(clip: Clip, frame: int) -> _Place:
    """A frame's place; for their number, the end of the take."""
    return _Place(frame, float(clip.times[frame]) if frame < len(clip) else clip.duration)


def _later(clip: Clip, stop: _Place, again: _Place) -> _Place:
    """The end of a cut that begins at `stop`: `again`, or the next place if that is no later."""
    if again.second <= stop.second:
        again = _place(clip, stop.second + 1.0 / clip.rate)
    if again.second <= stop.second:
        again = _on_frame(clip, min(stop.frame + 1, len(clip)))
    return again


def _piece(begin: _Place, stop: _Place, later: float, has_rest: bool) -> Piece:
    return Piece(begin.frame, stop.frame, begin.second, stop.second, later, has_rest)


def _frames(clip: Clip, pieces: Sequence[Piece]) -> tuple[Indices, Times]:
    """(N,) each: the frames of the take that are shown, also in inserted time, and when."""
    frames, times = [], []
    for piece, later in zip(pieces, [*pieces[1:], None], strict=True):
        frames.append(np.arange(piece.first, piece.stop))
        times.append(clip.times[piece.first : piece.stop] + piece.later)
        if later is not None and later.has_rest:
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


def _mixed(clip: Clip, pieces: Sequence[Piece], times: Times) -> _Mixed:
    first = np.full(len(times), np.nan)
    second, share = first.copy(), np.zeros(len(times))
    for number, (before, after) in enumerate(pairwise(pieces)):
        # Neighbouring joints share the piece between them: what they change does not overlap.
        left = before.length if number == 0 else 0.5 * before.length
        right = after.length if number == len(pieces) - 2 else 0.5 * after.length
        (early, last), (earliest, late) = (_seen(clip, t) for t in (before.end, after.start))
        left = min(left, before.end - early)
        right = min(right, late + 1.0 / clip.rate - after.start)
        at, rest = before.end + before.later, after.shown - before.end - before.later
        apart, inserted = times - at, rest > _INSTANT
        half = min(left, right, *((_EASE, 0.5 * rest) if inserted else (CROSSFADE,)))
        if half <= _INSTANT:
            continue
        near = (apart > -half) & (apart < rest + half)
        moved = apart[near]
        if inserted:
            moment = before.end + _resting(moved, rest, half)
            first[near] = second[near] = np.clip(moment, earliest, last)
        else:
            first[near] = np.minimum(before.end + moved, last)
            second[near] = np.maximum(after.start + moved, earliest)
            along = 0.5 + 0.5 * moved / half
            share[near] = along * along * (3.0 - 2.0 * along)
    rows = np.flatnonzero(~np.isnan(first))
    return _Mixed(rows, first[rows], second[rows], share[rows])


def _seen(clip: Clip, second: float) -> tuple[float, float]:
    """First and last moment around a time between which no long gap lies.

    In such a gap the first is after it, and the last more than a frame before it.
    """
    pairs = np.array([pair for pair in clip.gap_times if pair[1] - pair[0] > _BRIDGED])
    last, following = pairs.reshape(-1, 2).T
    earlier = following[last + 1.0 / clip.rate < second - _INSTANT]
    later = last[following > second + _INSTANT]
    return float(earlier.max(initial=0.0)), float(later.min(initial=clip.times[-1]))


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
