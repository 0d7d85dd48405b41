"""File > Character: show, check and correct a character of the user's."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtWidgets import QMenu

from faceedit_app.core.atomic import said_of
from faceedit_app.core.errors import FaceEditError
from faceedit_app.ui.commands import dialogs, places
from faceedit_app.ui.commands.workspace import Workspace
from faceedit_app.ui.look.widgets import list_files

if TYPE_CHECKING:  # they import the loaders of characters
    from faceedit_app.characters.fitted import FittedCharacter
    from faceedit_app.characters.map_file import CharacterMap
    from faceedit_app.core.levels import Level
    from faceedit_app.core.rig import Rig
    from faceedit_app.scans.steps import Attempt
    from faceedit_app.ui.character.checklist import CharacterChecklist
    from faceedit_app.ui.character.points_overlay import PointsOverlay


# Of files that may hold a character as well as a take, in lower case.
_ENDINGS = (".glb", ".gltf", ".vrm", ".fbx", ".obj")


def may_hold_character(path: Path) -> bool:
    """Whether a file may hold a character, by its name; cheap enough for every file."""
    return path.suffix.lower() in _ENDINGS


class CharacterCommands:
    """Opens characters, and keeps the checklist and the points on the face up to date."""

    def __init__(self, workspace: Workspace) -> None:
        self._workspace, self._document = workspace, workspace.document
        self._checklist: CharacterChecklist | None = None
        self._points: PointsOverlay | None = None
        self._saved: CharacterMap | None = None  # the map as it is in its file
        self._is_refit = False  # the next character is the same one with another map
        self._awaits_hints = False  # the checklist, while the first steps are shown
        self._document.character_changed.connect(self._follow)
        self._document.opened.connect(self._refresh)

    @property
    def can_show_own(self) -> bool:
        """Whether a character of the user's is shown, or being read."""
        return self.is_shown or self._workspace.opens_character

    @property
    def is_shown(self) -> bool:
        """Whether a character of the user's is shown."""
        return self._document.character is not None

    def ask_open(self) -> None:
        """Open a character that the user chooses."""
        if not self.may_leave():
            return
        folder = self._workspace.preferences.folder("character")
        path = dialogs.ask_character(self._workspace.window, folder)
        if path is not None:
            self.open(path)

    def open_if_saved(self, path: Path) -> None:
        """Open a character, after asking about choices that would be lost."""
        if self.may_leave():
            self.open(path)

    def may_leave(self) -> bool:
        """Ask about choices in the checklist that no map holds; False if the user cancels."""
        character = self._document.character
        if character is None or character.mapping == self._saved:
            return True
        match dialogs.ask_unsaved_map(self._workspace.window, character.character.path.name):
            case dialogs.Unsaved.SAVE:
                return self.save_map()
            case answer:
                return answer is dialogs.Unsaved.DISCARD

    def open(self, path: Path, saved: str = "") -> None:
        """Open a character in the background, and show its checklist.

        Args:
            saved: what to say if it was made and saved just now.
        """
        preferences = self._workspace.preferences

        def opened() -> None:
            preferences.set_folder("character", path.resolve().parent)
            preferences.add_recent_character(path)
            if saved:
                self._workspace.message.emit(saved)
            self._offer_checklist()

        def failed(problem: str) -> None:
            dialogs.show_error(self._workspace.window, problem)

        self._workspace.open_character(path, failed, opened)

    def offer(self, take: Path) -> None:
        """Offer to show the face of a take's file, if it has one and ours is shown."""
        if not self.is_shown and may_hold_character(take):
            text = f"{take.name} was opened as a take. It also has a face."
            self._workspace.offer.emit(
                text, "Show it as your character", lambda: self.open_if_saved(take)
            )

    def fill_recent(self, menu: QMenu) -> None:
        """List the characters that were opened recently and still exist."""
        known = self._workspace.preferences.recent_characters()
        list_files(menu, known, self.open_if_saved, "No recent characters")

    def show_own(self) -> None:
        """Show FaceEdit's own character again."""
        self._workspace.end_gestures()
        if self.may_leave():
            self._workspace.show_own_character()

    def ask_make(self) -> None:
        """Make a character from a scan that the user chooses."""
        workspace = self._workspace
        path = dialogs.ask_scan(workspace.window, workspace.preferences.folder("character"))
        if path is not None and workspace.rig is not None:
            self.make(path, workspace.rig)

    def make(self, path: Path, rig: Rig) -> None:
        """Make a character from a scan, shown step by step."""
        from faceedit_app.ui.character.scan_dialog import ScanDialog

        dialog = ScanDialog(self._workspace.window, path, rig)

        def save(attempt: Attempt) -> None:
            self._save_made(attempt, path)

        dialog.save_asked.connect(save)
        dialog.show()
        dialog.begin()

    def _save_made(self, attempt: Attempt, scan: Path) -> None:
        """Save a character that was made from a scan, and show it."""
        from faceedit_app.characters.glb_writing import write_rig

        suggestion = scan.with_name(f"{scan.stem}_character.glb")
        path = places.ask_where(self._workspace, dialogs.ask_save_character, suggestion)
        if path is None:
            return
        try:
            backup = write_rig(path, attempt.made.rig)
        except FaceEditError as error:
            dialogs.show_error(self._workspace.window, error)
            return
        self.open(path, f"Saved and opened {path}{said_of(backup)}")

    # --- closing ---------------------------------------------------------------------------------

    @property
    def closes(self) -> bool:
        """Whether lips and lids are closed on the user's character."""
        session = self._workspace.session
        return session is not None and session.settings.closes

    def switch_closing(self) -> None:
        """Close lips and lids on the user's character where edits close them on ours, or do not."""
        self._workspace.end_gestures()
        session = self._workspace.session
        if session is not None:
            session.configure(replace(session.settings, closes=not session.settings.closes))

    def close_range(self) -> None:
        """Close lips and lids on the user's character in the selection, or in the whole take."""
        from faceedit_app.editing.help.on_character import NAME, close_between

        self._workspace.end_gestures()
        line = self._workspace.timeline
        start, end = line.own_selection or (0.0, line.duration)
        self._workspace.add_edits((close_between(start, end),), NAME)

    # --- the checklist ---------------------------------------------------------------------------

    def _offer_checklist(self) -> None:
        """Show the checklist now, or once the first steps are read."""
        page = self._workspace.page
        self._awaits_hints = page is not None and page.hints.isVisible()
        if not self._awaits_hints:
            self.show_checklist()

    def make_room_for_hints(self) -> None:
        """Hide the checklist while the first steps are shown: it would cover them."""
        if self._checklist is not None and self._checklist.isVisible():
            self._checklist.hide()
            self._awaits_hints = True

    def hints_closed(self) -> None:
        """Show the checklist that waited for the end of the first steps."""
        if self._awaits_hints:
            self._offer_checklist()

    def show_checklist(self) -> None:
        """Show what was found in the character, and its points on the face."""
        if self._document.character is None:
            return
        if self._checklist is None:
            from faceedit_app.ui.character.checklist import CharacterChecklist

            self._checklist = CharacterChecklist(self._workspace.window)
            self._checklist.shape_chosen.connect(self._choose_shape)
            self._checklist.levelled.connect(self._set_level)
            self._checklist.save_asked.connect(self.save_map)
            self._checklist.closed.connect(self._hide_points)
        if self._workspace.page is not None and not self._checklist.isVisible():
            self._checklist.stand_left_of(self._workspace.page.face)
        self._checklist.show()
        self._checklist.raise_()
        self._refresh()

    def save_map(self) -> bool:
        """Save the user's choices beside the character; False if that fails."""
        from faceedit_app.characters.map_file import map_path, write_map

        character = self._document.character
        if character is None:
            return False
        path = map_path(character.character.path)
        try:
            backup = write_map(path, character.mapping)
        except FaceEditError as error:
            dialogs.show_error(self._workspace.window, error)
            return False
        self._saved = character.mapping
        self._workspace.message.emit(f"Saved {path}{said_of(backup)}")
        self._refresh()
        return True

    def _follow(self) -> None:
        """Another character is shown: its checklist follows."""
        character = self._document.character
        if character is None:
            if self._checklist is not None:
                self._checklist.close()
            self._saved = None
        elif not self._is_refit:
            self._saved = character.mapping
        self._is_refit = False
        self._refresh()

    def _refresh(self) -> None:
        character, checklist = self._document.character, self._checklist
        if character is None or checklist is None or not checklist.isVisible():
            return
        is_changed, is_drawn = character.mapping != self._saved, self._document.session is not None
        checklist.show_character(character, is_changed, is_drawn)
        page = self._workspace.page
        if page is None:
            return
        if self._points is None:
            from faceedit_app.ui.character.points_overlay import PointsOverlay

            self._points = PointsOverlay(page.face.viewport)
            self._points.moved.connect(self._move_point)
        self._points.show_points(character.points)

    def _hide_points(self) -> None:
        if self._points is not None:
            self._points.hide()

    def _choose_shape(self, channel: str, shape: str) -> None:
        """Make a channel of another shape."""
        from faceedit_app.characters.matches import Share

        character = self._document.character
        if character is not None:
            channels = dict(character.mapping.channels)
            channels[channel] = (Share(shape),) if shape else ()
            self._fit_again(character, replace(character.mapping, channels=channels))

    def _set_level(self, channel: str, level: Level) -> None:
        """Set how strongly the character answers a channel."""
        character = self._document.character
        if character is not None:
            self._is_refit = True
            self._document.use_character(character.with_level(channel, level))

    def _move_point(self, name: str, vertex: int) -> None:
        """Put a control point on another vertex."""
        character = self._document.character
        if character is not None:
            points = {**character.mapping.points, name: character.place(vertex)}
            self._fit_again(character, replace(character.mapping, points=points))

    def _fit_again(self, character: FittedCharacter, mapping: CharacterMap) -> None:
        """Fit the character with another map; if that is impossible, keep it as it is."""
        from faceedit_app.characters.fitted import fit

        def fitted(again: FittedCharacter) -> None:
            if self._document.character is character:
                self._is_refit = True
                self._document.use_character(again)

        def failed(error: Exception) -> None:
            dialogs.report_failure(self._workspace.window, error)
            self._refresh()

        read = character.character
        self._workspace.background.run(lambda: fit(read, mapping), fitted, failed)
