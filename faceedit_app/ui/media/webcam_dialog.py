"""Records a performance from a webcam: a mirror, a countdown, a film."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Sequence
from enum import Enum
from pathlib import Path

from PySide6.QtCore import QRectF, QSize, Qt, QTimer, Signal
from PySide6.QtGui import QColor, QImage, QPainter, QPaintEvent
from PySide6.QtWidgets import (
    QCheckBox,
    QDialog,
    QDialogButtonBox,
    QPushButton,
    QSizePolicy,
    QVBoxLayout,
    QWidget,
)

from faceedit_app.core.arrays import Pixels
from faceedit_app.core.errors import FaceEditError, Unavailable
from faceedit_app.media.microphone import Microphone
from faceedit_app.media.webcam import Webcam, WebcamRecorder
from faceedit_app.ui.look.guard import guarded
from faceedit_app.ui.look.palette import PANEL
from faceedit_app.ui.look.texts import Message
from faceedit_app.ui.look.theme import GAP
from faceedit_app.ui.look.widgets import Choice

COUNTDOWN = 3
_SECOND_MS = 1000
_TICK_MS = 200
_EACH = 1 / 20  # seconds between pictures on screen
_TIPS = "Look at the webcam, with light from the front; begin with your mouth shut, and blink once"


class _Stage(Enum):
    """What the dialog is doing."""

    LOOKING = 0
    COUNTING = 1
    RECORDING = 2
    OVER = 3


class Mirror(QWidget):
    """The webcam's picture, the other way round as in a mirror, and a countdown over it."""

    def __init__(self) -> None:
        super().__init__()
        self._image: QImage | None = None
        self.count = 0
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setMinimumSize(QSize(320, 240))
        self.setAccessibleName("What the webcam sees")

    def sizeHint(self) -> QSize:
        """As large as the usual picture."""
        return QSize(640, 480)

    @property
    def has_picture(self) -> bool:
        """Whether there was a picture."""
        return self._image is not None

    def show_picture(self, pixels: Pixels | None) -> None:
        """Show a picture (H, W, 4) BGRA, or nothing."""
        if pixels is None:
            self._image = None
        else:
            height, width = pixels.shape[:2]
            image = QImage(
                pixels.data, width, height, pixels.strides[0], QImage.Format.Format_RGB32
            )
            self._image = image.flipped(Qt.Orientation.Horizontal)
        self.update()

    def show_count(self, count: int) -> None:
        """Show how many seconds are left; 0 shows none."""
        self.count = count
        self.update()

    @guarded
    def paintEvent(self, _event: QPaintEvent) -> None:
        """Paint the picture as large as fits."""
        painter = QPainter(self)
        painter.fillRect(self.rect(), QColor(PANEL))
        if self._image is not None:
            size = self._image.size().scaled(self.size(), Qt.AspectRatioMode.KeepAspectRatio)
            left, top = (self.width() - size.width()) / 2, (self.height() - size.height()) / 2
            painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
            painter.drawImage(QRectF(left, top, size.width(), size.height()), self._image)
        if self.count:
            painter.fillRect(self.rect(), QColor(0, 0, 0, 90))
            font = painter.font()
            font.setPixelSize(max(self.height() // 3, 12))
            painter.setFont(font)
            painter.setPen(QColor("white"))
            painter.drawText(self.rect(), Qt.AlignmentFlag.AlignCenter, str(self.count))


class WebcamDialog(QDialog):
    """A mirror with a button that counts down and records, until it is pressed again.

    Esc while it records stops and keeps the film: no performance is lost.

    Signals:
        recorded(Path): the film is there; the dialog has closed.
        failed(Exception): the webcam cannot be used, or the film not be written; it has closed.
    """

    recorded = Signal(object)
    failed = Signal(object)
    _seen = Signal(object)  # sent in the recorder's thread
    _lost = Signal(object, object)

    def __init__(self, parent: QWidget, webcams: Sequence[Webcam], film: Path) -> None:
        super().__init__(parent)
        self.setWindowTitle("Record from webcam")
        self.setWindowModality(Qt.WindowModality.WindowModal)
        self._webcams, self._film = webcams, film
        self._stage, self._next = _Stage.LOOKING, 0.0
        self._recorder: WebcamRecorder | None = None
        self.mirror = Mirror()
        self.choice = Choice()
        self.choice.setAccessibleName("Webcam")
        self.choice.addItems([webcam.name for webcam in webcams])
        self.choice.setVisible(len(webcams) > 1)
        self.choice.currentIndexChanged.connect(self._look)
        self.sound = QCheckBox("Record the sound of the microphone")
        self.sound.setChecked(True)
        self.status = Message("Waiting for the webcam…")
        self.button = QPushButton("Record")
        self.button.setDefault(True)
        self.button.setEnabled(False)
        self.button.clicked.connect(self._pressed)
        self.buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Cancel)
        self.buttons.addButton(self.button, QDialogButtonBox.ButtonRole.ActionRole)
        self.buttons.rejected.connect(self.reject)
        column = QVBoxLayout(self)
        column.setSpacing(GAP)
        for widget in (self.choice, self.mirror, self.sound, self.status, self.buttons):
            column.addWidget(widget, 1 if widget is self.mirror else 0)
        self._countdown = QTimer(self, interval=_SECOND_MS)
        self._countdown.timeout.connect(self._count)
        self._tick = QTimer(self, interval=_TICK_MS)
        self._tick.timeout.connect(self._show_seconds)
        self._seen.connect(self._show, Qt.ConnectionType.QueuedConnection)
        self._lost.connect(self._ended, Qt.ConnectionType.QueuedConnection)
        self._look()

    @property
    def is_recording(self) -> bool:
        """Whether the film is being recorded."""
        return self._stage is _Stage.RECORDING

    def reject(self) -> None:
        """Cancel; while it records, stop and keep the film."""
        if self.is_recording:
            self._finish()
        else:
            self._close()

    def _look(self) -> None:
        """Show the chosen webcam."""
        if self._recorder is not None:
            self._recorder.close()
        self.mirror.show_picture(None)
        self.button.setEnabled(False)
        self.status.setText("Waiting for the webcam…")
        webcam = self._webcams[self.choice.currentIndex()]
        self._recorder = WebcamRecorder(
            webcam, self._report, lambda error: self._say(error, webcam)
        )

    def _report(self, pixels: Pixels) -> None:
        """Called in the recorder's thread."""
        now = time.monotonic()
        if now >= self._next:
            self._next = now + _EACH
            with contextlib.suppress(RuntimeError):  # the window was just closed
                self._seen.emit(pixels)

    def _say(self, error: FaceEditError, webcam: Webcam) -> None:
        """Called in the recorder's thread."""
        with contextlib.suppress(RuntimeError):
            self._lost.emit(error, webcam)

    def _show(self, pixels: Pixels) -> None:
        if self._stage is _Stage.OVER:
            return
        if not self.mirror.has_picture and self._stage is _Stage.LOOKING:
            self.button.setEnabled(True)
            self.button.setFocus()
            self.status.setText(_TIPS)
        self.mirror.show_picture(pixels)

    def _pressed(self) -> None:
        if self._stage is _Stage.LOOKING:
            self._stage = _Stage.COUNTING
            self.choice.setEnabled(False)
            self.sound.setEnabled(False)
            self.button.setText("Record now")
            self.mirror.show_count(COUNTDOWN)
            self.status.setText("Get ready…")
            self._countdown.start()
        elif self._stage is _Stage.COUNTING:
            self._begin()
        elif self._stage is _Stage.RECORDING:
            self._finish()

    def _count(self) -> None:
        if self.mirror.count > 1:
            self.mirror.show_count(self.mirror.count - 1)
        else:
            self._begin()

    def _begin(self) -> None:
        self._countdown.stop()
        self.mirror.show_count(0)
        assert self._recorder is not None
        microphone, self._silent = None, ""
        if self.sound.isChecked():
            try:
                microphone = Microphone()
            except Unavailable as error:  # a film without sound is better than none
                self._silent = f"\n{error}: the film has no sound"
        try:
            self._recorder.begin(self._film, microphone)
        except FaceEditError as error:
            self._close()
            self.failed.emit(error)
            return
        self._stage = _Stage.RECORDING
        self.button.setText("Stop")
        self.buttons.button(QDialogButtonBox.StandardButton.Cancel).hide()  # nothing is lost
        self._tick.start()
        self._show_seconds()

    def _show_seconds(self) -> None:
        assert self._recorder is not None
        self.status.setText(
            f"Recording {self._film.name}: {self._recorder.seconds:.1f} s{self._silent}"
        )

    def _finish(self) -> None:
        """Stop recording, and hand on the film."""
        recorder = self._recorder
        self._tick.stop()
        self._stage, has_film, error = _Stage.OVER, False, None
        if recorder is not None:
            try:
                has_film = recorder.end()
            except FaceEditError as failed:
                error = failed
        self._close()
        if error is not None:
            self.failed.emit(error)
        if has_film:
            self.recorded.emit(self._film)

    def _ended(self, error: FaceEditError, webcam: Webcam) -> None:
        """The webcam ended by itself."""
        if self._stage is _Stage.OVER or webcam is not self._webcams[self.choice.currentIndex()]:
            return
        if self._stage is _Stage.RECORDING:
            self._finish()
            self.failed.emit(error)
        elif len(self._webcams) > 1 and self._stage is _Stage.LOOKING:
            self.mirror.show_picture(None)
            self.button.setEnabled(False)
            self.status.setText(str(error))  # another one can be chosen
        else:
            self._close()
            self.failed.emit(error)

    def _close(self) -> None:
        self._stage = _Stage.OVER
        self._countdown.stop()
        self._tick.stop()
        if self._recorder is not None:
            self._recorder.close()
            self._recorder = None
        super().reject()
