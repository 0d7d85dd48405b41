"""The open take and what is done to it: the doing behind the menus, without any dialog."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QCoreApplication, QEventLoop, QObject, Signal

from faceedit_app.core.controls import CONTROL_IDS

if TYPE_CHECKING:  # torch comes with these; the window is there before it
    from faceedit_app.editing.edits.edit import Edit
    from faceedit_app.editing.edits.media import Placement
    from faceedit_app.editing.files.journal import Journal
    from faceedit_app.editing.files.project import View
    from faceedit_app.editing.session import EditSession
    from faceedit_app.editing.solving.solver import Settings
    from faceedit_app.networks.engine import Engine

_SLICE = 0.02  # seconds
_NO_INPUT = QEventLoop.ProcessEventsFlag.ExcludeUserInputEvents


class Document(QObject):
    """Holds the edit session and tells the views when something changed.

    Signals:
        opened(): another take is open.
        changed(): edits, settings or the networks changed; all curves and the face may differ.
        previewed(): the session shows a gesture in progress: curves and face differ.
        saved(): the edits are exported or saved.
    """

    opened = Signal()
    changed = Signal()
    previewed = Signal()
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
        self.session, self.path, self.project = session, session.take.path, project
        if self.keeps_journal:
            self._open_journal(session)
        self.opened.emit()

    def _open_journal(self, session: EditSession) -> None:
        """Write down every finished gesture from now on; what is not saved yet, at once."""
        from faceedit_app.editing.files.journal import Journal

        self._journal = Journal(session.take.path, self.project)
        session.on_finished = self._journal.record
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
                self.session.on_finished = None
            self._journal.close()
            self._journal = None

    def _is_saved(self) -> None:
        if self._journal is not None:
            self._journal.saved(self.project)
            if self.session is not None and not self.session.is_exported:
                self._journal.record(self.session.state)  # media are in no export
        self.saved.emit()

    def use_engine(self, engine: Engine) -> None:
        """Answer by the networks from now on."""
        self.engine = engine
        if self.session is not None:
            self.session.use_engine(engine)
            self.changed.emit()

    def act(self, work: Callable[[EditSession], object]) -> None:
        """Do something with the session that ends in an undo step, and tell."""
        if self.session is not None:
            work(self.session)
            self.changed.emit()

    def preview_replace(self, index: int, edit: Edit) -> None:
        """Show the take with another edit in place of one: a gesture in progress."""
        if self.session is not None:
            self.session.preview_replace(index, edit)
            self.previewed.emit()

    def preview_list(self, edits: Sequence[Edit]) -> None:
        """Show the take with another list of edits: a gesture in progress."""
        if self.session is not None:
            self.session.preview_list(edits)
            self.previewed.emit()

    def preview(self, *edits: Edit) -> None:
        """Show the take with more edits: they are proposed."""
        if self.session is not None:
            self.session.preview(*edits)
            self.previewed.emit()

    def commit(self) -> None:
        """Keep what is shown as one undo step."""
        self.act(lambda session: session.commit())

    def cancel(self) -> bool:
        """Drop what is shown and not kept; False if there was no such thing."""
        if self.session is None or not self.session.is_floating:
            return False
        self.act(lambda session: session.cancel())
        return True

    def undo(self) -> None:
        """Take the last step back."""
        if self.session is not None and self.session.can_undo:
            self.session.undo()
            self.changed.emit()

    def redo(self) -> None:
        """Take the step again."""
        if self.session is not None and self.session.can_redo:
            self.session.redo()
            self.changed.emit()

    def reset(
        self,
        start: float,
        end: float,
        falloff: float = 0.0,
        controls: Sequence[str] = CONTROL_IDS,
    ) -> None:
        """Bring curves back to the take as tracked from `start` to `end` seconds.

        Like any edit it fades out over `falloff` seconds on either side, so that no curve jumps.
        """
        from faceedit_app.editing.edits.edit import Edit, Op

        if self.session is not None and controls and self.session.edits:
            self.session.add(Edit(tuple(controls), Op.RESET, start, end, falloff))
            self.changed.emit()

    def configure(self, settings: Settings, replace_step: bool = False) -> bool:
        """Answer by other settings, as one undo step.

        Args:
            replace_step: the last step was this gesture's own and gives way to the new one.

        Returns:
            Whether there is now a step of this gesture.
        """
        session = self.session
        if session is None:
            return False
        if replace_step:
            session.undo()
        stepped = session.settings != settings
        session.configure(settings)
        self.changed.emit()
        return stepped

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

    def save_project(self, path: Path, view: View, media: Placement) -> None:
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
        project = Project(take, mark, session.state, view, media.sound, media.film)
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
            self.changed.emit()
