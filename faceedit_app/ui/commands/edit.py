"""The Edit menu: undo, reset, the clipboard, the list of edits, the selection, the mode."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

from PySide6.QtWidgets import QMenu

from faceedit_app.core.controls import CONTROL_IDS, MAIN_CONTROLS, SIDED_CONTROLS
from faceedit_app.editing.edits.settings import Mode
from faceedit_app.formats.timing import counted
from faceedit_app.ui.commands import conditions as c
from faceedit_app.ui.commands.retime import RetimeCommands
from faceedit_app.ui.commands.splicing import SpliceCommands
from faceedit_app.ui.commands.workspace import Workspace
from faceedit_app.ui.look.texts import name_entry
from faceedit_app.ui.state.actions import Command, Menu

if TYPE_CHECKING:  # the window is there before the solver, and before the page
    from faceedit_app.editing.help.clipboard import Clipboard
    from faceedit_app.ui.edits.panel import EditsPanel

MOST_STEPS = 25  # of the history, before and after the present
NO_FRAME = "There is no frame in the selection to {}; select a longer range"
AROUND = 0.5  # seconds before and after the playhead that are selected


class EditCommands:
    """Acts on the edits of the open take."""

    def __init__(self, workspace: Workspace, may_close: Callable[[], bool]) -> None:
        """Args: `may_close` asks about edits that would be lost."""
        self._workspace = workspace
        self._document, self._timeline = workspace.document, workspace.timeline
        self._clipboard: Clipboard | None = None
        self._undone = self._said = ""  # what was said of an undo or redo, and what was said last
        workspace.message.connect(self._remember_message)
        workspace.document.changed.connect(self._forget_undo)
        self.retime = RetimeCommands(workspace)
        self.splices = SpliceCommands(workspace, may_close)

    # --- undo and reset ----------------------------------------------------------------------

    @property
    def can_undo(self) -> bool:
        """Whether there is a step to undo."""
        session = self._document.session
        return session is not None and session.can_undo

    @property
    def can_redo(self) -> bool:
        """Whether there is a step to redo."""
        session = self._document.session
        return session is not None and session.can_redo

    @property
    def undo_name(self) -> str:
        """Name of the step that Undo undoes."""
        session = self._document.session
        return session.undo_name if session is not None else ""

    @property
    def redo_name(self) -> str:
        """Name of the step that Redo redoes."""
        session = self._document.session
        return session.redo_name if session is not None else ""

    def undo(self) -> None:
        """Undo the last step, or cancel the drag in progress."""
        if not self._workspace.cancel_gesture():
            self._workspace.commit_gestures()
            name, where = self.undo_name, self._place
            self._document.undo()
            if self._place != where:  # a take that is gone cannot be opened at another rate
                self._say("Undid", name)

    def redo(self) -> None:
        """Redo the step that was undone last."""
        if not self._workspace.cancel_gesture():
            self._workspace.commit_gestures()
            name, where = self.redo_name, self._place
            self._document.redo()
            if self._place != where:
                self._say("Redid", name)

    @property
    def _place(self) -> tuple[int, ...]:
        """How many steps can be undone and redone."""
        session = self._document.session
        return () if session is None else tuple(map(len, session.history))

    def _say(self, done: str, name: str) -> None:
        """Say what was done to a step, in place of what was said when it was made."""
        self._undone = f"{done}: {name}" if name else ""
        self._workspace.message.emit(self._undone)

    def _remember_message(self, text: str) -> None:
        self._said = text

    def _forget_undo(self) -> None:
        """Another step was made: what was undone before it is no longer to be said."""
        if self._undone and self._said == self._undone:
            self._workspace.message.emit("")
        self._undone = ""

    def fill_history(self, menu: QMenu) -> None:
        """List the steps, the newest on top; one that is chosen is the last that is kept."""
        menu.clear()
        session = self._document.session
        if session is None:
            return
        done, undone = session.history
        now = len(done)
        names = ("As opened", *done, *undone)
        for step, name in reversed(list(enumerate(names))):
            if not now - MOST_STEPS <= step <= now + MOST_STEPS:
                continue
            action = menu.addAction(name_entry(name))
            action.setStatusTip(name)
            action.setCheckable(True)
            action.setChecked(step == now)
            action.triggered.connect(lambda _checked=False, by=step - now: self.travel(by))

    def travel(self, steps: int) -> None:
        """Redo some steps, or undo as many if below 0."""
        self._workspace.cancel_gesture()
        self._workspace.commit_gestures()
        where = self._place
        self._document.travel(steps)
        if self._place != where:
            self._say("Back to" if steps < 0 else "Forward to", self.undo_name or "As opened")

    @property
    def has_edits(self) -> bool:
        """Whether there is anything to reset."""
        session = self._document.session
        return session is not None and bool(session.edits)

    def reset_range(self) -> None:
        """Reset all curves in the selection, or around the playhead if there is none."""
        self._reset(CONTROL_IDS)

    def reset_curve(self) -> None:
        """Reset the focused curve there."""
        page = self._workspace.page
        control = page.curves.focused_control if page is not None else None
        if control is None:
            self._workspace.message.emit("Click the name of the curve to reset first")
        self._reset((control,) if control else ())

    def _reset(self, controls: tuple[str, ...]) -> None:
        self._workspace.end_gestures()
        session = self._document.session
        if session is not None and session.edits and controls:
            session.reset(*self._range_at_hand(), controls, self._timeline.falloff)

    def _range_at_hand(self) -> tuple[float, float]:
        """The selection, or the playhead with the falloff on either side."""
        line = self._timeline
        if line.selection is not None:
            return line.selection
        return max(line.time - line.falloff, 0.0), min(line.time + line.falloff, line.duration)

    # --- clipboard ---------------------------------------------------------------------------

    def copy(self) -> None:
        """Keep what the face does in the selection."""
        self._copy(only_changes=False)

    def copy_changes(self) -> None:
        """Keep what the edits changed in the selection."""
        self._copy(only_changes=True)

    def _copy(self, only_changes: bool) -> None:
        from faceedit_app.editing.help.clipboard import Copied, copy_range

        session, selection = self._document.session, self._selection("copy")
        if session is None or selection is None:
            return
        # Nothing is copied of folded curves unasked; but their changes are the user's.
        every = CONTROL_IDS if only_changes else self._unfolded
        what = Copied.CHANGE if only_changes else Copied.CURVE
        copied = copy_range(session, *selection, self._chosen_controls() or every, what)
        if copied.is_empty:
            no_change = "The selection has no changes to copy"
            self._workspace.message.emit(no_change if only_changes else NO_FRAME.format("copy"))
            return
        self._clipboard = copied
        seconds, count = copied.seconds, len(copied.curves)
        self._workspace.message.emit(f"Copied {seconds:.2f} s of {counted(count, 'curve')}")

    @property
    def has_range(self) -> bool:
        """Whether a time range is selected, to be copied or retimed."""
        return self._timeline.has_range

    @property
    def has_copied(self) -> bool:
        """Whether there is anything to paste."""
        return self._clipboard is not None

    def paste(self) -> None:
        """Paste what was copied at the playhead."""
        if (copied := self._clipboard) is not None:
            self._put(copied, self._timeline.time, "Pasted", "Paste")

    def paste_mirrored(self) -> None:
        """Paste what was copied at the playhead, with left and right swapped."""
        if (copied := self._clipboard) is not None:
            self._put(copied.mirrored(), self._timeline.time, "Pasted mirrored", "Paste m&irrored")

    def mirror(self) -> None:
        """Swap left and right in the selection."""
        from faceedit_app.editing.help.clipboard import Copied, copy_range

        session, selection = self._document.session, self._selection("mirror")
        if session is None or selection is None:
            return
        self._workspace.end_gestures()
        sided = [control for control in self._unfolded if control in SIDED_CONTROLS]
        copied = copy_range(session, *selection, sided, Copied.CURVE)
        if copied.is_empty:
            self._workspace.message.emit(NO_FRAME.format("mirror"))
        self._put(copied.mirrored(), selection[0], "Mirrored", "Mirror")

    def _selection(self, what: str) -> tuple[float, float] | None:
        selection = self._timeline.selection
        if selection is None or selection[0] == selection[1]:
            self._workspace.message.emit(f"To {what} a time range, select it first")
            return None
        return selection

    @property
    def _unfolded(self) -> tuple[str, ...]:
        """The curves that are not folded away."""
        page = self._workspace.page
        open_group = page.curves.shown.open_group if page is not None else MAIN_CONTROLS
        return tuple(control for control in CONTROL_IDS if control in open_group)

    def _chosen_controls(self) -> tuple[str, ...]:
        """The chosen curves, if any."""
        page = self._workspace.page
        return page.curves.chosen_controls if page is not None else ()

    def _put(self, source: Clipboard, at: float, name: str, step: str) -> None:
        self._workspace.end_gestures()
        edits = source.paste(at, self._timeline.falloff)
        if edits:
            named = tuple(replace(edit, name=name) for edit in edits)
            self._workspace.add_edits(named, name, step)

    # --- the list of edits -------------------------------------------------------------------

    @property
    def has_selected_edit(self) -> bool:
        """Whether an edit is selected in the list."""
        page = self._workspace.page
        return page is not None and page.edits.current is not None

    def can_move(self, by: int) -> bool:
        """Whether the selected edit can be moved up (-1) or down (1) the list."""
        page = self._workspace.page
        row = page.edits.current if page is not None else None
        return page is not None and row is not None and 0 <= row + by < len(page.edits.model.edits)

    @property
    def selected_edits(self) -> str:
        """`edit`, or how many are selected in the list."""
        page = self._workspace.page
        if page is None or not self.has_selected_edit:
            return "edit"
        return page.edits.model.counted(page.edits.rows)

    def on_list(self, work: Callable[[EditsPanel], None]) -> None:
        """Do something with the list of edits, after any gesture in progress has ended."""
        page = self._workspace.page
        if page is not None:
            self._workspace.end_gestures()
            work(page.edits)

    # --- selection and mode ------------------------------------------------------------------

    def select_all(self) -> None:
        """Select the whole take."""
        self._timeline.select((0.0, self._timeline.snap(self._timeline.duration)))

    def select_around(self) -> None:
        """Select a second around the playhead, to be widened or narrowed by its edges."""
        line = self._timeline
        first, last = line.time - AROUND, line.time + AROUND
        line.select((max(first, 0.0), min(last, line.snap(line.duration))))

    def deselect(self) -> None:
        """Cancel the gesture in progress, else close the first steps, else clear the selection."""
        if not self._workspace.cancel_gesture():
            page = self._workspace.page
            if page is not None and page.hints.finish():
                return
            if page is not None:
                page.edits.leave()
                page.curves.setFocus()
            self._timeline.select(None)

    @property
    def mode(self) -> Mode:
        """How the networks' answer is combined with the take."""
        session = self._document.session
        return session.settings.mode if session is not None else Mode.PRESERVE

    def set_mode(self, mode: Mode) -> None:
        """Choose how the networks' answer is combined with the take."""
        self._workspace.end_gestures()
        session = self._document.session
        if session is not None:
            session.configure(replace(session.settings, mode=mode))


TIMING, SELECTED = "&Timing", "Selected e&dit"  # submenus

# fmt: off
MENU: Menu[EditCommands] = Menu("&Edit", (
    Command("undo", "&Undo", EditCommands.undo, ("Ctrl+Z",), "Undo the last step", "undo",
            detail=lambda do: do.undo_name, enabled=c.CAN_UNDO),
    Command("redo", "&Redo", EditCommands.redo, ("Ctrl+Shift+Z", "Ctrl+Y"),
            "Redo the step that was undone last", "redo", detail=lambda do: do.redo_name,
            enabled=c.CAN_REDO),
    Command("history", "&History", fills=EditCommands.fill_history),
    Command("reset_range", "Reset ran&ge", EditCommands.reset_range, ("Ctrl+R",),
            "Go back to the take as tracked, in the selection or around the playhead", "reset",
            enabled=c.HAS_EDITS, starts_group=True),
    Command("reset_curve", "Reset range of this cur&ve", EditCommands.reset_curve,
            ("Ctrl+Shift+R",),
            "Go back to the take as tracked for the focused curve only",
            enabled=c.HAS_EDITS),
    Command("copy", "&Copy range", EditCommands.copy, ("Ctrl+C",),
            "Copy what the face does in the selection", enabled=c.HAS_RANGE, starts_group=True),
    Command("copy_changes", "Copy changes on&ly", EditCommands.copy_changes,
            ("Ctrl+Shift+C",),
            "Copy only what your edits changed in the selection, to add it elsewhere",
            enabled=c.HAS_RANGE),
    Command("paste", "&Paste at playhead", EditCommands.paste, ("Ctrl+V",),
            "Paste what was copied at the playhead", enabled=c.HAS_COPIED),
    Command("paste_mirrored", "Paste m&irrored", EditCommands.paste_mirrored, ("Ctrl+Shift+V",),
            "Paste what was copied at the playhead, with left and right swapped",
            enabled=c.HAS_COPIED),
    Command("mirror", "&Mirror range", EditCommands.mirror, ("Ctrl+Shift+M",),
            "Swap left and right in the selection", enabled=c.HAS_RANGE),
    Command("stretch_time", "&Stretch…", lambda do: do.retime.stretch(), ("Shift+W",),
            "Make the selection longer or shorter; what follows makes up for it and keeps its time",
            enabled=c.HAS_RANGE, starts_group=True, submenu=TIMING),
    Command("move_time", "Mo&ve in time…", lambda do: do.retime.move(),
            tip="Show the selection earlier or later; what is beside it makes up for it",
            enabled=c.HAS_RANGE, submenu=TIMING),
    Command("cut_time", "Cut out of ti&me", lambda do: do.retime.cut(),
            tip="Leave out the selection; what follows plays slower until it has caught up",
            enabled=c.HAS_RANGE, submenu=TIMING),
    Command("insert_pause", "Insert a pa&use…", lambda do: do.retime.pause(),
            tip="Hold the face at the playhead; what follows plays faster until it has caught up",
            submenu=TIMING),
    Command("cut_shorter", "Cut out and s&horten…", lambda do: do.splices.shorten(),
            tip="Write a new take without the selection, with its sound and film",
            enabled=c.HAS_RANGE, starts_group=True, submenu=TIMING),
    Command("insert_longer", "Insert time and &lengthen…", lambda do: do.splices.lengthen(),
            tip="Write a new take with more time at the playhead, with its sound and film",
            submenu=TIMING),
    Command("toggle_edit", "Switch edit &on / off",
            lambda do: do.on_list(lambda edits: edits.toggle()), ("E",),
            "Switch the selected edit on or off",
            enabled=c.HAS_SELECTED_EDIT, starts_group=True, submenu=SELECTED),
    Command("rename_edit", "Re&name edit",
            lambda do: do.on_list(lambda edits: edits.rename()), ("F2",),
            "Rename the selected edit",
            enabled=c.HAS_SELECTED_EDIT, submenu=SELECTED),
    Command("edit_up", "Move edit up", lambda do: do.on_list(lambda edits: edits.move_edit(-1)),
            ("Alt+Up",), "Move the selected edit up the list, to apply it earlier",
            enabled=c.CAN_MOVE_UP, submenu=SELECTED),
    Command("edit_down", "Move edit down", lambda do: do.on_list(lambda edits: edits.move_edit(1)),
            ("Alt+Down",), "Move the selected edit down the list, to apply it later",
            enabled=c.CAN_MOVE_DOWN, submenu=SELECTED),
    Command("delete_edit", "&Delete",
            lambda do: do.on_list(lambda edits: edits.delete()), ("Del",),
            "Delete the selected edits", "trash", detail=lambda do: do.selected_edits,
            enabled=c.HAS_SELECTED_EDIT, submenu=SELECTED),
    Command("select_all", "Select &all", EditCommands.select_all, ("Ctrl+A",),
            "Select the whole take", starts_group=True),
    Command("select_around", "Select around the pla&yhead", EditCommands.select_around,
            tip="Select a second around the playhead; its edges can be dragged"),
    Command("deselect", "D&eselect", EditCommands.deselect, ("Esc",),
            "Cancel the drag in progress, or leave the chosen edit and clear the selection"),
    Command("preserve", "Preserve the ta&ke", lambda do: do.set_mode(Mode.PRESERVE),
            tip="Change only the frames and curves that your edits affect",
            checked=lambda do: do.mode is Mode.PRESERVE, starts_group=True),
    Command("resynthesize", "Re&synthesize", lambda do: do.set_mode(Mode.RESYNTHESIZE),
            tip="Generate the edited regions of the face for the whole take",
            checked=lambda do: do.mode is Mode.RESYNTHESIZE),
))
# fmt: on
