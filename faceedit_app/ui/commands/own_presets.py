"""The user's own presets: the menu that lists them, and saving, renaming and deleting them."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtWidgets import QMenu

from faceedit_app.core.errors import FaceEditError
from faceedit_app.editing.help.presets import (
    Preset,
    delete_preset,
    described,
    load_presets,
    rename_preset,
    save_preset,
    why_not_saved,
)
from faceedit_app.ui.commands import dialogs
from faceedit_app.ui.commands.workspace import Workspace
from faceedit_app.ui.look.texts import name_entry, plain_entry, plain_tip


class OwnPresetCommands:
    """Lists, saves, renames and deletes the user's presets.

    Args:
        apply: makes a preset's edits.
    """

    def __init__(self, workspace: Workspace, apply: Callable[[Preset], None]) -> None:
        self._workspace, self._apply = workspace, apply
        self._document, self._timeline = workspace.document, workspace.timeline

    def fill(self, menu: QMenu) -> None:
        """List the user's own presets, and where they act."""
        from faceedit_app.ui.page.expressions import where_acts

        menu.clear()
        presets, notes = load_presets()
        own = [preset for preset in presets if preset.own]
        if own:
            menu.addAction(where_acts(own, self._timeline)[0]).setEnabled(False)
        for preset in own:
            action = menu.addAction(name_entry(preset.name))
            action.setToolTip(plain_tip(preset.hint))
            action.triggered.connect(lambda _checked=False, p=preset: self._apply(p))
        if not own:
            menu.addAction("No presets of your own").setEnabled(False)
        for note in notes:
            menu.addAction(plain_entry(note)).setEnabled(False)
        if own:
            menu.addSeparator()
            for title, act in (("Rename", self._rename), ("Delete", self._delete)):
                for_each = menu.addMenu(title)
                for preset in own:
                    action = for_each.addAction(name_entry(preset.name))
                    action.triggered.connect(lambda _checked=False, p=preset, do=act: do(p))

    def save(self) -> None:
        """Save the edits in the selection as a preset."""
        session = self._document.session
        if session is None:
            return
        self._workspace.end_gestures()
        selection = self._timeline.own_selection
        why = why_not_saved(session.edits, selection)
        if selection is None or why:
            self._workspace.message.emit(why)
            return
        name = dialogs.ask_preset_name(self._workspace.window)
        if not name:
            return
        try:
            saved = save_preset(name, session.edits, *selection)
        except FaceEditError as error:
            dialogs.show_error(self._workspace.window, error)
            return
        text = described(saved, session.edits, *selection)
        self._workspace.message.emit(f"Saved the preset {text}")

    def _rename(self, preset: Preset) -> None:
        name = dialogs.ask_preset_name(self._workspace.window, preset.name)
        if not name or name == preset.name:
            return
        try:
            renamed = rename_preset(preset, name)
        except FaceEditError as error:
            dialogs.show_error(self._workspace.window, error)
            return
        text = f"Renamed the preset “{preset.name}” to “{renamed.name}”"
        self._workspace.message.emit(text)

    def _delete(self, preset: Preset) -> None:
        if not dialogs.ask_delete_preset(self._workspace.window, preset.name):
            return
        try:
            delete_preset(preset)
        except FaceEditError as error:
            dialogs.show_error(self._workspace.window, error)
            return
        self._workspace.message.emit(f"Deleted the preset “{preset.name}”")
