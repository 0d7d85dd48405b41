"""Computes the rest of a wide edit, in slices while the window is idle."""

from __future__ import annotations

import time

from PySide6.QtCore import QObject, QTimer, Signal

from faceedit_app.ui.state.document import Document
from faceedit_app.ui.state.timeline import Timeline

PATIENCE = 0.008  # seconds that a change may compute at once before the rest waits
SLICE = 0.006  # seconds of work before events are handled
REDRAW = 0.1  # seconds between two updates of the view
QUIET = 0.3  # seconds of work before progress is shown


class BackgroundSolving(QObject):
    """Computes the open take: first what is on screen, then the rest in the background.

    Signals:
        advanced(int, int): chunks done and in total; curves and face may have changed.
        finished(): everything is computed, or the user cancelled.
    """

    advanced = Signal(int, int)
    finished = Signal()

    def __init__(self, document: Document, timeline: Timeline, parent: QObject) -> None:
        super().__init__(parent)
        self._document, self._timeline = document, timeline
        self._timer = QTimer(self, interval=0)
        self._timer.timeout.connect(self._work)
        self._began = self._shown_at = 0.0
        document.opened.connect(self.watch)
        document.changed.connect(self.begin)
        document.previewed.connect(self.begin)
        timeline.playhead_moved.connect(self._look)
        timeline.view_changed.connect(self._look)

    @property
    def is_busy(self) -> bool:
        """Whether something is left to compute."""
        return self._timer.isActive()

    def begin(self) -> None:
        """Compute what the last change left."""
        session = self._document.session
        if session is None or session.live.is_complete:
            self._stop()
        elif not self.is_busy:
            self._began = self._shown_at = time.monotonic()
            self._timer.start()

    def cancel(self) -> None:
        """Undo the change being computed."""
        if self.is_busy and not self._document.cancel():
            self._document.undo()

    def watch(self) -> None:
        """Start with another take."""
        session = self._document.session
        if session is not None:
            session.live.patience = PATIENCE
            self._look()

    def _look(self) -> None:
        session = self._document.session
        if session is not None:
            clip = session.take.clip
            frame = min(max(self._timeline.frame, 0), len(clip) - 1)
            session.live.look(frame, *(clip.frame_at(t) for t in self._timeline.view))

    def _work(self) -> None:
        session = self._document.session
        if session is None or not session.live.work(SLICE):
            self._stop()
            return
        now = time.monotonic()
        if now - self._shown_at >= REDRAW:
            self._shown_at = now
            if now - self._began >= QUIET:
                self.advanced.emit(*session.live.progress)

    def _stop(self) -> None:
        if self.is_busy:
            self._timer.stop()
            self.finished.emit()
