"""The session: an open take with its edits, and the live result that is shown and exported."""

from __future__ import annotations

import time
from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from psygnal import Signal

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Floats
from faceedit_app.core.atomic import is_same_file, write_atomically
from faceedit_app.core.clip import Clip
from faceedit_app.core.errors import FileError
from faceedit_app.core.rig import Rig
from faceedit_app.editing.edits.edit import MOST_EDITS, Edit, Op
from faceedit_app.editing.files.edits_file import read_edits, write_edits
from faceedit_app.editing.files.fingerprint import (
    Fingerprint,
    fingerprint_of,
    fingerprint_of_content,
)
from faceedit_app.editing.files.originals import make_way
from faceedit_app.editing.history import EditHistory
from faceedit_app.editing.solving.answerable import Lack
from faceedit_app.editing.solving.filled_frames import AllFrames, FilledFrames, filled_frames
from faceedit_app.editing.solving.filled_rows import FilledRows
from faceedit_app.editing.solving.live import Live
from faceedit_app.editing.solving.solver import Solver
from faceedit_app.editing.steps import EditState
from faceedit_app.formats.opening import encoded_take
from faceedit_app.formats.take import LostRows, RoundingSource, Take, have_faces

if TYPE_CHECKING:  # the networks are imported after the window is up
    from faceedit_app.networks.engine import Engine


class EditSession(EditHistory):
    """An open take and its edits.

    `EditHistory` changes the edits; this shows what they do to the take.

    `tracked`, `asked` and `achieved` are (T, C) mm: the three curves of each plot. `weights` is
    (T, 52) in ARKit order: what the character shows and the export writes; `rotations` is (T, 9) as
    in `Clip.rotations`, or None. All are live arrays: read them, but do not keep or change them.
    `live.patience` limits how long a change may take before the rest is left to `live.work`.
    `shown_rig` is the user's character if one is open, else `rig`.

    Args:
        take: the open take.
        rig: the character.
        engine: answers edits; None = the rig alone answers them.

    Signals:
        previewed, changed, stepped: see `EditHistory`; `changed` also follows a change of the
            engine or the character.
        exporting(Fingerprint): the take's own file is about to be replaced by the edited take.

    Attributes:
        exported_over: the fingerprint of what was exported over the take's file, if anything was.
    """

    exporting = Signal(Fingerprint)

    def __init__(self, take: Take, rig: Rig, engine: Engine | None = None) -> None:
        super().__init__(take.fps)
        self.take, self.rig = take, rig
        self.exported_over: Fingerprint | None = None
        self.shown_rig = rig
        self._solver = Solver(take.clip, rig, engine)
        self._filled = FilledRows(self._solver)
        self._answered = self.state  # what the arrays show
        source = take.source
        shows = source.as_written if isinstance(source, RoundingSource) else None
        live = self.live = Live(self._solver, shows)
        self.tracked, self.asked = live.tracked, live.asked
        self.achieved, self.weights, self.rotations = live.achieved, live.weights, live.rotations

    # --- what answers the edits --------------------------------------------------------------

    @property
    def engine(self) -> Engine | None:
        """What answers the edits; None = the rig alone does."""
        return self._solver.engine

    @property
    def has_engine(self) -> bool:
        """Whether an engine answers the edits."""
        return self.engine is not None

    @property
    def closed(self) -> float:
        """Millimetres between the take's closed lips; no edit closes them further."""
        return self._solver.shut

    @property
    def limits(self) -> list[tuple[float, float]]:
        """The lowest and highest value of each control that a face, or this take, can have, mm."""
        return self._solver.limits

    @property
    def lacks(self) -> Mapping[str, Lack]:
        """The curves that the take's channels cannot answer, by control: edits leave them."""
        return self._solver.lacks

    def use_engine(self, engine: Engine) -> None:
        """Answer edits with this engine from now on; it is loaded after the window is up."""
        self.live.forget()
        self._solver.use_engine(engine)
        self._filled.forget()
        self._answer_again()

    def use_character(self, theirs: Rig | None) -> None:
        """Show the user's character from now on, and close lips and lids on it; None = ours."""
        self.shown_rig = self.rig if theirs is None else theirs
        self.live.forget()
        self._solver.use_character(theirs)
        self._filled.forget()
        self._answer_again()

    def _answer_again(self) -> None:
        self._answered = EditState()
        self._show(self._steps.shown)
        self.changed.emit()

    # --- the result ------------------------------------------------------------------------

    @property
    def tracked_weights(self) -> Floats:
        """(T, 52) in ARKit order, as the take came in; do not change them."""
        return self._solver.tracked

    def rig_weights(self, frame: int, tracked: bool = False) -> Floats:
        """(K,) weights of one frame, for `shown_rig.vertices`."""
        source = self._solver.tracked if tracked else self.weights
        return self.shown_rig.from_arkit(source[frame])

    def changed_frames(self) -> int:
        """The number of frames that differ from the take as tracked, with its file's digits.

        Rows that a fill gives a face count as well.
        """
        return self.live.changed_frames + self.count_filled()

    def count_filled(self) -> int:
        """The number of rows without a face that fills give one."""
        if not _has_fills(self.edits):
            return 0
        rows = self.filled_rows()
        return 0 if rows is None else int(have_faces(rows).sum())

    def _show(self, state: EditState) -> None:
        """Update the arrays, unless only media or words have changed."""
        before, self._answered = self._answered, state
        edits, settings = state.edits, state.settings
        if edits != before.edits or settings != before.settings:
            self.live.show(self._solver.tasks(edits, settings))

    # --- files -----------------------------------------------------------------------------

    @cached_property
    def fingerprint(self) -> Fingerprint:
        """The fingerprint of the take's file as it was opened."""
        return fingerprint_of(self.take)

    def clip_weights(self) -> Floats:
        """(T, K) the result in the take's own channels; unedited frames keep their bits."""
        self.live.work()
        columns = [ARKIT_INDEX[c] for c in self.take.clip.channels]
        return np.ascontiguousarray(self.weights[:, columns])

    def edited_clip(self) -> Clip:
        """The take's clip with the edits."""
        turns = self.rotations.copy() if self.rotations is not None else None
        clip, sure = self.take.clip, self.take.clip.confidence
        if sure is not None:
            sure = self.moved(sure)
        return replace(clip, weights=self.clip_weights(), rotations=turns, confidence=sure)

    def moved(self, values: Floats) -> Floats:
        """(T,) values of the frames, such as confidence, at the moments that retimes show."""
        return self._solver.moved(self.edits, values)

    def find_filled(self, seconds: float) -> bool:
        """Find some of the frames for `filled_frames`, for about so many seconds.

        Returns:
            Whether all are found, so that `filled_frames` is quick.
        """
        lost, edits = self.take.lost_rows, self._steps.shown.edits
        if lost is None or not _has_fills(edits):
            return True
        return self._solver.find_some(lost, edits, time.perf_counter() + seconds)

    def filled_frames(self) -> FilledFrames | None:
        """The frames that fills give to gaps, as shown: also those of a preview; None if none."""
        lost, shown = self.take.lost_rows, self._steps.shown
        if lost is None or not _has_fills(shown.edits):
            return None
        measure = self._solver.distances.measure
        rows, asked = self._rows_of(lost, shown)
        return filled_frames(self.take.clip, lost, rows, asked, self.tracked, measure)

    def all_frames(self) -> AllFrames:
        """The take's frames and those that fills give to gaps, as shown: what the face does.

        Its arrays may be live: read them, but do not keep or change them.
        """
        filled = self.filled_frames()
        curves = self.tracked, self.asked, self.achieved
        return AllFrames(self.take.clip, self.weights, *curves).with_filled(filled)

    def filled_rows(self) -> Floats | None:
        """(L, K) the weights that fills give to the take's `lost_rows`, NaN where none does."""
        lost = self.take.lost_rows
        return None if lost is None else self._rows_of(lost, self.state)[0]

    def _rows_of(self, lost: LostRows, state: EditState) -> tuple[Floats, Floats]:
        self.live.work()
        edits, settings = state.edits, state.settings
        return self._filled.find(lost, edits, settings, self.weights, self.asked)

    def export(self, path: Path | str, overwrite: bool = False) -> Path | None:
        """Write the edited take in its own format.

        Args:
            path: the file to write.
            overwrite: allow it to be the take itself, or the take of a project beside it; a copy
                of that recording is then kept.

        Returns:
            The copy, if one was made.

        Raises:
            FileError: it cannot be written, or is such a take; an existing file is then untouched.
        """
        weights, filled = self.clip_weights(), self.filled_rows()
        sure = self.edited_clip().confidence
        content = encoded_take(path, self.take, weights, filled, self.rotations, sure)
        backup = make_way(Path(path), self.take.path, overwrite)
        if is_same_file(Path(path), self.take.path):
            self.exported_over = fingerprint_of_content(content)
            self.exporting.emit(self.exported_over)
        write_atomically(path, content)
        self.seal()  # so that Undo can return to what is in the file
        return backup

    def save_edits(self, path: Path | str) -> Path | None:
        """Save the edits, for `faceedit apply` or for another take.

        Returns:
            The copy that was kept of a file that was no list of edits; None if there was none.

        Raises:
            FileError: the file cannot be written.
        """
        backup = write_edits(path, self.edits)
        self.seal()
        return backup

    def load_edits(self, path: Path | str) -> None:
        """Add the edits of a file as one step.

        Raises:
            FileError: it cannot be read, is not an edits file, or has too many edits.
        """
        edits = read_edits(path)
        if len(self.edits) + len(edits) > MOST_EDITS:
            problem = f"has {len(edits):,} edits, a take can have {MOST_EDITS:,} in all"
            raise FileError(path, problem, "delete some of them")
        self.add(*edits, name="Load edits")


def _has_fills(edits: Iterable[Edit]) -> bool:
    return any(edit.op is Op.FILL for edit in edits)
