"""Which chunks of a take a list of edits changes, and what each result depends on.

The take is divided into chunks of fixed length at fixed places. A chunk's result depends on the
take, the edits within its range and the settings, and on nothing else: neither on the order of the
gestures nor on what else is computed. A chunk is always computed in the same array shape, so that
it comes out bit for bit the same alone as with all others.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import compress

import numpy as np

from faceedit_app.core.arrays import Bools, Indices
from faceedit_app.core.clip import Clip
from faceedit_app.core.controls import CONTROL_IDS
from faceedit_app.core.resample import GRID_RATE
from faceedit_app.editing.edits.edit import OF_THE_TAKE, Edit, Op
from faceedit_app.editing.edits.settings import Mode, Settings
from faceedit_app.editing.solving.bridging import Bridging, Nearby
from faceedit_app.editing.solving.recent import Recent
from faceedit_app.editing.solving.request import active, affected, smoothing_frames

# Grid frames (8.3 s): long enough that the context on either side is not most of the work, short
# enough to be computed within one picture. The paper's take of 202 frames is one chunk.
CHUNK = 208
# Seconds by which a frame may be outside a time range and still count as on its edge.
SLACK = 1e-9
# Edits beside those of the list whose frames are cached; a drag makes a new edit with each move of
# the mouse, and one that is drawn has hundreds of points, 30 kB.
REMEMBERED = 32
# Chunks of a drag whose frames, and the way from these to the grid and back, are kept.
REMEMBERED_CHUNKS = 4

FrameRange = tuple[int, int]  # the first frame, and the one after the last
# The frames (first and stop, n each) that a fill or retime makes ranges of frames from.
Reads = Callable[[Edit, Indices, Indices], tuple[Indices, Indices]]


@dataclass(frozen=True)
class ChunkTask:
    """A chunk to compute, with everything that its result depends on.

    Attributes:
        chunk: its number.
        near: the frames that it is computed from: its own and those around them.
        settings: how the edits are answered.
        edits: the edits that it depends on, in the user's order.
        regions: ids of the regions to resynthesize.
    """

    chunk: int
    near: FrameRange
    settings: Settings
    edits: tuple[Edit, ...]
    regions: tuple[str, ...] = ()


@dataclass(frozen=True)
class EditFrames:
    """The frames that an edit can affect, and those of its hold."""

    affected: FrameRange
    held: FrameRange


class Chunks:
    """The chunks of one take.

    Args:
        clip: its times, rate and gaps.
        grid: the number of grid frames in the take.
        scale: the networks' input begins at a multiple of this many grid frames.
        context: grid frames on either side that an answer can depend on.
        reads: what fills and retimes depend on; None = such edits depend on their own frames.

    Attributes:
        rows: (n + 1,) the first frame of each chunk, then the number of frames.
        grid_ranges: (n, 2) the grid frames that the networks answer for each chunk.
        own_ranges: (n, 2) those of them that lie in the chunk itself.
    """

    def __init__(
        self,
        clip: Clip,
        grid: int,
        scale: int = 1,
        context: int = 0,
        reads: Reads | None = None,
    ) -> None:
        times = clip.times
        self._times, self._rate = times, clip.rate
        self._reads: Reads = reads or (lambda _edit, first, stop: (first, stop))
        length = -(-CHUNK // scale) * scale
        starts = length * np.arange(max(-(-grid // length), 1))
        self.rows = np.append(np.searchsorted(times, starts / GRID_RATE - SLACK), len(times))
        self.own_ranges = np.stack([starts, np.minimum(starts + length, grid)], axis=1)
        # Interpolation reads the grid frame before a frame and the two after it.
        margin = -(-(context + 3) // scale) * scale
        self.grid_ranges = np.stack(
            [np.maximum(starts - margin, 0), np.minimum(starts + length + margin, grid)], axis=1
        )
        edges = (self.grid_ranges + np.array([-1, 0])) / GRID_RATE
        self._near = np.clip(np.searchsorted(times, edges) + np.array([-1, 1]), 0, len(times))
        self._spans: dict[Edit, EditFrames] = {}
        self._bridging = Bridging(clip)
        self._nearby = Recent[Nearby](REMEMBERED_CHUNKS)

    def __len__(self) -> int:
        return len(self.grid_ranges)

    def of_frame(self, frame: int) -> int:
        """The chunk that contains a frame."""
        return int(np.searchsorted(self.rows, frame, side="right")) - 1

    def spread(self, most: int) -> list[int]:
        """Up to `most` chunks with frames, evenly spread over the take."""
        filled = np.flatnonzero(np.diff(self.rows) > 0)
        places = np.linspace(0, len(filled) - 1, min(most, len(filled))).round().astype(np.intp)
        return [int(chunk) for chunk in filled[places]]

    def slice(self, chunk: int) -> slice:
        """A chunk's frames."""
        return slice(int(self.rows[chunk]), int(self.rows[chunk + 1]))

    def nearby(self, task: ChunkTask) -> Nearby:
        """The frames that a chunk is computed from, with their gaps bridged."""

        def found() -> Nearby:
            frames, rows = slice(*task.near), self.slice(task.chunk)
            bridged, start = self._bridging(frames), frames.start
            inner, shown = bridged.within(rows.start - start, rows.stop - start)
            first, last = (int(i) for i in self.grid_ranges[task.chunk])
            return Nearby(frames, bridged, inner, shown, (first, last))

        return self._nearby.to((task.chunk, task.near), found)

    def tasks(
        self, edits: Sequence[Edit], settings: Settings, listening: Mapping[str, Iterable[str]]
    ) -> dict[int, ChunkTask]:
        """The tasks that answer edits, by chunk.

        Args:
            edits: in the user's order.
            settings: how they are answered.
            listening: the controls that each region listens to, by region id.
        """
        edits = active(edits)
        if not edits:
            return {}
        spans = [self._span(edit) for edit in edits]
        if len(self._spans) > REMEMBERED + len(edits):
            self._spans = dict(zip(edits, spans, strict=True))
        chunks: Iterable[int] = self._under(spans)
        regions: tuple[str, ...] = ()
        if settings.mode is Mode.RESYNTHESIZE:
            edited = _influenced(edits, spans)
            regions = tuple(r for r, controls in listening.items() if edited.intersection(controls))
            starts = [s for e, s in zip(edits, spans, strict=True) if e.op in OF_THE_TAKE]
            chunks = range(len(self)) if regions else self._under(starts)
        seen, near = self._seen(edits, spans)
        wanted = [chunk for chunk in chunks if self.rows[chunk] < self.rows[chunk + 1]]
        columns, ranges = seen.T[wanted].tolist(), near[wanted].tolist()
        return {
            chunk: ChunkTask(
                chunk, (first, last), settings, tuple(compress(edits, column)), regions
            )
            for chunk, column, (first, last) in zip(wanted, columns, ranges, strict=True)
        }

    def _span(self, edit: Edit) -> EditFrames:
        known = self._spans.get(edit)
        if known is None:
            spans = affected(edit), (edit.start, edit.end)
            known = self._spans[edit] = EditFrames(
                *(self._within(first, last) for first, last in spans)
            )
        return known

    def _within(self, first: float, last: float) -> FrameRange:
        start, stop = np.searchsorted(self._times, (first - SLACK, last + SLACK))
        return int(start), int(stop)

    def _under(self, spans: Sequence[EditFrames]) -> list[int]:
        """The chunks with frames that edits affect, in order of time."""
        rows = np.array([span.affected for span in spans], np.intp).reshape(-1, 2)
        first, last = rows[rows[:, 0] < rows[:, 1]].T
        starts, stops = (np.searchsorted(self.rows, i, side="right") for i in (first, last - 1))
        # Each run of chunks adds one at its first and takes one away after its last.
        runs = np.zeros(len(self) + 1, np.intp)
        np.add.at(runs, starts - 1, 1)
        np.add.at(runs, stops, -1)
        under: list[int] = np.flatnonzero(runs.cumsum()[:-1]).tolist()
        return under

    def _seen(self, edits: Sequence[Edit], spans: Sequence[EditFrames]) -> tuple[Bools, Indices]:
        """Which edits each chunk depends on (E, n), and the frames that it reads (n, 2).

        Goes from the last edit to the first: a smooth reads frames that earlier edits change.
        """
        first, last = self._near.T
        seen = np.zeros((len(edits), len(self)), np.bool_)
        for i in reversed(range(len(edits))):
            start, stop = spans[i].affected
            seen[i] = (start < last) & (stop > first)
            if edits[i].op is Op.SMOOTH and (margin := smoothing_frames(edits[i], self._rate)):
                from_, to = np.maximum(first, start) - margin, np.minimum(last, stop) + margin
                first = np.where(seen[i], np.minimum(first, from_), first)
                last = np.where(seen[i], np.maximum(last, to), last)
        if any(edit.op in OF_THE_TAKE for edit in edits):
            first, last = self._see_starts(edits, spans, seen, first, last)
        near = np.stack([np.maximum(first, 0), np.minimum(last, len(self._times))], axis=1)
        return seen, near

    def _see_starts(
        self,
        edits: Sequence[Edit],
        spans: Sequence[EditFrames],
        seen: Bools,
        first: Indices,
        last: Indices,
    ) -> tuple[Indices, Indices]:
        """Extend what chunks read to what fills and retimes do; adds to `seen` (E, n), in place.

        These change the take that all others start from, so order matters only among them.
        """
        for i in reversed(range(len(edits))):
            if edits[i].op in OF_THE_TAKE:
                start, stop = spans[i].affected
                seen[i] = (start < last) & (stop > first)
                from_, to = self._reads(edits[i], np.maximum(first, start), np.minimum(last, stop))
                first = np.where(seen[i], np.minimum(first, from_), first)
                last = np.where(seen[i], np.maximum(last, to), last)
        for i, span in enumerate(spans):
            start, stop = span.affected
            if edits[i].op is Op.RESET:  # it acts on what later retimes show there
                for edit, other in zip(edits[i + 1 :], spans[i + 1 :], strict=True):
                    low, high = other.affected
                    if edit.op is Op.RETIME and low < stop and start < high:
                        start, stop = min(start, low), max(stop, high)
            if edits[i].op not in OF_THE_TAKE:
                seen[i] = (start < last) & (stop > first)
        return first, last


def _influenced(edits: Sequence[Edit], spans: Sequence[EditFrames]) -> set[str]:
    """The controls that edits change, except where a later reset at full strength covers them."""
    left: dict[str, list[FrameRange]] = {control: [] for control in CONTROL_IDS}
    for edit, span in zip(edits, spans, strict=True):
        if edit.op in OF_THE_TAKE:  # the networks have no part in it
            continue
        for control in edit.controls:
            runs = left[control]
            if edit.op is not Op.RESET:
                runs.append(span.affected)
            elif edit.strength >= 1:
                start, stop = span.held
                cut = [part for a, b in runs for part in ((a, min(b, start)), (max(a, stop), b))]
                left[control] = [(a, b) for a, b in cut if a < b]
    return {control for control, runs in left.items() if any(a < b for a, b in runs)}
