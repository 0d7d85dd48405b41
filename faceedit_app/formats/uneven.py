"""Times that were noted when frames arrived, such as those of a network: uneven, though their
frames are not."""

from __future__ import annotations

import numpy as np

from faceedit_app.core.arrays import Indices, Times
from faceedit_app.formats.rates import RATES, nominal_rate

_FEWEST = 16  # steps that show it
_OFF = 0.08  # frames by which half of the steps are off whole ones
_UNCERTAIN = 0.005  # relative error of a rate from uneven steps
_BREAK = 0.25  # seconds that are a break in the recording, not a frame that came late
_BREAK_FRAMES = 8
_MOST_LOST = 0.85  # share of a rate's frames that must have come
_AROUND = 5  # frames before and after one that show how late it is
_LATE = 1.5  # steps after which a picture looks as if one were missing before it
_OFTEN = 0.1  # share of the pictures
_LATEST = 0.25  # seconds that a frame may come too late or too early


def is_uneven(steps: Times, period: float) -> bool:
    """Whether steps (N,) in seconds are no multiples of a period, not even roughly."""
    off = np.abs(steps / period - np.round(steps / period))
    return len(steps) >= _FEWEST and float(np.median(off)) > _OFF


def mean_rate(times: Times, rows: Indices) -> float | None:
    """The mean rate of pictures that a camera took now sooner, now later; None if it did not.

    Of a film in which a picture often comes half a step late or later, but no whole one, none is
    missing: the mean is its rate.

    Args:
        times: (T,) seconds, increasing.
        rows: (T,) of all pictures, also those without a face, the numbers of these.
    """
    steps = np.diff(times)[np.diff(rows) == 1]
    if len(steps) < _FEWEST:
        return None
    ratio = steps / np.median(steps)
    late = (ratio >= _LATE) & (np.abs(ratio - np.round(ratio)) > _OFF)
    if float(late.mean()) < _OFTEN:
        return None
    return float((rows[-1] - rows[0]) / (times[-1] - times[0]))


def evened(steps: Times) -> tuple[Times, float] | None:
    """The even times of frames that came unevenly, and their usual rate.

    If fewer frames came than any usual rate has, the next higher one is assumed; a frame was lost
    where those around it come later from then on.

    Args:
        steps: (N,) seconds from frame to frame.

    Returns:
        (N + 1,) seconds from the first frame, and frames per second; None if no rate fits.
    """
    breaks = steps >= max(_BREAK, _BREAK_FRAMES * float(np.median(steps)))
    if breaks.all():
        return None
    mean = float(steps[~breaks].mean())
    if mean <= 0:
        return None
    rate = nominal_rate(1 / mean, _UNCERTAIN)
    if rate is not None:
        frames = np.where(breaks, np.maximum(np.round(steps / mean), 1.0), 1.0)
        times = np.concatenate([[0.0], np.cumsum(frames * mean)])
    else:
        higher = (one for one in RATES if _MOST_LOST * one <= 1 / mean < one)
        rate = next(higher, None)
        if rate is None:
            return None
        times = _with_losses(steps, rate)
    late = np.concatenate([[0.0], np.cumsum(steps)]) - times
    return (times, float(rate)) if np.ptp(late) < _LATEST else None


def _with_losses(steps: Times, rate: float) -> Times:
    """The times of frames of which some are missing: how many, the frames around a place tell."""
    late = np.concatenate([[0.0], np.cumsum(steps)]) * rate - np.arange(len(steps) + 1)
    ends = np.pad(late, _AROUND, mode="edge")
    smooth = np.median(np.lib.stride_tricks.sliding_window_view(ends, 2 * _AROUND + 1), axis=1)
    phase = np.angle(np.mean(np.exp(2j * np.pi * smooth))) / (2 * np.pi)
    lost = np.maximum.accumulate(np.round(smooth - phase))
    numbers: Times = np.arange(len(late)) + lost - lost[0]
    return numbers / rate
