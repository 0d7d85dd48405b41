"""All menus: the source of the menu bar, the shortcuts and docs/shortcuts.md."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from faceedit_app.ui.commands import edit, file, fix, help, playback, take, tools, view
from faceedit_app.ui.commands.gestures import GESTURES
from faceedit_app.ui.commands.workspace import Workspace
from faceedit_app.ui.state import actions
from faceedit_app.ui.state.actions import Menu

MENUS: tuple[Menu[Any], ...] = (
    file.MENU,
    edit.MENU,
    take.MENU,
    tools.MENU,
    fix.MENU,
    view.MENU,
    playback.MENU,
    help.MENU,
)


class Commands:
    """The objects that carry out one window's commands, named after their menus."""

    def __init__(self, workspace: Workspace) -> None:
        self.file = file.FileCommands(workspace)
        self.edit = edit.EditCommands(workspace, self.file.may_close)
        self.take = take.TakeCommands(workspace)
        self.tools = tools.ToolCommands(workspace)
        self.fix = fix.FixCommands(workspace)
        self.view = view.ViewCommands(workspace)
        self.playback = playback.PlaybackCommands(workspace)
        self.help = help.HelpCommands(workspace, help_rows)

    def menus(self) -> list[tuple[Menu[Any], Any]]:
        """Each menu with the object that carries out its commands."""
        return [(menu, getattr(self, menu.name.lower())) for menu in MENUS]


def help_rows() -> Iterator[tuple[str, str, str]]:
    """(menu or place, keys or gesture, effect) of every shortcut and gesture."""
    yield from actions.help_rows(MENUS)
    yield from GESTURES
