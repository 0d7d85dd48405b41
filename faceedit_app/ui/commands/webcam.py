"""Record from webcam, for the File menu: a film, which is then tracked like any other."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from faceedit_app.core import on_disk
from faceedit_app.core.errors import FaceEditError, FileError
from faceedit_app.ui.commands import dialogs, file_kinds
from faceedit_app.ui.commands.workspace import Workspace

if TYPE_CHECKING:  # loaded with the first recording
    from faceedit_app.media.webcam import Webcam
    from faceedit_app.ui.media.webcam_dialog import WebcamDialog


def suggested_film(folder: Path) -> Path:
    """A name for a film that does not exist yet."""
    names = (f"performance{number}.mp4" for number in itertools.chain([""], itertools.count(2)))
    return next(folder / name for name in names if not on_disk.exists(folder / name))


class WebcamRecording:
    """Looks for webcams, asks for a name, records, and hands the film on.

    Args:
        workspace: the window's state.
        track: is given the film.
        failed: is given what went wrong.
    """

    def __init__(
        self,
        workspace: Workspace,
        track: Callable[[Path], None],
        failed: Callable[[Exception], None],
    ) -> None:
        self._workspace, self._track, self._failed = workspace, track, failed
        self._dialog: WebcamDialog | None = None
        self._is_looking = False

    def start(self) -> None:
        """Look for webcams, which may take a second."""
        if self._is_looking or self._dialog is not None:
            return
        self._is_looking = True
        self._workspace.message.emit("Looking for webcams…")

        def work() -> list[Webcam]:
            from faceedit_app.media.webcam import webcams

            return webcams()

        self._workspace.background.run(work, self._found, self._not_found)

    def _not_found(self, error: Exception) -> None:
        self._looked()
        if not isinstance(error, FaceEditError):
            raise error
        self._failed(error)

    def _looked(self) -> None:
        """Take back the message: an error or a question follows, and may wait for long."""
        self._is_looking = False
        self._workspace.message.emit("")

    def _found(self, webcams: list[Webcam]) -> None:
        self._looked()
        if not webcams:
            from faceedit_app.media.webcam import NO_WEBCAM

            self._failed(FaceEditError(NO_WEBCAM))
            return
        window, preferences = self._workspace.window, self._workspace.preferences
        suggestion = suggested_film(preferences.folder("media"))
        film = dialogs.ask_record_name(window, suggestion, file_kinds.MP4)
        if film is None:
            return
        if film.suffix.lower() != ".mp4":
            film = film.with_name(f"{film.name}.mp4")
        if on_disk.exists(film):
            self._failed(FileError(film, "exists", "choose a new name for the film"))
            return
        preferences.set_folder("media", film.resolve().parent)
        from faceedit_app.ui.media.webcam_dialog import WebcamDialog

        dialog = WebcamDialog(window, webcams, film)
        dialog.recorded.connect(self._recorded)
        dialog.failed.connect(self._failed)
        dialog.finished.connect(self._closed)
        self._dialog = dialog
        dialog.open()

    def _recorded(self, film: Path) -> None:
        self._workspace.message.emit(f"Recorded {film}")
        self._track(film)

    def _closed(self) -> None:
        if self._dialog is not None:
            self._dialog.deleteLater()
            self._dialog = None

    def stop(self) -> None:
        """Stop as the window closes; what was recorded is in the film."""
        if self._dialog is not None:
            self._dialog.recorded.disconnect(self._recorded)
            self._dialog.reject()
