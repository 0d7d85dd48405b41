"""The live result of a take: what is shown now, what is wanted, and what has still to be computed.

Nothing is ever computed from a result, so it does not matter in which order chunks come, or
whether some were begun and given up for others.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Mapping
from itertools import islice

from faceedit_app.core.arrays import Floats
from faceedit_app.editing.solving.chunks import Piece, Rows
from faceedit_app.editing.solving.solver import Solver

REMEMBERED = 1024  # changes of chunks


class Live:
    """The arrays that the window draws and the export writes.

    Attributes:
        tracked, asked, achieved: (T, C) mm: the three curves of the plots.
        weights: (T, 52) in ARKit order.
        patience: seconds that `show` may take, more or less; what is not done by then waits for
            `work`. None is as long as it takes.
    """

    def __init__(self, solver: Solver) -> None:
        self._solver = solver
        self.tracked: Floats = solver.controls
        self.asked: Floats = solver.controls.copy()
        self.achieved: Floats = solver.controls.copy()
        self.weights: Floats = solver.tracked.copy()
        self.patience: float | None = None
        self._wanted: Mapping[int, Piece] = {}
        self._shown: dict[int, Piece] = {}
        self._changed: dict[int, int] = {}  # frames, by chunk
        self._waiting: list[int] = []  # chunks, the most urgent last
        self._total = 0
        self._sight = (0, 0, 0)
        self._changes: deque[Rows] = deque(maxlen=REMEMBERED)
        self._count = 0

    @property
    def progress(self) -> tuple[int, int]:
        """How many chunks of the last change are done, and how many there are."""
        return self._total - len(self._waiting), self._total

    @property
    def is_complete(self) -> bool:
        """Whether all that was asked for is shown."""
        return not self._waiting

    @property
    def changed_frames(self) -> int:
        """How many frames differ from the take as tracked."""
        return sum(self._changed.values())

    def forget(self) -> None:
        """Show the take as tracked."""
        self.show({})

    def show(self, pieces: Mapping[int, Piece]) -> None:
        """Show these pieces, and the tracked take between them."""
        for chunk in [chunk for chunk in self._shown if chunk not in pieces]:
            rows = self._solver.chunks.slice(chunk)
            self.asked[rows] = self.achieved[rows] = self.tracked[rows]
            self.weights[rows] = self._solver.tracked[rows]
            del self._shown[chunk], self._changed[chunk]
            self._note(rows)
        self._wanted = pieces
        shown = self._shown
        self._waiting = [chunk for chunk, piece in pieces.items() if shown.get(chunk) != piece]
        self._total = len(self._waiting)
        self._sort()
        self.work(self.patience)

    def look(self, frame: int, first: int, last: int) -> None:
        """Say what the user sees: it comes first. Frame on screen, and those that curves show."""
        chunks = self._solver.chunks
        sight = chunks.of_frame(frame), chunks.of_frame(first), chunks.of_frame(last)
        if sight != self._sight:
            self._sight = sight
            self._sort()

    def _sort(self) -> None:
        at, first, last = self._sight

        def distance(chunk: int) -> tuple[bool, int]:
            return not (chunk == at or first <= chunk <= last), abs(chunk - at)

        if len(self._waiting) > 1:
            self._waiting.sort(key=distance, reverse=True)

    def work(self, seconds: float | None = None) -> bool:
        """Compute what waits, at least one chunk, until it is done or time is up.

        Returns:
            Whether something is left to do.
        """
        until = None if seconds is None else time.perf_counter() + seconds
        while self._waiting:
            self._compute(self._waiting.pop())
            if until is not None and time.perf_counter() >= until:
                break
        return bool(self._waiting)

    def _compute(self, chunk: int) -> None:
        piece = self._wanted[chunk]
        patch = self._solver.solve(piece)
        rows = self._solver.chunks.slice(chunk)
        self.asked[rows] = patch.asked
        self.achieved[rows] = patch.controls
        self.weights[rows] = patch.weights
        self._note(rows)
        self._shown[chunk] = piece
        differs = (patch.weights != self._solver.tracked[rows]).any(axis=1)
        self._changed[chunk] = int(differs.sum())

    def _note(self, rows: slice) -> None:
        self._changes.append((rows.start, rows.stop))
        self._count += 1

    def changes(self, since: int) -> tuple[int, list[Rows]]:
        """What has changed: for those who keep something that follows from the arrays.

        Args:
            since: the number that the last call gave, 0 at first.

        Returns:
            A number for the next call, and ranges that hold all frames that changed since.
        """
        missed = self._count - since
        if missed > len(self._changes):  # too long ago
            return self._count, [(0, len(self.tracked))]
        found: list[Rows] = []
        for first, last in sorted(islice(reversed(self._changes), missed)):
            if found and first <= found[-1][1]:
                found[-1] = found[-1][0], max(last, found[-1][1])
            else:
                found.append((first, last))
        return self._count, found
