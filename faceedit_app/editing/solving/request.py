"""From a list of edits to what the user asked for: curves, and where they are asked for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from faceedit_app.core.arrays import Doubles, Times
from faceedit_app.core.controls import CONTROL_INDEX
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.solving.companions import Companions
from faceedit_app.editing.solving.filters import gaussian

# How far beyond an edit the networks may let the face prepare and follow through, in seconds.
# Speech moves its lips into a closure in about this time.
SPILL = 0.25
FARTHEST = 10_000.0  # mm: what is asked for stays a number, however many edits scale it
NARROW = 0.01  # frames: a smooth of less changes nothing


@dataclass(frozen=True)
class Request:
    """What the edits ask for on N frames.

    Attributes:
        curves: (N, C), mm: the tracked controls with the edits applied, companions included.
        hold: (N, C) in 0..1: how firmly each curve is asked for (the edits' masks).
        influence: (N, C) in 0..1: where the networks may answer: 1 over an edit and its
            falloff, fading over `SPILL` seconds beyond.
    """

    curves: Doubles
    hold: Doubles
    influence: Doubles


def active(edits: Sequence[Edit]) -> tuple[Edit, ...]:
    """The edits that change something, as their `effect`."""
    return tuple(effect for edit in edits if (effect := edit.effect) is not None)


def affected(edit: Edit) -> tuple[float, float]:
    """First and last second at which an edit can change the face."""
    first, last = edit.reach
    return first - SPILL, last + SPILL


def request(
    times: Times,
    rate: float,
    tracked: Doubles,
    medians: Doubles,
    edits: Sequence[Edit],
    companions: Companions | None = None,
) -> Request:
    """Apply `edits` in order to the tracked controls.

    Args:
        times: (N,) seconds.
        rate: frames per second, for smoothing.
        tracked: (N, C), mm.
        medians: (C,), mm: the take's median of each control, which `scale` is about.
        companions: which curves follow which; None = none does.
    """
    curves = tracked.astype(np.float64, copy=True)
    hold, influence, claimed = (np.zeros_like(curves) for _ in range(3))
    for edit in active(edits):
        first, last = affected(edit)
        rows = slice(*map(int, np.searchsorted(times, (first - 1e-9, last + 1e-9))))
        if rows.start == rows.stop:
            continue
        mask, spread = edit.mask(times[rows]), _spread(edit, times[rows])
        share = mask * _share(edit)
        leads = companions is not None and companions.leads(edit)
        before = curves[rows].copy() if leads else None
        for control in edit.controls:
            column = CONTROL_INDEX[control]
            wanted = _wanted(edit, rows, times, curves, tracked, medians, rate, column)
            now = curves[rows, column]
            # A distance cannot be negative: 0 is touching.
            curves[rows, column] = np.where(
                mask > 0, np.clip(now + share * (wanted - now), 0.0, FARTHEST), now
            )
            if edit.op is Op.RESET:
                hold[rows, column] *= 1 - share
                influence[rows, column] *= 1 - share
                claimed[rows, column] *= 1 - share
            else:
                hold[rows, column] = np.maximum(hold[rows, column], mask)
                influence[rows, column] = np.maximum(influence[rows, column], spread)
        if companions is not None and before is not None:
            added = companions.follow(edit, curves[rows] - before, claimed[rows])
            moved = np.clip(curves[rows] + added, 0.0, FARTHEST)
            curves[rows] = np.where(added != 0, moved, curves[rows])
        for column in companions.claims(edit) if companions is not None else ():
            claimed[rows, column] = np.maximum(claimed[rows, column], mask)
    return Request(curves, hold, influence)


def _spread(edit: Edit, times: Times) -> Doubles:
    """(N,) in 0..1: over the edit 1, then fading so that velocity and acceleration are steady."""
    first, last = edit.reach
    left = np.clip(1.0 - np.maximum(first - times, times - last) / SPILL, 0.0, 1.0)
    spread: Doubles = left**3 * (10.0 - 15.0 * left + 6.0 * left**2)
    return spread


def _share(edit: Edit) -> float:
    """How much of the way to `_wanted` the edit goes in its hold."""
    # Beyond the smoothed or the tracked curve lies its mirror image, which nobody wants.
    return min(edit.strength, 1.0) if edit.op in (Op.SMOOTH, Op.RESET) else edit.strength


def smoothing(edit: Edit) -> float:
    """Standard deviation in seconds of a `smooth`: above full strength it grows; 0 for others."""
    return edit.value * max(edit.strength, 1.0) if edit.op is Op.SMOOTH else 0.0


def _wanted(
    edit: Edit,
    rows: slice,
    times: Times,
    curves: Doubles,
    tracked: Doubles,
    medians: Doubles,
    rate: float,
    column: int,
) -> Doubles:
    """One curve with the edit in full, on `rows`."""
    curve = curves[rows, column]
    match edit.op:
        case Op.OFFSET:
            return curve + edit.value
        case Op.SET:
            return np.full_like(curve, edit.value)
        case Op.SCALE:
            middle = medians[column] if edit.about is None else edit.about
            scaled: Doubles = middle + edit.value * (curve - middle)
            return scaled
        case Op.SMOOTH:
            return _smooth(curves[:, column], rows, edit, rate)
        case Op.RESET:
            return tracked[rows, column]
        case Op.DRAW:
            return _drawn(edit, times[rows])
        case Op.ADD:
            return curve + _drawn(edit, times[rows])


def smoothing_frames(edit: Edit, rate: float) -> int:
    """How many frames to either side a smooth reads; 0 for other edits."""
    frames = smoothing(edit) * rate
    return 0 if frames < NARROW else int(4 * frames + 0.5) + 1  # where the kernel ends


def _smooth(curve: Doubles, rows: slice, edit: Edit, rate: float) -> Doubles:
    """Zero-phase Gaussian on `rows`, from what surrounds them."""
    around = smoothing_frames(edit, rate)
    if not around:
        return curve[rows]
    first, last = max(rows.start - around, 0), min(rows.stop + around, len(curve))
    smooth: Doubles = gaussian(curve[first:last], smoothing(edit) * rate)
    return smooth[rows.start - first : rows.stop - first]


def _drawn(edit: Edit, times: Times) -> Doubles:
    drawn: Doubles = np.interp(times, *edit.polyline)
    return drawn


def region_influence(request: Request, controls: Sequence[str]) -> Doubles:
    """(N,) in 0..1: where a region that listens to `controls` may answer."""
    influence: Doubles = request.influence[:, [CONTROL_INDEX[c] for c in controls]].max(axis=1)
    return influence
