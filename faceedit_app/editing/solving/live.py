"""The live result of a take: what is shown, and which chunks have still to be computed.

No result is computed from another, so neither the order of the chunks matters nor whether some
were dropped for others.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Mapping
from itertools import islice

import numpy as np

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Bools, Doubles, Floats
from faceedit_app.editing.solving.channel_edits import AnyTask
from faceedit_app.editing.solving.chunks import FrameRange
from faceedit_app.editing.solving.solver import Solver

REMEMBERED = 1024  # changes that `Live.changes` can report


class Live:
    """The arrays that the window draws and the export writes.

    Attributes:
        tracked, asked, achieved: (T, C) mm: the three curves of the plots.
        weights: (T, 52) in ARKit order.
        rotations: (T, 9) radians, as `Clip.rotations`; None if the take has none.
        patience: about how many seconds `show` may take; the rest is left to `work`. None = as
            long as it takes.

    Args:
        as_written: numbers that differ where those that the take's file would show for weights
            (N,) do, which decides whether a frame is changed; None = the weights themselves do.
    """

    def __init__(
        self, solver: Solver, as_written: Callable[[Floats], Doubles] | None = None
    ) -> None:
        self._solver, self._as_written = solver, as_written
        self._columns = [ARKIT_INDEX[channel] for channel in solver.clip.channels]
        if as_written is not None:
            as_written(np.zeros(0, np.float32))  # finds the file's digits before the first drag
        self.tracked: Floats = solver.controls
        self.asked: Floats = solver.controls.copy()
        self.achieved: Floats = solver.controls.copy()
        self.weights: Floats = solver.tracked.copy()
        turns = solver.clip.rotations
        self._turns, self.rotations = turns, None if turns is None else turns.copy()
        self.patience: float | None = None
        self._wanted: Mapping[int, AnyTask] = {}
        self._shown: dict[int, AnyTask] = {}
        self._changed: dict[int, int] = {}  # frames, by chunk
        self._waiting: list[int] = []  # chunks, the most urgent last
        self._total = 0
        self._in_view = (0, 0, 0)
        self._changes: deque[FrameRange] = deque(maxlen=REMEMBERED)
        self._count = 0

    @property
    def progress(self) -> tuple[int, int]:
        """The number of chunks of the last change that are done, and of all."""
        return self._total - len(self._waiting), self._total

    @property
    def is_complete(self) -> bool:
        """Whether no chunk is waiting."""
        return not self._waiting

    @property
    def changed_frames(self) -> int:
        """The number of frames that differ from the take as tracked."""
        return sum(self._changed.values())

    def forget(self) -> None:
        """Show the take as tracked."""
        self.show({})

    def show(self, tasks: Mapping[int, AnyTask]) -> None:
        """Show the results of these tasks by chunk, and the take as tracked elsewhere."""
        for chunk in [chunk for chunk in self._shown if chunk not in tasks]:
            rows = self._solver.chunks.slice(chunk)
            self.asked[rows] = self.achieved[rows] = self.tracked[rows]
            self.weights[rows] = self._solver.tracked[rows]
            self._turn(rows, None)
            del self._shown[chunk], self._changed[chunk]
            self._note(rows)
        self._wanted = tasks
        shown = self._shown
        self._waiting = [chunk for chunk, task in tasks.items() if shown.get(chunk) != task]
        self._total = len(self._waiting)
        self._sort()
        self.work(self.patience)

    def look(self, frame: int, first: int, last: int) -> None:
        """Compute first what the user sees: the frame on screen, then `first` to `last`."""
        chunks = self._solver.chunks
        in_view = chunks.of_frame(frame), chunks.of_frame(first), chunks.of_frame(last)
        if in_view != self._in_view:
            self._in_view = in_view
            self._sort()

    def _sort(self) -> None:
        at, first, last = self._in_view

        def distance(chunk: int) -> tuple[bool, int]:
            return not (chunk == at or first <= chunk <= last), abs(chunk - at)

        if len(self._waiting) > 1:
            self._waiting.sort(key=distance, reverse=True)

    def work(self, seconds: float | None = None) -> bool:
        """Compute waiting chunks, at least one, until all are done or the time is up.

        Returns:
            Whether chunks are still waiting.
        """
        until = None if seconds is None else time.perf_counter() + seconds
        while self._waiting:
            self._compute(self._waiting.pop())
            if until is not None and time.perf_counter() >= until:
                break
        return bool(self._waiting)

    def _compute(self, chunk: int) -> None:
        task = self._wanted[chunk]
        patch = self._solver.solve(task)
        rows = self._solver.chunks.slice(chunk)
        self.asked[rows] = patch.asked
        self.achieved[rows] = patch.controls
        self.weights[rows] = patch.weights
        self._turn(rows, patch.rotations)
        self._note(rows)
        self._shown[chunk] = task
        differs = self._differing(patch.weights, self._solver.tracked[rows])
        if self._turns is not None and patch.rotations is not None:
            differs |= (patch.rotations != self._turns[rows]).any(axis=1)
        self._changed[chunk] = int(differs.sum())

    def _differing(self, weights: Floats, tracked: Floats) -> Bools:
        """(N,) which rows of weights (N, 52) the file shows to differ from those as tracked."""
        differs: Bools = (weights != tracked).any(axis=1)
        if self._as_written is not None and differs.any():
            changed = weights != tracked
            now, then = self._as_written(weights[changed]), self._as_written(tracked[changed])
            changed[changed] = now != then
            differs = changed[:, self._columns].any(axis=1)
        return differs

    def _turn(self, rows: slice, rotations: Floats | None) -> None:
        """Show rotations on some frames; None = as tracked."""
        if self.rotations is not None and self._turns is not None:
            self.rotations[rows] = self._turns[rows] if rotations is None else rotations

    def _note(self, rows: slice) -> None:
        self._changes.append((rows.start, rows.stop))
        self._count += 1

    def changes(self, since: int) -> tuple[int, list[FrameRange]]:
        """What has changed, for caches of values that are derived from the arrays.

        Args:
            since: the number that the last call returned; 0 at first.

        Returns:
            A number for the next call, and ranges that cover all frames changed since.
        """
        missed = self._count - since
        if missed > len(self._changes):  # too long ago
            return self._count, [(0, len(self.tracked))]
        found: list[FrameRange] = []
        for first, last in sorted(islice(reversed(self._changes), missed)):
            if found and first <= found[-1][1]:
                found[-1] = found[-1][0], max(last, found[-1][1])
            else:
                found.append((first, last))
        return self._count, found
