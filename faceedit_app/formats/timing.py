"""From the moments of a file's rows to a frame rate, even times and the gaps between frames."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from faceedit_app.core.arrays import Bools, Indices, Times
from faceedit_app.core.clip import Gap
from faceedit_app.core.errors import FileError

DEFAULT_RATE = 60.0
COMMON_RATES = (24.0, 25.0, 30000 / 1001, 30.0, 48.0, 50.0, 60000 / 1001, 60.0, 90.0, 120.0)
SLOWEST, FASTEST = 1.2, 1000.0  # frames per second; beyond, the times cannot be real
_RATES = (10, 12, 15, 20, 24, 25, 30, 48, 50, 60, 90, 100, 120, 240)
_BROADCAST_RATES = tuple(rate * 1000 / 1001 for rate in (24, 30, 48, 60, 120))
# 29.97 and 30 are 0.1 % apart: a slower rate is believed only where it is clearly the nearer.
_BROADCAST_TOLERANCE = 0.0003
_ROUNDED = 0.0045  # how far from it a broadcast rate is written with two decimals
# Cameras drift from what they promise; Live Link Face at "60" was measured to run at 59.9.
_DRIFT = 0.005
_GAP = 1.5  # steps, in frames, from which on a frame must be missing
_BREAK = 3  # frames from which on a step may begin on another beat
_FEW = 4  # frames up to which a step still measures the rate
_LONGEST_GAP = 3600.0  # seconds; what is farther apart is two recordings in one file
_COARSE = 0.1  # share of a frame by which rows are moved before it is worth a remark
_INERTIA = 0.2  # how far the beat of coarse times follows each of them
_UNUSABLE = 0.05  # share of rows out of order from which on no single row is to blame


class RateNeeded(FileError):
    """A take whose frame rate only the user can know: open it again with one.

    Args:
        path: the file.
        problem: why its times are of no use.
        rate: the likely frame rate.
        frames: how many frames the take has; at `rate` it lasts `frames / rate` seconds.
    """

    def __init__(self, path: Path | str, problem: str, rate: float, frames: int):
        self.rate, self.frames = rate, frames
        number = format_rate(rate).removesuffix(" fps")
        super().__init__(path, problem, f"give its frame rate, such as --fps {number}")


class NoTimes(ValueError):
    """Times that cannot be real, or are not there.

    Args:
        problem: what is wrong with them, as a phrase about the file.
        rate: the likely frame rate.
        numbers: (T,) numbers of the frames, increasing, where the file has those.
    """

    def __init__(self, problem: str, rate: float = DEFAULT_RATE, numbers: Times | None = None):
        super().__init__(problem)
        self.problem, self.rate, self.numbers = problem, rate, numbers

    def timing_at(self, rate: float, rows: Indices) -> Timing:
        """The frames at a rate that the user gave.

        Args:
            rows: (T,) which rows of the file they are.
        """
        numbers = rows.astype(np.float64) if self.numbers is None else self.numbers
        steps, notes = join_recordings(np.diff(numbers), 1.0, 1 / rate)
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
    """When rows happen.

    Attributes:
        times: (T,) seconds from the first row, strictly increasing.
        rate: nominal rows per second.
        notes: remarks on what was derived or mistrusted.
    """

    times: Times
    rate: float
    notes: tuple[str, ...] = ()


def time_rows(seconds: Times, resolution: float | None = None) -> Timing:
    """Rows from their own times.

    Times that are rounded to steps of the clock become even where rounding alone explains their
    unevenness. Times that are farther apart than an hour are taken for two recordings.

    Args:
        seconds: (T,) T >= 1.
        resolution: how finely the times are given, in seconds; None = find out.

    Raises:
        NoTimes: they cannot be real.
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
    repeats = _check_order(steps)
    frames, period, uncertainty = _count_frames(seconds, steps, resolution, repeats)
    if not SLOWEST <= 1 / period <= FASTEST:
        raise NoTimes(f"has times that step by {period:g} s")
    rate = nominal_rate(1 / period, uncertainty)
    slack = 1.01 * resolution + noise
    even = None
    if rate is not None:
        even = _even(seconds, frames, 1 / rate, slack)
    if even is None:
        even = _even(seconds, frames, period, slack)
    if even is None and repeats:
        raise NoTimes("has times that do not run forward")
    if rate is None:
        rate = 1 / period
        notes = (*notes, unusual_rate(rate))
    if even is not None and np.abs(seconds - even).max() > _COARSE * period:
        note = f"times are rounded to {resolution:g} s: rows are evenly spaced at"
        notes = (*notes, f"{note} {format_rate(rate)}")
    times = seconds if even is None else even
    return Timing(times - times[0], rate, notes)


def single_row() -> Timing:
    """A take of one frame."""
    note = f"a single frame: {format_rate(DEFAULT_RATE)} is assumed"
    return Timing(np.zeros(1), DEFAULT_RATE, (note,))


def unusual_rate(rate: float) -> str:
    """The remark on a rate that no camera promises."""
    return f"{format_rate(rate)} is not a usual frame rate"


def join_recordings(steps: Times, usual: float, unit: float) -> tuple[Times, tuple[str, ...]]:
    """Steps (N,) without those of hours, and a remark on them; `usual` takes their place.

    Args:
        unit: seconds that a step of 1 lasts.
    """
    apart = np.abs(steps) * unit > _LONGEST_GAP
    if not apart.any():
        return steps, ()
    where = counted(int(apart.sum()), "time")
    note = f"the times jump by more than an hour {where}: the rows follow one another there"
    return np.where(apart, usual, steps), (note,)


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
    """Whether times repeat because the clock is slower than the rows."""
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
    """How many frames each step (T - 1,) lasts, the seconds per frame, and its relative error.

    The period is a mean over runs of rows, in which all rounding errors but two cancel.
    """
    period = typical_step(steps)
    if repeats:
        # The clock is slower than the rows: count them between its first and its last change.
        frames = np.where(steps <= _FEW * period, 1.0, np.round(steps / period))
        ticks = np.flatnonzero(steps > 0)
        whole = slice(ticks[0] + 1, ticks[-1] + 1) if len(ticks) > 1 else slice(None)
        few = frames[whole] == 1
        period = float(steps[whole][few].mean())
        return frames, period, 1.0 / max(int(few.sum()), 1)
    for _ in range(4):
        if resolution > _COARSE * period:
            frames = _follow(seconds, period)
        else:
            frames = np.maximum(np.round(steps / period), 1.0)
        few = frames <= _FEW
        period = float(steps[few].sum() / frames[few].sum())
    return frames, period, resolution / float(seconds[-1] - seconds[0])


def _follow(seconds: Times, period: float) -> Times:
    """How many frames lie from row to row (T - 1,), by following the beat of coarse times.

    A step that was rounded up and the next that was rounded down are two frames, not three.
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
    """The even times of which `seconds` are roundings, or None if they are not.

    Rows between two breaks are on one beat; across a break the clock may have gone on by any time.

    Args:
        frames: (T - 1,) from row to row.
        slack: how far apart two roundings of the same time can be, in seconds.
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
    """How finely the times are given, in seconds."""
    for decimals in range(9):
        scaled = seconds * 10.0**decimals
        slack = min(max(1e-4, noise * 10.0**decimals), 0.05)
        if np.allclose(scaled, np.round(scaled), rtol=0, atol=slack):
            return float(10.0**-decimals)
    return 0.0


def nominal_rate(measured: float, uncertainty: float) -> float | None:
    """The standard rate that a measured one stands for, or None.

    Args:
        measured: frames per second.
        uncertainty: relative error of the measurement, from how finely the file tells time.
    """
    if uncertainty <= _BROADCAST_TOLERANCE:
        for rate in _BROADCAST_RATES:
            if abs(measured / rate - 1) <= _BROADCAST_TOLERANCE:
                return rate
    nearest = min(_RATES, key=lambda rate: abs(measured / rate - 1))
    if abs(measured / nearest - 1) <= max(_DRIFT, min(uncertainty, 0.05)):
        return float(nearest)
    return None


def exact_rate(rate: float) -> float:
    """The broadcast rate that a rounded one stands for (23.976, 29.97, 59.94), else the rate."""
    return next((exact for exact in _BROADCAST_RATES if abs(rate - exact) < _ROUNDED), rate)


def typical_step(steps: Times) -> float:
    """The mean of the steps that are about one frame, so that neither gaps nor jitter count.

    Args:
        steps: (N,) from row to row in any unit, at least one of them above 0.
    """
    median = float(np.median(steps[steps > 0]))
    usual = steps[(steps > median / _GAP) & (steps < median * _GAP)]
    return float(usual.mean()) if len(usual) else median


def find_gaps(times: Times, rate: float) -> tuple[Gap, ...]:
    """Where at least one frame is missing.

    Args:
        times: (T,) seconds, increasing.
        rate: frames per second.
    """
    steps = np.diff(times) * rate
    where = np.flatnonzero(steps >= _GAP)
    return tuple(Gap(int(i), max(1, round(float(steps[i])) - 1)) for i in where)


def gap_notes(gaps: tuple[Gap, ...]) -> tuple[str, ...]:
    """One remark that says how many gaps there are and how long, or none."""
    if not gaps:
        return ()
    missing = sum(gap.missing for gap in gaps)
    return (f"{counted(len(gaps), 'gap')}, {counted(missing, 'frame')} missing",)


def lost_notes(lost: Bools) -> tuple[str, ...]:
    """One remark that counts the rows that have no face, given for each row (R,), or none."""
    if not lost.any():
        return ()
    places = int((lost & ~np.concatenate([[False], lost[:-1]])).sum())
    what, where = counted(int(lost.sum()), "row"), counted(places, "place")
    return (f"the face was lost in {what} at {where}: no frames there, the rows are kept",)


def counted(number: int, noun: str) -> str:
    """`1 frame`, `2 frames`."""
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


def format_rate(rate: float) -> str:
    """`60 fps`, `29.97 fps`."""
    return f"{rate:.3f}".rstrip("0").rstrip(".") + " fps"


def format_time(seconds: float) -> str:
    """`0:04.533`, `2:14.330`, `1:00:00.000`."""
    thousandths = round(seconds * 1000)
    minutes, rest = divmod(thousandths, 60_000)
    tail = f"{rest // 1000:02d}.{rest % 1000:03d}"
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{tail}" if hours else f"{minutes}:{tail}"
