"""Retimes by hand: stretch a range, move it in time, cut it out, or insert a pause.

What a retime gains or loses in time, it takes from the rest of the take beside it, so that all
that follows keeps its time, and with it sound and film.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from faceedit_app.core.clip import Clip
from faceedit_app.core.controls import CONTROL_IDS
from faceedit_app.core.errors import FaceEditError
from faceedit_app.core.given import number, number_or_none
from faceedit_app.editing.edits.clock import CROSSFADE
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.help.by_name import check_inside

SLOWEST, FASTEST = 0.5, 2.0  # speeds, as multiples of the take's
LEAST_PAD = 0.3  # seconds beside the range that make up for it, if the take has them
_EASE = 0.15  # seconds in which the face comes to rest before a pause
_PADDED = 3.0  # times the difference in time is taken from the rest, where there is room
_DIGITS = 4  # of seconds
# What comes after a cut or pause and stands still makes up for it alone, if it is near enough (in
# seconds, or times the difference) and its speed is not changed by more than a factor.
_NEAR, _NEAR_TIMES, _STILL_FASTEST = 1.5, 4.0, 5.0
_STILL = 0.15  # of the speed of the fastest tenth of the frames around
_AROUND = 10.0  # seconds
_SMALLEST = 0.001  # seconds; smaller differences are none

Range = tuple[float, float]


def stretched(clip: Clip, span: Range, factor: float, pad: float = LEAST_PAD) -> Edit:
    """A retime that makes a range longer or shorter; the take after it makes up for it.

    Without room after the range, its end stays and its start moves.

    Args:
        clip: the take.
        span: first and last second of the range.
        factor: 1.3 makes it 30 % longer.
        pad: seconds beside it that make up for it at least, as far as the take has them.

    Raises:
        FaceEditError: the factor is out of range, or the take has no room for it.
    """
    least, most = 1.0 / FASTEST, 1.0 / SLOWEST
    if not least <= factor <= most:
        raise FaceEditError(f"A range can be stretched to {100 * least:.0f} to {100 * most:.0f} %")
    (start, end), length = span, factor * (span[1] - span[0])
    ways = (start, start + length), (end - length, end)
    return _first_possible(clip, span, ways, pad)


def moved(clip: Clip, span: Range, by: float, pad: float = LEAST_PAD) -> Edit:
    """A retime that shows a range earlier or later; the take on both sides makes up for it.

    Args:
        by: seconds; above 0 is later.

    Raises:
        FaceEditError: the take has no room for it.
    """
    return _first_possible(clip, span, ((span[0] + by, span[1] + by),), pad)


def _first_possible(clip: Clip, span: Range, ways: Sequence[Range], pad: float) -> Edit:
    span = _inside(clip, span)
    for goal in ways:
        near = nearest(clip, span, goal)
        if max(abs(near[0] - goal[0]), abs(near[1] - goal[1])) < _SMALLEST:
            return retime(clip, span, near, pad)
    first, last = nearest(clip, span, ways[0])
    raise FaceEditError(
        f"The take beside {span[0]:.2f} to {span[1]:.2f} s has no room for that; "
        f"it could go to {first:.2f} to {last:.2f} s"
    )


def _inside(clip: Clip, span: Range) -> Range:
    """The part of a range that is inside the take: a selection may end some rounding beyond it.

    Raises:
        FaceEditError: it is outside the take.
    """
    check_inside(clip, *span)
    return max(span[0], float(clip.times[0])), min(span[1], float(clip.times[-1]))


def nearest(clip: Clip, span: Range, goal: Range) -> Range:
    """Where a range can go, nearest to a goal, so that nothing is played too slow or too fast."""
    start, end = span
    first, last = float(clip.times[0]), float(clip.times[-1])
    before, after = max(start - first, 0.0), max(last - end, 0.0)
    slower, faster = 1.0 / SLOWEST - 1.0, 1.0 - 1.0 / FASTEST  # of what is beside it
    lows = start - faster * before, end - slower * after
    highs = start + slower * before, end + faster * after
    if end - start < 2.0 * _SMALLEST:  # a moment, which is only moved
        length = end - start
        only = min(max(goal[0], lows[0], lows[1] - length), highs[0], highs[1] - length)
        only = _moved_to(start, only)
        return only, only + length
    to, until = (min(max(at, low), high) for at, low, high in zip(goal, lows, highs, strict=True))
    least, most = (end - start) / FASTEST, (end - start) / SLOWEST
    if abs(until - end) >= abs(to - start):  # the end that was moved farther gives way
        to = min(max(to, lows[1] - most), highs[1] - least)
        until = min(max(until, to + least, lows[1]), to + most, highs[1])
    else:
        until = min(max(until, lows[0] + least), highs[0] + most)
        to = min(max(to, until - most, lows[0]), until - least, highs[0])
    return _moved_to(start, to), _moved_to(end, until)


def _moved_to(was: float, goal: float) -> float:
    """The goal, or where it was if that is hardly a difference: nothing would make up for it."""
    return goal if abs(goal - was) >= _SMALLEST else was


def retime(clip: Clip, span: Range, goal: Range, pad: float = LEAST_PAD) -> Edit:
    """A retime that shows a range at another one, as `nearest` allows.

    Args:
        pad: seconds beside the range that make up for it at least, as far as the take has them.
    """
    first, last = float(clip.times[0]), float(clip.times[-1])
    early, late = goal[0] - span[0], goal[1] - span[1]
    start = max(span[0] - padded(early, pad), first)
    end = min(span[1] + padded(late, pad), last)
    pins = tuple(zip(span, goal, strict=True))
    return _edit(start, end, pins if span[0] < span[1] else pins[:1])


def padded(difference: float, pad: float = LEAST_PAD) -> float:
    """Seconds of the take beside a range that make up for a difference; 0 for none."""
    if abs(difference) < _SMALLEST:
        return 0.0
    return max(pad, _PADDED * abs(difference))


def cut(clip: Clip, span: Range, pad: float = LEAST_PAD) -> Edit:
    """A retime that leaves out a range; the take after it fills its time by playing slower.

    If the face soon stands still, it stands still for longer. Without room after the range, the
    take before it fills the time.

    Raises:
        FaceEditError: the take has no room on either side.
    """
    start, end = _inside(clip, span)
    first, last = float(clip.times[0]), float(clip.times[-1])
    length = end - start
    if length <= 0:
        raise FaceEditError("Select what to cut first")
    still = _still(clip, end, length, length / (_STILL_FASTEST - 1.0))
    if still is not None:
        pins = ((start, start), (end, start), (still[0], still[0] - length))
        return _edit(max(start - CROSSFADE, first), still[1], pins)
    least, wanted = length / (1 / SLOWEST - 1), max(pad, 2.0 * length)
    if last - end >= least:
        beside = min(wanted, last - end)
        return _edit(max(start - CROSSFADE, first), end + beside, ((start, start), (end, start)))
    if start - first >= least:
        beside = min(wanted, start - first)
        return _edit(start - beside, min(end + CROSSFADE, last), ((start, end), (end, end)))
    raise FaceEditError(
        f"To cut {length:.2f} s, the take needs {least:.2f} s before or after it, "
        "which fill the time"
    )


def pause(clip: Clip, at: float, seconds: float, pad: float = LEAST_PAD) -> Edit:
    """A retime that holds the face for some seconds; the take after it plays faster.

    If the face soon stands still, it does so for a shorter time. Without room after the pause, the
    take before it makes room.

    Args:
        at: when the pause begins.

    Raises:
        FaceEditError: the take has no room on either side.
    """
    at = _inside(clip, (at, at))[0]
    first, last = float(clip.times[0]), float(clip.times[-1])
    if not seconds > 0:
        raise FaceEditError("A pause must be longer than 0 s")
    still = _still(clip, at, seconds, seconds / (1.0 - 1.0 / _STILL_FASTEST))
    if still is not None:
        # It sets off again at ease, then plays as it was until it stands still.
        own = [moment for moment in (at + _EASE, still[0]) if moment <= still[0]]
        pins = ((at, at), (at, at + seconds), *((moment, moment + seconds) for moment in own))
        return _edit(max(at - _EASE, first), still[1], pins)
    least, wanted = seconds / (1 - 1 / FASTEST), max(pad, _PADDED * seconds)
    if last - at >= least:
        end = at + min(wanted, last - at)
        return _edit(max(at - _EASE, first), end, ((at, at), (at, at + seconds)))
    if at - first >= least:
        start = at - min(wanted, at - first)
        return _edit(start, min(at + _EASE, last), ((at, at - seconds), (at, at)))
    raise FaceEditError(
        f"A pause of {seconds:.2f} s needs {least:.2f} s of the take before or after it, "
        "which make room"
    )


def reshaped(edit: Edit, start: float, end: float, fade_in: float, fade_out: float) -> Edit:
    """An edit with another hold and other falloffs.

    A retime has no falloff: its range grows by them. It keeps its pins, and as much room around
    them as they need; if it is only moved, they move along.
    """
    if edit.op is not Op.RETIME:
        return replace(edit.stretched(start, end), falloff=fade_in, falloff_out=fade_out)
    start, end = start - fade_in, end + fade_out
    if abs((end - start) - (edit.end - edit.start)) < _SMALLEST:
        return edit.shifted(start - edit.start)
    if edit.pins:
        (was, now), (then_was, then_now) = edit.pins[0], edit.pins[-1]
        start = min(start, was - _least_room(now - was))
        end = max(end, then_was + _least_room(then_was - then_now))
    return replace(edit, start=start, end=end)


def _least_room(later: float) -> float:
    """Seconds of the take before a pin that make up for it; after a pin, for the opposite."""
    return later / (1 / SLOWEST - 1) if later > 0 else -later / (1 - 1 / FASTEST)


def _still(clip: Clip, after: float, difference: float, least: float) -> Range | None:
    """The first stretch soon after a time in which the face stands still for long enough.

    Args:
        difference: seconds to make up for.
        least: seconds that the stretch must last.
    """
    times = clip.times
    near = slice(*np.searchsorted(times, (after - _AROUND, after + _AROUND)).tolist())
    if near.stop - near.start < 3:
        return None
    speeds = np.abs(np.diff(clip.weights[near], axis=0)).sum(axis=1) / np.diff(times[near])
    still = speeds < _STILL * float(np.percentile(speeds, 90))
    edges = np.flatnonzero(np.diff(np.concatenate([[False], still, [False]]).astype(np.int8)))
    for begin, end in edges.reshape(-1, 2).tolist():
        start, stop = float(max(times[near][begin], after)), float(times[near][end])
        if start - after > max(_NEAR, _NEAR_TIMES * difference):
            break
        if stop - start >= least:
            return start, stop
    return None


def by_pins(
    clip: Clip,
    pins: Sequence[tuple[float, float]],
    start: float | None = None,
    end: float | None = None,
) -> Edit:
    """A retime with any pins.

    Args:
        pins: (was, is) seconds, in order of time.
        start, end: the range; None = as far beyond the pins as it takes.

    Raises:
        FaceEditError: the pins cross, or lie outside the range or the take.
    """
    start, end = number_or_none("start", start), number_or_none("end", end)
    try:
        pins = tuple((number("pin", was), number("pin", now)) for was, now in pins)
    except (TypeError, ValueError):  # not pairs
        raise FaceEditError("pins must be pairs of seconds, such as [(1.2, 1.4)]") from None
    if not pins:
        raise FaceEditError("A retime needs pins: pairs of seconds, as they were and as they are")
    first, last = float(clip.times[0]), float(clip.times[-1])
    (was, now), (then_was, then_now) = pins[0], pins[-1]
    if start is None:
        start = max(min(was, now) - padded(now - was), first)
    if end is None:
        end = min(max(then_was, then_now) + padded(then_now - then_was), last)
    for pin in pins:
        if not all(first - _SMALLEST <= second <= last + _SMALLEST for second in pin):
            raise FaceEditError(
                f"The pin {pin[0]:g} → {pin[1]:g} s is outside the take: "
                f"it lasts from {first:g} to {last:g} s"
            )
    try:
        return _edit(start, end, tuple(pins))
    except ValueError as error:
        raise FaceEditError(f"The take cannot be retimed: {error}") from error


def _edit(start: float, end: float, pins: tuple[tuple[float, float], ...]) -> Edit:
    rounded = tuple((round(was, _DIGITS), round(now, _DIGITS)) for was, now in pins)
    return Edit(
        CONTROL_IDS, Op.RETIME, round(start, _DIGITS), round(end, _DIGITS), 0.0, pins=rounded
    )
