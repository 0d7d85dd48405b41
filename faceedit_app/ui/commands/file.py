"""The File menu: ask the user, then let the document do it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QMenu, QWidget

from faceedit_app.core.errors import FaceEditError, FileError
from faceedit_app.core.resources import shipped
from faceedit_app.ui.commands import dialogs
from faceedit_app.ui.state import background as loading
from faceedit_app.ui.state.document import Document
from faceedit_app.ui.state.preferences import Preferences

if TYPE_CHECKING:
    from faceedit_app.core.rig import Rig
    from faceedit_app.editing.session import EditSession

DEMO = "assets/demo_take.csv"
PROJECT = ".faceedit"


class FileCommands(QObject):
    """Opens, exports, saves.

    Signals:
        reading(str): a take is being read; empty when that is over.
        character_loaded(Rig): the character can be drawn.
        told(str): something went well, for the status bar.
    """

    reading = Signal(str)
    character_loaded = Signal(object)
    told = Signal(str)

    def __init__(
        self,
        window: QWidget,
        document: Document,
        preferences: Preferences,
        background: loading.Background,
    ) -> None:
        super().__init__(window)
        self._window, self._document = window, document
        self._preferences, self._background = preferences, background
        self._rig: Rig | None = None
        self._wanted: Path | None = None
        self._prepare: Callable[[EditSession], None] | None = None
        self._then: Callable[[], None] | None = None
        self._project: Path | None = None
        # Set by who knows projects.
        self.open_project: Callable[[Path], None] = self.open
        self.save_project: Callable[[], bool] = self.ask_save_edits

    # --- open --------------------------------------------------------------------------------

    def ask_open(self) -> None:
        """File > Open."""
        if self.may_close():
            path = dialogs.ask_open(self._window, self._preferences.folder("take"))
            if path is not None:
                self.open(path)

    def open_if_saved(self, path: Path) -> None:
        """Open a take that the user pointed at, unless edits would be lost."""
        if self.may_close():
            self.open(path)

    def open_demo(self) -> None:
        """File > Open demo take."""
        try:
            path = shipped(DEMO)
        except FileError as error:
            dialogs.show_error(self._window, error)
            return
        self.open_if_saved(path)

    def open(self, path: Path) -> None:
        """Read a take or a project in the background; on an error the present one stays open."""
        if path.suffix.lower() == PROJECT:
            self.open_project(path)
        else:
            self.read(path)

    def read(
        self,
        path: Path,
        prepare: Callable[[EditSession], None] | None = None,
        then: Callable[[], None] | None = None,
        project: Path | None = None,
    ) -> None:
        """Read a take and show it.

        Args:
            prepare: brings edits into its session before anything is shown.
            then: is done when it is shown.
            project: the project that it belongs to.
        """
        self._wanted, self._prepare, self._then, self._project = path, prepare, then, project
        self.reading.emit(f"Opening {path.name}…")
        self._background.run(
            lambda: self._read(path),
            lambda read: self._opened(path, *read),
            lambda error: self._failed(path, error),
        )

    @property
    def is_reading(self) -> bool:
        """Whether a take is being read."""
        return self._wanted is not None

    def _read(self, path: Path) -> tuple[Rig, EditSession]:
        rig = self._rig or loading.load_character()
        return rig, loading.open_session(path, rig)

    def _opened(self, path: Path, rig: Rig, session: EditSession) -> None:
        if path != self._wanted:  # another one was asked for meanwhile
            return
        self._wanted = None
        self.use_character(rig)
        if self._prepare is not None:
            self._prepare(session)
        self._document.adopt(session, self._project)
        self.reading.emit("")
        if self._then is not None:
            self._then()
        self._preferences.set_folder("take", path.resolve().parent)
        if not _is_shipped(path) and self._project is None:
            self._preferences.add_recent(path)

    def _failed(self, path: Path, error: Exception) -> None:
        if path != self._wanted:
            return
        self._wanted = None
        self.reading.emit("")
        if not isinstance(error, FaceEditError):
            raise error
        dialogs.show_error(self._window, error)
        if self._rig is None:
            self.load_character(error)

    def load_character(self, told: Exception | None = None) -> None:
        """Fetch the character without a take; an error that was told is not told again."""

        def failed(error: Exception) -> None:
            if told is None or str(told) != str(error):
                dialogs.show_error(self._window, error)

        self._background.run(loading.load_character, self.use_character, failed)

    def use_character(self, rig: Rig) -> None:
        """Keep the character for all takes of this window."""
        if self._rig is None:
            self._rig = rig
            self.character_loaded.emit(rig)

    def fill_recent(self, menu: QMenu) -> None:
        """List the takes and projects that were opened last and still exist."""
        menu.clear()
        for path in self._preferences.recent():
            action = menu.addAction(path.name)
            action.setToolTip(str(path))
            action.triggered.connect(lambda _checked=False, p=path: self.open_if_saved(p))
        if menu.isEmpty():
            menu.addAction("No recent takes").setEnabled(False)
            return
        menu.addSeparator()
        menu.addAction("Clear").triggered.connect(self._preferences.clear_recent)

    # --- write -------------------------------------------------------------------------------

    def ask_export(self) -> bool:
        """File > Export; False if the user thought better of it, or it failed."""
        path = dialogs.ask_export(self._window, self.suggest("export", "_edited", ".csv"))
        return path is not None and self._do(self._document.export, path, "export", "Exported")

    def ask_save_edits(self) -> bool:
        """File > Save edits; False if the user thought better of it, or it failed."""
        path = dialogs.ask_save_edits(self._window, self.suggest("edits", "_edits", ".json"))
        return path is not None and self._do(self._document.save_edits, path, "edits", "Saved")

    def ask_load_edits(self) -> None:
        """File > Load edits."""
        path = dialogs.ask_load_edits(self._window, self._preferences.folder("edits"))
        if path is not None:
            self.load_edits(path)

    def load_edits(self, path: Path) -> None:
        """Add the edits of a file."""
        self._do(self._document.load_edits, path, "edits", "Loaded")

    def _do(self, work: Callable[[Path], None], path: Path, kind: str, done: str) -> bool:
        try:
            work(path)
        except FaceEditError as error:
            dialogs.show_error(self._window, error)
            return False
        self._preferences.set_folder(kind, path.resolve().parent)
        self.told.emit(f"{done} {path}")
        return True

    def suggest(self, kind: str, tail: str, ending: str) -> Path:
        """A file name beside the take; the demo's folder belongs to the installation."""
        take = self._document.path
        assert take is not None
        folder = self._preferences.folder(kind) if _is_shipped(take) else take.parent
        return folder / f"{take.stem}{tail}{ending}"

    # --- close -------------------------------------------------------------------------------

    def may_close(self) -> bool:
        """Ask about edits that would be lost; False if the user wants to stay."""
        if self._document.is_clean or self._document.path is None:
            return True
        match dialogs.ask_unsaved(self._window, self._document.path.name):
            case dialogs.Unsaved.EXPORT:
                return self.ask_export()
            case dialogs.Unsaved.SAVE:
                return self.save_project()
            case dialogs.Unsaved.DISCARD:
                return True
            case _:
                return False


def _is_shipped(path: Path) -> bool:
    try:
        return path.resolve() == shipped(DEMO).resolve()
    except FileError:
        return False
