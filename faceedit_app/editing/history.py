"""What gestures do to the edits of a take: preview, commit, cancel, undo and redo."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Hashable, Sequence
from dataclasses import replace

from psygnal import Signal

from faceedit_app.core.controls import CONTROL_IDS
from faceedit_app.core.fields import clean_text
from faceedit_app.editing.edits.describe import describe, describe_edits
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.edits.media import Placement, sound_moved
from faceedit_app.editing.edits.settings import Settings
from faceedit_app.editing.steps import EditState, Origin, Steps
from faceedit_app.words.transcript import Transcript

# What a project holds of a take.
EDITS, SOUND, FILM, WORDS, RATE = "edits", "sound", "film", "words", "frame rate"


class EditHistory(ABC):
    """The edits of a take, how they came about, and the gesture in progress.

    A gesture calls `preview…` any number of times, then `commit` or `cancel`. Changes by one click
    are committed at once: `add`, `put`, `remove`, `configure` and so on are one step each.

    Signals:
        previewed(): a gesture has changed what is shown.
        changed(): the kept state is shown, after a commit, cancel, undo or redo.
        stepped(EditState): the kept state has changed; sent before `changed`, for the journal.

    Args:
        rate: the take's frame rate, if its file does not say it or is not believed: `Take.fps`.

    Attributes:
        beside: the sound and film found beside the take, which `EditState.media` None stands for.
            A function: they may be found and placed at any time.
    """

    previewed = Signal()
    changed = Signal()
    stepped = Signal(EditState)

    def __init__(self, rate: float | None = None) -> None:
        self._rate = rate
        self._steps = Steps(rate)
        self._saved_rate = rate
        self._origin = Origin(self._steps.state, rate)
        self.beside: Callable[[], Placement] = Placement

    @abstractmethod
    def _show(self, state: EditState) -> None:
        """Show a state of the take; sends no signal."""

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
    def is_saved(self) -> bool:
        """Whether a project holds the edits, sound, film and words; an export does not."""
        return not self.unsaved

    @property
    def unsaved(self) -> tuple[str, ...]:
        """What has changed since it was saved: `EDITS`, with their settings, `SOUND` and so on.

        Without edits there is nothing that the settings could answer, so they can wait.
        """
        state, saved = self.state, self._saved
        settings_count = bool(state.edits or saved.edits)
        old, new = (each.media or self.beside() for each in (saved, state))
        changed = {
            EDITS: state.edits != saved.edits
            or (settings_count and state.settings != saved.settings),
            SOUND: new.sound != old.sound,
            FILM: new.film != old.film,
            WORDS: state.words != saved.words,
            RATE: self._rate != self._saved_rate,
        }
        return tuple(part for part, has_changed in changed.items() if has_changed)

    @property
    def _saved(self) -> EditState:
        """What is in the files."""
        origin = self._origin
        return origin.state if origin.is_saved else _nothing_of(origin.state)

    @property
    def origin(self) -> Origin:
        """Where Undo would lead after a crash and a recovery."""
        return self._origin

    def mark_saved(self) -> None:
        """Note that the present state is saved."""
        self._origin, self._saved_rate = Origin(self.state, self._rate), self._rate
        self._steps.seal()  # so that Undo can return to what is in the file

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
        """Show the take with one edit of the list replaced, or added if it was undone meanwhile."""
        self.preview_list((*self.edits[:index], edit, *self.edits[index:][1:]))

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
            self._show(self._steps.shown)
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
        """Undo the last step, and drop the preview; raises as `travel`."""
        self.travel(-1)

    def redo(self) -> None:
        """Redo the step that was undone last, and drop the preview; raises as `travel`."""
        self.travel(1)

    @property
    def history(self) -> tuple[tuple[str, ...], tuple[str, ...]]:
        """The names of the steps that Undo takes back and of those that Redo repeats, by time."""
        done, undone = self._steps.done, self._steps.undone
        return tuple(step.name for step in done), tuple(step.name for step in reversed(undone))

    def travel(self, steps: int) -> None:
        """Redo some steps, or undo as many if below 0, and drop the preview.

        Raises:
            ValueError: the take has another frame rate there, at which it must be opened first:
                see `rate_after` and `arrive_from`.
        """
        if self._steps.rate_after(steps) != self._rate:
            raise ValueError("the take has another frame rate there")
        move = self._steps.redo if steps > 0 else self._steps.undo
        moved = 0
        while moved < abs(steps) and move():
            moved += 1
        if moved:
            self._arrive()

    def rate_after(self, steps: int) -> float | None:
        """The take's frame rate, as `Take.fps`, after `travel`."""
        return self._steps.rate_after(steps)

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
        """Replace one edit.

        Raises:
            IndexError: there is none at `index`.
        """
        edits = list(self.edits)
        edits[index] = edit
        self.put(edits, name or describe(edit))

    def rename(self, index: int, name: str) -> None:
        """Rename an edit; "" returns it to its description."""
        edit = replace(self.edits[index], name=clean_text(name.strip()))
        self.replace_edit(index, edit, "Rename edit")

    def remove(self, *indices: int, name: str = "") -> None:
        """Delete edits from the list; the step is named after their number, if it has no name."""
        gone = {range(len(self.edits))[index] for index in indices}
        kept = tuple(edit for i, edit in enumerate(self.edits) if i not in gone)
        self.put(kept, name or ("Delete edit" if len(gone) == 1 else f"Delete {len(gone)} edits"))

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

    def recover(self, state: EditState, origin: Origin) -> None:
        """Go to the state of a session that crashed, as one step, whatever was done before.

        Args:
            origin: that of the session, to which Undo goes back.
        """
        self._origin = origin
        self._saved_rate = origin.rate if origin.is_saved else None
        self._steps.begin_with(origin.state)
        if (origin.state, origin.rate) != (state, self._rate):
            self._steps.rate = origin.rate
            self._steps.step_to("Recovery", self._rate, state)
        self._arrive()

    def begin_with(self, state: EditState) -> None:
        """Start from the state of a project, which Undo cannot go behind."""
        self._steps.begin_with(state)
        self._origin = Origin(state, self._rate, is_saved=False)
        self._arrive(is_step=False)

    def continue_from(
        self, other: EditHistory, name: str, change: Callable[[EditState], EditState]
    ) -> None:
        """Go on with the history of the take at another frame rate: this one's is its next step.

        Args:
            other: the session of the take at that rate.
            name: of the step.
            change: what becomes of the present state.
        """
        self._take_over(other)
        self._steps.step_to(name, self._rate, change(other.state))
        self._arrive()

    def arrive_from(self, other: EditHistory, steps: int) -> None:
        """Go on with the history of the take at another frame rate: `travel` from there to here.

        Args:
            other: the session of the take at that rate.
            steps: as of `travel`.
        """
        self._take_over(other)
        self.travel(steps)

    def _take_over(self, other: EditHistory) -> None:
        self._steps.continue_from(other._steps)
        self._saved_rate, self._origin = other._saved_rate, other._origin

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
        self._show(self._steps.shown)
        if is_step:
            self.stepped.emit(self.state)
        self.changed.emit()


def _nothing_of(state: EditState) -> EditState:
    """What counts as saved of a state that is in no file: that it has no sound and film."""
    return EditState(media=state.media) if state.media == Placement() else EditState()
