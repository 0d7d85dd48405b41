"""The picture of the face: camera by mouse, drawn only when something changed."""

from __future__ import annotations

import contextlib
import logging
import time
from collections.abc import Iterable
from typing import TYPE_CHECKING, cast

import numpy as np
from PySide6.QtCore import QEvent, QPoint, QPointF, QRect, QRectF, QSize, Qt, QTimer
from PySide6.QtGui import (
    QCloseEvent,
    QColor,
    QFocusEvent,
    QImage,
    QKeyEvent,
    QMouseEvent,
    QPainter,
    QPaintEvent,
    QPen,
    QRegion,
    QResizeEvent,
    QWheelEvent,
)
from PySide6.QtWidgets import QLabel, QSizePolicy, QWidget

from faceedit_app import render
from faceedit_app.core.errors import FaceEditError
from faceedit_app.render.difference import tint_of
from faceedit_app.ui.face.camera_keys import moved_by_key
from faceedit_app.ui.face.difference_legend import Legend
from faceedit_app.ui.look.palette import ACCENT, BORDER, PANEL, TEXT

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from faceedit_app.core.arrays import Floats
    from faceedit_app.core.rig import Rig
    from faceedit_app.render import FaceRenderer

IDLE_MS = 150  # after so long without a change the picture is drawn with smooth edges
ORBIT = 0.008  # radians per pixel
ZOOM_STEP = 0.88  # per notch of the wheel
# A rough picture may cost so many seconds before its resolution is lowered.
_BUDGET = 0.035
_COARSEST = 0.5


class Viewport(QWidget):
    """Shows the character with the weights it is given.

    Drawing happens in `paintEvent`, so any number of changes in one turn of the event loop
    costs one picture, and a hidden viewport costs none.
    """

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.draws = 0
        self.covered_by: tuple[QWidget, ...] = ()  # widgets that stand upon the picture
        self._note = QLabel("Preparing the face…", self)
        self._note.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self._note.setWordWrap(True)
        self._note.setTextFormat(Qt.TextFormat.PlainText)
        self._note.setObjectName("caption")
        # The remedy is a command to be copied.
        self._note.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.legend = Legend(self)
        self._rig: Rig | None = None
        self._renderer: FaceRenderer | None = None
        self._weights: Floats | None = None
        self._beside: Floats | None = None
        self._against: Floats | None = None
        self._camera = render.Camera()
        self._is_home = True
        self._image: QImage | None = None
        self._buffer: NDArray[np.uint8] | None = None
        self._stale, self._smooth, self._hurried = True, True, False
        self._scale = 1.0
        self._grabbed: QPointF | None = None
        self._idle = QTimer(self, singleShot=True, interval=IDLE_MS)
        self._idle.timeout.connect(self._refine)
        self._spare = QTimer(self, singleShot=True, interval=0)  # once no event waits
        self._spare.timeout.connect(self._prepare)
        self.setMinimumSize(QSize(240, 240))
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setAttribute(Qt.WidgetAttribute.WA_OpaquePaintEvent)
        self.setMouseTracking(True)  # a release that was lost shows by the next move
        self.setAccessibleName("Face")
        self.setAccessibleDescription("Arrows turn it, with Shift they move it; + and - zoom.")
        # The mouse leaves the keyboard where it is, so that the arrows go on moving the playhead.
        self.setFocusPolicy(Qt.FocusPolicy.TabFocus)

    # --- what is shown -----------------------------------------------------------------------

    def open(self, rig: Rig) -> None:
        """Start drawing a character; where that is impossible, say why instead."""
        self.close_renderer()
        if self._rig is not None and self._rig is not rig:
            # Another character's weights mean nothing here.
            self._weights = self._beside = self._against = None
        self._rig = rig
        self.legend.open(rig)
        try:
            width, height = self._pixels()
            self._renderer = render.open_renderer(rig, width, height)
            self._say("")
        except FaceEditError as error:
            self._say(str(error))
        self._explain()
        self.reset_camera()

    @property
    def message(self) -> str:
        """What is said in place of a face."""
        return self._note.text()

    def _say(self, message: str) -> None:
        self._note.setText(message)
        self._note.setVisible(bool(message))

    @property
    def can_draw(self) -> bool:
        """Whether there is a face to see."""
        return self._renderer is not None

    def show_weights(
        self,
        weights: Floats | None,
        beside: Floats | None = None,
        against: Floats | None = None,
    ) -> None:
        """Show (K,) weights in the rig's order; None is the neutral face.

        Args:
            beside: of a second face, at the left of the first and seen from the same side.
            against: of a face that the first is tinted by its distance from.
        """
        was_pair = self._beside is not None
        self._weights, self._beside, self._against = weights, beside, against
        self._explain()
        if was_pair is not (beside is not None) and self._is_home:
            self.reset_camera()
        self.redraw()

    def _explain(self) -> None:
        """Say what the tint means while there is one."""
        self.legend.setVisible(self._against is not None and self.can_draw)

    def redraw(self) -> None:
        """Draw soon: roughly now, smoothly when nothing has changed for a moment."""
        self._stale, self._smooth, self._hurried = True, False, False
        self._idle.start()
        self.update(self._uncovered())

    def _uncovered(self) -> QRegion:
        """Where the picture is seen for certain.

        Buttons upon the picture would be painted anew with each of its frames, for the few pixels
        of their corners; those can wait for the smooth picture.
        """
        region = QRegion(self.rect())
        for widget in self.covered_by:
            if widget.isVisible():
                corner = self.mapFromGlobal(widget.mapToGlobal(QPoint(0, 0)))
                region -= QRect(corner, widget.size())
        return region

    def hurry(self) -> None:
        """Have the picture drawn while the rest of the window is painted, not after it."""
        if not self._stale or self._smooth or self._beside is not None or not self.isVisible():
            return
        if self._renderer is None or self._rig is None:
            return
        with contextlib.suppress(Exception):  # painting meets it again, and says so
            self._renderer.resize(*self._picture_size())
            vertices, tint = self._first(self._rig)
            self._renderer.begin(vertices, self._camera, smooth=False, tint=tint)
            self._hurried = True

    def _picture_size(self) -> tuple[int, int]:
        scale = 1.0 if self._smooth else self._scale
        width, height = (max(1, round(n * scale)) for n in self._pixels())
        return width, height

    def _first(self, rig: Rig) -> tuple[Floats, Floats | None]:
        """The vertices (V, 3) of the face and, where it is tinted, by how much (V,)."""
        vertices = rig.neutral if self._weights is None else rig.vertices(self._weights)
        if self._against is None:
            return vertices, None
        return vertices, tint_of(vertices, rig.vertices(self._against))

    def reset_camera(self) -> None:
        """Look from the front again."""
        if self._rig is not None:
            self._camera = render.default_camera(self._rig, self._aspect())
        self._is_home = True
        self.redraw()

    @property
    def camera(self) -> render.Camera:
        """Where the face is looked at from."""
        return self._camera

    def close_renderer(self) -> None:
        """Free the graphics memory."""
        renderer, self._renderer = self._renderer, None
        self._image = self._buffer = None
        if renderer is not None:
            with contextlib.suppress(Exception):  # a context that is lost cannot be freed
                renderer.close()
        self._explain()

    # --- drawing -----------------------------------------------------------------------------

    def paintEvent(self, event: QPaintEvent) -> None:
        """Draw the face if it is out of date, then paint the picture."""
        if self._stale:
            self._draw()
        painter = QPainter(self)
        # Rectangle by rectangle: into a region of several Qt would fill dot by dot.
        for part in cast(Iterable[QRect], event.region()):  # its type hints do not know
            painter.setClipRect(part)
            self._paint_picture(painter)
        painter.setClipping(False)
        if self.hasFocus():
            painter.setRenderHint(QPainter.RenderHint.Antialiasing, False)
            painter.setPen(QPen(QColor(ACCENT), 2))
            painter.drawRect(self.rect().adjusted(1, 1, -1, -1))

    def _paint_picture(self, painter: QPainter) -> None:
        if self._image is not None:
            if self._image.size() == QSize(*self._pixels()):
                painter.drawImage(self.rect(), self._image)  # pixel by pixel
            else:
                painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
                painter.drawImage(QRectF(self.rect()), self._image)
            if self._beside is not None:
                self._paint_names(painter)
            return
        painter.fillRect(self.rect(), QColor(PANEL))

    def _paint_names(self, painter: QPainter) -> None:
        """Which of two faces is which."""
        half, height = self.width() // 2, self.height()
        painter.fillRect(half, 0, 1, height, QColor(BORDER))
        painter.setPen(QColor(TEXT))
        for x, name in ((0, "Tracked"), (half, "Edited")):
            room = QRect(x, height - 34, half, 24)
            painter.drawText(room, Qt.AlignmentFlag.AlignCenter, name)

    def _faces(self, renderer: FaceRenderer, rig: Rig, size: tuple[int, int]) -> NDArray[np.uint8]:
        """(H, W, 4) the picture: one face, or two beside each other."""
        if self._hurried and self._beside is None and not self._smooth:
            self._hurried = False
            return renderer.finish()
        width, height = size
        shown = [self._first(rig)]
        if self._beside is not None:
            shown.insert(0, (rig.vertices(self._beside), None))
        renderer.resize(max(width // len(shown), 1), height)
        pictures = []
        for vertices, tint in shown:
            pixels = renderer.draw(vertices, self._camera, smooth=self._smooth, tint=tint)
            if len(shown) == 1:
                return pixels
            pictures.append(pixels.copy())  # the renderer may draw the next one into it
        return np.ascontiguousarray(np.concatenate(pictures, axis=1))

    def _draw(self) -> None:
        if self._renderer is None or self._rig is None:
            return
        began = time.perf_counter()
        try:
            pixels = self._faces(self._renderer, self._rig, self._picture_size())
        except Exception as error:  # drivers and PyOpenGL raise all kinds
            logging.getLogger("faceedit").warning("drawing failed", exc_info=True)
            self.close_renderer()
            known = isinstance(error, FaceEditError)
            self._say(str(error) if known else f"The face cannot be drawn: {error}")
            return
        self._buffer = pixels  # the image is a view of it
        height, width = pixels.shape[:2]
        self._image = QImage(
            pixels.data, width, height, pixels.strides[0], QImage.Format.Format_RGB32
        )
        self._stale = False
        self.draws += 1
        if not self._smooth:
            self._adapt(time.perf_counter() - began)
        self._spare.start()

    def _prepare(self) -> None:
        if self._renderer is not None and not self._hurried:
            with contextlib.suppress(Exception):  # painting meets it again, and says so
                self._renderer.prepare()

    def _adapt(self, seconds: float) -> None:
        """Trade resolution for speed while things move, on computers that draw slowly."""
        if seconds > _BUDGET:
            self._scale = max(self._scale * 0.8, _COARSEST)
        elif seconds < _BUDGET / 3:
            self._scale = min(self._scale * 1.1, 1.0)

    def _refine(self) -> None:
        if self._grabbed is not None:
            self._idle.start()
            return
        self._stale = self._smooth = True
        self.update()

    def _pixels(self) -> tuple[int, int]:
        ratio = self.devicePixelRatioF()
        return max(1, round(self.width() * ratio)), max(1, round(self.height() * ratio))

    def _aspect(self) -> float:
        faces = 1 if self._beside is None else 2
        return self.width() / faces / max(1, self.height())

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Keep the framing until the user has chosen another one."""
        self._note.setGeometry(self.rect().adjusted(32, 48, -32, -32))
        if self._is_home:
            self.reset_camera()
        self.redraw()

    # --- camera ------------------------------------------------------------------------------

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Grab the view."""
        self._grabbed = event.position()
        self.setCursor(Qt.CursorShape.ClosedHandCursor)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Left turns around the face, middle and right move the view."""
        if not event.buttons():
            self.let_go()
        if self._grabbed is None:
            return
        moved = event.position() - self._grabbed
        self._grabbed = event.position()
        if event.buttons() & Qt.MouseButton.LeftButton:
            self._look(self._camera.orbit(-moved.x() * ORBIT, moved.y() * ORBIT))
        elif event.buttons():
            metres = self._metres()
            self._look(self._camera.pan(-moved.x() * metres, moved.y() * metres))

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """Let go of the view."""
        if not event.buttons():
            self.let_go()

    def let_go(self) -> None:
        """The view is no longer turned."""
        self._grabbed = None
        self.unsetCursor()

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        """Back to the front."""
        self.reset_camera()

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Zoom."""
        notches = event.angleDelta().y() / 120
        if notches:
            self._look(self._camera.zoom(ZOOM_STEP**notches))
        event.accept()

    def _metres(self) -> float:
        """Of a pixel, at the face."""
        return self._camera.distance * 0.39 / max(1, self.height())

    # --- keys --------------------------------------------------------------------------------

    def event(self, event: QEvent) -> bool:
        """The keys for looking around are its own while it has the keyboard, not shortcuts."""
        if (
            event.type() == QEvent.Type.ShortcutOverride
            and isinstance(event, QKeyEvent)
            and moved_by_key(self._camera, event, self._metres()) is not None
        ):
            event.accept()
            return True
        return super().event(event)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Look around: see `camera_keys`."""
        camera = moved_by_key(self._camera, event, self._metres())
        if camera is not None:
            self._look(camera)
        else:
            super().keyPressEvent(event)

    def focusInEvent(self, event: QFocusEvent) -> None:
        """It shows that it has the keyboard."""
        super().focusInEvent(event)
        self.update()

    def focusOutEvent(self, event: QFocusEvent) -> None:
        """And that it has not."""
        super().focusOutEvent(event)
        self.update()

    def _look(self, camera: render.Camera) -> None:
        self._camera, self._is_home = camera, False
        self.redraw()

    def closeEvent(self, event: QCloseEvent) -> None:
        """Free what the picture is drawn with."""
        self.close_renderer()
        super().closeEvent(event)

    def sizeHint(self) -> QSize:
        """A portrait."""
        return QSize(560, 680)
