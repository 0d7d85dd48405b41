"""Shows a film while its face is tracked."""

from __future__ import annotations

import contextlib
import time
from pathlib import Path

import numpy as np
from PySide6.QtCore import QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QImage, QMouseEvent, QPainter, QPaintEvent
from PySide6.QtWidgets import (
    QDialog,
    QDialogButtonBox,
    QLabel,
    QProgressBar,
    QSizePolicy,
    QVBoxLayout,
    QWidget,
)

from faceedit_app.core.arrays import Doubles
from faceedit_app.core.texts import plain_line
from faceedit_app.tracking.film_landmarks import Chosen, Progress
from faceedit_app.ui.look.guard import guarded
from faceedit_app.ui.look.palette import PANEL
from faceedit_app.ui.look.texts import plain_label
from faceedit_app.ui.look.theme import GAP
from faceedit_app.ui.media.landmark_paint import paint_landmarks

_EACH = 1 / 15  # seconds between pictures on screen


class _Picture(QWidget):
    """The picture that is being looked at.

    Signals:
        clicked(float, float): a place on it, as shares of its width and height.
    """

    clicked = Signal(float, float)

    def __init__(self) -> None:
        super().__init__()
        self._image: QImage | None = None
        self._places: Doubles | None = None
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setMinimumSize(QSize(320, 240))
        self.setAccessibleName("The picture that is being tracked")
        self.setToolTip("Click another face to track that one")

    def sizeHint(self) -> QSize:
        """Large enough to see lips and lids."""
        return QSize(640, 480)

    def show_progress(self, progress: Progress) -> None:
        """Show a picture with its landmarks."""
        if progress.picture is None:
            return
        height, width = progress.picture.shape[:2]
        pixels = np.ascontiguousarray(progress.picture)
        image = QImage(pixels.data, width, height, pixels.strides[0], QImage.Format.Format_RGB32)
        self._image = image.copy()
        self._places = None if progress.points is None else progress.points / (width, height)
        self.update()

    def _room(self) -> QRectF:
        """Where the picture is shown."""
        assert self._image is not None
        size = self._image.size().scaled(self.size(), Qt.AspectRatioMode.KeepAspectRatio)
        left, top = (self.width() - size.width()) / 2, (self.height() - size.height()) / 2
        return QRectF(left, top, size.width(), size.height())

    @guarded
    def paintEvent(self, _event: QPaintEvent) -> None:
        """Paint the picture as large as fits."""
        painter = QPainter(self)
        painter.fillRect(self.rect(), QColor(PANEL))
        if self._image is None:
            return
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
        painter.drawImage(self._room(), self._image)
        if self._places is not None:
            paint_landmarks(painter, self._places, self._room())

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Choose a face."""
        if self._image is None:
            return
        room, at = self._room(), event.position()
        if room.contains(at):
            x, y = (at.x() - room.x()) / room.width(), (at.y() - room.y()) / room.height()
            self.clicked.emit(x, y)


class TrackingDialog(QDialog):
    """Progress of tracking a film; Cancel and Esc stop it.

    `report` and `is_stopped` are called in the thread that tracks.

    Signals:
        progressed(object): a Progress; sent from that thread.
        face_chosen(object): the user clicked a face; a Chosen.
    """

    progressed = Signal(object)
    face_chosen = Signal(object)

    def __init__(self, parent: QWidget, film: Path) -> None:
        super().__init__(parent)
        self.setWindowTitle("Track a film")
        self.setWindowModality(Qt.WindowModality.WindowModal)
        self._stopped, self._next = False, 0.0
        self._is_looking = False  # for the face; not while the character is fitted
        self._shown = 0.0  # seconds in the film of the picture on screen
        self.picture = _Picture()
        self.picture.clicked.connect(self._choose)
        self.name = plain_label(plain_line(film.name, 60))
        self.status = QLabel("Opening the film…")
        self.bar = QProgressBar()
        self.bar.setRange(0, 0)
        self.buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Cancel)
        self.buttons.rejected.connect(self.reject)
        column = QVBoxLayout(self)
        column.setSpacing(GAP)
        for widget in (self.name, self.picture, self.status, self.bar, self.buttons):
            column.addWidget(widget, 1 if widget is self.picture else 0)
        self.rejected.connect(self.stop)
        self.progressed.connect(self._show, Qt.ConnectionType.QueuedConnection)

    def report(self, progress: Progress) -> None:
        """Show how far it is, at most 15 times a second."""
        now = time.monotonic()
        if progress.picture is not None and now < self._next and progress.done < progress.of:
            return
        self._next = now + _EACH
        with contextlib.suppress(RuntimeError):  # the window was just closed
            self.progressed.emit(progress)

    def is_stopped(self) -> bool:
        """Whether the user gave up, or chose another face."""
        return self._stopped

    def stop(self) -> None:
        """Give up."""
        self._stopped = True

    def restart(self) -> None:
        """Tracking begins again."""
        self._stopped = False

    def _choose(self, x: float, y: float) -> None:
        if self._is_looking:
            self.stop()
            self.face_chosen.emit(Chosen(x, y, self._shown))

    def _show(self, progress: Progress) -> None:
        self.picture.show_progress(progress)
        self._is_looking, self._shown = progress.picture is not None, progress.seconds
        # The fit takes about as long for one picture as for a thousand.
        self.bar.setRange(0, progress.of if self._is_looking or progress.done else 0)
        self.bar.setValue(progress.done)
        count = f", picture {progress.done} of {progress.of}" if progress.done else ""
        lost = progress.picture is not None and progress.points is None
        self.status.setText(f"{progress.pass_}{count}{': no face here' if lost else '…'}")
