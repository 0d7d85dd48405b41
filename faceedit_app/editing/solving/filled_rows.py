"""The weights of rows to which fills give a face, with all that other edits do there.

The take has no frames for these rows. Other edits are therefore answered on a second take, which
has: its frames are those of the take with its fills, and the rows with what the fills put there.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Doubles, Floats, Indices, Times
from faceedit_app.core.rig import Rig
from faceedit_app.editing.edits.edit import OF_THE_TAKE, Edit, Op
from faceedit_app.editing.edits.settings import Mode, Settings
from faceedit_app.editing.solving.recent import Recent
from faceedit_app.editing.solving.request import affected
from faceedit_app.editing.solving.rounding import DECIMALS
from faceedit_app.editing.solving.solver import Solver
from faceedit_app.formats.gaps import find_gaps
from faceedit_app.formats.take import LostRows, RowsBetween, have_faces

# Seconds from a gap's edge within which rows go over into the frames beside it: both takes answer
# an edit there, and not quite in the same way, as one of them has a gap.
_JOINED = 0.1


class FilledRows:
    """Finds these weights for one take.

    Args:
        solver: of the take.
        rig: the character that its curves are measured on.
    """

    def __init__(self, solver: Solver, rig: Rig) -> None:
        self._solver, self._rig = solver, rig
        self._theirs: Rig | None = None
        self._columns = [ARKIT_INDEX[channel] for channel in solver.clip.channels]
        self._seconds = Recent[Solver](1)

    def forget(self) -> None:
        """Forget how edits were answered: the solver has another engine."""
        self._seconds = Recent[Solver](1)

    def use_character(self, theirs: Rig | None) -> None:
        """Close lips and lids on the user's character from now on."""
        self._theirs = theirs
        self.forget()

    def find(
        self, lost: LostRows, edits: Sequence[Edit], settings: Settings, weights: Floats
    ) -> Floats:
        """(L, K) the weights of the rows that fills cover; else NaN.

        Args:
            edits: all that are shown, in the user's order.
            settings: how they are answered.
            weights: (T, 52) the result of the edits on the take's own frames.
        """
        rows = self._solver.found(lost, edits)
        faces = have_faces(rows)
        filled = lost.with_faces(rows, self._solver.clip)
        others = [edit for edit in edits if edit.op not in OF_THE_TAKE]
        if settings.mode is Mode.PRESERVE:  # else any edit reaches everywhere
            others = others if any(_touches(edit, filled.times) for edit in others) else []
        if others and faces.any():
            rows[faces] = self._edited(filled, edits, others, settings, weights)
        if settings.closes:
            rows[faces] = self._solver.closed_on_theirs(rows[faces])
        return rows[:, self._columns]

    def _edited(
        self,
        rows: RowsBetween,
        edits: Sequence[Edit],
        others: Sequence[Edit],
        settings: Settings,
        weights: Floats,
    ) -> Floats:
        """(M, 52) the rows with `others`, which are among `edits`."""
        second = self._second(rows, edits)
        places = rows.before + 1 + np.arange(len(rows))
        tasks = second.tasks(others, settings)
        out = second.tracked.astype(np.float64)
        read = np.unique(np.concatenate([places - 1, places, places + 1]))
        for chunk in {second.chunks.of_frame(int(frame)) for frame in read} & tasks.keys():
            out[second.chunks.slice(chunk)] = second.solve(tasks[chunk]).weights
        _join(out, places, second.clip.times, np.delete(np.arange(len(out)), places), weights)
        found: Floats = np.round(np.clip(out[places], 0.0, 1.0), DECIMALS).astype(np.float32)
        return found

    def _second(self, rows: RowsBetween, edits: Sequence[Edit]) -> Solver:
        """What answers edits on the take that has the rows as frames."""
        clip, places = self._solver.clip, rows.before + 1

        def made() -> Solver:
            weights = self._solver.started(edits)[:, self._columns]
            times = np.insert(clip.times, places, rows.times)
            weights = np.insert(weights, places, rows.weights[:, self._columns], axis=0)
            bare = replace(clip, timecodes=None, rotations=None, confidence=None)
            gaps = find_gaps(times, clip.rate)
            second = replace(bare, weights=weights, times=times, gaps=gaps)
            solver = Solver(second, self._rig, self._solver.engine)
            solver.use_character(self._theirs)
            return solver

        of_the_take = tuple(edit for edit in edits if edit.op in (Op.RESET, *OF_THE_TAKE))
        return self._seconds.to((of_the_take, rows.weights.tobytes()), made)


def _touches(edit: Edit, times: Times) -> bool:
    """Whether an edit can change the face at one of some times."""
    first, last = affected(edit)
    return bool(((times >= first) & (times <= last)).any())


def _join(out: Doubles, places: Indices, times: Times, frames: Indices, weights: Floats) -> None:
    """Let filled rows go over into the frames beside their gap, in `out` (N, 52).

    Args:
        places: of the rows, in order.
        times: (N,) seconds.
        frames: (T,) places of the take's own frames.
        weights: (T, 52) their result.
    """
    for run in np.split(places, np.flatnonzero(np.diff(places) > 1) + 1):
        edges = run[0] - 1, run[-1] + 1
        reach = min(_JOINED, times[edges[1]] - times[edges[0]])
        for edge in edges:
            off = weights[np.searchsorted(frames, edge)] - out[edge]
            share = np.clip(1.0 - np.abs(times[run] - times[edge]) / reach, 0.0, 1.0)
            out[run] += share[:, None] * off
