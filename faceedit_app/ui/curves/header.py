"""The head of a plot's row: region, name, value at the playhead, and the value axis' numbers."""

from __future__ import annotations

from dataclasses import dataclass

from PySide6.QtCore import QRectF, Qt, Signal
from PySide6.QtGui import QFont, QFontMetricsF, QMouseEvent, QPainter, QPaintEvent
from PySide6.QtWidgets import QSizePolicy, QWidget

from faceedit_app.core.regions import Control
from faceedit_app.ui.curves import style
from faceedit_app.ui.curves.axes import Scale, value_ticks
from faceedit_app.ui.curves.backdrop import Backdrop

_BAR = 3  # pixels of region colour
_TEXT_LEFT = 12
_AXIS = 38  # pixels for the numbers
# Pixels that three lines may move together: rows differ by a pixel, and should all look alike.
_SQUEEZE = 6.0
_FLAGS = int(Qt.AlignmentFlag.AlignLeft | Qt.TextFlag.TextWordWrap)


@dataclass(frozen=True)
class Layout:
    """Name, value and remark as one block, centred; the name gets two lines where it needs them.

    The remark has its place whether there is one or not: names must not hop in playback.

    Attributes:
        name_font, value_font: the remark is in the name's.
        name, value, note: where each is written; no note where there is no room.
    """

    name_font: QFont
    value_font: QFont
    name: QRectF
    value: QRectF
    note: QRectF | None

    @classmethod
    def of(cls, widget: QWidget, label: str) -> Layout:
        """The block of a widget."""
        name, value = style.scaled_font(widget, 0.92), style.scaled_font(widget, 1.08, bold=True)
        height = widget.height()
        room = QRectF(_TEXT_LEFT, 0, widget.width() - _TEXT_LEFT - _AXIS, height)
        metrics = QFontMetricsF(name)
        name_height = metrics.boundingRect(room, _FLAGS, label).height()
        text_height = name_height + QFontMetricsF(value).height()
        with_note = text_height + metrics.height() <= height + _SQUEEZE
        whole = text_height + (metrics.height() if with_note else 0.0)
        top = max(0.5 * (height - whole), 0.0)
        closer = min(max(whole - height, 0.0), _SQUEEZE) / (2.0 if with_note else 1.0)
        tops = (top, top + name_height - closer, top + text_height - 2.0 * closer)
        places = [room.translated(0, y) for y in tops]
        return cls(name, value, places[0], places[1], places[2] if with_note else None)


class Header(QWidget):
    """Stands left of a plot, as tall as it.

    Signals:
        close_up_asked(): double click: show small movements large, or no longer.
        picked(bool): a click: this curve has the focus; True: it is added to the chosen ones.
    """

    close_up_asked = Signal()
    picked = Signal(bool)

    def __init__(self, control: Control, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.control = control
        self.value = ""
        self.note = ""
        self._scale: Scale | None = None
        self._active = self._chosen = False
        self._backdrop = Backdrop(self)
        self._layout: Layout
        self.setFixedWidth(style.HEADER_WIDTH)
        self.setAttribute(Qt.WidgetAttribute.WA_OpaquePaintEvent)
        self.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Expanding)
        self.setToolTip(
            f"{control.hint}\nDouble click: enlarge small movements.\n"
            "Ctrl+click: choose several curves, to edit them together."
        )
        self.setAccessibleName(control.label)

    def show_value(self, value: str, note: str = "") -> None:
        """Show the value at the playhead, and a remark on it."""
        if (value, note) != (self.value, self.note):
            self.value, self.note = value, note
            self.setAccessibleDescription(f"{value} at the playhead. {self.control.hint}")
            self.update()

    def show_scale(self, scale: Scale) -> None:
        """Number the value axis of the plot beside it."""
        known, self._scale = self._scale, scale
        if known is None or (known.span, known.height) != (scale.span, scale.height):
            self.update()

    def show_active(self, active: bool) -> None:
        """Light up with the plot that the pointer is on."""
        if active != self._active:
            self._active = active
            self.update()

    def show_chosen(self, chosen: bool) -> None:
        """Whether it is one of several curves that are edited together."""
        if chosen != self._chosen:
            self._chosen = chosen
            self.update()

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Take the focus; with Ctrl join the curves that are edited together."""
        self.picked.emit(bool(event.modifiers() & Qt.KeyboardModifier.ControlModifier))
        event.accept()

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        """Show small movements large."""
        self.close_up_asked.emit()
        event.accept()

    def paintEvent(self, _event: QPaintEvent) -> None:
        """Bar, name, value, numbers; only the value and the remark on it change often."""
        looks = (self._active, self._chosen, self._scale, self.font().key())
        with QPainter(self) as painter:
            self._backdrop.paint(painter, looks, self._paint_still)
            painter.setFont(self._layout.value_font)
            painter.setPen(style.color(style.TEXT))
            painter.drawText(self._layout.value, _FLAGS, self.value)
            if self._layout.note is not None:
                painter.setFont(self._layout.name_font)
                painter.setPen(style.color(style.MUTED))
                painter.drawText(self._layout.note, _FLAGS, self.note)

    def _paint_still(self, painter: QPainter, _rect: QRectF) -> None:
        """Whatever stays while the value changes."""
        self._layout = Layout.of(self, self.control.label)
        painter.fillRect(
            self.rect(), style.color(style.PLOT_ACTIVE if self._active else style.PLOT)
        )
        region = style.color(style.REGION_COLORS[self.control.region])
        if self._chosen:
            tint = style.color(style.REGION_COLORS[self.control.region], 46)
            painter.fillRect(self.rect(), tint)
        painter.fillRect(QRectF(0, 0, 2 * _BAR if self._chosen else _BAR, self.height()), region)
        painter.setFont(self._layout.name_font)
        painter.setPen(style.color(style.TEXT if self._active else style.LABEL))
        painter.drawText(self._layout.name, _FLAGS, self.control.label)
        self._paint_axis(painter)

    def _paint_axis(self, painter: QPainter) -> None:
        if self._scale is None:
            return
        font = style.scaled_font(self, 0.82)
        half = 0.5 * QFontMetricsF(font).height()
        painter.setFont(font)
        painter.setPen(style.color(style.MUTED))
        for tick in value_ticks(self._scale.span, self._scale.height, style.VALUE_SPACING):
            y = self._scale.y_of(tick.at)
            if half - 2 <= y <= self.height() - half + 2:  # never half a number
                box = QRectF(self.width() - _AXIS, y - half, _AXIS - 6, 2 * half)
                flags = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
                painter.drawText(box, flags, tick.label)
