"""Project files and what a crash left behind: ask the user, then let the document do it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QWidget

from faceedit_app.core.errors import FaceEditError
from faceedit_app.core.fields import FieldError, Fields
from faceedit_app.formats.timing import counted
from faceedit_app.ui.commands import dialogs
from faceedit_app.ui.commands.file import PROJECT, FileCommands
from faceedit_app.ui.media.take_media import Media
from faceedit_app.ui.state.background import Background
from faceedit_app.ui.state.document import Document
from faceedit_app.ui.state.preferences import Store
from faceedit_app.ui.state.timeline import Timeline

if TYPE_CHECKING:
    from faceedit_app.editing.files.journal import Pending
    from faceedit_app.editing.files.project import Located, Project, View
    from faceedit_app.editing.session import EditSession


class ProjectCommands(QObject):
    """Saves and opens projects, and offers what was not saved.

    Signals:
        told(str): something went well, for the status bar.
        warned(str): something the user should know, for the banner.
    """

    told = Signal(str)
    warned = Signal(str)

    def __init__(
        self,
        window: QWidget,
        document: Document,
        timeline: Timeline,
        media: Media,
        files: FileCommands,
        background: Background,
        store: Store,
    ) -> None:
        super().__init__(window)
        self._window, self._document, self._timeline = window, document, timeline
        self._media, self._files, self._store = media, files, store
        self._background = background
        files.open_project, files.save_project = self.open, self.save

    # --- save --------------------------------------------------------------------------------

    def save(self) -> bool:
        """File > Save; False if the user thought better of it, or it failed."""
        path = self._document.project
        return self._save(path) if path is not None else self.save_as()

    def save_as(self) -> bool:
        """File > Save as."""
        suggestion = self._document.project or self._files.suggest("project", "", PROJECT)
        path = dialogs.ask_save_project(self._window, suggestion)
        return path is not None and self._save(path)

    def _save(self, path: Path) -> bool:
        try:
            self._document.save_project(path, self._view(), self._media.placement)
        except FaceEditError as error:
            dialogs.show_error(self._window, error)
            return False
        self._store.set_folder("project", path.resolve().parent)
        self._store.add_recent(path)
        self.told.emit(f"Saved {path}")
        return True

    def _view(self) -> View:
        from faceedit_app.editing.files.project import View

        line = self._timeline
        return View(
            line.time,
            line.view,
            line.selection,
            line.falloff,
            {
                "falloff_out": line.falloff_out,
                "unit": line.clock.unit.value,
                "mirror_film": self._media.mirrored,
            },
        )

    # --- open --------------------------------------------------------------------------------

    def open(self, path: Path) -> None:
        """Read a project, and find its take."""
        from faceedit_app.editing.files.project import locate_take, read_project

        def read() -> tuple[Project, Located]:
            project = read_project(path)
            return project, locate_take(project, path)

        def failed(error: Exception) -> None:
            if not isinstance(error, FaceEditError):
                raise error
            self._files.reading.emit("")
            dialogs.show_error(self._window, error)

        self._files.reading.emit(f"Opening {path.name}…")
        self._background.run(read, lambda found: self._found(path, *found), failed)

    def _found(self, path: Path, project: Project, located: Located) -> None:
        from faceedit_app.editing.edits.media import Placement
        from faceedit_app.editing.files.project import Whereabouts

        take = located.path
        match located.where:
            case Whereabouts.CHANGED | Whereabouts.MISSING:
                choices = [*([take] if take is not None else []), *located.others]
                folder = path.parent
                take = dialogs.ask_take_of_project(self._window, located.message, choices, folder)
            case Whereabouts.MOVED:
                self.warned.emit(located.message)
        if take is None:
            self._files.reading.emit("")
            return
        keeps_note = located.where is Whereabouts.FOUND

        def prepare(session: EditSession) -> None:
            # What stands beside the take by chance is not the project's.
            media = Placement(project.audio, project.film)
            session.begin_with(replace(project.state, media=media))
            if keeps_note:
                session.mark_saved()

        self._files.read(take, prepare, lambda: self._opened(project), path)
        self._store.add_recent(path)

    def _opened(self, project: Project) -> None:
        """Look at the take as it was looked at."""
        from faceedit_app.ui.state.clock import Unit

        line, view = self._timeline, project.view
        try:
            fade_out = Fields(view.ui).number("falloff_out", view.falloff, 0.0)
        except FieldError:
            fade_out = view.falloff
        line.set_falloffs(view.falloff, fade_out)
        if view.visible is not None:
            line.show_range(*view.visible)
        line.select(view.selection)
        line.go_to_time(view.playhead)
        unit = view.ui.get("unit")
        if unit in list(Unit):
            line.clock.choose(Unit(str(unit)))
        self._media.mirror(view.ui.get("mirror_film") is True)

    # --- after a crash -----------------------------------------------------------------------

    def offer_recovery(self, otherwise: Callable[[], None]) -> None:
        """Ask about the newest session that ended without closing, else do what was asked."""
        from faceedit_app.editing.files.journal import pending_journals

        pending = pending_journals()
        if pending:
            match dialogs.ask_recover(self._window, pending[0]):
                case dialogs.Recover.RECOVER:
                    self.recover(pending[0])
                    return
                case dialogs.Recover.DISCARD:
                    pending[0].discard()
        otherwise()

    def recover(self, pending: Pending) -> None:
        """Open the take with all that was done to it."""

        def prepare(session: EditSession) -> None:
            session.restore(pending.state)

        def opened() -> None:
            pending.discard()
            steps = counted(pending.gestures, "step")
            self.told.emit(f"Recovered {steps} of {pending.take.name}; Undo takes all back at once")
            session = self._document.session
            if session is not None and session.fingerprint != pending.fingerprint:
                self.warned.emit(f"{pending.take.name} has changed since these edits were made")

        self._files.read(pending.take, prepare, opened, pending.project)
