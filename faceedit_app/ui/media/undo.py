"""Makes changes to sound and film previewed, committed and undone like edits."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import QObject

from faceedit_app.editing.edits.media import Placement, describe_change
from faceedit_app.ui.media.take_media import TakeMedia
from faceedit_app.ui.state.document import Document

if TYPE_CHECKING:  # the window is there before the solver is imported
    from faceedit_app.editing.session import EditSession

_NUMBERS = "offset"  # merge key: arrow keys and wheel ticks on an offset are one step


class MediaSteps(QObject):
    """Passes the media's placement to the session, and the session's back to the media."""

    def __init__(self, document: Document, media: TakeMedia) -> None:
        super().__init__(document)
        self._document, self._media = document, media
        self._is_previewed = False  # the session previews a drag of the sound
        self._waits = False  # for another gesture to end, which no step may interrupt
        self._follows = False
        document.opened.connect(self._opened)
        media.placed.connect(self._moved)
        media.acted.connect(self._acted)
        document.changed.connect(self._follow)

    def settle(self) -> None:
        """Commit changes."""
        self._keep()

    def _acted(self) -> None:
        """A gesture is over: later changes are a new step."""
        self._keep()
        self._document.seal()

    def _moved(self) -> None:
        """An offset changed: preview it during a drag, otherwise commit it."""
        if self._follows:
            return
        if not self._media.is_held:
            self._keep(_NUMBERS)
            return
        session = self._document.session
        if session is not None and (self._is_previewed or not session.is_previewing):
            self._is_previewed = True
            session.preview_media(self._media.placement)

    def _keep(self, merge: str | None = None) -> None:
        session, placement = self._document.session, self._media.placement
        if session is None or self._media.is_held:
            return
        self._waits = session.is_previewing and not self._is_previewed
        if self._waits:
            return
        self._is_previewed = False
        before = self._placement_of(session)
        if placement != before:
            session.place(placement, describe_change(before, placement), merge)
        else:
            session.cancel()

    def _placement_of(self, session: EditSession) -> Placement:
        return session.state.media or self._media.base

    def _follow(self) -> None:
        """After an undo, bring sound and film to the session's placement."""
        session = self._document.session
        if session is None:
            return
        self._is_previewed &= session.is_previewing
        if self._media.is_held or self._follows:
            return
        if self._waits:
            self._keep()
            return
        self._follows = True
        self._media.show(self._placement_of(session))
        self._follows = False

    def _opened(self) -> None:
        self._is_previewed = self._waits = False
        if (session := self._document.session) is not None:
            session.beside = self._beside

    def _beside(self) -> Placement:
        return self._media.base
