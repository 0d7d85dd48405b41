"""Reads takes in the background and opens them; asks the user nothing."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal

from faceedit_app.core.errors import FaceEditError
from faceedit_app.formats.timing import RateNeeded
from faceedit_app.ui.state import loading
from faceedit_app.ui.state.background import Background
from faceedit_app.ui.state.document import Document

if TYPE_CHECKING:  # the window is there before the solver
    from faceedit_app.core.rig import Rig
    from faceedit_app.editing.files.fingerprint import KnownFile
    from faceedit_app.editing.session import EditSession


class TakeOpener(QObject):
    """Opens takes, all with the window's character.

    Attributes:
        rig: the character, once it is loaded.

    Signals:
        reading(str): what is being read; empty when done.
        character_loaded(Rig): the character is loaded.
        opened(Path): a take was opened.
        failed(object): a FaceEditError about a take, or about the character.
        rate_needed(RateNeeded, object): only the user can know the take's frame rate; the
            function opens it at a rate.
    """

    reading = Signal(str)
    character_loaded = Signal(object)
    opened = Signal(object)
    failed = Signal(object)
    rate_needed = Signal(object, object)

    def __init__(self, document: Document, background: Background, parent: QObject) -> None:
        super().__init__(parent)
        self._document, self._background = document, background
        self.rig: Rig | None = None
        self._wanted: Path | None = None
        self._shown = ""  # an error in which what is still being read will end as well
        self._loads_character = False

    @property
    def is_reading(self) -> bool:
        """Whether a take is being read."""
        return self._wanted is not None

    def open(
        self,
        path: Path,
        prepare: Callable[[EditSession], None] = lambda session: None,
        then: Callable[[], None] = lambda: None,
        project: KnownFile | None = None,
        fps: float | None = None,
    ) -> None:
        """Read a take and open it; on an error the current one stays open.

        Args:
            prepare: adds edits to its session before it is shown.
            then: called once it is shown.
            project: the project that it belongs to, as it was read.
            fps: its frame rate, if its file does not tell it or is not believed.
        """
        self._wanted = path

        def read() -> tuple[Rig, EditSession]:
            rig = self.rig or loading.load_character()
            return rig, loading.open_session(path, rig, fps)

        def done(found: tuple[Rig, EditSession]) -> None:
            if path != self._wanted:  # another one was opened meanwhile
                return
            self._wanted = None
            rig, session = found
            self.use_character(rig)
            prepare(session)
            self._document.adopt(session, project)
            self.reading.emit("")
            then()
            self.opened.emit(path)

        def failed(error: Exception) -> None:
            if path != self._wanted:
                return
            self._wanted = None
            self.reading.emit("")
            if isinstance(error, RateNeeded):
                self.rate_needed.emit(error, partial(self.open, path, prepare, then, project))
            else:
                self._failed(error)

        self.reading.emit(f"Opening {path.name}…")
        self._background.run(read, done, failed)

    def _failed(self, error: Exception) -> None:
        if not isinstance(error, FaceEditError):
            raise error
        self._show_once(error, self._loads_character)

    def load_character(self) -> None:
        """Load the character, whether or not a take is opened."""

        def done(rig: Rig) -> None:
            self._loads_character, self._shown = False, ""
            self.use_character(rig)

        def failed(error: Exception) -> None:
            self._loads_character = False
            self._show_once(error, self.is_reading)

        self._loads_character = True
        self._background.run(loading.load_character, done, failed)

    def _show_once(self, error: Exception, other_follows: bool) -> None:
        """Report an error, unless it was: a character that is missing ends its own loading and a
        take's, in either order.

        Args:
            other_follows: the other one is still being read.
        """
        known, self._shown = self._shown, ""
        if str(error) != known:
            self._shown = str(error) if other_follows else ""
            self.failed.emit(error)

    def use_character(self, rig: Rig) -> None:
        """Use a character for all takes of this window."""
        if self.rig is None:
            self.rig = rig
            self.character_loaded.emit(rig)
