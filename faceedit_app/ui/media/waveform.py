"""The sound's waveform under the curves, on the same time axis."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QEvent, QPointF, QRectF, Qt
from PySide6.QtGui import (
    QContextMenuEvent,
    QImage,
    QKeyEvent,
    QMouseEvent,
    QPainter,
    QPaintEvent,
    QPen,
    QWheelEvent,
)
from PySide6.QtWidgets import QGridLayout, QMenu, QSizePolicy, QWidget

from faceedit_app.ui.curves import paint, style
from faceedit_app.ui.curves.gestures import Pan, Span
from faceedit_app.ui.curves.paint import turn_wheel
from faceedit_app.ui.curves.scale import Scale
from faceedit_app.ui.look.guard import guarded
from faceedit_app.ui.media.parts import Name, OffsetBox, placing_actions, remove_button
from faceedit_app.ui.media.strip_row import StripRow
from faceedit_app.ui.media.take_media import TakeMedia
from faceedit_app.ui.state.timeline import Timeline

HEIGHT = 58  # pixels of the row
FINE = 0.1  # factor on the pointer's movement, with Shift
# Keys with which a drag moves the sound; many desktops take Alt and a drag for the window.
_MOVES = Qt.KeyboardModifier.ControlModifier | Qt.KeyboardModifier.AltModifier
_INK = "#8fb3a6"  # of the waveform; differs from the curves' colours
_LOUD = 0.99  # quantile of the samples that fits the row's height
_QUIETEST = 0.05  # of full scale; quieter sound is not enlarged to fill the row
_TIP = (
    "The take's sound. Drag to scrub.\n"
    "Ctrl+drag or Alt+drag moves it in time; with Shift, ten times finer.\n"
    "Or type a number on the left."
)


class Waveform(QWidget):
    """The waveform in the visible time range; scrubs like the ruler."""

    def __init__(self, media: TakeMedia, timeline: Timeline, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._media, self._timeline = media, timeline
        self._drag: Pan | None = None
        self._scrubs = False
        self._grabbed: tuple[float, float] | None = None  # last pointer and offset
        self._before = 0.0  # offset at the start of the drag
        self._picture: tuple[object, QImage, NDArray[np.uint32]] | None = None
        self._loudest = 1.0
        self.setObjectName("waveform")
        self.setAccessibleName("Sound")
        self.setAccessibleDescription(
            "Waveform of the take's sound. Ctrl and drag moves it in time."
        )
        self.setToolTip(_TIP)
        self.setMinimumWidth(40)
        self.setMouseTracking(True)  # the next move reveals a lost release
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setAttribute(Qt.WidgetAttribute.WA_OpaquePaintEvent)
        media.sound_changed.connect(self._measure)
        media.placed.connect(self.update)
        timeline.view_changed.connect(self.update)
        timeline.playhead_moved.connect(self.update)
        timeline.selection_changed.connect(self.update)
        timeline.falloff_changed.connect(self.update)

    @property
    def scale(self) -> Scale:
        """How its pixels map to seconds and to amplitudes, -1..1."""
        return Scale(self.width(), self.height(), self._timeline.view, (-1.0, 1.0))

    def _measure(self) -> None:
        sound = self._media.sound.item if self._media.sound is not None else None
        self._grabbed = self._picture = None
        self._media.is_held = False
        if sound is not None:
            top = sound.columns(sound.start, sound.end, 1000)
            # One loud noise must not shrink all speech; it is clipped instead.
            loud = float(np.nanquantile(np.abs(top), _LOUD))
            self._loudest = max(_QUIETEST, loud)
        self.update()

    # --- painting --------------------------------------------------------------------------

    @guarded
    def paintEvent(self, _event: QPaintEvent) -> None:
        """Selection, waveform, playhead."""
        painter = QPainter(self)
        painter.fillRect(self.rect(), style.color(style.PLOT))
        placed, scale, timeline = self._media.sound, self.scale, self._timeline
        if placed is None:
            return
        first, last = (scale.x_of(t + placed.offset) for t in (placed.item.start, placed.item.end))
        for left, right in ((0.0, first), (last, scale.width)):  # outside the sound
            if right > left:
                rect = QRectF(left, 0, right - left, scale.height)
                painter.fillRect(rect, style.color(style.BACKGROUND))
        if timeline.selection is not None:
            start, end = timeline.selection
            span = Span(start, end, timeline.falloff, timeline.falloff_out)
            paint.draw_selection(painter, scale, span)
        painter.drawImage(QRectF(self.rect()), self._drawn())
        painter.setPen(QPen(style.color(_INK, 90), 0))
        middle = round(0.5 * scale.height)
        painter.drawLine(QPointF(max(first, 0), middle), QPointF(min(last, scale.width), middle))
        paint.draw_playhead(painter, scale, timeline.time)
        if self._grabbed is not None:
            font = style.scaled_font(self, 0.92)
            at = QPointF(self._grabbed[0], 0.5 * scale.height)
            lines = (f"{placed.offset:+.3f} s",)
            paint.draw_tag(painter, paint.tag_box(at, scale, lines, font), lines, font)

    def _drawn(self) -> QImage:
        """The waveform alone, a column for each screen pixel, cached until it changes."""
        placed = self._media.sound
        assert placed is not None
        ratio = self.devicePixelRatioF()
        size = max(1, round(self.width() * ratio)), max(1, round(self.height() * ratio))
        key = (placed, self._timeline.view, size)
        if self._picture is None or self._picture[0] != key:
            first, last = self._timeline.view
            shift = placed.offset
            columns = placed.item.columns(first - shift, last - shift, size[0])
            pixels = _painted(
                np.clip(columns / self._loudest, -1.0, 1.0), size[1], style.color(_INK).rgb()
            )
            image = QImage(pixels.data, *size, QImage.Format.Format_ARGB32_Premultiplied)
            self._picture = key, image, pixels
        return self._picture[1]

    # --- mouse -----------------------------------------------------------------------------

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Left scrubs, or with Ctrl or Alt moves the sound; middle pans."""
        x = event.position().x()
        if self._grabbed is not None:
            self._cancel()  # another button during the drag
        elif event.button() == Qt.MouseButton.MiddleButton:
            self._drag = Pan(x, self._timeline.view, self.scale.seconds_per_pixel)
        elif event.button() == Qt.MouseButton.LeftButton and self._media.sound is not None:
            if event.modifiers() & _MOVES:
                self._before = self._media.sound.offset
                self._grabbed = x, self._before
                self._media.is_held = True
                self.setCursor(Qt.CursorShape.SizeHorCursor)
                self.setFocus()  # for Esc
            else:
                self._scrubs = True
                self._timeline.go_to_time(self.scale.time_at(x))

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Continue the gesture."""
        if not event.buttons() and event.type() == QEvent.Type.MouseMove:
            self.mouse_lost()
        x = event.position().x()
        if self._drag is not None:
            self._timeline.show_range(*self._drag.moved(x))
        elif self._grabbed is not None:
            fine = bool(event.modifiers() & Qt.KeyboardModifier.ShiftModifier)
            way = (x - self._grabbed[0]) * self.scale.seconds_per_pixel * (FINE if fine else 1.0)
            self._grabbed = x, self._grabbed[1] + way
            self._media.move_sound(self._grabbed[1])
            self.update()
        elif self._scrubs:
            self._timeline.go_to_time(self.scale.time_at(min(max(x, 0), self.width())))

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """End the gesture."""
        if event.button() == Qt.MouseButton.LeftButton and self._grabbed is not None:
            self.mouseMoveEvent(event)
            self._end_move()
        if not event.buttons():
            self.mouse_lost()

    def mouse_lost(self) -> None:
        """The release was lost: end the drag and keep its result."""
        self._drag, self._scrubs = None, False
        if self._grabbed is not None:
            self._end_move()

    def event(self, event: QEvent) -> bool:
        """During a drag, Esc is not a shortcut."""
        if event.type() == QEvent.Type.ShortcutOverride and self._grabbed is not None:
            event.accept()
            return True
        return super().event(event)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Esc cancels the drag."""
        if event.key() == Qt.Key.Key_Escape and self._grabbed is not None:
            self._cancel()
        else:
            super().keyPressEvent(event)

    def _cancel(self) -> None:
        self._media.move_sound(self._before)
        self._end_move()

    def _end_move(self) -> None:
        self._grabbed, self._media.is_held = None, False
        self._media.acted.emit()
        self.unsetCursor()
        self.update()

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Zoom around the pointer; with Shift, pan."""
        turn_wheel(self._timeline, self.scale.time_at(event.position().x()), event)
        event.accept()

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:
        """Show the sound's menu."""
        sound_menu(self, self._media, self._timeline).popup(event.globalPos())


def sound_menu(parent: QWidget, media: TakeMedia, timeline: Timeline) -> QMenu:
    """The menu to place or remove the sound."""
    menu = QMenu(parent)
    menu.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
    placing_actions(menu, media, media.move_sound, timeline)
    menu.addSeparator()
    menu.addAction("Remove sound").triggered.connect(media.remove_sound)
    return menu


class SoundRow(StripRow):
    """The waveform and its header, aligned with the plots. Hidden without sound."""

    def __init__(self, media: TakeMedia, timeline: Timeline) -> None:
        self.waveform = Waveform(media, timeline)
        super().__init__(self.waveform, HEIGHT)
        self._media = media
        self.name = Name()
        self.offset = OffsetBox("sound")
        self.offset.valueChanged.connect(media.move_sound)
        self.offset.editingFinished.connect(media.acted)
        remove = remove_button("sound")
        remove.clicked.connect(media.remove_sound)
        grid = QGridLayout(self.head)
        grid.setContentsMargins(12, 4, 6, 4)
        grid.setHorizontalSpacing(4)
        grid.setVerticalSpacing(2)
        grid.addWidget(self.name, 0, 0)
        grid.addWidget(remove, 0, 1)
        grid.addWidget(self.offset, 1, 0, 1, 2)
        grid.setColumnStretch(0, 1)
        media.sound_changed.connect(self._show)
        media.placed.connect(self._show)
        self._show()

    def _show(self) -> None:
        placed = self._media.sound
        self.want(placed is not None)
        if placed is not None:
            self.name.show_name(placed.path.name, str(placed.path))
            self.offset.show_offset(placed.offset)


def _painted(columns: NDArray[np.float32], height: int, ink: int) -> NDArray[np.uint32]:
    """(H, W) premultiplied ARGB of (W, 2) lowest and highest amplitudes, soft at the ends."""
    middle, reach = 0.5 * height, 0.5 * height - 2.0
    top, bottom = middle - columns[:, 1] * reach, middle - columns[:, 0] * reach
    thin = bottom - top < 1.0  # draw silence as a line
    top = np.where(thin, 0.5 * (top + bottom) - 0.5, top)
    bottom = np.where(thin, top + 1.0, bottom)
    rows = np.arange(height, dtype=np.float32)[:, None]
    covered = np.clip(np.minimum(bottom, rows + 1) - np.maximum(top, rows), 0.0, 1.0)
    alpha = np.nan_to_num(covered)
    out = (alpha * 255).astype(np.uint32) << 24
    for shift in (16, 8, 0):
        out |= (alpha * (ink >> shift & 255)).astype(np.uint32) << shift
    return np.ascontiguousarray(out)
