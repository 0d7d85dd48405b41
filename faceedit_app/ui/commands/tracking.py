"""Tracking a film from the window: progress, then the take beside its film."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from faceedit_app.core import on_disk
from faceedit_app.core.atomic import check_writable, keep_inputs, said_of
from faceedit_app.core.errors import FaceEditError
from faceedit_app.editing.edits.media import MediaFile, Placement
from faceedit_app.media import beside
from faceedit_app.media.container import Abandoned, has_sound
from faceedit_app.tracking.film_landmarks import Chosen, NoFaceThere
from faceedit_app.tracking.landmark_file import files_of, write_landmarks
from faceedit_app.ui.commands.places import refuse_open
from faceedit_app.ui.commands.workspace import Workspace
from faceedit_app.ui.look.texts import sentence
from faceedit_app.ui.media.tracking_dialog import TrackingDialog
from faceedit_app.ui.state import loading

if TYPE_CHECKING:  # these bring much along
    from faceedit_app.editing.session import EditSession
    from faceedit_app.tracking.tracker import Tracked


def suggested_take(film: Path) -> Path:
    """A name for the take of a film that does not exist yet, beside it."""
    for name in (f"{film.stem}.csv", f"{film.stem}_tracked.csv"):
        if not on_disk.exists(film.with_name(name)):
            return film.with_name(name)
    return film.with_name(f"{film.stem}_tracked.csv")


class FilmTracking:
    """Tracks one film in the background, while a dialog shows progress.

    Args:
        workspace: the window's state.
        film: the film.
        take: the take to write.
        failed: is given the error of a film that cannot be tracked; the open take stays.
    """

    def __init__(
        self, workspace: Workspace, film: Path, take: Path, failed: Callable[[Exception], None]
    ) -> None:
        self._workspace, self._film, self._take, self._failed = workspace, film, take, failed
        self._face: Chosen | None = None
        self._face_before: Chosen | None = None  # what was followed before the last choice
        self._again = False  # another face was chosen: begin again
        self._written: Callable[[], None] = lambda: None
        self._kept: tuple[Path | None, ...] = ()  # copies of files of other kinds
        self.dialog = TrackingDialog(workspace.window, film)
        self.dialog.face_chosen.connect(self._choose)

    def start(self) -> None:
        """Show the dialog and begin, if the take can be written: no film is tracked in vain."""
        try:
            keep_inputs(files_of(self._take), [self._film])
            for path in files_of(self._take):
                refuse_open(self._workspace, path)
                check_writable(path)
        except FaceEditError as error:
            self.dialog.deleteLater()
            self._failed(error)
            return
        self._written = self._workspace.unfinished.begin(self._take.name, self._give_up)
        self.dialog.open()
        self._run()

    def _run(self) -> None:
        dialog, face, rig = self.dialog, self._face, self._workspace.rig

        def work() -> Tracked:
            # Imported here, in the background, as it takes a moment.
            from faceedit_app.tracking.tracker import track_film, write_take

            tracked = track_film(
                self._film,
                rig or loading.load_character(),
                dialog.report,
                dialog.is_stopped,
                face,
                choose=dialog.ask_face,
            )
            self._kept = write_take(tracked, self._take), write_landmarks(tracked, self._take)
            return tracked

        self._workspace.background.run(work, self._done, self._ended)

    def _choose(self, face: Chosen) -> None:
        if not self._again:
            self._face_before = self._face
        self._face, self._again = face, True

    def _ended(self, error: Exception) -> None:
        """It failed, was cancelled, or another face was chosen."""
        if isinstance(error, Abandoned):
            if self._again:
                self._again = False
                self.dialog.restart()
                self._run()
            else:
                self._close()
                self._workspace.message.emit(f"{self._film.name} was not tracked")
            return
        if isinstance(error, NoFaceThere) and self._face != self._face_before:
            self._workspace.warning.emit(str(error))
            self._face = self._face_before
            self._run()
            return
        self._close()
        if not isinstance(error, FaceEditError):
            raise error
        self._failed(error)

    def _give_up(self) -> None:
        self._again = False
        self.dialog.stop()

    def _close(self) -> None:
        self._written()
        self.dialog.close()
        self.dialog.deleteLater()

    def _done(self, tracked: Tracked) -> None:
        self._close()
        workspace, film = self._workspace, self._film
        begins = float(tracked.clip.times[0])  # in the film; before it there is no face

        def prepare(session: EditSession) -> None:
            if begins > 0 or beside(self._take.absolute())[1] != film.absolute():
                entry = MediaFile(film.absolute(), -begins)
                placement = Placement(entry if has_sound(film) else None, entry)
                session.begin_with(replace(session.state, media=placement))
                session.mark_saved()

        def opened() -> None:
            for note in tracked.notes:
                workspace.warning.emit(sentence(note))
            frames = int(tracked.sure.sum())
            text = f"Tracked {frames} frames of {film.name}: {self._take}{said_of(*self._kept)}"
            workspace.message.emit(text)

        workspace.opener.open(self._take, prepare, opened)
