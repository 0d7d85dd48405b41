"""The open take: its session, its files and its journal."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Hashable
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QCoreApplication, QEventLoop, QObject, Signal

from faceedit_app.core import on_disk
from faceedit_app.core.atomic import is_same_file
from faceedit_app.core.errors import FaceEditError
from faceedit_app.editing.files import is_kept_project

if TYPE_CHECKING:  # the window is there before the solver and the networks are imported
    from faceedit_app.characters.fitted import FittedCharacter
    from faceedit_app.editing.edits.edit import Edit
    from faceedit_app.editing.edits.media import Placement
    from faceedit_app.editing.files.fingerprint import KnownFile
    from faceedit_app.editing.files.journal import Journal
    from faceedit_app.editing.files.project import CharacterFile, ViewState
    from faceedit_app.editing.session import EditSession
    from faceedit_app.editing.steps import EditState
    from faceedit_app.networks.engine import Engine

_SLICE = 0.02  # seconds
_NO_INPUT = QEventLoop.ProcessEventsFlag.ExcludeUserInputEvents


class Document(QObject):
    """Holds the session, and passes its changes on to the views.

    Code that changes something calls the session, and leaves it to the document to update views.

    Attributes:
        path: the take's file.
        project_file: the project's file as it was read or saved last, if there is one. It may be
            the copy of a project that was replaced, which is not written.
        exported: the file that the take was last exported to.

    Signals:
        opened(): another take is open.
        previewed(): a gesture is in progress: curves and face show a preview.
        changed(): edits, settings, media or model changed, or a gesture was cancelled.
        saved(): the project was saved.
        character_changed(): another character is shown.
        rate_wanted(object, int): these steps, as of `travel`, lead to another frame rate, as
            `Take.fps`; who opens the take at that rate takes them.
        engine_settled(): the engine has been loaded, or cannot be.
    """

    opened = Signal()
    previewed = Signal()
    changed = Signal()
    saved = Signal()
    engine_settled = Signal()
    character_changed = Signal()
    rate_wanted = Signal(object, int)

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.session: EditSession | None = None
        self.engine: Engine | None = None
        self.character: FittedCharacter | None = None  # the user's own, if it is shown
        self.path: Path | None = None
        self.project_file: KnownFile | None = None
        self.exported: Path | None = None
        self._exported_state: EditState | None = None
        self.keeps_journal = False
        self.awaits_engine = False  # it is being loaded
        self._journal: Journal | None = None

    @property
    def project(self) -> Path | None:
        """The project's file, to which it is saved, if there is one."""
        file = self.project_file
        return file.path if file is not None and not is_kept_project(file.path) else None

    @property
    def is_clean(self) -> bool:
        """Whether all changes have been saved."""
        return self.session is None or self.session.is_saved

    @property
    def loses_by_closing(self) -> bool:
        """Whether closing would lose something: what is not saved, or no longer in the project."""
        return not self.is_clean or not self.is_in_project

    @property
    def is_in_project(self) -> bool:
        """Whether the project's file, if there is one, still holds what was saved in it.

        Looks into the file. One in which another window has saved the same, or only another view,
        holds it as well.
        """
        from faceedit_app.editing.files.project import Project, holds

        session, file = self.session, self.project_file
        if session is None or file is None:
            return True
        if on_disk.is_file(file.path) and not file.was_changed:
            return True
        take = session.take
        return holds(
            file.path, Project(take.path, session.fingerprint, session.state, fps=take.fps)
        )

    def adopt(self, session: EditSession, project: KnownFile | None = None) -> None:
        """Open a take that has been read, with its project, if any."""
        if self.engine is not None and not session.has_engine:
            session.use_engine(self.engine)
        if self.character is not None:
            session.use_character(self.character.rig)
        self.close_journal()
        if self.session is not None:
            self.session.previewed.disconnect(self._pass_on_preview)
            self.session.changed.disconnect(self._pass_on_change)
        self.session, self.path, self.project_file = session, session.take.path, project
        self.exported = self._exported_state = None
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
        """Record every step from now on, and unsaved edits at once."""
        from faceedit_app.editing.files.journal import Journal

        self._journal = Journal(
            session.take.path,
            self.project_file,
            fps=session.take.fps,
            opened=session.fingerprint,
            exported_over=session.exported_over,
            character=self._character_path,
            origin=session.origin,
        )
        session.stepped.connect(self._journal.record)
        session.exporting.connect(self._journal.exporting)
        if not session.is_saved:
            self._journal.record(session.state)

    @property
    def journal_note(self) -> str:
        """Why steps cannot be recorded; empty if they can."""
        return self._journal.note if self._journal is not None else ""

    @property
    def open_elsewhere(self) -> Path | None:
        """The take, or a copy (`.bak`) of it, if another window has that open now."""
        from faceedit_app.editing.files.pending import open_elsewhere

        return open_elsewhere(self._journal) if self._journal is not None else None

    def close_journal(self) -> None:
        """Discard the journal: everything is saved, or discarded by the user."""
        if self._journal is not None:
            if self.session is not None:
                self.session.stepped.disconnect(self._journal.record)
                self.session.exporting.disconnect(self._journal.exporting)
            self._journal.close()
            self._journal = None

    def _is_saved(self) -> None:
        if self._journal is not None and self.session is not None:
            self._journal.saved(self.project_file, self.session.origin)
        self.saved.emit()

    # --- changes to the open take ----------------------------------------------------------------

    def act(self, work: Callable[[EditSession], object]) -> None:
        """Do something with the session, if there is one."""
        if self.session is not None:
            work(self.session)

    def use_engine(self, engine: Engine) -> None:
        """Use the engine from now on."""
        self.engine = engine
        self.act(lambda session: session.use_engine(engine))
        self.settle_engine()

    def settle_engine(self) -> None:
        """Note that the engine is loaded, or cannot be."""
        self.awaits_engine = False
        self.engine_settled.emit()

    def use_character(self, character: FittedCharacter | None) -> None:
        """Show the user's character from now on, and close lips and lids on it; None = ours."""
        self.character = character
        rig = character.rig if character is not None else None
        self.act(lambda session: session.use_character(rig))
        if self._journal is not None:
            self._journal.showing(self._character_path)
        self.character_changed.emit()

    def preview(self, *edits: Edit) -> None:
        """Preview additional edits, as a proposal."""
        self.act(lambda session: session.preview(*edits))

    def commit(self, name: str = "", merge: Hashable = None) -> None:
        """Commit the preview as one step."""
        self.act(lambda session: session.commit(name, merge))

    def seal(self) -> None:
        """End the last gesture for good: later changes are not merged with it."""
        self.act(lambda session: session.seal())

    def cancel(self) -> bool:
        """Cancel the preview; False if there is none."""
        return self.session is not None and self.session.cancel()

    def undo(self) -> None:
        """Undo the last step."""
        self.travel(-1)

    def redo(self) -> None:
        """Redo the step that was undone last."""
        self.travel(1)

    def travel(self, steps: int) -> None:
        """Redo some steps, or undo as many if below 0."""
        session = self.session
        if session is None:
            return
        rate = session.rate_after(steps)
        if rate == session.take.fps:
            session.travel(steps)
        else:
            self.rate_wanted.emit(rate, steps)

    # --- files ---------------------------------------------------------------------------------

    def was_changed(self, path: Path) -> bool:
        """Whether another program has changed a file since this window read or wrote it.

        True only for the open take and its project; a file that is gone has not changed.
        """
        from faceedit_app.editing.files.fingerprint import KnownFile

        session = self.session
        if session is not None and is_same_file(path, session.take.path):
            marks = {session.fingerprint, session.exported_over} - {None}
            return bool(marks) and all(KnownFile(path, mark).was_changed for mark in marks)
        if self.project_file is not None and is_same_file(path, self.project_file.path):
            return self.project_file.was_changed
        return False

    def export(self, path: Path, overwrite: bool = False) -> Path | None:
        """Write the edited take; see `EditSession.export`.

        Raises:
            FileError: it cannot be written.
        """
        if self.session is None:
            return None
        self.work_off()
        backup = self.session.export(path, overwrite)
        self.note_export(path, self.session.state)
        return backup

    def note_export(self, path: Path, state: EditState) -> None:
        """Remember that a file holds the take with the edits of a state."""
        self.exported, self._exported_state = path, state

    @property
    def export_is_current(self) -> bool:
        """Whether the file that was exported last holds all edits, as they are now."""
        session, then = self.session, self._exported_state
        if session is None or then is None:
            return False
        return (session.edits, session.settings) == (then.edits, then.settings)

    def work_off(self) -> None:
        """Finish the answer to all edits, in slices, so that the window stays responsive.

        If the engine that answers them is still being loaded, wait for it.
        """
        if self.awaits_engine:
            waiting = QEventLoop()
            self.engine_settled.connect(waiting.quit)
            waiting.exec(_NO_INPUT)
        while self.session is not None and self.session.live.work(_SLICE):
            QCoreApplication.processEvents(_NO_INPUT)

    def save_project(self, path: Path, view: ViewState, media: Placement) -> Path | None:
        """Write take, edits, view, sound and film as one project.

        Returns:
            The copy that was kept of a file that is there, unless it is the project that this
            window has open, as it was read or saved last; None if there was none.

        Raises:
            FileError: it cannot be written; an existing file is then untouched.
        """
        from faceedit_app.editing.files.fingerprint import known
        from faceedit_app.editing.files.project import Project, write_project

        session = self.session
        if session is None:
            return None
        take = session.take.path.absolute()
        # Of the take as opened: the file may be gone or overwritten by now.
        mark = session.fingerprint
        parts = (view, media.sound, media.film, session.take.fps, self._character_file())
        project = Project(take, mark, session.state, *parts, session.exported_over)
        backup = write_project(path, project, self._is_own)
        self.project_file = known(path)
        session.mark_saved()
        self._is_saved()
        return backup

    def _is_own(self, path: Path) -> bool:
        """Whether a file is the open project, and nobody else has changed it."""
        file, own = self.project_file, self.project
        if file is None or own is None:
            return False
        return is_same_file(path, own) and not file.was_changed

    @property
    def _character_path(self) -> Path | None:
        return self.character.character.path.absolute() if self.character is not None else None

    def _character_file(self) -> CharacterFile | None:
        from faceedit_app.editing.files.fingerprint import fingerprint
        from faceedit_app.editing.files.project import CharacterFile

        path = self._character_path
        if path is None:
            return None
        with contextlib.suppress(FaceEditError):  # it may be gone by now, or a folder
            return CharacterFile(path, fingerprint(path))
        return CharacterFile(path)

    def save_edits(self, path: Path) -> Path | None:
        """Write the list of edits; see `EditSession.save_edits`.

        Raises:
            FileError: it cannot be written.
        """
        return None if self.session is None else self.session.save_edits(path)

    def load_edits(self, path: Path) -> None:
        """Add the edits in a file, as one step.

        Raises:
            FileError: it is not an edits file.
        """
        if self.session is not None:
            self.session.load_edits(path)
