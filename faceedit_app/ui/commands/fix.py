"""Fixes, presets, problems and the clipboard: ordinary edits, made by one command."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QMenu, QWidget

from faceedit_app.core.controls import CONTROL_IDS, SIDED_CONTROLS
from faceedit_app.core.errors import FaceEditError
from faceedit_app.editing.help.presets import (
    Preset,
    delete_preset,
    load_presets,
    save_preset,
    shipped_presets,
)
from faceedit_app.formats.timing import counted
from faceedit_app.ui.commands import dialogs
from faceedit_app.ui.state.document import Document
from faceedit_app.ui.state.timeline import Timeline

if TYPE_CHECKING:
    from faceedit_app.editing.edits.edit import Edit
    from faceedit_app.editing.help.clipboard import Clipboard
    from faceedit_app.ui.page.editor import Editor


class FixCommands(QObject):
    """Makes edits for the user.

    Args:
        editor: the page with the open take, once it is there.
        finish: drops a drag in progress and brings other gestures to their end.

    Signals:
        told(str): what was done, or why nothing was.
    """

    told = Signal(str)

    def __init__(
        self,
        window: QWidget,
        document: Document,
        timeline: Timeline,
        editor: Callable[[], Editor | None],
        finish: Callable[[], None],
    ) -> None:
        super().__init__(window)
        self._window, self._document, self._timeline = window, document, timeline
        self._editor, self._finish = editor, finish
        self._clipboard: Clipboard | None = None

    def handlers(self) -> dict[str, Callable[[], None]]:
        """What to do for each of these `Command.id`s."""
        return {
            **{f"fix_{fix.id}": partial(self.apply, fix) for fix in shipped_presets()},
            "mood": self.mood,
            "save_preset": self.save_preset,
            "previous_problem": lambda: self.step(-1),
            "next_problem": lambda: self.step(1),
            "fix_problem": self.fix_problem,
            "fix_all": self.fix_all,
            "accept_fix": self.accept,
            "discard_fix": self.discard,
            "copy": lambda: self.copy(changes=False),
            "copy_changes": lambda: self.copy(changes=True),
            "paste": lambda: self.paste(mirrored=False),
            "paste_mirrored": lambda: self.paste(mirrored=True),
            "mirror": self.mirror,
        }

    # --- fixes and presets -------------------------------------------------------------------

    def range_meant(self) -> tuple[float, float] | None:
        """The selection; that of an edit in the list only while the playhead is in it."""
        selection, editor = self._timeline.selection, self._editor()
        if selection is None or editor is None or not editor.edits.is_tied:
            return selection
        return selection if selection[0] <= self._timeline.time <= selection[1] else None

    def apply(self, preset: Preset) -> None:
        """Make a preset's edits: one undo step. The last is ready to be weakened."""
        edits = self.edits_of(preset)
        if edits:
            self.add(edits, preset.name)

    def edits_of(self, preset: Preset) -> tuple[Edit, ...]:
        """What a preset would do now."""
        from faceedit_app.editing.help.fixes import apply_preset

        session, line = self._document.session, self._timeline
        if session is None:
            return ()
        self._finish()
        return apply_preset(session, preset, self.range_meant(), line.time, line.falloff)

    def mood(self) -> None:
        """Let a slider from sad to smiling be tried out."""
        from faceedit_app.ui.edits.expression_dialog import MoodDialog

        if self._document.session is None:
            return
        presets = {preset.id: preset for preset in shipped_presets()}
        span = self.range_meant()
        where = "in the whole take" if span is None else f"from {span[0]:.2f} to {span[1]:.2f} s"
        MoodDialog(
            self._window,
            self._document,
            lambda name: self.edits_of(presets[name]),
            where,
            lambda edits: self.add(edits, edits[0].name),
        ).show()

    def add(self, edits: tuple[Edit, ...], name: str, step: str = "") -> None:
        """Make edits as one step; `name` is theirs, and the step's if that has none of its own."""
        self._document.act(lambda session: session.add(*edits, name=step or name))
        editor = self._editor()
        if editor is not None:
            editor.edits.select_new(len(edits))
        start, end = min(e.start for e in edits), max(e.end for e in edits)
        self.told.emit(f"{name}: {start:.2f} to {end:.2f} s; its strength is beside the list")

    def fill_presets(self, menu: QMenu) -> None:
        """List the user's own presets."""
        menu.clear()
        presets, notes = load_presets()
        own = [preset for preset in presets if preset.own]
        for preset in own:
            action = menu.addAction(preset.name)
            action.setToolTip(preset.hint)
            action.triggered.connect(lambda _checked=False, p=preset: self.apply(p))
        if not own:
            menu.addAction("No presets of your own").setEnabled(False)
        for note in notes:
            menu.addAction(note).setEnabled(False)
        if own:
            menu.addSeparator()
            delete = menu.addMenu("Delete")
            for preset in own:
                action = delete.addAction(preset.name)
                action.triggered.connect(lambda _checked=False, p=preset: self._delete(p))

    def save_preset(self) -> None:
        """Keep the edits of the selection, else the edit that is selected, under a name."""
        session = self._document.session
        if session is None:
            return
        self._finish()
        start, end = self._timeline.selection or (0.0, self._timeline.duration)
        name = dialogs.ask_preset_name(self._window)
        if not name:
            return
        try:
            save_preset(name, session.edits, start, end)
        except FaceEditError as error:
            dialogs.show_error(self._window, error)
            return
        self.told.emit(f"Saved the preset “{name}”")

    def _delete(self, preset: Preset) -> None:
        try:
            delete_preset(preset)
        except FaceEditError as error:
            dialogs.show_error(self._window, error)

    # --- problems ----------------------------------------------------------------------------

    def step(self, by: int) -> None:
        """Go to the next problem, or the one before."""
        editor = self._editor()
        if editor is not None:
            index = editor.problems.step(by)
            if index is not None:
                self.go_to(index)

    def go_to(self, index: int) -> None:
        """Show a problem."""
        editor = self._editor()
        if editor is not None:
            editor.proposal.discard()
            editor.problems.go_to(index)
            self.told.emit(editor.problems.problems[index].message)

    def fix_problem(self) -> None:
        """Show what would mend the problem under the playhead."""
        editor = self._editor()
        if editor is None or editor.problems.current is None:
            return
        self._finish()
        problem = editor.problems.problems[editor.problems.current]
        if problem.fix:
            message = f"{problem.message}. Proposed fix is shown."
            editor.proposal.offer(message, problem.fix, "Fix problem")

    def fix_all(self) -> None:
        """Show what would mend all problems."""
        editor = self._editor()
        if editor is None:
            return
        self._finish()
        problems = [problem for problem in editor.problems.problems if problem.fix]
        edits = tuple(edit for problem in problems for edit in problem.fix)
        if edits:
            count = counted(len(problems), "problem")
            editor.proposal.offer(f"Proposed fixes of {count} are shown.", edits, f"Fix {count}")

    def accept(self) -> None:
        """Make what is proposed."""
        editor = self._editor()
        if editor is not None:
            editor.proposal.accept()
            editor.edits.select_new()
            editor.problems.search()

    def discard(self) -> None:
        """Drop what is proposed."""
        editor = self._editor()
        if editor is not None:
            editor.proposal.discard()

    # --- clipboard ---------------------------------------------------------------------------

    def _controls(self) -> tuple[str, ...]:
        """The curves that were chosen, else all."""
        editor = self._editor()
        chosen = editor.curves.chosen_controls if editor is not None else ()
        return chosen or CONTROL_IDS

    def _selection(self, what: str) -> tuple[float, float] | None:
        selection = self._timeline.selection
        if selection is None:
            self.told.emit(f"Select a range of time first, to {what} it")
        return selection

    def copy(self, changes: bool) -> None:
        """Keep what the face does in the selection, or only what the edits changed there."""
        from faceedit_app.editing.help.clipboard import Copied, copy_range

        session, selection = self._document.session, self._selection("copy")
        if session is None or selection is None:
            return
        what = Copied.CHANGE if changes else Copied.CURVE
        copied = copy_range(session, *selection, self._controls(), what)
        if copied.is_empty:
            self.told.emit("There are no changes in the selection")
            return
        self._clipboard = copied
        self.told.emit(f"Copied {copied.seconds:.2f} s of {len(copied.curves)} curves")

    def paste(self, mirrored: bool) -> None:
        """Put what was copied at the playhead."""
        copied = self._clipboard
        if copied is None or self._document.session is None:
            self.told.emit("Nothing was copied yet")
            return
        self._finish()
        names = ("Pasted mirrored", "Paste mirrored") if mirrored else ("Pasted", "Paste")
        self._put(copied.mirrored() if mirrored else copied, self._timeline.time, *names)

    def mirror(self) -> None:
        """Let left and right change places in the selection."""
        from faceedit_app.editing.help.clipboard import Copied, copy_range

        session, selection = self._document.session, self._selection("mirror")
        if session is None or selection is None:
            return
        self._finish()
        copied = copy_range(session, *selection, SIDED_CONTROLS, Copied.CURVE)
        self._put(copied.mirrored(), selection[0], "Mirrored", "Mirror")

    def _put(self, source: Clipboard, at: float, name: str, step: str) -> None:
        edits = source.paste(at, self._timeline.falloff)
        if edits:
            self.add(tuple(replace(edit, name=name) for edit in edits), name, step)
