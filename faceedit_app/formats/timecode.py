"""Timecodes to seconds, as Live Link Face and its imitators write them.

This module parses the texts and derives the times of the rows; `timecode_readings.py` finds out
what the last fields mean.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from faceedit_app.core.arrays import Times
from faceedit_app.formats.rates import nominal_rate, unsure
from faceedit_app.formats.timecode_readings import (
    BASES,
    MILLISECONDS,
    Reading,
    Stamps,
    assumed_base,
    can_drop,
    count_frames,
    read_stamps,
)
from faceedit_app.formats.timing import (
    SLOWEST,
    NoTimes,
    Timing,
    counted,
    format_rate,
    join_recordings,
    set_back,
    single_row,
    time_rows,
    typical_step,
    unusual_rate,
)

_DAY, _HOUR = 86_400, 3600
_FRAMES = re.compile(
    r"(\d{1,2})[:;](\d{1,2})[:;](\d{1,2})([:;])(\d{1,3})(?:[.,](\d{1,9}))?", re.ASCII
)
_CLOCK = re.compile(  # pandas begins with the days
    r"(?:\d+ days? \+?)?(\d{1,2}):(\d{1,2}):(\d{1,2})(?:[.,](\d{1,9}))?", re.ASCII
)
_SHORT_CLOCK = re.compile(r"\d{1,2}:\d{1,2}[.,]\d{1,9}", re.ASCII)  # minutes and seconds
_HUNDREDTHS = re.compile(r"(.*)[.,](\d\d)")
_MOST_FRAMES = 60  # a second; hundredths of a second go on to 99
_FEWEST_ROWS = 12  # in a second that shows how far they go
# An odd step of at least this many frames is a break in the recording, not jitter.
_BREAK = 4.0
# Share of steps that must be off the grid of whole frames before the timecode is mistrusted.
_JITTER = 0.1
_DISORDER = 0.2  # share of rows out of order from which on the times are unusable
_UNEVEN = 0.05  # relative uncertainty of a rate from uneven steps
_NUDGE = 0.1  # frames between rows with the same timecode
_OFF = 0.25  # frames by which a step is off the ordinary one


class BadTimecode(ValueError):
    """A text that is not a timecode.

    Args:
        row: the index of the first such text.
        text: the text.
    """

    def __init__(self, row: int, text: str):
        super().__init__(text)
        self.row, self.text = row, text


def is_timecode(text: str) -> bool:
    """Whether a text is `HH:MM:SS:FF`, with or without a fraction."""
    return _FRAMES.fullmatch(text) is not None


def is_clock(text: str) -> bool:
    """Whether a text is `HH:MM:SS`, `HH:MM:SS.mmm` or `MM:SS.mmm`."""
    return _CLOCK.fullmatch(text) is not None or _SHORT_CLOCK.fullmatch(text) is not None


def parse_timecodes(texts: Sequence[str]) -> Stamps:
    """Parse timecodes.

    Raises:
        BadTimecode: a text is not a timecode.
    """
    rows: list[tuple[int, int, int, int]] = []
    width, drop = 9, False
    for row, text in enumerate(texts):
        match = _FRAMES.fullmatch(text)
        if match is None:
            raise BadTimecode(row, text)
        fraction = match[6] or ""
        rows.append((_clock(match, row), int(match[5]), int(fraction or 0), len(fraction)))
        width = min(width, len(match[5]))
        drop = drop or match[4] == ";"
    clock, last, part, digits = np.array(rows, np.float64).T
    return Stamps(_unwrapped(clock, _DAY), last, part, digits, width, drop)


def clock_times(texts: Sequence[str]) -> Timing:
    """The times of rows with clock times (`HH:MM:SS.mmm`, or `HH:MM:SS.FF` with frames).

    Raises:
        BadTimecode: a text is not one.
        NoTimes, BadRow: see `timing.time_rows`.
    """
    if _counts_frames(texts):
        return derive_timing([_HUNDREDTHS.sub(r"\1:\2", text) for text in texts])
    clock, part = np.empty(len(texts)), np.zeros(len(texts))
    digits, short = 0, True  # minutes and seconds alone begin again after an hour
    for row, text in enumerate(texts):
        long = f"0:{text}" if _SHORT_CLOCK.fullmatch(text) else text
        match = _CLOCK.fullmatch(long)
        if match is None:
            raise BadTimecode(row, text)
        clock[row] = _clock(match, row)
        short = short and long != text
        part[row] = float(f"0.{match[4] or 0}")
        digits = max(digits, len(match[4] or ""))
    seconds, notes = set_back(_unwrapped(clock, _HOUR if short else _DAY) + part)
    timing = time_rows(seconds, 10.0**-digits)
    return Timing(timing.times, timing.rate, notes + timing.notes)


def _counts_frames(texts: Sequence[str]) -> bool:
    """Whether the two digits after a point number the frames of a second."""
    most: dict[str, int] = {}
    rows: dict[str, int] = {}
    for text in texts:
        match = _HUNDREDTHS.fullmatch(text)
        if match is None or text.count(":") != 2:
            return False
        most[match[1]] = max(most.get(match[1], 0), int(match[2]))
        rows[match[1]] = rows.get(match[1], 0) + 1
    full = [most[second] for second, count in rows.items() if count >= _FEWEST_ROWS]
    return len(rows) > 1 and bool(full) and max(most.values()) < _MOST_FRAMES


def derive_timing(texts: Sequence[str]) -> Timing:
    """The times of rows with timecodes; the notes say what is uncertain.

    Args:
        texts: T >= 1 timecodes, one per row.

    Raises:
        BadTimecode: a text is not one.
        NoTimes: they cannot be the times of the rows.
    """
    stamps = parse_timecodes(texts)
    if len(texts) == 1:
        return single_row()
    reading = read_stamps(stamps)
    steps = np.diff(reading.places)
    if not np.any(steps > 0):
        raise NoTimes("has the same timecode in every row")
    if (steps < 0).mean() > _DISORDER:
        raise NoTimes("has timecodes that do not run forward")
    step = typical_step(steps)
    if reading.second / step < SLOWEST:
        raise NoTimes(f"has timecodes that step by {step / reading.second:g} s")
    steps, apart = join_recordings(steps, step, 1 / reading.second)
    if reading.base == MILLISECONDS and np.all(steps > 0):
        timing = time_rows(np.concatenate([[0.0], np.cumsum(steps)]) / reading.second, 0.001)
    else:
        timing = _time_rows(steps, reading)
    notes = reading.notes + apart
    if abs(timing.rate / reading.base - 1) > 0.01 and reading.base in BASES:
        notes = (*notes, _slower(timing.rate, reading.base))
    return Timing(timing.times, timing.rate, notes + timing.notes)


def time_of_day(text: str, base: int) -> float | None:
    """Seconds since midnight of a timecode with `base` frames a second; None if it is invalid."""
    try:
        stamps = parse_timecodes([text])
    except BadTimecode:
        return None
    drop = stamps.drop and can_drop(base)
    second = base / 1.001 if drop else float(base)
    return float(count_frames(stamps, base, drop)[0]) / second


def start_of_day(texts: Sequence[str]) -> float:
    """Seconds since midnight of the first of T >= 1 timecodes, as all of them are read.

    Raises:
        BadTimecode: a text is not one.
    """
    stamps = parse_timecodes(texts)
    if len(texts) == 1:
        return time_of_day(texts[0], assumed_base(stamps)) or 0.0
    return read_stamps(stamps).begin


def write_timecode(seconds: float, base: int) -> str:
    """`HH:MM:SS:FF.sss` of a time of day, with `base` frames in a second."""
    thousandths = round(seconds * base * 1000)
    whole, part = divmod(thousandths, base * 1000)
    frames, fraction = divmod(part, 1000)
    minutes, second = divmod(whole, 60)
    hours, minute = divmod(minutes, 60)
    return f"{hours % 24:02d}:{minute:02d}:{second:02d}:{frames:02d}.{fraction:03d}"


def derive_base(stamps: Stamps) -> tuple[int, tuple[str, ...]]:
    """The base of timecodes, in frames a second, with a note if it is a guess."""
    if len(stamps.clock) == 1:
        return assumed_base(stamps), ()
    reading = read_stamps(stamps)
    return reading.base, reading.notes


def _clock(match: re.Match[str], row: int) -> int:
    hours, minutes, seconds = int(match[1]), int(match[2]), int(match[3])
    if minutes > 59 or seconds > 59:  # some tools count on past midnight
        raise BadTimecode(row, match[0])
    return (hours * 60 + minutes) * 60 + seconds


def _unwrapped(clock: Times, period: int) -> Times:
    """(T,) seconds since the first midnight or hour; each step goes the shorter way round."""
    steps = (np.diff(clock) + period // 2) % period - period // 2
    unwrapped: Times = np.concatenate([clock[:1], clock[0] + np.cumsum(steps)])
    return unwrapped


# --- rows ----------------------------------------------------------------------------------------


def _time_rows(steps: Times, reading: Reading) -> Timing:
    """Rows from the frames (T - 1,) between them."""
    second = reading.second
    step = typical_step(steps)
    whole = np.maximum(np.round(steps / step), 1)
    off_grid = np.abs(steps - whole * step) > _OFF * step
    backwards = steps <= 0
    whole_frames = np.allclose(steps, np.round(steps), rtol=0, atol=1e-4)
    coarse = whole_frames or backwards.mean() > _JITTER / 2
    if off_grid.mean() > _JITTER and coarse:
        return _uniform_rows(steps, step, second)
    rate, notes = _rate(second / step, reading.resolution / (step * len(steps)))
    broken = steps <= -_BREAK * step
    if np.any(broken):
        jumps = counted(int(broken.sum()), "time")
        notes = (*notes, f"the timecode jumps back {jumps}: the rows follow one another there")
    times = np.concatenate([[0.0], np.cumsum(np.where(broken, step, steps))]) / second
    repeated = int((backwards & ~broken).sum())
    if repeated:
        times = _strictly_increasing(times, _NUDGE * step / second)
        notes = (*notes, f"{counted(repeated, 'repeated timecode')}: placed just after the first")
    return Timing(times, rate, notes)


def _uniform_rows(steps: Times, step: float, second: float) -> Timing:
    """The times of evenly spaced rows, for a timecode written by a clock, not a camera."""
    breaks = steps >= _BREAK * step
    usual = steps[(steps > -_BREAK * step) & ~breaks]
    mean = float(usual.mean()) if usual.sum() > 0 else step
    rate, notes = _rate(second / mean, _UNEVEN)
    lengths = np.where(breaks, steps / second, 1 / rate)
    times = np.concatenate([[0.0], np.cumsum(lengths)])
    note = f"the timecode steps unevenly: rows are evenly spaced at {format_rate(rate)}"
    return Timing(times, rate, (*notes, unsure(note)))


def _slower(rate: float, base: int) -> str:
    """The note about rows that are fewer, or more, than the frames that their timecode counts."""
    counts = f"the timecode counts {base} frames a second, {base / rate:.3g} from row to row"
    camera = "slower" if rate < base else "faster"
    return unsure(f"{format_rate(rate)}: {counts}, as from a camera {camera} than its timecode")


def _rate(measured: float, uncertainty: float) -> tuple[float, tuple[str, ...]]:
    rate = nominal_rate(measured, uncertainty)
    if rate is not None:
        return rate, ()
    return measured, (unusual_rate(measured),)


def _strictly_increasing(times: Times, least: float) -> Times:
    out = times.copy()
    for i in range(1, len(out)):
        out[i] = max(out[i], out[i - 1] + least)
    return out
