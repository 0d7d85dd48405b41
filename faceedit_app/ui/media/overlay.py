"""The landmarks of a tracked take, shown over its film."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal

from faceedit_app.core import on_disk
from faceedit_app.core.arrays import Doubles
from faceedit_app.core.errors import FileError
from faceedit_app.tracking.drawing import ENDING
from faceedit_app.ui.state.background import Background

if TYPE_CHECKING:  # not needed before a tracked take is open
    from faceedit_app.tracking.landmark_file import StoredLandmarks


class LandmarksOverlay(QObject):
    """Reads the landmarks beside a take.

    Attributes:
        is_shown: whether they are to be shown.

    Signals:
        changed(): others are there, or they are shown or hidden.
    """

    changed = Signal()

    def __init__(self, background: Background, parent: QObject) -> None:
        super().__init__(parent)
        self._background = background
        self._stored: StoredLandmarks | None = None
        self._wanted: Path | None = None
        self.is_shown = True

    @property
    def stored(self) -> StoredLandmarks | None:
        """The landmarks, if the take has any."""
        return self._stored

    def follow(self, take: Path) -> None:
        """Another take is open."""
        self.clear()
        path = take.with_name(take.stem + ENDING)
        if not on_disk.is_file(path):
            return
        self._wanted = path

        def read() -> StoredLandmarks | None:
            from faceedit_app.tracking.landmark_file import read_landmarks

            try:
                return read_landmarks(path)
            except FileError:  # the take is complete without them
                return None

        def done(stored: StoredLandmarks | None) -> None:
            if self._wanted == path:
                self._stored = stored
                self.changed.emit()

        self._background.run(read, done, lambda error: None)

    def clear(self) -> None:
        """No take is open."""
        self._wanted, self._stored = None, None
        self.changed.emit()

    def toggle(self) -> None:
        """Show or hide them."""
        self.is_shown = not self.is_shown
        self.changed.emit()

    def at(self, film: Path, index: int) -> Doubles | None:
        """The landmarks to show on a picture of a film, as `StoredLandmarks.at`, or None."""
        stored = self._stored
        if stored is None or not self.is_shown or stored.film != film.name:
            return None
        return stored.at(index)
