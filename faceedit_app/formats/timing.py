"""From the times of a file's rows to a frame rate and even times."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

import numpy as np

from faceedit_app.core.arrays import Indices, Times
from faceedit_app.core.errors import FileError
from faceedit_app.formats.changing_rates import (
    evened_stretches,
    stretches,
    usual_rate,
)
from faceedit_app.formats.rates import nominal_rate, unsure
from faceedit_app.formats.uneven import evened, is_uneven, mean_rate

DEFAULT_RATE = 60.0
SLOWEST, FASTEST = 1.2, 1000.0  # frames per second; other rates are impossible
_USUAL = 0.5  # share of the usual step by which others of about one frame differ
_BREAK = 3  # after a step of this many frames the phase may be another
_SHORT = 8  # steps; fewer do not show which is the usual one
_OFF = 0.05  # share of a step by which its multiples may be off
_MOST_LOST = 60  # steps that lost frames may make, in a take of a few rows
_FEWEST_TICKS = 2  # changes of a clock that is slower than the rows
_FEW = 4  # steps of at most this many frames measure the rate
_LONGEST_GAP = 3600.0  # seconds; rows farther apart are two recordings in one file
_HOUR, _HOUR_OFF = 3600.0, 2.0  # seconds that a clock is set back at the end of summer, and a row
_COARSE = 0.1  # share of a frame; rows that move farther get a note
_INERTIA = 0.2  # how far the phase follows each coarse time
_UNUSABLE = 0.05  # share of rows out of order from which on all times are unusable


class RateNeeded(FileError):
    """A take whose frame rate the user must give.

    Args:
        path: the file.
        problem: why its times are unusable.
        rate: the likely frame rate.
        frames: the number of frames, with those that were lost between them; at `rate` the take
            lasts `frames / rate` seconds.
    """

    def __init__(self, path: Path | str, problem: str, rate: float, frames: int):
        self.rate, self.frames = rate, frames
        number = format_rate(rate).removesuffix(" fps")
        remedy = "give its frame rate"
        super().__init__(path, problem, remedy, command_remedy=f"{remedy}, such as --fps {number}")


class NoTimes(ValueError):
    """Times that are impossible or missing.

    Args:
        problem: what is wrong with them, as a phrase about the file.
        rate: the likely frame rate.
        numbers: (T,) frame numbers, increasing, if the file has them; in usual steps, so that
            those of rows that follow one another differ by about 1.
        step: the usual step of the file's own frame numbers.
    """

    def __init__(
        self,
        problem: str,
        rate: float = DEFAULT_RATE,
        numbers: Times | None = None,
        step: float = 1.0,
    ):
        super().__init__(problem)
        self.problem, self.rate, self.numbers = problem, rate, numbers
        self.step = 1.0 if numbers is None else step

    def timing_at(self, rate: float, rows: Indices) -> Timing:
        """The times of the frames at a rate that the user gave, which is that of the rows.

        Args:
            rows: (T,) the rows of the frames in the file.
        """
        numbers = rows.astype(np.float64) if self.numbers is None else self.numbers
        steps, notes = join_recordings(np.diff(numbers), 1.0, 1 / rate)
        if self.step != 1:
            by = f"its frame numbers step by {shown_step(self.step)}"
            notes = (f"{by}: {format_rate(rate)} is the rate of its rows", *notes)
        return Timing(np.concatenate([[0.0], np.cumsum(steps)]) / rate, rate, notes)


class BadRow(ValueError):
    """A row that does not come after the one before it.

    Args:
        row: its index.
    """

    def __init__(self, row: int):
        super().__init__(row)
        self.row = row


@dataclass(frozen=True)
class Timing:
    """The times of rows.

    Attributes:
        times: (T,) seconds from the first row, strictly increasing.
        rate: nominal rows per second.
        notes: what was derived or corrected.
    """

    times: Times
    rate: float
    notes: tuple[str, ...] = ()


def time_rows(seconds: Times, resolution: float | None = None) -> Timing:
    """The timing of rows with times.

    Times rounded to the steps of a clock become even if rounding alone explains their unevenness.
    Rows more than an hour apart are treated as two recordings.

    Args:
        seconds: (T,) T >= 1.
        resolution: of the times, in seconds; None = find out.

    Raises:
        NoTimes: they are impossible.
        BadRow: one row, or a few, is out of order.
    """
    if len(seconds) == 1:
        return single_row()
    noise = 8 * float(np.spacing(np.abs(seconds).max()))
    if resolution is None:
        resolution = _resolution(seconds, noise)
    seconds, notes = _joined(seconds)
    steps = np.diff(seconds)
    if not np.any(steps > 0):
        raise NoTimes("has the same time in every row")
    together = np.any(steps == 0) and not np.any(steps < 0)
    if together and is_uneven(steps[steps > 0], typical_step(steps)) and (came := evened(steps)):
        return _uneven(*came, notes)
    repeats = _check_order(steps)
    found = [] if repeats else stretches(seconds) or stretches(seconds, resolution)
    if found:
        times = evened_stretches(seconds, found, 1.01 * resolution + noise)
        return Timing(times - times[0], usual_rate(found), notes)
    frames, period, uncertainty = _count_frames(seconds, steps, resolution, repeats)
    if not SLOWEST <= 1 / period <= FASTEST:
        raise NoTimes(f"has times that step by {period:g} s")
    rate = nominal_rate(1 / period, uncertainty)
    slack = 1.01 * resolution + noise
    if len(steps) < _SHORT and resolution > _COARSE * period and np.ptp(steps) > slack:
        note = "these few rounded times leave the frame rate open"
        notes = (*notes, unsure(f"{note}: {format_rate(rate or 1 / period)} is assumed"))
    even = None
    if rate is not None:
        even = _even(seconds, frames, 1 / rate, slack)
    if even is None:
        even = _even(seconds, frames, period, slack)
    if even is None and repeats:
        raise NoTimes("has times that do not run forward")
    if even is None and is_uneven(steps, period) and (came := evened(steps)):
        return _uneven(*came, notes)
    if rate is None:
        rate = 1 / period
        notes = (*notes, unusual_rate(rate))
    if even is not None and np.abs(seconds - even).max() > _COARSE * period:
        note = f"times are rounded to {resolution:g} s: rows are evenly spaced at"
        notes = (*notes, f"{note} {format_rate(rate)}")
    times = seconds if even is None else even
    return Timing(times - times[0], rate, notes)


def _uneven(times: Times, rate: float, notes: tuple[str, ...]) -> Timing:
    note = unsure(f"times come unevenly: rows are evenly spaced at {format_rate(rate)}")
    return Timing(times, rate, (*notes, note))


def of_pictures(
    timing: Timing | NoTimes, rows: Indices, known: tuple[str, ...] = ()
) -> Timing | NoTimes:
    """The timing of a film's pictures, which may have been taken unevenly.

    Args:
        rows: (T,) the rows of the frames in the file, which has one for each picture.
        known: notes that are needless, because FaceEdit wrote the file.
    """
    if isinstance(timing, NoTimes):
        return timing
    timing = replace(timing, notes=tuple(note for note in timing.notes if note not in known))
    rate = None if stretches(timing.times) else mean_rate(timing.times, rows)
    if rate is None:
        return timing
    notes = tuple(note for note in timing.notes if format_rate(timing.rate) not in note)
    note = f"the film's pictures come unevenly: {format_rate(rate)} on average"
    return Timing(timing.times, rate, (*notes, note))


def single_row() -> Timing:
    """A take of one frame."""
    note = f"a single frame: {format_rate(DEFAULT_RATE)} is assumed"
    return Timing(np.zeros(1), DEFAULT_RATE, (note,))


def unusual_rate(rate: float) -> str:
    """The note about a rate that is not a camera's nominal rate."""
    return unsure(f"{format_rate(rate)} by its times, which is not a usual frame rate")


def join_recordings(steps: Times, usual: float, unit: float) -> tuple[Times, tuple[str, ...]]:
    """Replace steps (N,) of more than an hour by `usual`, with a note about them.

    Args:
        unit: the seconds in a step of 1.
    """
    apart = np.abs(steps) * unit > _LONGEST_GAP
    if not apart.any():
        return steps, ()
    where = counted(int(apart.sum()), "time")
    note = f"the times jump by more than an hour {where}: the rows follow one another there"
    return np.where(apart, usual, steps), (note,)


def set_back(seconds: Times) -> tuple[Times, tuple[str, ...]]:
    """Undo that a local clock was set back by an hour, with a note about it.

    Args:
        seconds: (T,) of a clock on a wall.
    """
    steps = np.diff(seconds)
    back = np.abs(steps + _HOUR) < _HOUR_OFF
    if back.sum() != 1:
        return seconds, ()
    note = "the clock goes back by an hour: the rows follow one another there"
    return seconds + np.concatenate([[0.0], np.cumsum(np.where(back, _HOUR, 0.0))]), (note,)


def _joined(seconds: Times) -> tuple[Times, tuple[str, ...]]:
    steps = np.diff(seconds)
    usual = float(np.median(steps[steps > 0])) if np.any(steps > 0) else 0.0
    if usual * SLOWEST > 1:  # all are far apart
        return seconds - seconds[0], ()
    steps, notes = join_recordings(steps, usual, 1.0)
    if not notes:
        return seconds - seconds[0], ()
    return np.concatenate([[0.0], np.cumsum(steps)]), notes


def _check_order(steps: Times) -> bool:
    """Whether times repeat, because the clock is slower than the rows."""
    wrong = steps <= 0
    if not wrong.any():
        return False
    if wrong.sum() == 1 or wrong.mean() < _UNUSABLE:
        raise BadRow(int(np.argmax(wrong)) + 1)
    if np.any(steps < 0):
        raise NoTimes("has times that do not run forward")
    return True


def _count_frames(
    seconds: Times, steps: Times, resolution: float, repeats: bool
) -> tuple[Times, float, float]:
    """The frames in each step (T - 1,), the seconds per frame, and their relative error.

    The period is a mean over runs of rows, in which all but two rounding errors cancel.
    """
    period = typical_step(steps)
    if repeats:
        # The clock is slower than the rows: count the rows between its first and last change.
        frames = np.where(steps <= _FEW * period, 1.0, np.round(steps / period))
        ticks = np.flatnonzero(steps > 0)
        if len(ticks) < _FEWEST_TICKS:
            raise NoTimes("has times that are too coarse to show its frame rate")
        whole = slice(ticks[0] + 1, ticks[-1] + 1) if len(ticks) > 1 else slice(None)
        few = frames[whole] == 1
        period = float(steps[whole][few].mean())
        return frames, period, 1.0 / max(int(few.sum()), 1)
    if len(steps) < _SHORT:
        period = _common_step(steps, period, resolution)
    elif resolution > _COARSE * period:
        # Rounded to hundredths, 90 frames a second step by 0.01 s, and now and then by 0.02 s.
        length, ones = float(seconds[-1] - seconds[0]), np.ones(len(steps))
        rate = nominal_rate(len(steps) / length, resolution / length)
        if rate and _even(seconds, ones, 1 / rate, 1.01 * resolution) is not None:
            return ones, length / len(steps), resolution / length
    for _ in range(4):
        if resolution > _COARSE * period:
            frames = _follow(seconds, period)
        else:
            frames = np.maximum(np.round(steps / period), 1.0)
        few = frames <= _FEW
        period = float(steps[few].sum() / frames[few].sum())
    return frames, period, resolution / float(seconds[-1] - seconds[0])


def _common_step(steps: Times, period: float, resolution: float) -> float:
    """The smallest step of a few rows if it divides all of them, else `period`.

    Among few rows, the step that is most frequent may have lost a frame.
    """
    least = float(steps.min())
    counts = np.round(steps / least)
    off = np.abs(steps - counts * least)
    fits = counts.max() <= _MOST_LOST and np.all(off <= counts * max(resolution, _OFF * least))
    if not fits or 2 * resolution > least:
        return period
    found = float(steps.sum() / counts.sum())
    return found if nominal_rate(1 / found, resolution / float(steps.sum())) else period


def _follow(seconds: Times, period: float) -> Times:
    """The frames from row to row (T - 1,), by following the phase of coarse times.

    A step that was rounded up and one that was rounded down are two frames, not three.
    """
    frames = np.empty(len(seconds) - 1)
    beat = float(seconds[0])
    for row, time in enumerate(seconds[1:].tolist()):
        count = max(round((time - beat) / period), 1)
        beat += count * period
        beat += _INERTIA * (time - beat)
        frames[row] = count
    return frames


def _even(seconds: Times, frames: Times, period: float, slack: float) -> Times | None:
    """The even times that were rounded to `seconds`, or None if there are none.

    Rows between two breaks share one phase; across a break the phase may change.

    Args:
        frames: (T - 1,) from row to row.
        slack: the largest difference of two roundings of the same time, in seconds.
    """
    numbers = np.concatenate([[0.0], np.cumsum(frames)])
    even = numbers * period
    late = seconds - even
    for part in _unbroken(frames):
        if np.ptp(late[part]) > slack:
            return None
        even[part] += (late[part].max() + late[part].min()) / 2
    return even if np.all(np.diff(even) > 0) else None


def _unbroken(frames: Times) -> Iterator[slice]:
    ends = np.flatnonzero(frames >= _BREAK) + 1
    edges = [0, *ends.tolist(), len(frames) + 1]
    return (slice(a, b) for a, b in pairwise(edges))


def _resolution(seconds: Times, noise: float) -> float:
    """The resolution of times, in seconds."""
    for decimals in range(9):
        scaled = seconds * 10.0**decimals
        slack = min(max(1e-4, noise * 10.0**decimals), 0.05)
        if np.allclose(scaled, np.round(scaled), rtol=0, atol=slack):
            return float(10.0**-decimals)
    return 0.0


def typical_step(steps: Times) -> float:
    """The mean of the steps of about one frame, without gaps and jitter.

    Args:
        steps: (N,) from row to row in any unit, at least one of them above 0.
    """
    median = float(np.median(steps[steps > 0]))
    # As far below as above, or jitter would make the mean too large.
    usual = steps[np.abs(steps - median) < _USUAL * median]
    return float(usual.mean()) if len(usual) else median


def counted(number: int, noun: str) -> str:
    """`1 frame`, `2 frames`."""
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


def shown_step(step: float) -> str:
    """`2`, `about 2.37`: how many frames it is from row to row."""
    return f"{step:.0f}" if step == round(step) else f"about {step:.3g}"


def format_rate(rate: float) -> str:
    """`60 fps`, `29.97 fps`."""
    return f"{rate:.3f}".rstrip("0").rstrip(".") + " fps"


def format_time(seconds: float) -> str:
    """`0:04.533`, `2:14.330`, `1:00:00.000`."""
    thousandths = round(1000 * round(seconds, 3))  # as `.3f` rounds halves elsewhere
    minutes, rest = divmod(thousandths, 60_000)
    tail = f"{rest // 1000:02d}.{rest % 1000:03d}"
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{tail}" if hours else f"{minutes}:{tail}"
