"""The viewport: the picture of the face, drawn when something changes, and its mouse and keys."""

from __future__ import annotations

import logging
import time
from collections.abc import Iterable, Sequence
from typing import cast

from PySide6.QtCore import QEvent, QPoint, QRect, QRectF, QSize, Qt, QTimer, Signal
from PySide6.QtGui import (
    QCloseEvent,
    QColor,
    QContextMenuEvent,
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
from PySide6.QtWidgets import QSizePolicy, QWidget

from faceedit_app.core.arrays import Doubles, Floats
from faceedit_app.core.errors import FaceEditError
from faceedit_app.core.rig import Rig
from faceedit_app.render import Aim, Camera, FaceRenderer
from faceedit_app.ui.face.camera_keys import moved_by_key
from faceedit_app.ui.face.camera_mouse import ZOOM_STEP, CameraMouse
from faceedit_app.ui.face.difference_legend import DifferenceLegend
from faceedit_app.ui.face.face_picture import FacePicture, Size, paint_names
from faceedit_app.ui.face.resolution import Quality
from faceedit_app.ui.look.guard import guarded
from faceedit_app.ui.look.palette import ACCENT, PANEL
from faceedit_app.ui.look.texts import plain_label

IDLE_MS = 150  # without a change, before the picture is drawn with smooth edges


class Viewport(QWidget):
    """Shows the character with given weights.

    Drawing happens in `paintEvent`, so any number of changes in one turn of the event loop
    takes one picture, and a hidden viewport takes none.

    Signals:
        opened(): whether a face can be drawn has changed.
        drawn(): a picture was drawn.
        menu_asked(QPoint): the context menu was asked for, at a place on the screen.
    """

    opened = Signal()
    drawn = Signal()
    menu_asked = Signal(QPoint)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.draws = 0
        self.covered_by: tuple[QWidget, ...] = ()  # widgets on top of the picture
        self._note = plain_label("Preparing the face…")
        self._note.setParent(self)
        self._note.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self._note.setWordWrap(True)
        self._note.setObjectName("caption")
        # So that the command in the message can be copied.
        self._note.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.legend = DifferenceLegend(self)
        self._picture = FacePicture()
        self._aim: Aim | None = Aim.FRONT  # None once the user has moved the camera
        self._stale, self._smooth = True, True
        self.quality = Quality()
        self._mouse = CameraMouse()
        self._idle = QTimer(self, singleShot=True, interval=IDLE_MS)
        self._idle.timeout.connect(self._refine)
        self._spare = QTimer(self, singleShot=True, interval=0)  # when no event is waiting
        self._spare.timeout.connect(self._picture.prepare)
        self.setMinimumSize(QSize(240, 100))  # low: the film may lie above it
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setAttribute(Qt.WidgetAttribute.WA_OpaquePaintEvent)
        self.setMouseTracking(True)  # the next move reveals a lost release
        self.setAccessibleName("Face")
        self.setAccessibleDescription("Arrows orbit, with Shift they pan; + and - zoom.")
        # A click does not take the focus, so that the arrows still move the playhead.
        self.setFocusPolicy(Qt.FocusPolicy.TabFocus)

    # --- what is shown -----------------------------------------------------------------------

    def open(self, rig: Rig, ready: FaceRenderer | None = None) -> None:
        """Start drawing a character, perhaps by a renderer that is ready; else show why not."""
        self.legend.open(rig)
        try:
            self._picture.open(rig, self._pixels(), ready)
            self._show_note("")
        except FaceEditError as error:
            self._show_note(str(error))
        self._explain()
        self.reset_camera()
        self.opened.emit()

    @property
    def message(self) -> str:
        """The message shown instead of a face."""
        return self._note.text()

    def _show_note(self, message: str) -> None:
        self._note.setText(message)
        self._note.setVisible(bool(message))

    @property
    def can_draw(self) -> bool:
        """Whether a face can be drawn."""
        return self._picture.can_draw

    def show_weights(
        self,
        weights: Floats | None,
        beside: Floats | None = None,
        against: Floats | None = None,
    ) -> None:
        """Show (K,) weights in the rig's order; None is the neutral face.

        Args:
            beside: of a second face, left of the first and seen from the same side.
            against: of a face; the first is tinted by its distance from it.
        """
        was_pair = self._picture.is_pair
        self._picture.show(weights, beside, against)
        self._explain()
        if was_pair is not self._picture.is_pair:
            self._frame()
        self.redraw()

    def turn_heads(self, rotation: Floats | None, beside: Floats | None = None) -> None:
        """Turn the heads from the next `show_weights` on; None = straight.

        Args:
            rotation: yaw, pitch and roll in radians, see `Head.turned`.
            beside: of the second face.
        """
        self._picture.turn(rotation, beside)

    def _explain(self) -> None:
        """Show the legend while the face is tinted."""
        self.legend.setVisible(self._picture.is_tinted and self.can_draw)

    def redraw(self) -> None:
        """Draw a picture soon: a smooth one if it is fast, else one after a moment of rest."""
        self._stale, self._smooth = True, self.quality.is_smooth
        self._picture.forget_begun()
        self._idle.start()
        self.update(QRegion(self.rect()) if self._smooth else self._uncovered())

    def _uncovered(self) -> QRegion:
        """The part of the picture that no widget covers.

        Buttons on the picture would be repainted with every rough picture, for the few pixels of
        their corners; those can wait for the smooth picture.
        """
        region = QRegion(self.rect())
        for widget in self.covered_by:
            if widget.isVisible():
                corner = self.mapFromGlobal(widget.mapToGlobal(QPoint(0, 0)))
                region -= QRect(corner, widget.size())
        return region

    def hurry(self) -> None:
        """Draw the picture while the rest of the window is painted, not after it."""
        if self._stale and not self._smooth and self.isVisible():
            self._picture.begin(self._picture_size(), self.quality.is_doubled)

    def close_renderer(self) -> None:
        """Free the graphics memory."""
        self._picture.close()
        self._explain()
        self.opened.emit()

    def picture(self) -> QImage | None:
        """A copy of what is shown, with labels and legend; None without a face."""
        self._stale = self._smooth = True
        self._draw()
        if self._picture.image is None:
            return None
        image = self._picture.image.copy()
        image.setDevicePixelRatio(self.devicePixelRatioF())
        with QPainter(image) as painter:
            painter.setFont(self.font())
            if self._picture.is_pair:
                paint_names(painter, self.rect())
            if not self.legend.isHidden():
                painter.drawPixmap(self.legend.pos(), self.legend.grab())
        return image

    def thumbnail(self, weights: Floats, size: Size, aim: Aim) -> QImage | None:
        """See `FacePicture.thumbnail`."""
        return self._picture.thumbnail(weights, size, aim)

    # --- drawing -----------------------------------------------------------------------------

    @guarded
    def paintEvent(self, event: QPaintEvent) -> None:
        """Draw the face if it is out of date, then paint the picture."""
        if self._stale:
            self._draw()
        painter = QPainter(self)
        # One rectangle at a time: in a region of several, Qt fills pixel by pixel.
        for part in cast(Iterable[QRect], event.region()):  # missing in its type hints
            painter.setClipRect(part)
            self._paint_picture(painter)
        painter.setClipping(False)
        if self.hasFocus():
            painter.setRenderHint(QPainter.RenderHint.Antialiasing, False)
            painter.setPen(QPen(QColor(ACCENT), 2))
            painter.drawRect(self.rect().adjusted(1, 1, -1, -1))

    def _paint_picture(self, painter: QPainter) -> None:
        image = self._picture.image
        if image is None:
            painter.fillRect(self.rect(), QColor(PANEL))
            return
        if image.size() == QSize(*self._pixels()):
            painter.drawImage(self.rect(), image)  # one to one
        else:
            painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
            painter.drawImage(QRectF(self.rect()), image)
        if self._picture.is_pair:
            paint_names(painter, self.rect())

    def _draw(self) -> None:
        if not self.can_draw:
            return
        began, size, quality = time.perf_counter(), self._picture_size(), self.quality
        try:
            self._picture.draw(size, self._smooth, not quality.is_hurried, quality.is_doubled)
        except Exception as error:  # drivers and PyOpenGL raise all kinds
            logging.getLogger("faceedit").warning("drawing failed", exc_info=True)
            self.close_renderer()
            known = isinstance(error, FaceEditError)
            self._show_note(str(error) if known else f"The face cannot be drawn: {error}")
            return
        self._stale = False
        self.draws += 1
        self.drawn.emit()
        quality.drew(time.perf_counter() - began, self._smooth, quality.is_doubled)
        self._spare.start()

    def _refine(self) -> None:
        if self._mouse.is_held:
            self._idle.start()
            return
        if self._smooth and not self._stale:
            return
        self._stale = self._smooth = True
        self.update()

    def _pixels(self) -> Size:
        ratio = self.devicePixelRatioF()
        return max(1, round(self.width() * ratio)), max(1, round(self.height() * ratio))

    def _picture_size(self) -> Size:
        return self.quality.size(self._pixels(), self._smooth)

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Keep the face framed until the user moves the camera."""
        self._note.setGeometry(self.rect().adjusted(32, 48, -32, -32))
        self.quality.forget()
        self._frame()
        self.redraw()

    # --- camera ------------------------------------------------------------------------------

    @property
    def camera(self) -> Camera:
        """Where the face is seen from."""
        return self._picture.camera

    def project(self, vertices: Sequence[int] | None) -> Doubles | None:
        """Where vertices of the face are in the picture; None if it shows two faces, or none.

        Args:
            vertices: their numbers; None = all.

        Returns:
            (N, 3): pixels from the left and from the top, and metres in front of the camera.
        """
        return self._picture.project(vertices, self.width(), self.height())

    def camera_for(self, aspect: float) -> Camera:
        """The camera for a picture of width / height `aspect`, framed as this one is."""
        return self.camera if self._aim is None else self._picture.aimed(self._aim, aspect)

    def reset_camera(self) -> None:
        """Look from the front again."""
        self.aim(Aim.FRONT)

    def aim(self, aim: Aim) -> None:
        """Point the camera, and keep the face framed until the user moves it."""
        self._aim = aim
        self._frame()
        self.redraw()

    def _frame(self) -> None:
        if self._aim is not None:
            self._picture.aim(self._aim, self.width() / max(1, self.height()))

    def _look(self, camera: Camera) -> None:
        self._picture.camera, self._aim = camera, None
        self.redraw()

    def _metres(self) -> float:
        """Size of a pixel at the face."""
        return self.camera.distance * 0.39 / max(1, self.height())

    # --- mouse -------------------------------------------------------------------------------

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Start moving the camera."""
        self._mouse.press(event.position())
        self.setCursor(Qt.CursorShape.ClosedHandCursor)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Move the camera; see `CameraMouse`."""
        if not event.buttons():
            self.mouse_lost()
        camera = self._mouse.moved(self.camera, event, self._metres())
        if camera is not None:
            self._look(camera)

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """Stop moving the camera; a right click asks for the menu."""
        clicked = self._mouse.is_click(event.position())
        if not event.buttons():
            self.mouse_lost()
        if clicked and event.button() == Qt.MouseButton.RightButton:
            self.menu_asked.emit(event.globalPosition().toPoint())

    def mouse_lost(self) -> None:
        """Stop moving the camera: the release was lost."""
        self._mouse.release()
        self.unsetCursor()

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:
        """Show the menu for its key; for the mouse it comes on release, as a drag may follow."""
        if event.reason() != QContextMenuEvent.Reason.Mouse:
            self.menu_asked.emit(self.mapToGlobal(self.rect().center()))

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        """Reset the camera."""
        if event.button() == Qt.MouseButton.LeftButton:
            self.reset_camera()

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Zoom."""
        notches = event.angleDelta().y() / 120
        if notches:
            self._look(self.camera.zoom(ZOOM_STEP**notches))
        event.accept()

    # --- keys --------------------------------------------------------------------------------

    def event(self, event: QEvent) -> bool:
        """While it has the focus, camera keys are not shortcuts."""
        if (
            event.type() == QEvent.Type.ShortcutOverride
            and isinstance(event, QKeyEvent)
            and moved_by_key(self.camera, event, self._metres()) is not None
        ):
            event.accept()
            return True
        return super().event(event)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Move the camera; see `camera_keys`."""
        camera = moved_by_key(self.camera, event, self._metres())
        if camera is not None:
            self._look(camera)
        else:
            super().keyPressEvent(event)

    def focusInEvent(self, event: QFocusEvent) -> None:
        """Show the focus."""
        super().focusInEvent(event)
        self.update()

    def focusOutEvent(self, event: QFocusEvent) -> None:
        """Show that the focus is gone."""
        super().focusOutEvent(event)
        self.update()

    def closeEvent(self, event: QCloseEvent) -> None:
        """Free the graphics memory."""
        self.close_renderer()
        super().closeEvent(event)

    def sizeHint(self) -> QSize:
        """Portrait format."""
        return QSize(560, 680)
