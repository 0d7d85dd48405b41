"""The edited take: edits, undo, and the live result that the window and the export read."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Floats
from faceedit_app.core.controls import CONTROL_IDS
from faceedit_app.core.rig import Rig
from faceedit_app.editing.edits.edit import Edit, Op, read_edits, write_edits
from faceedit_app.editing.edits.media import Placement
from faceedit_app.editing.edits.settings import Settings
from faceedit_app.editing.files.fingerprint import Fingerprint, fingerprint_of
from faceedit_app.editing.solving.live import Live
from faceedit_app.editing.solving.solver import Solver
from faceedit_app.formats.opening import write_take
from faceedit_app.formats.take import Take

if TYPE_CHECKING:  # torch comes with it, and the window is there before torch
    from faceedit_app.networks.engine import Engine


@dataclass(frozen=True)
class EditState:
    """What undo steps through.

    Attributes:
        edits: oldest first.
        settings: how they are answered.
        media: the take's sound and film; None = what lies beside it, as it lies there.
    """

    edits: tuple[Edit, ...] = ()
    settings: Settings = field(default_factory=Settings)
    media: Placement | None = None


class EditSession:
    """One open take and what the user has done to it.

    `tracked`, `asked` and `achieved` are (T, C) mm: the three curves of the plots. `weights` is
    (T, 52) in ARKit order: what the character shows and the export writes. All are live arrays:
    read them, do not keep or change them. `live.patience` says how long a change may take before
    the rest is left to `live.work`.

    `on_finished`, where it is set, hears of every finished gesture, undo and redo (the journal).

    Args:
        take: the open take.
        rig: the character.
        engine: the networks, or None to edit by the rig alone.
    """

    def __init__(self, take: Take, rig: Rig, engine: Engine | None = None) -> None:
        self.take, self.rig = take, rig
        self._solver = Solver(take.clip, rig, engine)
        self._state = EditState()
        self._saved = self._state
        self._undo: list[EditState] = []
        self._redo: list[EditState] = []
        self._floating: tuple[Edit, ...] | None = None
        self.on_finished: Callable[[EditState], None] | None = None
        self.live = Live(self._solver)
        self.tracked, self.asked = self.live.tracked, self.live.asked
        self.achieved, self.weights = self.live.achieved, self.live.weights

    # --- what the user did -----------------------------------------------------------------

    @property
    def edits(self) -> tuple[Edit, ...]:
        """The committed edits, oldest first."""
        return self._state.edits

    @property
    def settings(self) -> Settings:
        """Mode and naturalness."""
        return self._state.settings

    @property
    def can_undo(self) -> bool:
        """Whether there is a step back."""
        return bool(self._undo)

    @property
    def can_redo(self) -> bool:
        """Whether there is a step forward."""
        return bool(self._redo)

    @property
    def has_engine(self) -> bool:
        """Whether the networks answer."""
        return self._solver.engine is not None

    @property
    def is_exported(self) -> bool:
        """Whether the present edits are the ones last exported or saved, and media are saved."""
        return self._state == self._saved

    @property
    def state(self) -> EditState:
        """What has been done, without what floats."""
        return self._state

    @property
    def is_floating(self) -> bool:
        """Whether a gesture is in progress: what is shown is not yet kept."""
        return self._floating is not None

    def preview(self, *edits: Edit | None) -> None:
        """Show the take with more edits that float: a drag in progress. None is no edit."""
        more = tuple(edit for edit in edits if edit is not None)
        self._float(self._state.edits + more if more else None)

    def preview_list(self, edits: Sequence[Edit]) -> None:
        """Show the take with another list of edits: one of them is being changed."""
        self._float(tuple(edits))

    def preview_replace(self, index: int, edit: Edit) -> None:
        """Show the take with another edit in place of one of the list."""
        self.preview_list(self._with(index, edit))

    def commit(self) -> None:
        """Keep what floats as one undo step."""
        if self._floating is not None:
            # It is shown already: nothing has to be computed, or looked for.
            edits, self._floating = self._floating, None
            self._change(replace(self._state, edits=edits), is_shown=True)

    def cancel(self) -> None:
        """Drop what floats."""
        self._float(None)

    def _float(self, edits: tuple[Edit, ...] | None) -> None:
        self._floating = edits
        self._refresh()

    def add(self, *edits: Edit) -> None:
        """Add edits as one undo step."""
        self._change(replace(self._state, edits=self._state.edits + edits))

    def reset(self, start: float, end: float, controls: Sequence[str] = CONTROL_IDS) -> None:
        """Bring controls back to the take as tracked from `start` to `end` seconds."""
        self.add(Edit(tuple(controls), Op.RESET, start, end, 0.0))

    def put(self, edits: Sequence[Edit]) -> None:
        """Have another list of edits, as one undo step."""
        self._change(replace(self._state, edits=tuple(edits)))

    def replace_edit(self, index: int, edit: Edit) -> None:
        """Put another edit in the place of one, as one undo step."""
        self._change(replace(self._state, edits=self._with(index, edit)))

    def set_enabled(self, index: int, enabled: bool) -> None:
        """Switch an edit on or off, as one undo step."""
        self.replace_edit(index, replace(self.edits[index], enabled=enabled))

    def set_strength(self, index: int, strength: float) -> None:
        """Make an edit weaker or stronger (0..1.5), as one undo step."""
        self.replace_edit(index, replace(self.edits[index], strength=strength))

    def rename(self, index: int, name: str) -> None:
        """Call an edit something else, as one undo step; "" is its description again."""
        self.replace_edit(index, replace(self.edits[index], name=name.strip()))

    def remove(self, *indices: int) -> None:
        """Take edits out of the list, as one undo step."""
        gone = {range(len(self.edits))[index] for index in indices}
        kept = tuple(edit for i, edit in enumerate(self.edits) if i not in gone)
        self._change(replace(self._state, edits=kept))

    def move(self, index: int, to: int) -> None:
        """Bring an edit to another place in the list, as one undo step.

        Args:
            index: where it is.
            to: where it is afterwards; beyond an end of the list is that end.
        """
        edits = list(self.edits)
        edit = edits.pop(index)
        edits.insert(max(to, 0), edit)
        self._change(replace(self._state, edits=tuple(edits)))

    def configure(self, settings: Settings) -> None:
        """Answer all edits by other settings, as one undo step."""
        self._change(replace(self._state, settings=settings))

    def place(self, media: Placement) -> None:
        """Have this sound and film, and have them there, as one undo step."""
        self._change(replace(self._state, media=media))

    def begin_with(self, state: EditState) -> None:
        """Start from the state that a project holds: there is nothing before it to go back to."""
        self._undo.clear()
        self._redo.clear()
        self._arrive(state)

    def restore(self, state: EditState) -> None:
        """Go to a state that was kept in a file, as one undo step."""
        self._change(state)

    def undo(self) -> None:
        """Take the last step back."""
        if self._undo:
            self._redo.append(self._state)
            self._arrive(self._undo.pop())

    def redo(self) -> None:
        """Take the step again that was undone last."""
        if self._redo:
            self._undo.append(self._state)
            self._arrive(self._redo.pop())

    def _with(self, index: int, edit: Edit) -> tuple[Edit, ...]:
        edits = list(self.edits)
        edits[index] = edit
        return tuple(edits)

    def _change(self, state: EditState, is_shown: bool = False) -> None:
        """Go to a new state, as one undo step; a step to where one is would be no step."""
        if state != self._state:
            self._undo.append(self._state)
            self._redo.clear()
            self._arrive(state, is_shown)

    def _arrive(self, state: EditState, is_shown: bool = False) -> None:
        self._state, self._floating = state, None
        if not is_shown:
            self._refresh()
        if self.on_finished is not None:
            self.on_finished(state)

    def use_engine(self, engine: Engine) -> None:
        """Answer by these networks from now on (they load after the window is up)."""
        self.live.forget()
        self._solver.use_engine(engine)
        self._refresh()

    # --- what it looks like ----------------------------------------------------------------

    def rig_weights(self, frame: int, tracked: bool = False) -> Floats:
        """(K,) weights of one frame for `Rig.vertices`."""
        source = self._solver.tracked if tracked else self.weights
        return self.rig.from_arkit(source[frame])

    def changed_frames(self) -> int:
        """How many frames differ from the take as tracked."""
        return self.live.changed_frames

    def _refresh(self) -> None:
        edits = self._state.edits if self._floating is None else self._floating
        self.live.show(self._solver.pieces(edits, self._state.settings))

    # --- files -----------------------------------------------------------------------------

    @cached_property
    def fingerprint(self) -> Fingerprint:
        """What tells the take's file, as it was opened, from all others."""
        return fingerprint_of(self.take)

    def clip_weights(self) -> Floats:
        """(T, K) the result in the take's own channels; untouched frames are bit for bit its."""
        self.live.work()
        columns = [ARKIT_INDEX[c] for c in self.take.clip.channels]
        return np.ascontiguousarray(self.weights[:, columns])

    def export(self, path: Path | str) -> None:
        """Write the edited take in its own format.

        Raises:
            FileError: it cannot be written; an existing file is then untouched.
        """
        write_take(path, self.take, self.clip_weights())
        self._mark_exported()

    def mark_saved(self) -> None:
        """What has been done up to now is in a file."""
        self._saved = self._state

    def _mark_exported(self) -> None:
        """The edits are in a file; where sound and film lie is only in projects."""
        self._saved = replace(self._state, media=self._saved.media)

    def save_edits(self, path: Path | str) -> None:
        """Save the edits for `faceedit apply` or for another day."""
        write_edits(path, self.edits)
        self._mark_exported()

    def load_edits(self, path: Path | str) -> None:
        """Add the edits of a file, as one undo step.

        Raises:
            FileError: it is no edits file.
        """
        self.add(*read_edits(path))
