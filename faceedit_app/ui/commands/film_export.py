"""Export film for the File menu: film the take in the background, with progress and Cancel."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Qt, Signal
from PySide6.QtWidgets import QProgressDialog

from faceedit_app.core.errors import FaceEditError
from faceedit_app.ui.commands import dialogs
from faceedit_app.ui.commands.workspace import Workspace

if TYPE_CHECKING:
    from faceedit_app.editing.filming import Filmed, Shot

_AFTER_MS = 300  # a film that takes no longer shows no progress


class FilmExport(QObject):
    """Films the open take, one film at a time."""

    _advanced = Signal(int, int)  # pictures done, of all; from the thread that films

    def __init__(
        self,
        workspace: Workspace,
        place: Callable[[str, str], tuple[Path, bool] | None],
        failed: Callable[[Exception], None],
    ) -> None:
        """Args: `place` asks for a file, given a tail and an ending; `failed` shows an error."""
        super().__init__(workspace)
        self._workspace, self._place, self._failed = workspace, place, failed
        self._stop: threading.Event | None = None
        self._dialog: QProgressDialog | None = None
        self._advanced.connect(self._show_progress, Qt.ConnectionType.QueuedConnection)

    @property
    def is_filming(self) -> bool:
        """Whether a film is being written."""
        return self._stop is not None

    def export(self) -> None:
        """Ask how and where, and film the take."""
        self._workspace.end_gestures()
        session, media = self._workspace.session, self._workspace.media
        if session is None or self.is_filming:
            return
        chosen = dialogs.ask_film(
            self._workspace.window,
            session.take.clip.rate,
            media.sound is not None,
            media.film is not None,
        )
        if chosen is None:
            return
        form, shot = chosen
        found = self._place("_face", form.ending)
        if found is not None:
            path, overwrite = found
            self._film(path, replace(shot, overwrite=overwrite, mirrored=media.mirrored))

    def _film(self, path: Path, shot: Shot) -> None:
        from faceedit_app.editing.filming import film_take

        session, page = self._workspace.session, self._workspace.page
        assert session is not None
        if page is not None:
            width, height = shot.view.room(shot.size)
            camera = page.face.viewport.camera_for(width / height)
            shot = replace(shot, camera=camera, follows_head=page.face.follows_head)
        self._workspace.document.work_off()
        stop = self._stop = threading.Event()
        take, rig, weights = session.take, session.shown_rig, session.weights.copy()
        turns = None if session.rotations is None else session.rotations.copy()
        placement = self._workspace.media.placement
        self._open_dialog(path, stop)
        self._workspace.background.run(
            lambda: film_take(
                take, weights, rig, placement, path, shot, self._advanced.emit, stop.is_set, turns
            ),
            self._done,
            self._report,
        )

    def _open_dialog(self, path: Path, stop: threading.Event) -> None:
        dialog = QProgressDialog(f"Filming {path.name}…", "Cancel", 0, 0, self._workspace.window)
        dialog.setWindowTitle("Export film")
        dialog.setMinimumDuration(_AFTER_MS)
        dialog.setWindowModality(Qt.WindowModality.NonModal)
        dialog.setAutoClose(False)
        dialog.setAutoReset(False)
        dialog.canceled.connect(stop.set)
        self._dialog = dialog

    def _show_progress(self, done: int, of: int) -> None:
        if self._dialog is not None and not self._dialog.wasCanceled():
            self._dialog.setMaximum(of)
            self._dialog.setValue(done)

    def _finish(self) -> None:
        if self._dialog is not None:
            self._dialog.canceled.disconnect()  # closing cancels
            self._dialog.close()
            self._dialog.deleteLater()
        self._dialog = self._stop = None

    def _done(self, filmed: Filmed | None) -> None:
        self._finish()
        if filmed is None:
            self._workspace.message.emit("Film cancelled; nothing was written")
            return
        self._workspace.preferences.set_folder("export", filmed.path.resolve().parent)
        self._workspace.message.emit(f"Exported {filmed.path} ({filmed.codecs})")

    def _report(self, error: Exception) -> None:
        self._finish()
        self._workspace.message.emit("")
        if not isinstance(error, FaceEditError):
            raise error
        self._failed(error)

    def stop(self) -> None:
        """Give up, as the window closes."""
        if self._stop is not None:
            self._stop.set()
            self._finish()
