"""Peaks and smoothing of curves, by numpy alone.

They find and return what `scipy.signal.find_peaks` and `scipy.ndimage` do. Those bring a second
of imports, and half of scipy with a linear algebra of its own into the installed application.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from faceedit_app.core.arrays import Doubles


def gaussian(curve: Doubles, sigma: float) -> Doubles:
    """A curve (T,) smoothed by a Gaussian of `sigma` frames, cut at four; the ends go on level."""
    radius = int(4 * sigma + 0.5)
    kernel = np.exp(-0.5 * (np.arange(-radius, radius + 1) / sigma) ** 2)
    return np.convolve(np.pad(curve, radius, mode="edge"), kernel / kernel.sum(), mode="valid")


def moving_mean(curves: Doubles, window: int) -> Doubles:
    """Curves (T, C), each frame the mean of the `window` around it; the ends go on level."""
    before = window // 2
    wide = np.pad(curves, ((before + 1, window - 1 - before), (0, 0)), mode="edge")
    sums = np.cumsum(wide, axis=0)
    mean: Doubles = (sums[window:] - sums[:-window]) / window
    return mean


def peaks(
    curve: Doubles, prominence: float, width: float, reach: int
) -> Iterator[tuple[int, float]]:
    """Peaks of a curve, at least so prominent and at half of that at most so wide.

    Args:
        curve: (T,).
        prominence: by how much a peak is above the higher of the lowest points on its two sides,
            each as far as nothing is higher than the peak.
        width: frames.
        reach: frames on either side that are looked at.

    Yields:
        Frame and prominence of each; of a level top, the frame in the middle.
    """
    starts = np.flatnonzero(np.diff(curve, prepend=np.nan))  # of runs of equal values
    ends = np.append(starts[1:], len(curve)) - 1
    tops = curve[starts]
    peak = 1 + np.flatnonzero((tops[1:-1] > tops[:-2]) & (tops[1:-1] > tops[2:]))
    frames = (starts[peak] + ends[peak]) // 2
    # Both sides of each peak, outwards, (peaks, reach + 1), up to where the curve is higher.
    walled = np.pad(curve, reach, constant_values=np.inf)
    steps = np.arange(reach + 1)
    sides = [walled[frames[:, None] + reach + way * steps] for way in (-1, 1)]
    for side in sides:
        side[np.maximum.accumulate(side > side[:, :1], axis=1)] = np.inf
    prominences = curve[frames] - np.maximum(*(side.min(axis=1) for side in sides))
    for row in np.flatnonzero(prominences >= prominence):
        half = curve[frames[row]] - 0.5 * prominences[row]
        if sum(_distance(side[row], half) for side in sides) <= width:
            yield int(frames[row]), float(prominences[row])


def _distance(side: Doubles, level: float) -> float:
    """Frames from the beginning to where a curve that begins higher comes down to a level."""
    frame = int(np.argmax(side <= level))
    below, above = side[frame], side[frame - 1]
    return frame - float((level - below) / (above - below))
