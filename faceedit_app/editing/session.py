"""The session: what gestures do to a take, and the live result that is shown and exported."""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from psygnal import Signal

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Floats
from faceedit_app.core.atomic import write_atomically
from faceedit_app.core.clip import Clip
from faceedit_app.core.controls import CONTROL_IDS
from faceedit_app.core.errors import FileError
from faceedit_app.core.fields import clean_text
from faceedit_app.core.rig import Rig
from faceedit_app.editing.edits.describe import describe, describe_edits
from faceedit_app.editing.edits.edit import MOST_EDITS, Edit, Op
from faceedit_app.editing.edits.media import Placement, sound_moved
from faceedit_app.editing.edits.settings import Settings
from faceedit_app.editing.files.edits_file import read_edits, write_edits
from faceedit_app.editing.files.fingerprint import (
    Fingerprint,
    fingerprint_of,
    fingerprint_of_content,
    is_same_file,
)
from faceedit_app.editing.files.originals import make_way
from faceedit_app.editing.solving.answerable import Lack
from faceedit_app.editing.solving.live import Live
from faceedit_app.editing.solving.solver import Solver
from faceedit_app.editing.steps import EditState, Steps
from faceedit_app.formats.opening import encoded_take
from faceedit_app.formats.take import Take
from faceedit_app.words.transcript import Transcript

if TYPE_CHECKING:  # the networks are imported after the window is up
    from faceedit_app.networks.engine import Engine


class EditSession:
    """An open take and its edits.

    A gesture calls `preview…` any number of times, then `commit` or `cancel`. Changes by one click
    are committed at once: `add`, `put`, `remove`, `configure` and so on are one step each.

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
        previewed(): a gesture has changed what is shown.
        changed(): the kept state is shown, after a commit, cancel, undo or redo, or after the
            engine has changed.
        stepped(EditState): the kept state has changed; sent before `changed`, for the journal.
        exporting(Fingerprint): the take's own file is about to be replaced by the edited take.

    Attributes:
        exported_over: the fingerprint of what was exported over the take's file, if anything was.
    """

    previewed = Signal()
    changed = Signal()
    stepped = Signal(EditState)
    exporting = Signal(Fingerprint)

    def __init__(self, take: Take, rig: Rig, engine: Engine | None = None) -> None:
        self.take, self.rig = take, rig
        self.exported_over: Fingerprint | None = None
        self.shown_rig = rig
        self._solver = Solver(take.clip, rig, engine)
        self._steps = Steps()
        self._saved = self._computed = self._steps.state
        live = self.live = Live(self._solver)
        self.tracked, self.asked = live.tracked, live.asked
        self.achieved, self.weights, self.rotations = live.achieved, live.weights, live.rotations

    # --- the kept state ----------------------------------------------------------------------

    @property
    def state(self) -> EditState:
        """The kept state, without a preview."""
        return self._steps.state

    @property
    def edits(self) -> tuple[Edit, ...]:
        """The committed edits, oldest first."""
        return self.state.edits

    @property
    def settings(self) -> Settings:
        """Mode, naturalness and reach."""
        return self.state.settings

    @property
    def words(self) -> Transcript | None:
        """What is said in the take as shown, in its seconds; None if the user has not said."""
        return self._steps.shown.words

    @property
    def has_engine(self) -> bool:
        """Whether an engine answers the edits."""
        return self._solver.engine is not None

    @property
    def limits(self) -> list[tuple[float, float]]:
        """The lowest and highest value of each control that a face, or this take, can have, mm."""
        return self._solver.limits

    @property
    def lacks(self) -> Mapping[str, Lack]:
        """The curves that the take's channels cannot answer, by control: edits leave them."""
        return self._solver.lacks

    @property
    def is_saved(self) -> bool:
        """Whether a project holds the edits, sound and film; an export does not."""
        return self.state == self._saved

    # --- gestures ----------------------------------------------------------------------------

    @property
    def is_previewing(self) -> bool:
        """Whether a gesture is in progress."""
        return self._steps.preview is not None

    def preview(self, *edits: Edit | None) -> None:
        """Show the take with further edits, as a drag does; None is ignored, no edit cancels."""
        more = tuple(edit for edit in edits if edit is not None)
        if more:
            self.preview_list(self.edits + more)
        else:
            self.cancel()

    def preview_list(self, edits: Sequence[Edit]) -> None:
        """Show the take with another list of edits."""
        self._preview(replace(self.state, edits=tuple(edits)))

    def preview_replace(self, index: int, edit: Edit) -> None:
        """Show the take with one edit of the list replaced."""
        self.preview_list(self._with(index, edit))

    def preview_settings(self, settings: Settings) -> None:
        """Show the take with other settings."""
        self._preview(replace(self.state, settings=settings))

    def preview_media(self, media: Placement) -> None:
        """Show the take with this sound and film; the words move with the sound."""
        self._preview(self._with_media(media))

    def preview_words(self, words: Transcript) -> None:
        """Show the take with these words."""
        self._preview(replace(self.state, words=words))

    def commit(self, name: str = "", merge: Hashable = None) -> None:
        """Keep the preview as one step.

        Args:
            name: the step's name, which Undo shows; by default that of the edits that it adds.
            merge: extends the last step if it had the same key and nothing happened between.
        """
        if self._steps.preview is not None:
            self._change(self._steps.preview, name, merge)

    def extends(self, merge: Hashable) -> bool:
        """Whether a commit with this merge key would extend the last step."""
        return self._steps.extends(merge)

    def seal(self) -> None:
        """Let no later commit extend the last step."""
        self._steps.seal()

    def cancel(self) -> bool:
        """Drop the preview; False if there is none."""
        was_previewing = self._steps.cancel()
        if was_previewing:
            self._arrive(is_step=False)
        return was_previewing

    def _preview(self, state: EditState) -> None:
        if self._steps.show(state):
            self._compute()
            self.previewed.emit()

    # --- undo --------------------------------------------------------------------------------

    @property
    def can_undo(self) -> bool:
        """Whether there is a step to undo."""
        return bool(self._steps.done)

    @property
    def can_redo(self) -> bool:
        """Whether there is a step to redo."""
        return bool(self._steps.undone)

    @property
    def undo_name(self) -> str:
        """The name of the step that Undo takes back; empty if there is none."""
        return self._steps.done[-1].name if self.can_undo else ""

    @property
    def redo_name(self) -> str:
        """The name of the step that Redo repeats; empty if there is none."""
        return self._steps.undone[-1].name if self.can_redo else ""

    def undo(self) -> None:
        """Undo the last step, and drop the preview."""
        if self._steps.undo():
            self._arrive()

    def redo(self) -> None:
        """Redo the step that was undone last, and drop the preview."""
        if self._steps.redo():
            self._arrive()

    @property
    def history(self) -> tuple[tuple[str, ...], tuple[str, ...]]:
        """The names of the steps that Undo takes back and of those that Redo repeats, by time."""
        done, undone = self._steps.done, self._steps.undone
        return tuple(step.name for step in done), tuple(step.name for step in reversed(undone))

    def travel(self, steps: int) -> None:
        """Redo some steps, or undo as many if below 0, and drop the preview."""
        move = self._steps.redo if steps > 0 else self._steps.undo
        moved = 0
        while moved < abs(steps) and move():
            moved += 1
        if moved:
            self._arrive()

    # --- one click, one step; by default it is named after the edits that it adds ------------

    def add(self, *edits: Edit, name: str = "") -> None:
        """Add edits."""
        self.put(self.edits + edits, name)

    def reset(
        self,
        start: float,
        end: float,
        controls: Sequence[str] = CONTROL_IDS,
        falloff: float = 0.0,
    ) -> None:
        """Bring curves back to the take as tracked, from `start` to `end` seconds."""
        self.add(Edit(tuple(controls), Op.RESET, start, end, falloff), name="Reset range")

    def put(self, edits: Sequence[Edit], name: str = "", merge: Hashable = None) -> None:
        """Replace the list of edits."""
        self._change(replace(self.state, edits=tuple(edits)), name, merge)

    def replace_edit(self, index: int, edit: Edit, name: str = "") -> None:
        """Replace one edit."""
        self.put(self._with(index, edit), name or describe(edit))

    def set_enabled(self, index: int, enabled: bool) -> None:
        """Switch an edit on or off."""
        edit = replace(self.edits[index], enabled=enabled)
        self.replace_edit(index, edit, "Switch edit on" if enabled else "Switch edit off")

    def rename(self, index: int, name: str) -> None:
        """Rename an edit; "" returns it to its description."""
        edit = replace(self.edits[index], name=clean_text(name.strip()))
        self.replace_edit(index, edit, "Rename edit")

    def remove(self, *indices: int) -> None:
        """Delete edits from the list."""
        gone = {range(len(self.edits))[index] for index in indices}
        kept = tuple(edit for i, edit in enumerate(self.edits) if i not in gone)
        self.put(kept, "Delete edit" if len(gone) == 1 else f"Delete {len(gone)} edits")

    def move(self, index: int, to: int) -> None:
        """Move an edit to another place in the list.

        Args:
            index: its present place.
            to: its new place; beyond an end of the list means that end.
        """
        edits = list(self.edits)
        edit = edits.pop(index)
        edits.insert(max(to, 0), edit)
        self.put(edits, "Move edit")

    def configure(self, settings: Settings, merge: Hashable = None) -> None:
        """Change the settings that all edits are answered by."""
        name = self.settings.describe_change(settings)
        self._change(replace(self.state, settings=settings), name, merge)

    def place(self, media: Placement, name: str = "Sound and film", merge: Hashable = None) -> None:
        """Set sound and film of the take, and when they begin; the words move with the sound."""
        self._change(self._with_media(media), name, merge)

    def say(self, words: Transcript | None, media: Placement | None = None) -> None:
        """Set the words of the take, or remove them.

        Args:
            media: where sound and film lie now, so that the words move with the sound from now on.
        """
        name = "Words" if words is not None else "Remove words"
        self._change(replace(self.state, words=words, media=media or self.state.media), name)

    def restore(self, state: EditState, name: str = "Recovery") -> None:
        """Go to another state, such as one from a file, as one step."""
        self._change(state, name)

    def begin_with(self, state: EditState) -> None:
        """Start from the state of a project, which Undo cannot go behind."""
        self._steps.begin_with(state)
        self._arrive(is_step=False)

    def use_engine(self, engine: Engine) -> None:
        """Answer edits with this engine from now on; it is loaded after the window is up."""
        self.live.forget()
        self._solver.use_engine(engine)
        self._computed = EditState()
        self._compute()
        self.changed.emit()

    def use_character(self, theirs: Rig | None) -> None:
        """Show the user's character from now on, and close lips and lids on it; None = ours."""
        self.shown_rig = self.rig if theirs is None else theirs
        self.live.forget()
        self._solver.use_character(theirs)
        self._computed = EditState()
        self._compute()
        self.changed.emit()

    def _with(self, index: int, edit: Edit) -> tuple[Edit, ...]:
        return (*self.edits[:index], edit, *self.edits[index:][1:])

    def _with_media(self, media: Placement) -> EditState:
        words = self.state.words
        if words is not None and self.state.media is not None:
            words = words.shifted(sound_moved(self.state.media, media))
        return replace(self.state, media=media, words=words)

    def _change(self, state: EditState, name: str, merge: Hashable = None) -> None:
        """Preview and commit at once, with one signal."""
        added = state.edits[len(self.edits) :] or state.edits[-1:]
        was_previewing = self.is_previewing
        self._steps.show(state)
        is_step = self._steps.commit(name or describe_edits(added), merge)
        if is_step or was_previewing:
            self._arrive(is_step)

    def _arrive(self, is_step: bool = True) -> None:
        """Show the kept state and send the signals."""
        self._compute()
        if is_step:
            self.stepped.emit(self.state)
        self.changed.emit()

    # --- the result ------------------------------------------------------------------------

    def rig_weights(self, frame: int, tracked: bool = False) -> Floats:
        """(K,) weights of one frame, for `shown_rig.vertices`."""
        source = self._solver.tracked if tracked else self.weights
        return self.shown_rig.from_arkit(source[frame])

    def changed_frames(self) -> int:
        """The number of frames that differ from the take as tracked."""
        return self.live.changed_frames

    def _compute(self) -> None:
        """Update the arrays to the shown state, unless only media or words have changed."""
        before, self._computed = self._computed, self._steps.shown
        edits, settings = self._computed.edits, self._computed.settings
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
        return replace(self.take.clip, weights=self.clip_weights(), rotations=turns)

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
        weights, lost = self.clip_weights(), self.take.lost_rows
        found = self._solver.found(lost, self.edits, self.weights) if lost is not None else None
        content = encoded_take(path, self.take, weights, found, self.rotations)
        backup = make_way(Path(path), self.take.path, overwrite)
        if is_same_file(Path(path), self.take.path):
            self.exported_over = fingerprint_of_content(content)
            self.exporting.emit(self.exported_over)
        write_atomically(path, content)
        self._steps.seal()  # so that Undo can return to what is in the file
        return backup

    def mark_saved(self) -> None:
        """Note that the present state is saved."""
        self._saved = self.state
        self._steps.seal()  # so that Undo can return to what is in the file

    def save_edits(self, path: Path | str) -> None:
        """Save the edits, for `faceedit apply` or for another take.

        Raises:
            FileError: the file cannot be written.
        """
        write_edits(path, self.edits)
        self._steps.seal()

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
