"""Which parts of a take a list of edits changes, and what each part depends on.

The take is cut into chunks of fixed length at fixed places. A chunk's result follows from the
take, from the edits that can be seen from it and from the settings, and from nothing else: not
from the order in which the user got there, and not from what else is computed. A chunk is always
computed in the same shape, so that a part of a take comes out bit for bit as in the whole.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import compress

import numpy as np

from faceedit_app.core.arrays import Bools, Indices, Times
from faceedit_app.core.controls import CONTROL_IDS
from faceedit_app.core.resample import GRID_RATE
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.edits.settings import Mode, Settings
from faceedit_app.editing.solving.request import active, affected, smoothing_frames

# Grid frames (8.3 s): long enough that the context on either side is not most of the work, short
# enough to be computed between two pictures. The paper's take of 202 frames is one chunk.
CHUNK = 208
# Seconds by which a frame may stand outside a time range and still count as on its edge.
SLACK = 1e-9
# Edits whose frames are remembered; a drag makes another edit with each move of the mouse.
REMEMBERED = 4096

Rows = tuple[int, int]  # the first frame, and the one after the last


@dataclass(frozen=True)
class Piece:
    """A chunk to be computed, with all that its result depends on.

    Attributes:
        chunk: its number.
        near: the frames that it is computed from.
        settings: how the edits are answered.
        edits: those that matter to it, in the user's order.
        regions: ids of those to be made anew (resynthesize).
    """

    chunk: int
    near: Rows
    settings: Settings
    edits: tuple[Edit, ...]
    regions: tuple[str, ...] = ()


@dataclass(frozen=True)
class Span:
    """The frames that an edit can affect, and those that it holds in full."""

    affected: Rows
    held: Rows


class Chunks:
    """The chunks of one take.

    Args:
        times: (T,) seconds of the frames.
        rate: nominal frames per second.
        grid: how many frames the take has on the networks' grid.
        scale: the networks' windows begin at multiples of so many grid frames.
        context: grid frames on either side that an answer can depend on.

    Attributes:
        rows: (n + 1,) where each chunk's frames begin, and the number of frames.
        windows: (n, 2) the grid frames that the networks answer for each.
    """

    def __init__(
        self, times: Times, rate: float, grid: int, scale: int = 1, context: int = 0
    ) -> None:
        self._times, self._rate = times, rate
        length = -(-CHUNK // scale) * scale
        starts = length * np.arange(max(-(-grid // length), 1))
        self.rows = np.append(np.searchsorted(times, starts / GRID_RATE - SLACK), len(times))
        # A frame is read from the grid frame before it and from the two after it.
        margin = -(-(context + 3) // scale) * scale
        self.windows = np.stack(
            [np.maximum(starts - margin, 0), np.minimum(starts + length + margin, grid)], axis=1
        )
        edges = (self.windows + np.array([-1, 0])) / GRID_RATE
        self._near = np.clip(np.searchsorted(times, edges) + np.array([-1, 1]), 0, len(times))
        self._spans: dict[Edit, Span] = {}

    def __len__(self) -> int:
        return len(self.windows)

    def of_frame(self, frame: int) -> int:
        """The chunk that a frame lies in."""
        return int(np.searchsorted(self.rows, frame, side="right")) - 1

    def slice(self, chunk: int) -> slice:
        """A chunk's frames."""
        return slice(int(self.rows[chunk]), int(self.rows[chunk + 1]))

    def pieces(
        self, edits: Sequence[Edit], settings: Settings, listening: Mapping[str, Iterable[str]]
    ) -> dict[int, Piece]:
        """What has to be computed to answer edits, by chunk.

        Args:
            edits: in the user's order.
            settings: how they are answered.
            listening: the controls that each region answers to.
        """
        edits = active(edits)
        if not edits:
            return {}
        spans = [self._span(edit) for edit in edits]
        chunks: Iterable[int] = self._under(spans)
        regions: tuple[str, ...] = ()
        if settings.mode is Mode.RESYNTHESIZE:
            edited = _influenced(edits, spans)
            regions = tuple(r for r, controls in listening.items() if edited.intersection(controls))
            chunks = range(len(self)) if regions else ()
        seen, near = self._seen(edits, spans)
        wanted = [chunk for chunk in chunks if self.rows[chunk] < self.rows[chunk + 1]]
        columns, ranges = seen.T[wanted].tolist(), near[wanted].tolist()
        return {
            chunk: Piece(chunk, (first, last), settings, tuple(compress(edits, column)), regions)
            for chunk, column, (first, last) in zip(wanted, columns, ranges, strict=True)
        }

    def _span(self, edit: Edit) -> Span:
        known = self._spans.get(edit)
        if known is None:
            if len(self._spans) >= REMEMBERED:
                self._spans.clear()
            spans = affected(edit), (edit.start, edit.end)
            known = self._spans[edit] = Span(*(self._within(first, last) for first, last in spans))
        return known

    def _within(self, first: float, last: float) -> Rows:
        start, stop = np.searchsorted(self._times, (first - SLACK, last + SLACK))
        return int(start), int(stop)

    def _under(self, spans: Sequence[Span]) -> list[int]:
        """The chunks that have frames which edits affect, in order of time."""
        found: set[int] = set()
        for first, last in {span.affected for span in spans}:
            if first < last:
                found.update(range(self.of_frame(first), self.of_frame(last - 1) + 1))
        return sorted(found)

    def _seen(self, edits: Sequence[Edit], spans: Sequence[Span]) -> tuple[Bools, Indices]:
        """Which edits (E, n) each chunk depends on, and the frames (n, 2) that it reads.

        Going back from the last edit: what a smooth reads, the edits before it have changed.
        """
        first, last = self._near.T
        seen = np.zeros((len(edits), len(self)), np.bool_)
        for i in reversed(range(len(edits))):
            start, stop = spans[i].affected
            seen[i] = (start < last) & (stop > first)
            if edits[i].op is Op.SMOOTH and (radius := smoothing_frames(edits[i], self._rate)):
                from_, to = np.maximum(first, start) - radius, np.minimum(last, stop) + radius
                first = np.where(seen[i], np.minimum(first, from_), first)
                last = np.where(seen[i], np.maximum(last, to), last)
        near = np.stack([np.maximum(first, 0), np.minimum(last, len(self._times))], axis=1)
        return seen, near


def _influenced(edits: Sequence[Edit], spans: Sequence[Span]) -> set[str]:
    """The controls that edits influence on some frame that no full reset after them covers."""
    left: dict[str, list[Rows]] = {control: [] for control in CONTROL_IDS}
    for edit, span in zip(edits, spans, strict=True):
        for control in edit.controls:
            runs = left[control]
            if edit.op is not Op.RESET:
                runs.append(span.affected)
            elif edit.strength >= 1:
                start, stop = span.held
                cut = [part for a, b in runs for part in ((a, min(b, start)), (max(a, stop), b))]
                left[control] = [(a, b) for a, b in cut if a < b]
    return {control for control, runs in left.items() if any(a < b for a, b in runs)}
