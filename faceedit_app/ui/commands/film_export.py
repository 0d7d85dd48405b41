"""Export film for the File menu: film the take in the background, with progress and Cancel."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from faceedit_app.core.atomic import said_of
from faceedit_app.core.errors import FaceEditError
from faceedit_app.ui.commands import dialogs
from faceedit_app.ui.commands.workspace import Workspace
from faceedit_app.ui.commands.writing import Writing

if TYPE_CHECKING:
    from faceedit_app.editing.filming import Filmed, Shot


class FilmExport:
    """Films the open take, one film at a time."""

    def __init__(
        self,
        workspace: Workspace,
        place: Callable[[str, str], tuple[Path, bool] | None],
        failed: Callable[[Exception], None],
    ) -> None:
        """Args: `place` asks for a file, given a tail and an ending; `failed` shows an error."""
        self._workspace, self._place, self._failed = workspace, place, failed
        self._writing = Writing(workspace, "Export film")

    @property
    def is_filming(self) -> bool:
        """Whether a film is being written."""
        return self._writing.is_busy

    def export(self) -> None:
        """Ask how and where, and film the take."""
        left = self._workspace.end_before_writing()
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
            shot = replace(shot, overwrite=overwrite, mirrored=media.mirrored)
            self._film(path, shot, left)

    def _film(self, path: Path, shot: Shot, left: str) -> None:
        from faceedit_app.editing.filming import film_take, shown_by

        session, page = self._workspace.session, self._workspace.page
        assert session is not None
        if page is not None:
            width, height = shot.view.room(shot.size)
            camera = page.face.viewport.camera_for(width / height)
            shot = replace(shot, camera=camera, follows_head=page.face.follows_head)
        self._workspace.document.work_off()
        rig, (take, weights, turns) = session.shown_rig, shown_by(session)
        placement = self._workspace.media.placement
        self._writing.start(
            path.name,
            "Filming",
            lambda advance, stopped: film_take(
                take, weights, rig, placement, path, shot, advance, stopped, turns
            ),
            lambda filmed: self._done(filmed, left),
            self._report,
        )

    def _done(self, filmed: Filmed | None, left: str) -> None:
        if filmed is None:
            self._workspace.message.emit("Film cancelled; nothing was written")
            return
        self._workspace.preferences.set_folder("export", filmed.path.resolve().parent)
        kept = said_of(filmed.backup)
        self._workspace.message.emit(f"Exported {filmed.path} ({filmed.codecs}){left}{kept}")

    def _report(self, error: Exception) -> None:
        self._workspace.message.emit("")
        if not isinstance(error, FaceEditError):
            raise error
        self._failed(error)
