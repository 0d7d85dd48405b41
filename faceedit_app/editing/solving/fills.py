"""The take that all other edits start from: as tracked, with fills, retimes and neutral rests.

They are applied in the user's order, and a reset takes away those before it. All other edits act
on the result, so that curves drawn within a fill stay as they are, whichever came first. A reset
takes edits of curves away as well, so its range is in their time: that of the take after all
retimes, also after those that follow the reset.
"""

from __future__ import annotations

import time
from collections.abc import Hashable, Sequence
from functools import partial

import numpy as np

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Doubles, Floats, Indices, Times
from faceedit_app.core.clip import Clip
from faceedit_app.core.controls import MAIN_CONTROLS
from faceedit_app.core.regions import OPTIONAL_REGIONS, REGIONS
from faceedit_app.editing.edits.clock import clock_of
from faceedit_app.editing.edits.edit import OF_THE_TAKE, Edit, Op
from faceedit_app.editing.edits.following import DIGITS
from faceedit_app.editing.solving.filling import Filling, Stretch, fill_frames
from faceedit_app.editing.solving.neutral import keep_lips_together, without_rest
from faceedit_app.editing.solving.recent import Recent
from faceedit_app.editing.solving.request import affected
from faceedit_app.editing.solving.retimes import Measure, Retiming
from faceedit_app.editing.solving.rounding import DECIMALS, rounded

REMEMBERED = 32  # results that are kept: a drag over a fill asks for the same again
MOST_GAPS = 1024  # whose frames are kept: they are shown after each change
ROOM = 16 << 20  # bytes of each kind of results; one of a fill of ten minutes takes 15 MB


class Fills:
    """Applies the fills and retimes of one take.

    Args:
        clip: its times, rate and gaps.
        tracked: (T, 52) in ARKit order.
        opening: (T,) mm, the mouth opening.
        measure: measures the curves of weights.
    """

    def __init__(self, clip: Clip, tracked: Floats, opening: Floats, measure: Measure) -> None:
        self._clip, self._tracked = clip, tracked
        self._filling = Filling(clip, tracked, opening)
        self._retiming = Retiming(clip, tracked, measure)
        self._starts, self._turns = (Recent[Floats](REMEMBERED, ROOM) for _ in range(2))
        self._known = Recent[Doubles](REMEMBERED, ROOM)
        self._found = Recent[Doubles](MOST_GAPS, ROOM)
        self._present = np.array([ARKIT_INDEX[c] for c in clip.channels], np.intp)

    @property
    def around(self) -> int:
        """Frames on either side that a fill depends on."""
        return self._filling.context

    def reads(self, edit: Edit, first: Indices, stop: Indices) -> tuple[Indices, Indices]:
        """(n,) each: the frames that ranges of frames (first and stop, n each) are made of.

        Args:
            edit: a fill, which needs all of itself, a retime or a neutral rest.
        """
        if edit.op is Op.NEUTRAL:
            return first, stop
        if edit.op is Op.RETIME:
            return self._retiming.reads(edit, first, stop)
        begin, end = fill_frames(self._clip.times, affected(edit))
        return np.full_like(first, begin - self.around), np.full_like(stop, end + self.around)

    def applied(self, edits: Sequence[Edit], near: slice) -> Floats:
        """(N, 52) the take with the fills and retimes among `edits`, on the frames `near`.

        What these edits read for the frames that matter must lie within `near`, see `reads`, as
        far as the take has it; frames beyond may be wrong.
        """
        acting = _acting(edits)
        return self._starts.to((acting, near.start, near.stop), lambda: self._made(acting, near))

    def _made(self, edits: Sequence[Edit], near: slice) -> Floats:
        tracked, times = self._tracked[near], self._clip.times[near]
        out = tracked.copy()
        for i, edit in enumerate(edits):
            acts = _acts_at(edits, i, times)
            if edit.op is Op.RETIME:
                _put(out, self._retiming.weights(edit, out, near))
            elif edit.op is Op.NEUTRAL:
                self._rest(edit, out, near)
            elif (rows := _rows(edit, acts)) is not None:
                first, stop = rows.start + near.start, rows.stop + near.start
                columns = self._columns(edit)
                new = self._content(edit, out, near, first, stop)[:, columns]
                _mix(edit, out, acts, rows, columns, new, tracked)
        return out

    def turned(self, edits: Sequence[Edit], near: slice, rows: slice) -> Floats | None:
        """(N, 9) rotations with the retimes among `edits`, radians; None if the take has none.

        Args:
            near: the frames that they are made from, see `applied`.
            rows: those of them that are wanted.
        """
        turns = self._clip.rotations
        if turns is None or not any(edit.op is Op.RETIME for edit in edits):
            return None if turns is None else turns[rows]
        acting = _acting(edits)
        key = acting, near.start, near.stop
        made = self._turns.to(key, lambda: self._turned(acting, near, turns))
        return made[rows.start - near.start : rows.stop - near.start]

    def _turned(self, edits: Sequence[Edit], near: slice, turns: Floats) -> Floats:
        tracked, times = turns[near], self._clip.times[near]
        out = tracked.copy()
        columns = np.arange(turns.shape[1])
        for i, edit in enumerate(edits):
            if edit.op is Op.RETIME:
                _put(out, self._retiming.rotations(edit, out, near))
            elif edit.op is Op.RESET and set(edit.controls).issuperset(MAIN_CONTROLS):
                acts = _acts_at(edits, i, times)
                if (rows := _rows(edit, acts)) is not None:
                    new = tracked[rows].astype(np.float64)
                    _mix(edit, out, acts, rows, columns, new, tracked)
        return out

    def moved(self, edits: Sequence[Edit], values: Floats) -> Floats:
        """(T,) values of the frames, at the moments that the retimes among `edits` show.

        Args:
            values: (T,) without units, such as confidence.
        """
        out, near = values[:, None].copy(), slice(0, len(values))
        for edit in _acting(edits):
            if edit.op is Op.RETIME:
                _put(out, self._retiming.values(edit, out, near))
        return np.clip(out[:, 0], values.min(), values.max())

    def _rest(self, edit: Edit, out: Floats, near: slice) -> None:
        """Take a rest away, in `out`; what it leaves unchanged keeps its bits."""
        times = self._clip.times[near]
        if (rows := _rows(edit, times)) is not None:
            out[rows] = self._without(edit, out[rows], times[rows])

    def _without(self, edit: Edit, weights: Floats, times: Times) -> Floats:
        """Weights (N, 52) at `times` without the rest of an edit."""
        before = weights.astype(np.float64)
        kept = [k for k, name in enumerate(edit.channels) if name in self._clip.channels]
        columns = [ARKIT_INDEX[edit.channels[k]] for k in kept]
        rest, peak = np.array(edit.amounts)[kept].reshape(-1, 2).T
        mask = edit.mask(times)[:, None] * min(edit.strength, 1.0)
        now, after = before[:, columns], before.copy()
        after[:, columns] = now + mask * (without_rest(now, rest, peak) - now)
        keep_lips_together(after, before)
        return rounded(after, weights)

    def _content(self, edit: Edit, out: Floats, near: slice, first: int, stop: int) -> Doubles:
        """(N, 52) what an edit puts in place of the take."""
        if edit.op is Op.RESET:
            return self._tracked[first:stop].astype(np.float64)
        stretch = self._stretch(edit, out, near, first, stop)
        return self._known.to(_key(edit, stretch), lambda: self._filling.fill(stretch))

    def _stretch(self, edit: Edit, out: Floats, near: slice, first: int, stop: int) -> Stretch:
        """What a fill has to fill, in the take with earlier fills (N, 52) on the frames `near`."""
        begin, end = first - near.start, stop - near.start
        return Stretch(
            first,
            stop,
            out[max(begin - self.around, 0) : begin],
            out[end : end + self.around],
            edit.seed,
            edit.polyline if edit.points else None,
        )

    def found(
        self,
        edits: Sequence[Edit],
        seconds: Times,
        until: float | None = None,
    ) -> Floats | None:
        """(L, 52) weights for rows that lost the face, where a fill covers them; else NaN.

        Args:
            seconds: (L,) of the rows.
            until: a time of `time.perf_counter`; then it goes on with no other gap.

        Returns:
            The weights; None if the time was up. What was found by then is not sought again.
        """
        times, whole = self._clip.times, slice(0, len(self._tracked))
        out = np.full((len(seconds), self._tracked.shape[1]), np.nan)
        has_found = False
        movers = [i for i, edit in enumerate(edits) if edit.op in (Op.RETIME, Op.RESET)]
        changing: list[Edit] = []  # a fill between two frames changes none
        for i, edit in enumerate(edits):
            earlier = tuple(changing)
            if edit.op is not Op.FILL or _rows(edit, times) is not None:
                changing.append(edit)
            covered = edit.mask(_acts_at(edits, i, seconds)) > 0.5
            if edit.op is Op.NEUTRAL:
                out = self._without(edit, out.astype(np.float32), seconds).astype(np.float64)
                continue
            if len(self._columns(edit)) < len(self._present) or not covered.any():
                continue
            if edit.op is Op.RESET:
                out[covered] = np.nan
            first, stop = fill_frames(times, edit.span)
            if edit.op is Op.FILL and stop - first < len(times):
                moving = _moving(edits, movers, i)
                around = self.applied((*changing, *moving) if moving else earlier, whole)
                stretch = self._stretch(edit, around, whole, first, stop)
                key = (*_key(edit, stretch), seconds[covered].tobytes())
                if key not in self._found:
                    if until is not None and has_found and time.perf_counter() >= until:
                        return None
                    has_found = True
                between = partial(self._filling.between, stretch, seconds[covered])
                out[covered] = self._found.to(key, between)
        found: Floats = np.round(np.clip(out, 0.0, 1.0), DECIMALS).astype(np.float32)
        return found

    def _columns(self, edit: Edit) -> Indices:
        """The channels that a fill replaces, or that a reset brings back.

        A fill of some curves replaces the regions that they belong to; one of all curves, the
        whole face. A reset brings back the regions all of whose curves it resets.
        """
        controls = set(edit.controls)
        if controls.issuperset(MAIN_CONTROLS):
            return self._present
        enough = any if edit.op is Op.FILL else all
        every = (*REGIONS, *OPTIONAL_REGIONS)
        regions = [r for r in every if r.own and enough(c in controls for c in r.own)]
        names = [c for region in regions for c in (*region.channels, *region.accompanying)]
        mine: Indices = np.intersect1d([ARKIT_INDEX[c] for c in names], self._present)
        return mine.astype(np.intp)


def _key(edit: Edit, stretch: Stretch) -> tuple[Hashable, ...]:
    """What the content of a fill depends on."""
    around = stretch.before.tobytes(), stretch.after.tobytes()
    return stretch.first, stretch.stop, edit.seed, edit.points, *around


def _acting(edits: Sequence[Edit]) -> tuple[Edit, ...]:
    """Those that change the take that all others start from."""
    return tuple(edit for edit in edits if edit.op in (Op.RESET, *OF_THE_TAKE))


def _moving(edits: Sequence[Edit], movers: Sequence[int], place: int) -> tuple[Edit, ...]:
    """The retimes and resets after a fill; none if there are no retimes.

    They leave rows without a face where they are, and change the frames that its rows have to join.

    Args:
        movers: the places of all retimes and resets.
        place: that of the fill.
    """
    moving = tuple(edits[mover] for mover in movers if mover > place)
    return moving if any(edit.op is Op.RETIME for edit in moving) else ()


def _put(out: Floats, made: tuple[slice, Doubles] | None) -> None:
    """Put retimed values in their place; what is the same keeps its bits."""
    if made is not None:
        rows, values = made
        out[rows] = rounded(values, out[rows])


def _acts_at(edits: Sequence[Edit], place: int, times: Times) -> Times:
    """(N,) the times at which an edit acts on what is at `times` (N,) before it.

    For a reset they are those at which the retimes after it show that.
    """
    if edits[place].op is Op.RESET:
        for later in edits[place + 1 :]:
            if later.op is Op.RETIME:  # rounded as the ranges of edits that follow it
                times = clock_of(later).shown(times).round(DIGITS)
    return times


def _rows(edit: Edit, times: Times) -> slice | None:
    """Which of the frames at `times` (N,) an edit acts on; None = none."""
    first, stop = fill_frames(times, edit.span)
    return slice(first, stop) if first < stop else None


def _mix(
    edit: Edit,
    out: Floats,
    times: Times,
    rows: slice,
    columns: Indices,
    new: Doubles,
    tracked: Floats,
) -> None:
    """Put (n, K) values in their place as far as an edit applies, in `out`.

    Args:
        out, tracked: (N, C) weights or rotations so far, and as tracked.
        times: (N,) seconds.
        rows: those n of the N frames that the edit acts on.
        columns: (K,) of the C.
    """
    before = out[rows]
    old = before[:, columns]
    mask = edit.mask(times[rows])[:, None] * min(edit.strength, 1.0)
    mixed = before.astype(np.float64)
    mixed[:, columns] = old + mask * (new - old)
    out[rows] = rounded(mixed, before)
    if edit.op is Op.RESET:  # to the bit
        recorded, now = tracked[rows][:, columns], out[rows][:, columns]
        exact = np.where((mask == 1) | (old == recorded), recorded, now)
        out[rows.start : rows.stop, columns] = exact
