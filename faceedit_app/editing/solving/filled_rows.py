"""Rows to which fills give a face, with all that other edits do there.

The take has no frames for these rows. Other edits are therefore answered on a second take, which
has: its frames are those of the take with its fills, and the rows with what the fills put there.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Doubles, Floats, Indices, Times
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
    """

    def __init__(self, solver: Solver) -> None:
        self._solver = solver
        self._columns = [ARKIT_INDEX[channel] for channel in solver.clip.channels]
        self._second_takes = Recent[Solver](1)

    def forget(self) -> None:
        """Forget how edits were answered: the solver has another engine or character."""
        self._second_takes = Recent[Solver](1)

    def find(
        self,
        lost: LostRows,
        edits: Sequence[Edit],
        settings: Settings,
        weights: Floats,
        asked: Floats,
    ) -> tuple[Floats, Floats]:
        """The rows that fills cover: (L, K) their weights, and (L, C) mm asked for; else NaN.

        Args:
            edits: all that are shown, in the user's order.
            settings: how they are answered.
            weights: (T, 52) the result of the edits on the take's own frames.
            asked: (T, C) mm, what they ask for there.
        """
        rows = self._solver.found(lost, edits)
        wanted = np.full((len(rows), asked.shape[1]), np.nan, np.float32)
        faces, filled = have_faces(rows), lost.with_faces(rows, self._solver.clip)
        if not faces.any():
            return rows[:, self._columns], wanted
        others = [edit for edit in edits if edit.op not in OF_THE_TAKE]
        if settings.mode is Mode.PRESERVE:  # else any edit reaches everywhere
            others = others if any(_touches(edit, filled.times) for edit in others) else []
        if others:
            found = self._edited(filled, edits, others, settings, weights, asked)
            rows[faces], wanted[faces] = found
        else:  # a fill asks for what it puts there
            wanted[faces] = self._solver.distances.measure(rows[faces])
        if settings.closes:
            rows[faces] = self._solver.closed_on_theirs(rows[faces])
        return rows[:, self._columns], wanted

    def _edited(
        self,
        rows: RowsBetween,
        edits: Sequence[Edit],
        others: Sequence[Edit],
        settings: Settings,
        weights: Floats,
        asked: Floats,
    ) -> tuple[Floats, Floats]:
        """(M, 52) the rows with `others`, which are among `edits`; and (M, C) mm asked for."""
        second = self._second(rows, edits)
        places = rows.before + 1 + np.arange(len(rows))
        tasks = second.tasks(others, settings)
        out, wanted = (each.astype(np.float64) for each in (second.tracked, second.controls))
        read = np.unique(np.concatenate([places - 1, places, places + 1]))
        for chunk in {second.chunks.of_frame(int(frame)) for frame in read} & tasks.keys():
            own, patch = second.chunks.slice(chunk), second.solve(tasks[chunk])
            out[own], wanted[own] = patch.weights, patch.asked
        _join(out, places, second.clip.times, weights)
        _join(wanted, places, second.clip.times, asked)
        found = np.round(np.clip(out[places], 0.0, 1.0), DECIMALS)
        return found.astype(np.float32), wanted[places].astype(np.float32)

    def _second(self, rows: RowsBetween, edits: Sequence[Edit]) -> Solver:
        """What answers edits on the take that has the rows as frames."""

        def made() -> Solver:
            clip, start = self._solver.clip, self._solver.started(edits)
            times = np.insert(clip.times, rows.before + 1, rows.times)
            weights = np.insert(start, rows.before + 1, rows.weights, axis=0)[:, self._columns]
            bare = replace(clip, timecodes=None, rotations=None, confidence=None)
            gaps = find_gaps(times, clip.rate)
            return self._solver.on(replace(bare, weights=weights, times=times, gaps=gaps))

        of_the_take = tuple(edit for edit in edits if edit.op in (Op.RESET, *OF_THE_TAKE))
        return self._second_takes.to((of_the_take, rows.weights.tobytes()), made)


def _touches(edit: Edit, times: Times) -> bool:
    """Whether an edit can change the face at one of some times."""
    first, last = affected(edit)
    return bool(((times >= first) & (times <= last)).any())


def _join(out: Doubles, places: Indices, times: Times, beside: Floats) -> None:
    """Let filled rows go over into the frames beside their gap, in `out` (N, K).

    Args:
        places: of the M rows among the N frames, in order.
        times: (N,) seconds.
        beside: (N - M, K) the values of the other frames.
    """
    for run in np.split(places, np.flatnonzero(np.diff(places) > 1) + 1):
        edges = run[0] - 1, run[-1] + 1
        reach = min(_JOINED, times[edges[1]] - times[edges[0]])
        for edge in edges:
            off = beside[edge - np.searchsorted(places, edge)] - out[edge]
            share = np.clip(1.0 - np.abs(times[run] - times[edge]) / reach, 0.0, 1.0)
            out[run] += share[:, None] * off
