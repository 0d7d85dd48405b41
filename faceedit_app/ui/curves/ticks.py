"""The ticks of the axes: their positions and labels."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from faceedit_app.ui.curves.scale import Interval

Values = NDArray[np.floating]

# Seconds between labelled times, and between the marks in between.
_TIME_STEPS = {
    **{0.01: 0.002, 0.02: 0.005, 0.05: 0.01, 0.1: 0.02, 0.2: 0.05, 0.5: 0.1, 1.0: 0.2, 2.0: 0.5},
    **{5.0: 1.0, 10.0: 2.0, 15.0: 5.0, 30.0: 10.0, 60.0: 10.0, 120.0: 30.0, 300.0: 60.0},
    **{600.0: 120.0, 1800.0: 300.0, 3600.0: 600.0},
}


def nice_step(smallest: float) -> float:
    """The least of 1, 2, 5, 10, 20, ... (and 0.5, 0.2, ...) that is not below `smallest`."""
    power = 10.0 ** math.floor(math.log10(smallest))
    return next(m * power for m in (1.0, 2.0, 5.0, 10.0) if m * power >= smallest * (1 - 1e-9))


def time_steps(smallest: float) -> Interval:
    """Seconds between two labelled times, `smallest` or more, and between two marks."""
    step = next((step for step in _TIME_STEPS if step >= smallest), max(_TIME_STEPS))
    return step, _TIME_STEPS[step]


def time_label(seconds: float, step: float) -> str:
    """`2 s`, `2.50 s`, `1:05`: as many decimals as the step between labels needs."""
    decimals = 0 if step >= 1 else (1 if step >= 0.1 else 2)
    if seconds < 60 - 1e-9:
        return f"{seconds:.{decimals}f} s"
    minutes, rest = divmod(round(seconds, decimals), 60)
    width = 2 if decimals == 0 else 3 + decimals
    hours, minutes = divmod(int(minutes), 60)
    tail = f"{rest:0{width}.{decimals}f}"
    return f"{hours}:{minutes:02d}:{tail}" if hours else f"{minutes}:{tail}"


def frame_spacing(times: Values, view: Interval, width: float) -> float:
    """Pixels between two frames, on average over those in view; 0 if there are not two."""
    start, stop = _frames_in(times, view)
    if stop - start < 2:
        return 0.0
    seconds = float(times[stop - 1] - times[start]) / (stop - 1 - start)
    return seconds * width / (view[1] - view[0])


def frame_ticks(
    times: Values, view: Interval, width: float, spacing: float, closest: float
) -> tuple[list[int], list[int]]:
    """The numbered frames, and the marked ones between them.

    Frames count from 1, and the numbers are round: 10, 20, 30.

    Args:
        times: (T,) seconds of the frames.
        view: first and last visible second.
        width: pixels.
        spacing: least pixels between two numbers.
        closest: least pixels between two marks.
    """
    start, stop = _frames_in(times, view)
    pixels = frame_spacing(times, view, width)
    if pixels == 0.0:
        return list(range(start, stop)), []
    step = round(nice_step(max(spacing / pixels, 1.0)))
    parts = (1, step // 10, step // 5, step // 2)
    fine = next((n for n in parts if n and step % n == 0 and n * pixels >= closest), step)
    numbered, marked = (range(start + -(start + 1) % n, stop, n) for n in (step, fine))
    return list(numbered), [frame for frame in marked if (frame + 1) % step]


def _frames_in(times: Values, view: Interval) -> tuple[int, int]:
    """The first frame in view, and the one after the last."""
    return int(np.searchsorted(times, view[0])), int(np.searchsorted(times, view[1], "right"))
