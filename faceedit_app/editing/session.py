"""The edited take: edits, undo, and the live result that the window and the export read."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.clip import Floats
from faceedit_app.core.regions import CONTROL_IDS
from faceedit_app.core.rig import Rig
from faceedit_app.editing.edit import Edit, Op, read_edits, write_edits
from faceedit_app.editing.solve import Island, Patch, Settings, Solver
from faceedit_app.formats.opening import write_take
from faceedit_app.formats.take import Take

if TYPE_CHECKING:  # torch comes with it, and the window is there before torch
    from faceedit_app.networks.engine import Engine


@dataclass(frozen=True)
class EditState:
    """What undo steps through: the edits and how they are answered."""

    edits: tuple[Edit, ...] = ()
    settings: Settings = field(default_factory=Settings)


class EditSession:
    """One open take and what the user has done to it.

    `tracked`, `asked` and `achieved` are (T, 8) mm: the three curves of the plots. `weights` is
    (T, 52) in ARKit order: what the character shows and the export writes. All are live arrays:
    read them, do not keep or change them.

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
        self._floating: Edit | None = None
        self._shown: dict[tuple[object, ...], Island] = {}
        self._patches: dict[tuple[object, ...], Patch] = {}
        self.tracked = self._solver.controls
        self.asked = self.tracked.copy()
        self.achieved = self.tracked.copy()
        self.weights = self._solver.tracked.copy()

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
        """Whether the present edits are the ones last exported or saved."""
        return self._state == self._saved

    def preview(self, edit: Edit | None) -> None:
        """Show the take with one more edit that floats: a drag in progress."""
        self._floating = edit
        self._refresh()

    def commit(self) -> None:
        """Keep the floating edit as one undo step."""
        if self._floating is not None:
            edit, self._floating = self._floating, None
            self.add(edit)

    def cancel(self) -> None:
        """Drop the floating edit."""
        self.preview(None)

    def add(self, *edits: Edit) -> None:
        """Add edits as one undo step."""
        self._change(replace(self._state, edits=self._state.edits + edits))

    def reset(self, start: float, end: float, controls: Sequence[str] = CONTROL_IDS) -> None:
        """Bring controls back to the take as tracked from `start` to `end` seconds."""
        self.add(Edit(tuple(controls), Op.RESET, start, end, 0.0))

    def configure(self, settings: Settings) -> None:
        """Answer all edits by other settings, as one undo step."""
        if settings != self._state.settings:
            self._change(replace(self._state, settings=settings))

    def undo(self) -> None:
        """Take the last step back."""
        if self._undo:
            self._redo.append(self._state)
            self._state = self._undo.pop()
            self._refresh()

    def redo(self) -> None:
        """Take the step again that was undone last."""
        if self._redo:
            self._undo.append(self._state)
            self._state = self._redo.pop()
            self._refresh()

    def _change(self, state: EditState) -> None:
        self._undo.append(self._state)
        self._redo.clear()
        self._state = state
        self._refresh()

    def use_engine(self, engine: Engine) -> None:
        """Answer by these networks from now on (they load after the window is up)."""
        self._solver.engine = engine
        self._patches.clear()
        self._show([])
        self._refresh()

    # --- what it looks like ----------------------------------------------------------------

    def rig_weights(self, frame: int, tracked: bool = False) -> Floats:
        """(K,) weights of one frame for `Rig.vertices`."""
        source = self._solver.tracked if tracked else self.weights
        return self.rig.from_arkit(source[frame])

    def changed_frames(self) -> int:
        """How many frames differ from the take as tracked."""
        rows = [island.rows for island in self._shown.values()]
        return sum(
            int((self.weights[r] != self._solver.tracked[r]).any(axis=1).sum()) for r in rows
        )

    def _refresh(self) -> None:
        floating = () if self._floating is None else (self._floating,)
        self._show(self._solver.islands(self._state.edits + floating, self._state.settings))

    def _show(self, islands: list[Island]) -> None:
        """Make the live arrays show these islands and the tracked take between them."""
        wanted = {island.key: island for island in islands}
        for key in [key for key in self._shown if key not in wanted]:
            rows = self._shown.pop(key).rows
            self.asked[rows] = self.achieved[rows] = self.tracked[rows]
            self.weights[rows] = self._solver.tracked[rows]
        patches = {}
        for key, island in wanted.items():
            patch = patches[key] = self._patches.get(key) or self._solver.solve(island)
            # Islands never overlap, but one that went may have lain under one that stays.
            self.asked[island.rows] = patch.asked
            self.achieved[island.rows] = patch.controls
            self.weights[island.rows] = patch.weights
        self._shown, self._patches = wanted, patches

    # --- files -----------------------------------------------------------------------------

    def clip_weights(self) -> Floats:
        """(T, K) the result in the take's own channels; untouched frames are bit for bit its."""
        columns = [ARKIT_INDEX[c] for c in self.take.clip.channels]
        return np.ascontiguousarray(self.weights[:, columns])

    def export(self, path: Path | str) -> None:
        """Write the edited take in its own format.

        Raises:
            FileError: it cannot be written; an existing file is then untouched.
        """
        write_take(path, self.take, self.clip_weights())
        self._saved = self._state

    def save_edits(self, path: Path | str) -> None:
        """Save the edits for `faceedit apply` or for another day."""
        write_edits(path, self.edits)
        self._saved = self._state

    def load_edits(self, path: Path | str) -> None:
        """Add the edits of a file, as one undo step.

        Raises:
            FileError: it is no edits file.
        """
        self.add(*read_edits(path))
