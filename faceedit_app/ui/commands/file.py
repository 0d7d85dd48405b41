"""The File menu: ask the user, then hand over to the document, the opener or projects.

What comes with the solver is imported once it is needed: the window is there before it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtWidgets import QMenu

from faceedit_app.core import on_disk
from faceedit_app.core.atomic import said_of
from faceedit_app.core.errors import FaceEditError, FileError
from faceedit_app.core.resources import DEMO_TAKE, is_demo_take, shipped
from faceedit_app.editing.files import PROJECT_SUFFIX, is_named_as_project
from faceedit_app.formats.timing import counted
from faceedit_app.media import is_film
from faceedit_app.ui.commands import conditions as c
from faceedit_app.ui.commands import dialogs, places
from faceedit_app.ui.commands.character import CharacterCommands, may_hold_character
from faceedit_app.ui.commands.exports import Exports
from faceedit_app.ui.commands.live import LivePreview, PhoneRecording
from faceedit_app.ui.commands.webcam import WebcamRecording
from faceedit_app.ui.commands.workspace import Workspace
from faceedit_app.ui.look.widgets import list_files
from faceedit_app.ui.state.actions import Command, Menu

if TYPE_CHECKING:  # loaded with the first film
    from faceedit_app.ui.commands.tracking import FilmTracking

CHARACTER = "C&haracter"  # submenu


class FileCommands:
    """Opens, saves, exports; asks before anything is lost."""

    def __init__(self, workspace: Workspace) -> None:
        self._workspace, self._window = workspace, workspace.window
        self._document, self._preferences = workspace.document, workspace.preferences
        self.live = LivePreview(workspace)
        self._recording = PhoneRecording(workspace, self.open_if_saved)
        self._webcam = WebcamRecording(workspace, self.open_if_saved, self._show_error)
        self.character = CharacterCommands(workspace)
        self._exports = Exports(workspace, self._show_error)
        workspace.opener.opened.connect(self._remember)
        workspace.opener.failed.connect(self._show_error)
        self._tracking: FilmTracking | None = None

    def _show_error(self, error: Exception) -> None:
        dialogs.show_error(self._window, error)

    # --- open --------------------------------------------------------------------------------

    def ask_open(self) -> None:
        """Open a take or a project that the user chooses."""
        path = dialogs.ask_open(self._window, self._workspace.beside("take"))
        if path is not None:
            self.open_if_saved(path)

    def open_demo(self) -> None:
        """Open the take that ships with FaceEdit."""
        try:
            path = shipped(DEMO_TAKE)
        except FileError as error:
            self._show_error(error)
            return
        self.open_if_saved(path)

    def open_if_saved(self, path: Path) -> None:
        """Open a file, after asking about edits that would be lost."""
        if self._is_refused(path):
            return
        # A project comes with its character.
        is_project = is_named_as_project(path)
        if self.may_close() and (not is_project or self.character.may_leave()):
            self.open(path)

    def _is_refused(self, path: Path) -> bool:
        """Whether a file is seen at once not to be one to open; then the user is not asked to save.

        Without changes that would be lost, reading it says the same.
        """
        if not self._workspace.has_changes:
            return False
        if is_film(path):
            return self._is_no_film(path)
        try:
            if not may_hold_character(path) and not is_named_as_project(path):
                from faceedit_app.formats.registry import check_start

                check_start(path)
        except FaceEditError as error:
            self._show_error(error)
            return True
        return False

    def _is_no_film(self, path: Path) -> bool:
        """Whether a file is seen at once not to be a film that can be tracked."""
        from faceedit_app.tracking.film_landmarks import check_kind

        try:
            check_kind(path)
        except FaceEditError as error:
            self._show_error(error)
            return True
        return False

    def open(self, path: Path, keeps_character: bool = False) -> None:
        """Read a take or a project in the background; on an error the current one stays open.

        The face in a film is tracked first. A character without an animation is shown.

        Args:
            keeps_character: the character that is shown or read now stays, whatever a project has.
        """
        if is_film(path):
            self.track(path)
            return
        if may_hold_character(path) and on_disk.is_file(path):
            from faceedit_app.formats.registry import is_take  # not needed for other takes

            if not is_take(path):
                self.character.open_if_saved(path)
                return
        if not is_named_as_project(path):
            self._workspace.opener.open(path)
            return
        from faceedit_app.ui.commands import projects

        def ask(message: str, likely: Sequence[Path]) -> Path | None:
            return dialogs.ask_take_of_project(self._window, message, likely, path.parent)

        projects.open_project(self._workspace, path, ask, self._show_error, keeps_character)

    def ask_track(self) -> None:
        """Track the face in a film that the user chooses."""
        film = dialogs.ask_film_to_track(self._window, self._preferences.folder("media"))
        if film is not None and not self._is_no_film(film) and self.may_close():
            self._preferences.set_folder("media", film.resolve().parent)
            self._track(film)

    def track(self, film: Path) -> None:
        """Track the face in a film and open the take; until then the present one stays open."""
        if not self._is_no_film(film):
            self._track(film)

    def _track(self, film: Path) -> None:
        from faceedit_app.ui.commands import tracking

        take = dialogs.ask_save_take(self._window, tracking.suggested_take(film))
        if take is not None:
            # Kept until the next one: only its dialog knows it otherwise.
            self._tracking = tracking.FilmTracking(self._workspace, film, take, self._show_error)
            self._tracking.start()

    def _remember(self, path: Path) -> None:
        """Remember the take and its folder."""
        self._preferences.set_folder("take", path.resolve().parent)
        if not is_demo_take(path) and self._document.project is None:
            self._preferences.add_recent(path)

    def fill_recent(self, menu: QMenu) -> None:
        """List the takes and projects that were opened recently and still exist."""
        takes = self._preferences.recent()
        list_files(menu, takes, self.open_if_saved, "No recent takes")
        if not takes:
            return
        menu.addSeparator()
        menu.addAction("Clear").triggered.connect(self._preferences.clear_recent)

    # --- write -------------------------------------------------------------------------------

    def save(self) -> bool:
        """Save the project; False if the user cancels or it fails."""
        path = self._document.project
        if path is None:
            return self.save_as()
        return self._save(path, self._workspace.end_before_writing())

    def save_as(self) -> bool:
        """Save the project under a name that the user chooses; False as for `save`."""
        return self._save_as(self._workspace.end_before_writing())

    def _save_as(self, left: str) -> bool:
        suggestion = self._document.project or self._workspace.suggest(
            "project", "", PROJECT_SUFFIX
        )
        own = self._document.project
        path = places.ask_where(self._workspace, dialogs.ask_save_project, suggestion, own)
        return path is not None and self._save(path, left)

    def _save(self, path: Path, left: str) -> bool:
        from faceedit_app.ui.commands import projects

        if self._document.was_changed(path):
            match dialogs.ask_changed(self._window, path):
                case dialogs.Changed.ELSEWHERE:
                    return self._save_as(left)
                case dialogs.Changed.CANCEL:
                    return False

        def save(path: Path) -> Path | None:
            backup = projects.save(self._workspace, path)
            self._preferences.add_recent(path)
            return backup

        return self._write(save, path, "project", "Saved", left)

    def export(self) -> bool:
        """Export the take as it came; False if the user cancels or it fails."""
        return self._exports.export()

    @property
    def is_filming(self) -> bool:
        """Whether a film is being written."""
        return self._exports.is_filming

    def stop(self) -> None:
        """Stop sending and recording, as the window closes."""
        self.live.stop()
        self._recording.stop()
        self._webcam.stop()

    def live_preview(self) -> None:
        """Send the face to another program, or stop."""
        self.live.toggle()

    def record(self) -> None:
        """Record a take from a phone."""
        self._recording.start()

    def record_webcam(self) -> None:
        """Record a film from a webcam, and track it."""
        self._webcam.start()

    def export_as(self) -> None:
        """Export the take for another program."""
        self._exports.export_as()

    def export_film(self) -> None:
        """Film the take."""
        self._exports.export_film()

    def save_edits(self) -> bool:
        """Save the list of edits; False if the user cancels or it fails."""
        left = self._workspace.end_before_writing()
        suggestion = self._workspace.suggest("edits", "_edits", ".json")
        path = places.ask_where(self._workspace, dialogs.ask_save_edits, suggestion)
        save = self._document.save_edits
        return path is not None and self._write(save, path, "edits", "Saved", left)

    def ask_load_edits(self) -> None:
        """Add the edits in a file that the user chooses."""
        path = dialogs.ask_load_edits(self._window, self._workspace.beside("edits"))
        if path is not None:
            self.load_edits(path)

    def load_edits(self, path: Path) -> None:
        """Add the edits in a file."""

        def load(path: Path) -> None:
            self._document.load_edits(path)

        session = self._document.session
        before = len(session.edits) if session is not None else 0
        if not self._write(load, path, "edits", "Loaded") or session is None:
            return
        loaded, ends = session.edits[before:], session.take.clip.duration
        outside = sum(edit.span[0] > ends or edit.span[1] < 0 for edit in loaded)
        if outside:
            lie = "lies" if outside == 1 else "lie"
            self._workspace.warning.emit(
                f"{outside} of {counted(len(loaded), 'edit')} of {path.name} {lie} outside the "
                "take, where nothing changes"
            )

    def _write(
        self, work: Callable[[Path], Path | None], path: Path, kind: str, done: str, left: str = ""
    ) -> bool:
        """Do something with a file, which may return the copy that was kept of another one."""
        try:
            backup = work(path)
        except FaceEditError as error:
            self._show_error(error)
            return False
        self._preferences.set_folder(kind, path.resolve().parent)
        self._workspace.message.emit(f"{done} {path}{left}{said_of(backup)}")
        return True

    # --- close -------------------------------------------------------------------------------

    def may_close(self) -> bool:
        """Ask about edits that no project holds; False if the user cancels."""
        document = self._document
        if document.path is None:
            return True
        from faceedit_app.ui.commands.unsaved import may_be_exported, question_about

        left_out = bool(self._workspace.end_before_writing())
        while document.loses_by_closing:
            project, question = document.project, question_about(document, left_out)
            asks = project is None or document.was_changed(project)
            exports = may_be_exported(document)
            match dialogs.ask_unsaved(self._window, *question, asks=asks, exports=exports):
                case dialogs.Unsaved.EXPORT:
                    if not self.export():
                        return False
                case dialogs.Unsaved.SAVE:
                    return self.save()
                case dialogs.Unsaved.DISCARD:
                    return True
                case _:
                    return False
        return True

    def may_quit(self) -> bool:
        """Ask about all that closing the window would lose; False if the user cancels."""
        return self.may_close() and self.character.may_leave() and self.may_stop()

    def may_stop(self) -> bool:
        """Ask about files that are still being written; False if the user goes on with them."""
        names = self._workspace.unfinished.names
        return not names or dialogs.ask_stop_writing(self._window, names)

    def quit(self) -> None:
        """Close the window, which asks about unsaved edits."""
        self._window.close()


# fmt: off
MENU: Menu[FileCommands] = Menu("&File", (
    Command("open", "&Open…", FileCommands.ask_open, ("Ctrl+O",),
            "Open a tracked take or a project", "open", needs_take=False),
    Command("track_film", "&Track a film…", FileCommands.ask_track, (),
            "Find the face in a film, and open its performance as a take", needs_take=False),
    Command("open_demo", "Open &demo take", FileCommands.open_demo, (),
            "Open the take that ships with FaceEdit", needs_take=False),
    Command("recent", "Open &recent", fills=FileCommands.fill_recent, needs_take=False),
    Command("record", "Record from &phone…", FileCommands.record, (),
            "Record a take that a phone or another program sends", needs_take=False),
    Command("record_webcam", "Record from &webcam…", FileCommands.record_webcam, (),
            "Film yourself, and open your performance as a take", needs_take=False),
    Command("save", "&Save project", FileCommands.save, ("Ctrl+S",),
            "Save your edits, the view, sound and film as a project", "save",
            starts_group=True),
    Command("save_as", "Save project &as…", FileCommands.save_as, ("Ctrl+Shift+S",),
            "Save the project under another name"),
    Command("export", "&Export…", FileCommands.export, ("Ctrl+E",),
            "Write the edited take in the format it was opened from", "export", starts_group=True),
    Command("export_as", "E&xport as…", FileCommands.export_as, ("Ctrl+Shift+E",),
            "Write the edited take in another format, or as a character that plays it"),
    Command("export_film", "Export fil&m…", FileCommands.export_film, (),
            "Film the face, both faces, or the face beside the take's film, with its sound",
            enabled=c.NOT_FILMING),
    Command("live", "Li&ve preview…", FileCommands.live_preview, (),
            "Send the face on screen to Unreal, VSeeFace and others, while you edit and play",
            checked=lambda file: file.live.is_on),
    Command("save_edits", "Save l&ist of edits…", FileCommands.save_edits, (),
            "Save the list of edits, to use on another take or with “faceedit apply”"),
    Command("load_edits", "&Load edits…", FileCommands.ask_load_edits, (),
            "Add the edits in a file to this take"),
    Command("open_character", "&Open…", lambda do: do.character.ask_open(), (),
            "Show your own character: GLB, glTF, VRM, FBX or OBJ with blendshapes",
            needs_take=False, submenu=CHARACTER),
    Command("recent_characters", "Open &recent", submenu=CHARACTER, needs_take=False,
            fills=lambda do, menu: do.character.fill_recent(menu)),
    Command("own_character", "&FaceEdit's own", lambda do: do.character.show_own(), (),
            "Show the character that ships with FaceEdit", needs_take=False,
            enabled=c.CAN_SHOW_OWN, submenu=CHARACTER),
    Command("character_checklist", "Chec&klist…", lambda do: do.character.show_checklist(), (),
            "Show which shapes and points were found in your character, and correct them",
            needs_take=False, enabled=c.SHOWS_OWN, submenu=CHARACTER),
    Command("make_character", "Make from a &scan…", lambda do: do.character.ask_make(), (),
            "Give a head without blendshapes (OBJ, PLY, STL or GLB) all 52 of them",
            submenu=CHARACTER),
    Command("close_on_character", "&Close on my character",
            lambda do: do.character.switch_closing(), (),
            "Where edits close lips or lids, also close them on your character",
            enabled=c.SHOWS_OWN, checked=lambda do: do.character.closes,
            submenu=CHARACTER),
    Command("close_range", "Close in the se&lection or everywhere",
            lambda do: do.character.close_range(), (),
            "Add an edit that closes lips and lids on your character where they are closed on ours",
            enabled=c.CLOSES,
            submenu=CHARACTER),
    Command("quit", "&Quit", FileCommands.quit, ("Ctrl+Q",), needs_take=False,
            starts_group=True),
))
# fmt: on
