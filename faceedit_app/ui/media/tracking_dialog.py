"""Shows a film while its face is tracked."""

from __future__ import annotations

import contextlib
import threading
import time
from pathlib import Path

import numpy as np
from PySide6.QtCore import QPointF, QRectF, QSize, QSizeF, Qt, Signal
from PySide6.QtGui import QColor, QImage, QMouseEvent, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import (
    QDialog,
    QDialogButtonBox,
    QLabel,
    QProgressBar,
    QSizePolicy,
    QVBoxLayout,
    QWidget,
)

from faceedit_app.core.arrays import Doubles, Pixels
from faceedit_app.core.texts import plain_line
from faceedit_app.tracking.film_landmarks import Chosen, Faces, Progress
from faceedit_app.ui.look.guard import guarded
from faceedit_app.ui.look.palette import ACCENT, PANEL
from faceedit_app.ui.look.texts import plain_label
from faceedit_app.ui.look.theme import GAP
from faceedit_app.ui.media.landmark_paint import paint_landmarks

_EACH = 1 / 15  # seconds between pictures on screen
_FRAME, _ROUND = 2.0, 8.0  # pixels: how thick a frame around a face is, and its corners


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
        self._boxes: Doubles | None = None
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
        self._show(progress.picture)
        self._places = None if progress.points is None else progress.points / (width, height)

    def show_faces(self, faces: Faces) -> None:
        """Show a picture with frames around its faces."""
        self._show(faces.picture)
        self._places, self._boxes = None, faces.boxes

    def _show(self, picture: Pixels) -> None:
        height, width = picture.shape[:2]
        pixels = np.ascontiguousarray(picture)
        image = QImage(pixels.data, width, height, pixels.strides[0], QImage.Format.Format_RGB32)
        self._image, self._boxes = image.copy(), None
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
        if self._boxes is not None:
            self._paint_frames(painter, self._boxes)

    def _paint_frames(self, painter: QPainter, boxes: Doubles) -> None:
        """Paint a frame around each face (n, 4)."""
        room = self._room()
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(QPen(QColor(ACCENT), _FRAME))
        for left, top, right, bottom in boxes.tolist():
            corner = QPointF(left * room.width(), top * room.height()) + room.topLeft()
            size = QSizeF((right - left) * room.width(), (bottom - top) * room.height())
            painter.drawRoundedRect(QRectF(corner, size), _ROUND, _ROUND)

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

    `report`, `is_stopped` and `ask_face` are called in the thread that tracks.

    Signals:
        progressed(object): a Progress; sent from that thread.
        asked(object): which of these Faces to follow; sent from that thread.
        face_chosen(object): the user clicked a face; a Chosen.
    """

    progressed = Signal(object)
    asked = Signal(object)
    face_chosen = Signal(object)

    def __init__(self, parent: QWidget, film: Path) -> None:
        super().__init__(parent)
        self.setWindowTitle("Track a film")
        self.setWindowModality(Qt.WindowModality.WindowModal)
        self._stopped, self._next = False, 0.0
        self._is_looking = False  # for the face; not while the character is fitted
        self._shown = 0.0  # seconds in the film of the picture on screen
        self._faces: Faces | None = None  # of which the user is to choose one
        self._answer: int | None = None
        self._answered = threading.Event()
        self.picture = _Picture()
        self.picture.clicked.connect(self._choose)
        self.name = plain_label(plain_line(film.name, 60))
        self.status = QLabel("Opening the film…")
        self.hint = QLabel("If there are several faces, click the one to track.")
        self.hint.setObjectName("caption")
        policy = self.hint.sizePolicy()
        policy.setRetainSizeWhenHidden(True)
        self.hint.setSizePolicy(policy)
        self.hint.hide()
        self.bar = QProgressBar()
        self.bar.setRange(0, 0)
        self.buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Cancel)
        self.buttons.rejected.connect(self.reject)
        self.largest = self.buttons.addButton(
            "Track the &largest", QDialogButtonBox.ButtonRole.AcceptRole
        )
        self.largest.hide()
        self.largest.clicked.connect(lambda: self._choose_of(0))
        column = QVBoxLayout(self)
        column.setSpacing(GAP)
        for widget in (self.name, self.picture, self.hint, self.status, self.bar, self.buttons):
            column.addWidget(widget, 1 if widget is self.picture else 0)
        self.rejected.connect(self.stop)
        self.progressed.connect(self._show, Qt.ConnectionType.QueuedConnection)
        self.asked.connect(self._ask, Qt.ConnectionType.QueuedConnection)

    def report(self, progress: Progress) -> None:
        """Show progress, at most 15 times a second."""
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
        self._answered.set()

    def restart(self) -> None:
        """Tracking begins again."""
        self._stopped = False

    def ask_face(self, faces: Faces) -> int:
        """Which face to follow: waits until the user has chosen one, or gives up."""
        if self._answer is None:
            with contextlib.suppress(RuntimeError):
                self.asked.emit(faces)
                self._answered.wait()
        return self._answer or 0

    def _ask(self, faces: Faces) -> None:
        self._faces = faces
        self.picture.show_faces(faces)
        self.bar.setRange(0, 1)
        self.bar.setValue(0)
        self.status.setText(f"{len(faces.boxes)} faces: click the one to track")
        self.hint.hide()
        self.largest.show()
        self.largest.setFocus()

    def _choose_of(self, number: int) -> None:
        self._faces, self._answer = None, number
        self.largest.hide()
        self._answered.set()

    def _choose(self, x: float, y: float) -> None:
        if self._faces is not None:
            left, top, right, bottom = self._faces.boxes.T
            hit = np.flatnonzero((left <= x) & (x <= right) & (top <= y) & (y <= bottom))
            if len(hit):
                self._choose_of(int(hit[-1]))  # the smallest: it is before the others
        elif self._is_looking:
            self.stop()
            self.face_chosen.emit(Chosen(x, y, self._shown))

    def _show(self, progress: Progress) -> None:
        self.picture.show_progress(progress)
        self._is_looking, self._shown = progress.picture is not None, progress.seconds
        self.hint.setVisible(self._is_looking)
        # The fit takes about as long for one picture as for a thousand.
        self.bar.setRange(0, progress.of if self._is_looking or progress.done else 0)
        self.bar.setValue(progress.done)
        count = f", picture {progress.done} of {progress.of}" if progress.done else ""
        lost = progress.picture is not None and progress.points is None
        self.status.setText(f"{progress.pass_}{count}{': no face here' if lost else '…'}")
