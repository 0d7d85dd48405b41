"""From a list of edits to what is asked for: curves, and where and how firmly."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from faceedit_app.core.arrays import Bools, Doubles, Times
from faceedit_app.core.controls import CONTROL_INDEX
from faceedit_app.editing.edits.edit import OF_THE_TAKE, Edit, Op
from faceedit_app.editing.solving.bridging import smoothed_without
from faceedit_app.editing.solving.companions import Companions
from faceedit_app.editing.solving.filters import gaussian

# Seconds beyond an edit in which the networks may let the face prepare and follow through. Lips
# take about this long to close in speech.
SPILL = 0.25
FARTHEST = 10_000.0  # mm; keeps what is asked for finite, however many edits scale it
SAME_MM = 1e-4  # mm by which a curve may differ and count as unfilled
NARROW = 0.01  # frames; a narrower smooth changes nothing


@dataclass(frozen=True)
class Request:
    """What the edits ask for on N frames.

    Attributes:
        curves: (N, C), mm: the tracked controls with the edits applied, companions included.
        hold: (N, C) in 0..1, how firmly each curve is asked for (the edits' masks).
        influence: (N, C) in 0..1, where the networks may answer: 1 in an edit's span, fading
            over `SPILL` seconds beyond it.
        calm: (N, C) in 0..1, how far a curve is asked to be calm, rather than to be where it is
            asked for to a fraction of a millimetre (the masks of smooths).
    """

    curves: Doubles
    hold: Doubles
    influence: Doubles
    calm: Doubles

    def at(self, rows: slice) -> Request:
        """The request on some of the frames."""
        return Request(self.curves[rows], self.hold[rows], self.influence[rows], self.calm[rows])


def active(edits: Sequence[Edit]) -> tuple[Edit, ...]:
    """The `effect` of each edit that has one."""
    return tuple(effect for edit in edits if (effect := edit.effect) is not None)


def affected(edit: Edit) -> tuple[float, float]:
    """First and last second at which an edit can change the face."""
    first, last = edit.span
    return first - SPILL, last + SPILL


def request(
    times: Times,
    rate: float,
    tracked: Doubles,
    medians: Doubles,
    edits: Sequence[Edit],
    companions: Companions | None = None,
    limits: tuple[Doubles, Doubles] | None = None,
    recorded: Doubles | None = None,
    far: Bools | None = None,
) -> Request:
    """Apply `edits` in order to the tracked controls.

    Fills and retimes have changed `tracked` already. A reset goes back to `recorded`, unless such
    an edit follows it in the list.

    An edit that asks for more than a face can do asks for what it can do, before its strength
    applies: half of far too much is half of all that is possible.

    Args:
        times: (N,) seconds.
        rate: frames per second, for smoothing.
        tracked: (N, C), mm, with fills and retimes.
        medians: (C,), mm: the take's median of each control, the fixed point of `scale`.
        companions: which curves follow which; None = no curve follows.
        limits: (C,) mm each, the lowest and highest values that the take and a face can have;
            None = 0 to `FARTHEST`.
        recorded: (N, C), mm, without fills and retimes; None = `tracked`.
        far: (N,) the frames that smooths leave out, see `bridging.py`; None = none.
    """
    low, high = limits or (np.zeros(tracked.shape[1]), np.full(tracked.shape[1], FARTHEST))
    goal = recorded = tracked if recorded is None else recorded
    asking = _Asking.for_nothing(tracked)
    curves = asking.curves
    acting = active(edits)
    for i, edit in enumerate(acting):
        if edit.op in OF_THE_TAKE:
            continue
        first, last = affected(edit)
        rows = slice(*map(int, np.searchsorted(times, (first - 1e-9, last + 1e-9))))
        if rows.start == rows.stop:
            continue
        mask, spread = edit.mask(times[rows]), _spread(edit, times[rows])
        share = mask * _share(edit)
        leads = companions is not None and companions.leads(edit)
        before = curves[rows].copy() if leads else None
        if edit.op is Op.RESET:
            goal = _goal_of_reset(acting[i + 1 :], times, tracked, recorded)
        for column in (CONTROL_INDEX[control] for control in edit.controls):
            wanted = _wanted(edit, rows, times, curves, goal, medians, rate, column, far)
            now, least, most = curves[rows, column], low[column], high[column]
            wanted = np.clip(wanted, least, most)
            curves[rows, column] = np.where(
                mask > 0, np.clip(now + share * (wanted - now), least, most), now
            )
            if edit.op is Op.RESET:
                filled = np.abs(goal[rows, column] - tracked[rows, column]) > SAME_MM
                asking.reset(rows, column, share, spread, filled)
            else:
                asking.ask(rows, column, mask, spread, calms=edit.op is Op.SMOOTH)
        if companions is not None:
            if before is not None:
                added = companions.follow(edit, curves[rows] - before, asking.claimed[rows])
                moved = np.clip(curves[rows] + added, low, high)
                curves[rows] = np.where(added != 0, moved, curves[rows])
            asking.claim(rows, companions.claims(edit), mask)
    return Request(curves, asking.hold, asking.influence, asking.calm)


@dataclass(frozen=True)
class _Asking:
    """What the edits applied so far ask for, on all frames; its methods change it in place.

    Attributes:
        curves, hold, influence, calm: (N, C), see `Request`.
        claimed: (N, C) in 0..1, how firmly each curve is claimed, see `companions.py`.
    """

    curves: Doubles
    hold: Doubles
    influence: Doubles
    calm: Doubles
    claimed: Doubles

    @classmethod
    def for_nothing(cls, tracked: Doubles) -> _Asking:
        """Before the first edit."""
        curves = tracked.astype(np.float64, order="F", copy=True)
        return cls(curves, *(np.zeros_like(curves) for _ in range(4)))

    def ask(self, rows: slice, column: int, mask: Doubles, spread: Doubles, calms: bool) -> None:
        """Ask for a curve by an edit's mask; `calms` if it is a smooth."""
        at = rows, column
        self.hold[at] = np.maximum(self.hold[at], mask)
        self.influence[at] = np.maximum(self.influence[at], spread)
        self.calm[at] = np.maximum(self.calm[at], mask) if calms else self.calm[at] * (1 - mask)

    def reset(
        self, rows: slice, column: int, share: Doubles, spread: Doubles, filled: Bools
    ) -> None:
        """Ask no longer for a curve, but for what was recorded where it was `filled`."""
        at = rows, column
        for each in (self.hold, self.influence, self.claimed):
            each[at] *= 1 - share
        self.hold[at] = np.maximum(self.hold[at], share * filled)
        self.influence[at] = np.maximum(self.influence[at], spread * filled)

    def claim(self, rows: slice, columns: Sequence[int], mask: Doubles) -> None:
        """The curves no longer follow others, by an edit's mask."""
        for column in columns:
            self.claimed[rows, column] = np.maximum(self.claimed[rows, column], mask)


def _goal_of_reset(
    later: Sequence[Edit], times: Times, tracked: Doubles, recorded: Doubles
) -> Doubles:
    """(N, C) mm that a reset goes back to: it leaves the fills and retimes after it."""
    kept = np.zeros(len(times), np.bool_)
    for edit in later:
        if edit.op in OF_THE_TAKE:
            kept |= edit.mask(times) > 0
    return np.where(kept[:, None], tracked, recorded)


def _spread(edit: Edit, times: Times) -> Doubles:
    """(N,) in 0..1: 1 in the edit's span, then fading with continuous velocity and acceleration."""
    first, last = edit.span
    left = np.clip(1.0 - np.maximum(first - times, times - last) / SPILL, 0.0, 1.0)
    spread: Doubles = left**3 * (10.0 - 15.0 * left + 6.0 * left**2)
    return spread


def _share(edit: Edit) -> float:
    """How much of the way to `_wanted` the edit goes in its hold."""
    # More than 1 would go beyond the smoothed or the tracked curve, to its mirror image.
    return min(edit.strength, 1.0) if edit.op in (Op.SMOOTH, Op.RESET) else edit.strength


def smoothing(edit: Edit) -> float:
    """Standard deviation of a `smooth`, seconds; it grows above full strength; else 0."""
    return edit.value * max(edit.strength, 1.0) if edit.op is Op.SMOOTH else 0.0


def _wanted(
    edit: Edit,
    rows: slice,
    times: Times,
    curves: Doubles,
    recorded: Doubles,
    medians: Doubles,
    rate: float,
    column: int,
    far: Bools | None,
) -> Doubles:
    """One curve with the edit at full strength, on `rows`."""
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
            return _smooth(curves[:, column], rows, edit, rate, far)
        case Op.RESET:
            return recorded[rows, column]
        case Op.DRAW:
            return _drawn(edit, times[rows])
        case Op.FILL | Op.RETIME:  # `fills.py` has changed the take itself
            return curve
        case Op.ADD:
            return curve + _drawn(edit, times[rows])
        case Op.LIMIT | Op.NEUTRAL | Op.LEVELS:
            raise ValueError(f"{edit.op} is for channels")


def smoothing_frames(edit: Edit, rate: float) -> int:
    """How many frames on either side a smooth reads; 0 for other edits."""
    frames = smoothing(edit) * rate
    return 0 if frames < NARROW else int(4 * frames + 0.5) + 1  # where the kernel ends


def _smooth(curve: Doubles, rows: slice, edit: Edit, rate: float, far: Bools | None) -> Doubles:
    """Zero-phase Gaussian on `rows`, from what surrounds them."""
    around = smoothing_frames(edit, rate)
    if not around:
        return curve[rows]
    first, last = max(rows.start - around, 0), min(rows.stop + around, len(curve))
    smooth = smoothed_without(
        curve[first:last],
        None if far is None else far[first:last],
        lambda kept: gaussian(kept, smoothing(edit) * rate),
    )
    return smooth[rows.start - first : rows.stop - first]


def _drawn(edit: Edit, times: Times) -> Doubles:
    drawn: Doubles = np.interp(times, *edit.polyline)
    return drawn
