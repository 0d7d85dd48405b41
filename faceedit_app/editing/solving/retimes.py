"""Retimes: the take's frames at other moments of it, for all channels and rotations alike.

Where a retime plays faster than the take, a frame is the mean of nine moments over its own time,
so that shaking does not turn into slow waves. A mean would open lips that touch for a frame or
two. So where an extreme of a curve that can close would lose more than `_LOSS`, the frame nearest
to it shows the pose of that extreme, in the channels of its region.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Bools, Doubles, Floats, Indices
from faceedit_app.core.clip import Clip, nearest_rows
from faceedit_app.core.controls import CONTROL_INDEX, CONTROLS, Control
from faceedit_app.core.regions import REGIONS
from faceedit_app.core.resample import interpolate
from faceedit_app.editing.edits.clock import Clock, Moments, clock_of
from faceedit_app.editing.edits.edit import Edit
from faceedit_app.editing.solving.filling import fill_frames

_WIDEST = 8.0  # times as fast as the take: the mean over a frame's time gets no wider
_OFFSETS = np.linspace(-4, 4, 9) / 9  # of the moments in the mean, as shares of its width
_LOSS = 0.1  # mm
_CLOSE, _JAW = ARKIT_INDEX["mouthClose"], ARKIT_INDEX["jawOpen"]
_LASTS = 3  # frames of the longest extreme: of a longer one, the mean keeps the middle
# Frames on either side of a moment that its value depends on.
AROUND = int(_WIDEST / 2) + _LASTS

Measure = Callable[[Floats], Floats]  # (N, 52) weights -> (N, C) mm


class Retiming:
    """Applies the retimes of one take.

    Args:
        clip: its times and rate.
        tracked: (T, 52) in ARKit order.
        measure: measures the curves of weights.
    """

    def __init__(self, clip: Clip, tracked: Floats, measure: Measure) -> None:
        self._times, self._step, self._measure = clip.times, 1.0 / clip.rate, measure
        close, jaw = (tracked[:, column].astype(np.float64) for column in (_CLOSE, _JAW))
        self._excess = float(max((close - jaw).max(), 0.0))
        self._groups = [
            (CONTROL_INDEX[control.id], _columns_with(control))
            for control in CONTROLS
            if control.closes is not None
        ]

    def reads(self, edit: Edit, first: Indices, stop: Indices) -> tuple[Indices, Indices]:
        """(n,) each: the frames that ranges of frames (first and stop, n each) are made of."""
        clock, last = clock_of(edit), len(self._times) - 1
        begin, end = (
            clock.mixed(self._times[np.clip(rows, 0, last)]) for rows in (first, stop - 1)
        )
        # Between them time only goes on, except for what is mixed at a cut.
        low = np.minimum(begin.first, begin.second) - clock.mixes
        high = np.maximum(end.first, end.second) + clock.mixes
        return (
            np.searchsorted(self._times, low) - AROUND,
            np.searchsorted(self._times, high, side="right") + AROUND,
        )

    def weights(self, edit: Edit, out: Floats, near: slice) -> tuple[slice, Doubles] | None:
        """The retimed weights (N, 52), and their place among the frames `near`.

        Args:
            out: (N', 52) the take on the frames `near`, as the retime finds it.
        """
        rows = self._rows(edit, near)
        if rows is None:
            return None
        clock, times = clock_of(edit), self._times[rows]
        mixed = clock.mixed(times)
        found = self._sampled(out, near, mixed)
        self._keep_extremes(found, out, near, rows, clock, mixed)
        # Between frames, lips may close a little more than the jaw is open.
        found[:, _CLOSE] = np.minimum(found[:, _CLOSE], found[:, _JAW] + self._excess)
        return slice(rows.start - near.start, rows.stop - near.start), found

    def rotations(self, edit: Edit, out: Floats, near: slice) -> tuple[slice, Doubles] | None:
        """The retimed rotations (N, 9), radians, and their place; see `weights`."""
        return self.values(edit, np.unwrap(out.astype(np.float64), axis=0), near)

    def values(
        self, edit: Edit, out: Floats | Doubles, near: slice
    ) -> tuple[slice, Doubles] | None:
        """The retimed values (N, K) of `out` (N', K), and their place; see `weights`."""
        rows = self._rows(edit, near)
        if rows is None:
            return None
        found = self._sampled(out, near, clock_of(edit).mixed(self._times[rows]))
        return slice(rows.start - near.start, rows.stop - near.start), found

    def _rows(self, edit: Edit, near: slice) -> slice | None:
        first, stop = fill_frames(self._times, edit.span)
        first, stop = max(first, near.start), min(stop, near.stop)
        return slice(first, stop) if first < stop else None

    def _sampled(self, values: Floats | Doubles, near: slice, mixed: Moments) -> Doubles:
        """(N, K) the values (N', K) on the frames `near` at some moments."""
        cut = mixed.share > 0
        fast = (mixed.speed > 1.0) & ~cut
        # A frame's own time blurs once already when it is recorded.
        speed = np.minimum(mixed.speed[fast], _WIDEST)
        width = self._step * np.sqrt(speed * speed - 1.0)
        spread = mixed.first[fast][:, None] + width[:, None] * _OFFSETS
        moments = np.concatenate([mixed.first, mixed.second[cut], spread.ravel()])
        every = interpolate(self._times[near], values, moments)
        count, others = len(cut), int(cut.sum())
        found, other, means = np.split(every, [count, count + others])
        found[cut] += mixed.share[cut][:, None] * (other - found[cut])
        found[fast] = means.reshape(-1, len(_OFFSETS), values.shape[1]).mean(axis=1)
        return found

    def _keep_extremes(
        self,
        found: Doubles,
        out: Floats,
        near: slice,
        rows: slice,
        clock: Clock,
        mixed: Moments,
    ) -> None:
        """Show the extremes of curves that can close, in place."""
        moments, recorded = clock.moments(self._times[rows]), self._times[near]
        shown = (recorded > moments[0]) & (recorded < moments[-1]) & ~clock.cuts_out(recorded)
        curves = self._measure(out)
        kept = self._measure(found.astype(np.float32))
        for control, columns in self._groups:
            curve = curves[:, control]
            at = np.flatnonzero(_extremes(curve) & shown)
            place = nearest_rows(moments, recorded[at])
            good = mixed.share[place] == 0
            missed = curve[at] - kept[place, control]
            good &= np.abs(missed) > _LOSS
            # Of several for one frame the last stays: a closure, and the one that loses most.
            for k in np.lexsort((np.abs(missed), missed < 0)):
                if good[k]:
                    found[place[k], columns] = out[at[k], columns]


def _columns_with(control: Control) -> Indices:
    """The channels of the region that a curve belongs to, of its own side if it has one."""
    names = [
        channel
        for region in REGIONS
        if control.id in region.own
        for channel in (*region.channels, *region.accompanying)
    ]
    side = control.id.partition("_")[0].capitalize() if control.mirror else ""
    return np.array([ARKIT_INDEX[name] for name in names if name.endswith(side)], np.intp)


def _extremes(curve: Floats) -> Bools:
    """(N,) whether a frame is a local extreme, of up to `_LASTS` frames.

    It depends on `_LASTS` frames on either side only, so that a part has the same as the whole.
    """
    padded = np.pad(curve, _LASTS, mode="edge")
    around = np.lib.stride_tricks.sliding_window_view(padded, 2 * _LASTS + 1)
    sides = around[:, :_LASTS], around[:, _LASTS + 1 :]
    low, high = (np.stack([f(side, axis=1) for side in sides]) for f in (np.min, np.max))
    least = ((curve <= low) & (curve < high)).all(axis=0)
    most = ((curve >= high) & (curve > low)).all(axis=0)
    return np.logical_or(least, most)
