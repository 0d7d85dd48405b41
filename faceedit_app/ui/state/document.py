"""The open take as the window knows it: its session, its files and its journal."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QCoreApplication, QEventLoop, QObject, Signal

if TYPE_CHECKING:  # the window is there before the solver and the networks are imported
    from faceedit_app.editing.edits.edit import Edit
    from faceedit_app.editing.edits.media import Placement
    from faceedit_app.editing.files.journal import Journal
    from faceedit_app.editing.files.project import ViewState
    from faceedit_app.editing.session import EditSession
    from faceedit_app.networks.engine import Engine

_SLICE = 0.02  # seconds
_NO_INPUT = QEventLoop.ProcessEventsFlag.ExcludeUserInputEvents


class Document(QObject):
    """Holds the session, and passes on what it announces: the one way from it to the views.

    Whoever changes something calls the session and says nothing to the views.

    Signals:
        opened(): another take is open.
        previewed(): a gesture is in progress: curves and face differ from what is kept.
        changed(): edits, settings, media or networks changed, or a gesture was dropped.
        saved(): the edits are exported or saved.
    """

    opened = Signal()
    previewed = Signal()
    changed = Signal()
    saved = Signal()

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.session: EditSession | None = None
        self.engine: Engine | None = None
        self.path: Path | None = None
        self.project: Path | None = None
        self.keeps_journal = False
        self._journal: Journal | None = None

    @property
    def is_clean(self) -> bool:
        """Whether nothing would be lost by closing."""
        return self.session is None or self.session.is_exported

    def adopt(self, session: EditSession, project: Path | None = None) -> None:
        """Open a take that has been read, and the project that it belongs to."""
        if self.engine is not None and not session.has_engine:
            session.use_engine(self.engine)
        self.close_journal()
        if self.session is not None:
            self.session.previewed.disconnect(self._pass_on_preview)
            self.session.changed.disconnect(self._pass_on_change)
        self.session, self.path, self.project = session, session.take.path, project
        session.previewed.connect(self._pass_on_preview)
        session.changed.connect(self._pass_on_change)
        if self.keeps_journal:
            self._open_journal(session)
        self.opened.emit()

    def _pass_on_preview(self) -> None:
        self.previewed.emit()

    def _pass_on_change(self) -> None:
        self.changed.emit()

    def _open_journal(self, session: EditSession) -> None:
        """Write down every step from now on; what is not saved yet, at once."""
        from faceedit_app.editing.files.journal import Journal

        self._journal = Journal(session.take.path, self.project, fps=session.take.fps)
        session.stepped.connect(self._journal.record)
        if not session.is_exported:
            self._journal.record(session.state)

    @property
    def journal_note(self) -> str:
        """Why gestures cannot be written down; empty if all is well."""
        return self._journal.note if self._journal is not None else ""

    def close_journal(self) -> None:
        """Nothing needs to be recovered: all is saved, or not wanted."""
        if self._journal is not None:
            if self.session is not None:
                self.session.stepped.disconnect(self._journal.record)
            self._journal.close()
            self._journal = None

    def _is_saved(self) -> None:
        if self._journal is not None:
            self._journal.saved(self.project)
            if self.session is not None and not self.session.is_exported:
                self._journal.record(self.session.state)  # media are in no export
        self.saved.emit()

    # --- what views and commands do where a take is open ---------------------------------------

    def act(self, work: Callable[[EditSession], object]) -> None:
        """Do something with the session, if there is one."""
        if self.session is not None:
            work(self.session)

    def use_engine(self, engine: Engine) -> None:
        """Answer by the networks from now on."""
        self.engine = engine
        self.act(lambda session: session.use_engine(engine))

    def preview(self, *edits: Edit) -> None:
        """Show the take with more edits: they are proposed."""
        self.act(lambda session: session.preview(*edits))

    def commit(self, name: str = "", merge: Hashable = None) -> None:
        """Keep what is previewed as one step."""
        self.act(lambda session: session.commit(name, merge))

    def seal(self) -> None:
        """End the last gesture for good: whatever comes now is a step of its own."""
        self.act(lambda session: session.seal())

    def cancel(self) -> bool:
        """Drop what is previewed; False if nothing was."""
        return self.session is not None and self.session.cancel()

    def undo(self) -> None:
        """Take the last step back."""
        self.act(lambda session: session.undo())

    def redo(self) -> None:
        """Take the step again."""
        self.act(lambda session: session.redo())

    # --- files ---------------------------------------------------------------------------------

    def export(self, path: Path) -> None:
        """Write the edited take.

        Raises:
            FileError: it cannot be written.
        """
        if self.session is not None:
            while self.session.live.work(_SLICE):  # the window stays alive
                QCoreApplication.processEvents(_NO_INPUT)
            self.session.export(path)
            self._is_saved()

    def save_project(self, path: Path, view: ViewState, media: Placement) -> None:
        """Write take, edits, view, sound and film as one project.

        Raises:
            FileError: it cannot be written; an existing file is then untouched.
        """
        from faceedit_app.editing.files.project import Project, write_project

        session = self.session
        if session is None:
            return
        take = session.take.path.absolute()
        # Of the take as it was opened: the file may be gone by now, or exported over.
        mark = session.fingerprint
        parts = (view, media.sound, media.film, session.take.fps)
        project = Project(take, mark, session.state, *parts)
        write_project(path, project)
        session.mark_saved()
        self.project = path
        self._is_saved()

    def save_edits(self, path: Path) -> None:
        """Write the list of edits.

        Raises:
            FileError: it cannot be written.
        """
        if self.session is not None:
            self.session.save_edits(path)
            self._is_saved()

    def load_edits(self, path: Path) -> None:
        """Add the edits of a file, as one undo step.

        Raises:
            FileError: it is no edits file.
        """
        if self.session is not None:
            self.session.load_edits(path)
