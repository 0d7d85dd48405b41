"""The View and Help menus, the tools, and what is done with the list of edits."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

from PySide6.QtWidgets import QWidget

from faceedit_app.ui.commands.help import about_dialog, shortcuts_dialog
from faceedit_app.ui.edits.panel import EditsPanel
from faceedit_app.ui.state.actions import Actions
from faceedit_app.ui.state.clock import Clock, Unit
from faceedit_app.ui.state.preferences import Preferences
from faceedit_app.ui.state.tools import Tool, Tools

if TYPE_CHECKING:
    from faceedit_app.core.rig import Rig
    from faceedit_app.ui.page.editor import Editor


class ViewCommands:
    """Acts on the page with the open take, once it is there.

    Args:
        editor: that page.
        rig: the character, once it is loaded.
        finish: brings gestures elsewhere in the window to their end.
        preferences: remembers what is chosen until the next start.
    """

    def __init__(
        self,
        window: QWidget,
        tools: Tools,
        clock: Clock,
        editor: Callable[[], Editor | None],
        rig: Callable[[], Rig | None],
        finish: Callable[[], None],
        preferences: Preferences,
    ) -> None:
        self._window, self._tools, self._clock = window, tools, clock
        self._editor, self._rig, self._finish = editor, rig, finish
        self._preferences = preferences

    def handlers(self) -> dict[str, Callable[[], None]]:
        """What to do for each of these `Command.id`s."""
        return {
            **{f"tool_{tool}": partial(self._tools.choose, tool) for tool in Tool},
            **{f"unit_{unit}": partial(self._clock.choose, unit) for unit in Unit},
            "link": lambda: self._tools.link(not self._tools.linked),
            "toggle_edit": self._on_edits(EditsPanel.toggle),
            "rename_edit": self._on_edits(EditsPanel.rename),
            "edit_up": self._on_edits(lambda edits: edits.bring(-1)),
            "edit_down": self._on_edits(lambda edits: edits.bring(1)),
            "delete_edit": self._on_edits(EditsPanel.delete),
            "reset_camera": self._with(lambda editor: editor.face.viewport.reset_camera()),
            "go_to": self._with(lambda editor: editor.transport.type_time()),
            "focus_face": self._with(lambda editor: editor.face.viewport.setFocus()),
            "show_edited": self._with(lambda editor: editor.face.set_tracked(False)),
            "show_tracked": self._with(
                lambda editor: editor.face.set_tracked(not editor.face.shows_tracked)
            ),
            "show_both": self._with(lambda editor: editor.face.show_both()),
            "show_difference": self._with(self._toggle_difference),
            "first_steps": self._with(lambda editor: editor.hints.begin()),
            "shortcuts": lambda: shortcuts_dialog(self._window).show(),
            "about": self._about,
        }

    def _with(self, work: Callable[[Editor], None]) -> Callable[[], None]:
        """Something to do with the page, once it is there."""

        def do() -> None:
            editor = self._editor()
            if editor is not None:
                work(editor)

        return do

    def _on_edits(self, work: Callable[[EditsPanel], None]) -> Callable[[], None]:
        """Something to do with the list of edits, when nothing else is in progress."""

        def do(editor: Editor) -> None:
            self._finish()
            work(editor.edits)

        return self._with(do)

    def _toggle_difference(self, editor: Editor) -> None:
        wanted = not editor.face.shows_difference
        editor.face.show_difference(wanted)
        self._preferences.set_difference(wanted)

    def glance(self, glancing: bool) -> None:
        """Show the tracked face while a key is held."""
        editor = self._editor()
        if editor is not None:
            editor.face.glance(glancing)

    def show_unit(self, actions: Actions) -> None:
        """Tick the unit that times are shown in."""
        for unit in Unit:
            actions[f"unit_{unit}"].setChecked(unit is self._clock.unit)

    def _about(self) -> None:
        rig = self._rig()
        about_dialog(self._window, rig.attribution if rig is not None else "").show()
