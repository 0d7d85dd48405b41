"""The take that all other edits start from: as tracked, with fills in place of what they cover.

Fills are applied in the user's order, and a reset takes away those before it. All other edits act
on the result, so that curves drawn within a fill stay as they are, whichever came first.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Doubles, Floats, Indices
from faceedit_app.core.clip import Clip
from faceedit_app.core.controls import MAIN_CONTROLS
from faceedit_app.core.regions import OPTIONAL_REGIONS, REGIONS
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.solving.filling import Filling, Stretch, fill_frames

DECIMALS = 5  # of filled weights, see `solver.DECIMALS`
REMEMBERED = 32  # fills that are kept: a drag over a fill asks for the same again


class Fills:
    """Applies the fills of one take.

    Args:
        clip: its times, rate and gaps.
        tracked: (T, 52) in ARKit order.
        opening: (T,) mm, the mouth opening.
    """

    def __init__(self, clip: Clip, tracked: Floats, opening: Floats) -> None:
        self._clip, self._tracked = clip, tracked
        self._filling = Filling(clip, tracked, opening)
        self._known: dict[tuple[object, ...], Doubles] = {}
        self._present = np.array([ARKIT_INDEX[c] for c in clip.channels], np.intp)

    @property
    def around(self) -> int:
        """Frames on either side that a fill depends on."""
        return self._filling.context

    def applied(self, edits: Sequence[Edit], near: slice) -> Floats:
        """(N, 52) the take with the fills among `edits`, on the frames `near`.

        Each fill that reaches into these frames must lie within them, with `around` frames on
        either side, as far as the take has them.
        """
        out = self._tracked[near].copy()
        for edit in edits:
            if edit.op not in (Op.FILL, Op.RESET):
                continue
            first, stop = fill_frames(self._clip.times, edit.span)
            first, stop = max(first, near.start), min(stop, near.stop)
            if first >= stop:
                continue
            rows = slice(first - near.start, stop - near.start)
            columns = self._columns(edit)
            old = out[rows][:, columns].astype(np.float64)
            new = self._content(edit, out, near, first, stop)[:, columns]
            mask = edit.mask(self._clip.times[first:stop])[:, None] * min(edit.strength, 1.0)
            mixed = np.round(old + mask * (new - old), DECIMALS).astype(np.float32)
            mixed = np.where(mask == 0, old.astype(np.float32), mixed)
            if edit.op is Op.RESET:  # to the bit
                recorded = self._tracked[first:stop][:, columns]
                mixed = np.where((mask == 1) | (old == recorded), recorded, mixed)
            out[rows.start : rows.stop, columns] = mixed
        return out

    def _content(self, edit: Edit, out: Floats, near: slice, first: int, stop: int) -> Doubles:
        """(N, 52) what an edit puts in place of the take."""
        if edit.op is Op.RESET:
            return self._tracked[first:stop].astype(np.float64)
        stretch = self._stretch(edit, out, near, first, stop)
        around = stretch.before.tobytes(), stretch.after.tobytes()
        key = (first, stop, edit.seed, edit.points, *around)
        content = self._known.pop(key, None)
        if content is None:
            content = self._filling.fill(stretch)
        self._known[key] = content
        while len(self._known) > REMEMBERED:
            del self._known[next(iter(self._known))]  # the least recently used
        return content

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

    def found(self, edits: Sequence[Edit], positions: Sequence[float], weights: Floats) -> Floats:
        """(L, 52) weights for rows that lost the face, where a fill covers them; else NaN.

        What other edits change in the frames around is added, in proportion.

        Args:
            positions: (L) see `LostRows`.
            weights: (T, 52) the result with all edits.
        """
        times, whole = self._clip.times, slice(0, len(self._tracked))
        before = np.floor(positions).astype(np.intp)
        share = np.asarray(positions, np.float64) - before
        seconds = times[before] + share * (times[before + 1] - times[before])
        out = np.full((len(before), self._tracked.shape[1]), np.nan)
        for i, edit in enumerate(edits):
            covered = edit.mask(seconds) > 0.5
            if len(self._columns(edit)) < len(self._present) or not covered.any():
                continue
            if edit.op is Op.RESET:
                out[covered] = np.nan
            first, stop = fill_frames(times, edit.span)
            if edit.op is Op.FILL and 0 < stop - first < len(times):
                stretch = self._stretch(edit, self.applied(edits[:i], whole), whole, first, stop)
                out[covered] = self._filling.between(stretch, seconds[covered])
        change = (weights - self.applied(edits, whole)).astype(np.float64)
        share = share[:, None]
        out += (1.0 - share) * change[before] + share * change[before + 1]
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
