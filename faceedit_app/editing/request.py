"""From a list of edits to what the user asked for: curves, and where they are asked for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d

from faceedit_app.core.regions import CONTROL_INDEX
from faceedit_app.editing.edit import Edit, Op

Array = NDArray[np.float64]

# How far beyond an edit the networks may let the face prepare and follow through, in seconds.
# Speech moves its lips into a closure in about this time.
SPILL = 0.25


@dataclass(frozen=True)
class Request:
    """What the edits ask for on N frames.

    Attributes:
        curves: (N, 8), mm: the tracked controls with the edits applied.
        hold: (N, 8) in 0..1: how firmly each curve is asked for (the edits' masks).
        influence: (N, 8) in 0..1: where the networks may answer: 1 over an edit and its
            falloff, fading over `SPILL` seconds beyond.
    """

    curves: Array
    hold: Array
    influence: Array


def affected(edit: Edit) -> tuple[float, float]:
    """First and last second at which an edit can change the face."""
    first, last = edit.reach
    return first - SPILL, last + SPILL


def request(
    times: Array, rate: float, tracked: Array, medians: Array, edits: Sequence[Edit]
) -> Request:
    """Apply `edits` in order to the tracked controls.

    Args:
        times: (N,) seconds.
        rate: frames per second, for smoothing.
        tracked: (N, 8), mm.
        medians: (8,), mm: the take's median of each control, which `scale` is about.
    """
    curves = tracked.astype(np.float64, copy=True)
    hold, influence = np.zeros_like(curves), np.zeros_like(curves)
    for edit in edits:
        first, last = affected(edit)
        rows = slice(*np.searchsorted(times, (first - 1e-9, last + 1e-9)))
        if rows.start == rows.stop:
            continue
        mask, spread = edit.mask(times[rows]), _spread(edit, times[rows])
        for control in edit.controls:
            column = CONTROL_INDEX[control]
            wanted = _wanted(edit, curves[:, column], tracked[:, column], medians[column], rate)
            now = curves[rows, column]
            # A distance cannot be negative: 0 is touching.
            curves[rows, column] = np.where(
                mask > 0, np.maximum(now + mask * (wanted[rows] - now), 0.0), now
            )
            if edit.op is Op.RESET:
                hold[rows, column] *= 1 - mask
                influence[rows, column] *= 1 - mask
            else:
                hold[rows, column] = np.maximum(hold[rows, column], mask)
                influence[rows, column] = np.maximum(influence[rows, column], spread)
    return Request(curves, hold, influence)


def _spread(edit: Edit, times: Array) -> Array:
    first, last = edit.reach
    return Edit(edit.controls, Op.OFFSET, first, last, SPILL).mask(times)


def _wanted(edit: Edit, curve: Array, tracked: Array, median: float, rate: float) -> Array:
    """The whole curve with the edit in full."""
    match edit.op:
        case Op.OFFSET:
            return curve + edit.value
        case Op.SET:
            return np.full_like(curve, edit.value)
        case Op.SCALE:
            return median + edit.value * (curve - median)
        case Op.SMOOTH:
            frames = edit.value * rate
            if frames < 0.01:  # narrower than any frame
                return curve
            smooth: Array = gaussian_filter1d(curve, frames, mode="nearest")
            return smooth
        case Op.RESET:
            return tracked


def region_influence(request: Request, controls: Sequence[str]) -> Array:
    """(N,) in 0..1: where a region that listens to `controls` may answer."""
    influence: Array = request.influence[:, [CONTROL_INDEX[c] for c in controls]].max(axis=1)
    return influence
