"""Peaks and smoothing of curves, in numpy.

The results are those of `scipy.signal.find_peaks` and `scipy.ndimage`, whose imports take more
than half a second, which a drag would wait for.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from faceedit_app.core.arrays import Doubles


def gaussian(curve: Doubles, sigma: float) -> Doubles:
    """A curve (T,) smoothed by a Gaussian of `sigma` frames, cut at four; the ends are repeated."""
    half_width = int(4 * sigma + 0.5)
    kernel = np.exp(-0.5 * (np.arange(-half_width, half_width + 1) / sigma) ** 2)
    return np.convolve(np.pad(curve, half_width, mode="edge"), kernel / kernel.sum(), mode="valid")


def smoothed(curves: Doubles, sigma: float) -> Doubles:
    """Curves (T, C), each smoothed as by `gaussian`; faster, for narrow Gaussians."""
    half_width = int(4 * sigma + 0.5)
    kernel = np.exp(-0.5 * (np.arange(half_width + 1) / sigma) ** 2)
    kernel /= kernel[0] + 2 * kernel[1:].sum()
    count = len(curves)
    # `np.pad` takes as long as all the sums.
    wide = np.empty((count + 2 * half_width, curves.shape[1]), order="F")
    wide[:half_width], wide[half_width + count :] = curves[0], curves[-1]
    wide[half_width : half_width + count] = curves
    smooth: Doubles = kernel[0] * curves
    for step in range(1, half_width + 1):
        before, after = half_width - step, half_width + step
        smooth += kernel[step] * (wide[before : before + count] + wide[after : after + count])
    return smooth


def moving_mean(curves: Doubles, window: int) -> Doubles:
    """The mean of `window` frames around each frame of curves (T, C); the ends are repeated."""
    before = window // 2
    wide = np.pad(curves, ((before + 1, window - 1 - before), (0, 0)), mode="edge")
    sums = np.cumsum(wide, axis=0)
    mean: Doubles = (sums[window:] - sums[:-window]) / window
    return mean


def peaks(
    curve: Doubles, prominence: float, width: float, extent: int
) -> Iterator[tuple[int, float]]:
    """Find peaks of a curve by their prominence and width.

    Args:
        curve: (T,).
        prominence: the least prominence: the height of a peak above the higher of the lowest
            points on its two sides, each searched up to where the curve is above the peak.
        width: the greatest width at half prominence, frames.
        extent: frames on either side that are searched.

    Yields:
        The frame and the prominence of each peak; for a flat top, the frame in its middle.
    """
    starts = np.flatnonzero(np.diff(curve, prepend=np.nan))  # of runs of equal values
    ends = np.append(starts[1:], len(curve)) - 1
    tops = curve[starts]
    peak = 1 + np.flatnonzero((tops[1:-1] > tops[:-2]) & (tops[1:-1] > tops[2:]))
    frames = (starts[peak] + ends[peak]) // 2
    # Both sides of each peak, outwards, (peaks, extent + 1); infinite beyond a higher value.
    walled = np.pad(curve, extent, constant_values=np.inf)
    steps = np.arange(extent + 1)
    sides = [walled[frames[:, None] + extent + way * steps] for way in (-1, 1)]
    for side in sides:
        side[np.maximum.accumulate(side > side[:, :1], axis=1)] = np.inf
    prominences = curve[frames] - np.maximum(*(side.min(axis=1) for side in sides))
    for row in np.flatnonzero(prominences >= prominence):
        half = curve[frames[row]] - 0.5 * prominences[row]
        if sum(_distance(side[row], half) for side in sides) <= width:
            yield int(frames[row]), float(prominences[row])


def _distance(side: Doubles, level: float) -> float:
    """Frames until a curve that begins above a level comes down to it."""
    frame = int(np.argmax(side <= level))
    below, above = side[frame], side[frame - 1]
    return frame - float((level - below) / (above - below))
