"""What is done with sound and film is undone and redone like all else."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, QTimer

from faceedit_app.ui.media.take_media import TakeMedia
from faceedit_app.ui.state.document import Document

if TYPE_CHECKING:  # the window is there before it is imported
    from faceedit_app.editing.session import EditState

NUDGE_MS = 900  # changes of an offset closer together than this are one undo step


class MediaSteps(QObject):
    """Keeps the media's placement as steps of the document, and follows its undo and redo."""

    def __init__(self, document: Document, media: TakeMedia) -> None:
        super().__init__(document)
        self._document, self._media = document, media
        self._waits = False  # for the end of a gesture on the curves, which no step may cut
        self._follows = False
        self._nudged: EditState | None = None  # what the last change of a number led to
        self._nudges = QTimer(self, singleShot=True, interval=NUDGE_MS)
        media.placed.connect(self._moved)
        media.acted.connect(self.settle)
        document.changed.connect(self._follow)
        document.opened.connect(self._forget)

    def settle(self) -> None:
        """What was done is a step; what comes now is another one."""
        self._nudges.stop()
        self._keep()

    def _moved(self) -> None:
        """An offset was changed: at once a step, which the next change soon after extends."""
        if self._follows or self._media.is_held:
            return
        session = self._document.session
        if self._nudges.isActive() and session is not None and session.state is self._nudged:
            session.undo()
        self._keep()
        self._nudged = session.state if session is not None else None
        self._nudges.start()

    def _keep(self) -> None:
        session = self._document.session
        if session is None or self._media.is_held:
            return
        self._waits = session.is_floating
        placement = self._media.placement
        if not self._waits and placement != (session.state.media or self._media.base):
            self._document.act(lambda session: session.place(placement))

    def _follow(self) -> None:
        """The document is elsewhere: after an undo, sound and film go there too."""
        session = self._document.session
        if session is None or self._media.is_held or self._follows:
            return
        if self._waits:
            self._keep()
            return
        self._follows = True
        self._media.show(session.state.media or self._media.base)
        self._follows = False

    def _forget(self) -> None:
        self._nudges.stop()
        self._waits = False
