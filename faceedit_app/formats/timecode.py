"""SMPTE-like timecodes, as Live Link Face writes them, to seconds.

`HH:MM:SS:FF.sss` counts frames `FF` and thousandths of a frame `sss` within a second. How many
frames make a second (the base) is written nowhere, and rows need not come once per frame of the
base: a 30 fps recording on a 60 fps timecode steps by two. Both are derived from the rows.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from faceedit_app.core.arrays import Times
from faceedit_app.formats.timing import (
    DEFAULT_RATE,
    counted,
    format_rate,
    nominal_rate,
    typical_step,
)

DEFAULT_BASE = 60  # what Live Link Face uses
_BASES = (24, 25, 30, 48, 50, 60, 72, 90, 100, 120, 240)
_DAY = 86_400
_PATTERN = re.compile(r"(\d{1,2})[:;](\d{1,2})[:;](\d{1,2})([:;])(\d{1,3}(?:\.\d{1,9})?)", re.ASCII)
# From how many frames on an odd step is a break in the recording and no jitter.
_BREAK = 4.0
# Share of steps that must be off the grid of whole frames before the timecode is mistrusted.
_JITTER = 0.1
_UNEVEN = 0.05  # how well uneven steps tell the rate
_NUDGE = 0.1  # frames between rows whose timecodes are the same


class BadTimecode(ValueError):
    """A text that is no timecode.

    Args:
        row: index of the first such text.
        text: the text.
    """

    def __init__(self, row: int, text: str):
        super().__init__(text)
        self.row, self.text = row, text


@dataclass(frozen=True)
class Timing:
    """When rows happen.

    Attributes:
        times: (T,) seconds from the first row, strictly increasing.
        rate: nominal rows per second.
        base: frames that the timecode counts in a second.
        notes: remarks on what was derived or mistrusted.
    """

    times: Times
    rate: float
    base: int
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Stamps:
    """Timecodes taken apart.

    Attributes:
        clock: (T,) seconds of the day.
        frames: (T,) frames within the second, with their fraction.
        drop: whether they are drop-frame (`;` before the frames).
    """

    clock: NDArray[np.int64]
    frames: Times
    drop: bool


def parse_timecodes(texts: Sequence[str]) -> Stamps:
    """Take timecodes apart.

    Raises:
        BadTimecode: one of them is none.
    """
    clock = np.empty(len(texts), np.int64)
    frames = np.empty(len(texts), np.float64)
    drop = False
    for row, text in enumerate(texts):
        match = _PATTERN.fullmatch(text)
        if match is None:
            raise BadTimecode(row, text)
        hours, minutes, seconds = int(match[1]), int(match[2]), int(match[3])
        if hours > 23 or minutes > 59 or seconds > 59:
            raise BadTimecode(row, text)
        clock[row] = (hours * 60 + minutes) * 60 + seconds
        frames[row] = float(match[5])
        drop = drop or match[4] == ";"
    return Stamps(clock, frames, drop)


def derive_timing(texts: Sequence[str]) -> Timing:
    """When rows with these timecodes happen; what is uncertain is said in the notes.

    Args:
        texts: T >= 1 timecodes, one per row.

    Raises:
        BadTimecode: one of them is none.
    """
    stamps = parse_timecodes(texts)
    base, notes = derive_base(stamps)
    if len(texts) == 1:
        note = f"a single frame: {format_rate(DEFAULT_RATE)} is assumed"
        return Timing(np.zeros(1), DEFAULT_RATE, base, (note,))
    second = base / 1.001 if stamps.drop else float(base)
    steps = np.diff(_count_frames(stamps, base))
    # Drop-frame is itself the evidence for a broadcast rate, however short the take.
    resolution = 0.0 if stamps.drop else _resolution(stamps.frames)
    timing = _time_rows(steps, second, base, resolution)
    if abs(timing.rate / base - 1) > 0.01:
        notes = (*notes, f"{format_rate(timing.rate)} on a {base} fps timecode")
    return Timing(timing.times, timing.rate, base, notes + timing.notes)


def time_of_day(text: str, base: int) -> float | None:
    """Seconds since midnight of a timecode that counts `base` frames; None if it is none."""
    try:
        stamps = parse_timecodes([text])
    except BadTimecode:
        return None
    second = base / 1.001 if stamps.drop else float(base)
    return float(_count_frames(stamps, base)[0]) / second


def derive_base(stamps: Stamps) -> tuple[int, tuple[str, ...]]:
    """How many frames the timecode counts in a second, with a remark where that is a guess."""
    frames, seconds = stamps.frames, np.diff(stamps.clock)
    steps = np.diff(frames)
    inside = steps[(seconds == 0) & (steps > 0)]
    step = float(np.median(inside)) if len(inside) else 1.0
    at_least = int(frames.max()) + 1
    # Where the second rolls over, the frames fall by the base less one ordinary step; by less
    # where frames were lost just there, so the larger falls are to be believed.
    falls = step - steps[seconds == 1]
    if len(falls):
        fall = float(np.percentile(falls, 75, method="higher"))
        possible = [base for base in _BASES if base >= at_least] or [at_least]
        base = min(possible, key=lambda candidate: abs(candidate - fall))
        if abs(base - fall) <= 0.1 * fall:
            return base, ()
        if round(fall) >= at_least:
            return round(fall), ()
    base = next((b for b in _BASES if b >= max(at_least, DEFAULT_BASE)), at_least)
    return base, (f"the timecode does not tell its base: {base} fps is assumed",)


def _count_frames(stamps: Stamps, base: int) -> Times:
    """(T,) frames of the base since midnight of the first day."""
    # A clock that falls by more than half a day has passed midnight.
    days = np.concatenate([[0], np.cumsum(np.diff(stamps.clock) < -_DAY // 2)])
    clock = stamps.clock + _DAY * days
    counts: Times = clock * float(base) + stamps.frames
    if stamps.drop:
        # Drop-frame leaves out the first numbers (2 of 30) of each minute but every tenth.
        minutes = clock // 60
        counts -= max(1, round(base / 15)) * (minutes - minutes // 10)
    return counts


def _resolution(frames: Times) -> float:
    """How finely the timecode tells time, in frames."""
    return 1.0 if bool(np.all(frames == np.floor(frames))) else 0.001


def _time_rows(steps: Times, second: float, base: int, resolution: float) -> Timing:
    """Rows from the frames (T - 1,) between them, at `second` frames in a true second."""
    if not np.any(steps > 0):
        times = np.arange(len(steps) + 1) / DEFAULT_RATE
        note = f"the timecode stands still: rows are uniform at {format_rate(DEFAULT_RATE)}"
        return Timing(times, DEFAULT_RATE, base, (note,))
    step = typical_step(steps)
    whole = np.maximum(np.round(steps / step), 1)
    off_grid = np.abs(steps - whole * step) > 0.25 * step
    backwards = steps <= 0
    whole_frames = np.allclose(steps, np.round(steps), rtol=0, atol=1e-4)
    coarse = whole_frames or backwards.mean() > _JITTER / 2
    if off_grid.mean() > _JITTER and coarse:
        return _uniform_rows(steps, step, second, base)
    rate, notes = _rate(second / step, resolution / (step * len(steps)))
    broken = steps <= -_BREAK * step
    if np.any(broken):
        jumps = counted(int(broken.sum()), "time")
        notes = (*notes, f"the timecode jumps back {jumps}: the rows follow one another there")
    times = np.concatenate([[0.0], np.cumsum(np.where(broken, step, steps))]) / second
    repeated = int((backwards & ~broken).sum())
    if repeated:
        times = _strictly_increasing(times, _NUDGE * step / second)
        notes = (*notes, f"{counted(repeated, 'row')} repeat a timecode: moved just behind it")
    return Timing(times, rate, base, notes)


def _uniform_rows(steps: Times, step: float, second: float, base: int) -> Timing:
    """Rows of a timecode that was written by a clock, not a camera: evenly spaced."""
    breaks = steps >= _BREAK * step
    usual = steps[(steps > -_BREAK * step) & ~breaks]
    mean = float(usual.mean()) if usual.sum() > 0 else step
    rate, notes = _rate(second / mean, _UNEVEN)
    lengths = np.where(breaks, steps / second, 1 / rate)
    times = np.concatenate([[0.0], np.cumsum(lengths)])
    note = f"the timecode steps unevenly: rows are uniform at {format_rate(rate)}"
    return Timing(times, rate, base, (*notes, note))


def _rate(measured: float, uncertainty: float) -> tuple[float, tuple[str, ...]]:
    rate = nominal_rate(measured, uncertainty)
    if rate is not None:
        return rate, ()
    return measured, (f"{format_rate(measured)} is not a usual frame rate",)


def _strictly_increasing(times: Times, least: float) -> Times:
    out = times.copy()
    for i in range(1, len(out)):
        out[i] = max(out[i], out[i - 1] + least)
    return out
