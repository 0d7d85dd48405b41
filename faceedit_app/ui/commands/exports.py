"""Export for the File menu: ask how and where, and keep recordings safe."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from faceedit_app.core.atomic import said_of
from faceedit_app.core.errors import FaceEditError
from faceedit_app.ui.commands import dialogs, places
from faceedit_app.ui.commands.film_export import FilmExport
from faceedit_app.ui.commands.workspace import Workspace
from faceedit_app.ui.commands.writing import Advance, IsStopped, Writing

if TYPE_CHECKING:
    from faceedit_app.editing.exporting import Exported, Options, OutFormat


class Exports:
    """Writes the open take for other programs."""

    def __init__(self, workspace: Workspace, failed: Callable[[Exception], None]) -> None:
        self._workspace, self._failed = workspace, failed
        self._film = FilmExport(workspace, self._place, failed)
        self._writing = Writing(workspace, "Export")

    def export(self) -> bool:
        """Export the take as it came; False if the user cancels or it fails."""
        from faceedit_app.editing.exporting import Options, by_ending

        left = self._workspace.end_before_writing()
        document = self._workspace.document
        assert document.path is not None
        place = self._place("_edited", document.path.suffix or ".csv")
        if place is None:
            return False
        path, overwrite = place
        self._note_wait()
        session = self._workspace.session
        form = by_ending(path, session.take) if session is not None else None
        if form is not None:  # take.glb was typed for a take that came as a CSV
            options = Options(character=document.character, overwrite=overwrite)
            self._write(path, form, options, left)
            return True
        try:
            backup = document.export(path, overwrite)
        except FaceEditError as error:
            self._failed(error)
            return False
        self._done(path, left + said_of(backup))
        if session is not None and (note := session.take.rate_note):
            # Longer on screen than the message: other programs play the file at that rate.
            self._workspace.warning.emit(
                f"{path.name}: {note}; a format chosen in File > Export as has the new rate"
            )
        return True

    def export_as(self) -> None:
        """Export the take in a format, at a rate and on a character that the user chooses."""
        left = self._workspace.end_before_writing()
        session = self._workspace.session
        if session is None:
            return
        document = self._workspace.document
        shown = document.character
        chosen = dialogs.ask_export_as(
            self._workspace.window,
            session.take,
            shown.character.path if shown is not None else None,
        )
        if chosen is None:
            return
        form, options = chosen
        place = self._place("_edited", form.ending)
        if place is None:
            return
        path, overwrite = place
        self._write(path, form, replace(options, overwrite=overwrite, character=shown), left)

    def _write(self, path: Path, form: OutFormat, options: Options, left: str) -> None:
        """Write the take in the background, and say what to do with it and what was left out."""
        from faceedit_app.editing.exporting import export_take

        if self._writing.is_busy:
            self._workspace.message.emit("Another file is being exported; wait until it is written")
            return
        document, session = self._workspace.document, self._workspace.session
        assert session is not None
        self._note_wait()
        document.work_off()
        take, edited, state = session.take, session.edited_clip(), session.state
        page = self._workspace.page
        follows = page is not None and page.face.follows_head
        options = replace(options, follows_head=follows, filled=session.filled_rows())

        def done(written: Exported) -> None:
            if document.session is session:
                document.note_export(path, state)
            self._done(path, left + said_of(written.backup))
            lines = [*written.said("View > Follow the head"), *form.hints(written.clip.rate)]
            dialogs.show_exported(self._workspace.window, path, lines)

        def write(_advance: Advance, stopped: IsStopped) -> Exported:
            return export_take(take, edited, path, form, options, stopped)

        self._workspace.message.emit(f"Exporting {path.name}…")
        self._writing.start(path.name, "Exporting", write, done, self._report)

    def export_film(self) -> None:
        """Film the take."""
        self._film.export()

    @property
    def is_filming(self) -> bool:
        """Whether a film is being written."""
        return self._film.is_filming

    def _place(self, tail: str, ending: str) -> tuple[Path, bool] | None:
        """Where to write, and whether to replace a recording there; None if the user cancels."""
        window = self._workspace.window
        suggestion = self._workspace.suggest("export", tail, ending)
        take = self._workspace.document.path  # about which `_why_keep` asks
        while path := places.ask_where(self._workspace, dialogs.ask_export, suggestion, take):
            reason = self._why_keep(path)
            if not reason:
                return path, False
            answer = dialogs.ask_overwrite(window, path, reason)
            if answer is not dialogs.Changed.ELSEWHERE:
                return (path, True) if answer is dialogs.Changed.REPLACE else None
        return None

    def _note_wait(self) -> None:
        if self._workspace.document.awaits_engine:
            self._workspace.message.emit("Waiting for the face model before exporting…")

    def _why_keep(self, path: Path) -> str:
        """Why a file should not be replaced; "" if it may be."""
        from faceedit_app.editing.files.originals import why_keep

        document = self._workspace.document
        assert document.path is not None
        if document.was_changed(path):
            return "has been changed by another program since it was opened"
        own = [document.project] if document.project is not None else []
        return why_keep(path, document.path, [*own, *self._workspace.preferences.recent()])

    def _report(self, error: Exception) -> None:
        if not isinstance(error, FaceEditError):
            raise error
        self._workspace.message.emit("")
        self._failed(error)

    def _done(self, path: Path, left: str) -> None:
        self._workspace.preferences.set_folder("export", path.resolve().parent)
        self._workspace.message.emit(f"Exported {path}{left}")
