"""The header of a plot: region colour, name, and value at the playhead."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from PySide6.QtCore import QPoint, QPointF, QRect, QRectF, Qt, Signal
from PySide6.QtGui import (
    QContextMenuEvent,
    QFont,
    QFontMetricsF,
    QMouseEvent,
    QPainter,
    QPaintEvent,
)
from PySide6.QtWidgets import QSizePolicy, QWidget

from faceedit_app.core.controls import CONTROLS, Control
from faceedit_app.ui.curves import style
from faceedit_app.ui.look.guard import guarded
from faceedit_app.ui.look.palette import DISABLED, FAINT

_BAR = 3  # pixels of region colour
_TEXT_LEFT = 12
UNIT = " mm"
WIDEST = "88.8"  # of the values without a unit
_NAME, _SMALLEST_NAME, _SMALLER = 0.92, 0.72, 0.04  # of the window's font
_LOW_VALUE = 0.92  # of the window's font: of the value beside a name
_APART = 3.0  # pixels between name and value
_SQUEEZE = 6.0  # pixels that three lines may move closer
_LEFT = int(Qt.AlignmentFlag.AlignLeft | Qt.TextFlag.TextWordWrap)
_RIGHT_TOP = int(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignTop)
_RIGHT = int(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
_MIDDLE = int(Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter)


@dataclass(frozen=True)
class Layout:
    """Places of name, value and note.

    In a tall row they form one centred block, always with room for the note, so that names do
    not jump during playback; the name gets two lines if it needs them. In a low row the value is
    right of the name, which has one line.

    Attributes:
        name_font, value_font: the note uses the name's.
        name, value, share, note: their places; None without room.
        is_low: whether the value is beside the name.
    """

    name_font: QFont
    value_font: QFont
    name: QRectF
    value: QRectF
    share: QRectF | None
    note: QRectF | None
    is_low: bool = False

    @cached_property
    def value_at(self) -> QPointF:
        """Where the value begins, on its base line: text at a point is not laid out in lines."""
        ascent = QFontMetricsF(self.value_font).ascent()
        return QPointF(self.value.left(), self.value.top() + ascent)

    @property
    def readout(self) -> QRect:
        """Where all of value, share and note are, in whole pixels."""
        room = self.value if self.note is None else self.value.united(self.note)
        return room.toAlignedRect()

    @classmethod
    def of(cls, widget: QWidget, label: str, least: int) -> Layout:
        """The layout of a widget.

        Args:
            least: the height of the lowest row: rows differ by a pixel, and should look the same.
        """
        name, value = style.scaled_font(widget, _NAME), style.scaled_font(widget, 1.08, bold=True)
        height = widget.height()
        room = QRectF(_TEXT_LEFT, 0, widget.width() - _TEXT_LEFT, height)
        metrics, bold = QFontMetricsF(name), QFontMetricsF(value)
        name_height = metrics.boundingRect(room, _LEFT, label).height()
        text_height = name_height + bold.height()
        # Room for names of two lines, even if this one is shorter, so that all rows match.
        if 2 * metrics.height() + bold.height() > least:
            return cls._low(widget, room)
        with_note = text_height + metrics.height() <= least + _SQUEEZE
        whole = text_height + (metrics.height() if with_note else 0.0)
        top = max(0.5 * (height - whole), 0.0)
        closer = min(max(whole - height, 0.0), _SQUEEZE) / (2.0 if with_note else 1.0)
        tops = (top, top + name_height - closer, top + text_height - 2.0 * closer)
        places = [room.translated(0, y) for y in tops]
        share = places[1].adjusted(bold.horizontalAdvance(WIDEST + UNIT) + _APART, 1, -_APART, 0)
        return cls(name, value, places[0], places[1], share, places[2] if with_note else None)

    @classmethod
    def _low(cls, widget: QWidget, room: QRectF) -> Layout:
        """Side by side, on one line; the value goes without its unit.

        All names are printed as small as the longest one has to be.
        """
        value = style.scaled_font(widget, _LOW_VALUE, bold=True)
        wide = QFontMetricsF(value).horizontalAdvance(WIDEST)
        beside = QRectF(room.right() - wide, 0.0, wide, room.height())
        place = room.adjusted(0.0, 0.0, -wide - _APART, 0.0)
        size = _NAME
        while size > _SMALLEST_NAME and _longest(style.scaled_font(widget, size)) > place.width():
            size -= _SMALLER
        return cls(style.scaled_font(widget, size), value, place, beside, None, None, True)


def _longest(font: QFont) -> float:
    """Pixels of the longest name, with the overhang of its letters."""
    metrics = QFontMetricsF(font)
    return 1.0 + max(metrics.horizontalAdvance(control.label) for control in CONTROLS)


class Header(QWidget):
    """Left of a plot, with the same height.

    Signals:
        close_up_asked(): double click: switch the enlargement of small movements.
        picked(bool): a click: focus this curve; True: add it to the chosen ones, or remove it.
        menu_asked(place): a right click, and its place on the screen.
    """

    close_up_asked = Signal()
    picked = Signal(bool)
    menu_asked = Signal(QPoint)

    def __init__(self, control: Control, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.control = control
        self.value = ""
        self.note = self.share = ""
        self._active = self._chosen = False
        self._least = 0  # the height of the lowest row; 0 = not known yet
        self._measured: tuple[tuple[int, int, int, QFont], Layout] | None = None
        self.setFixedWidth(style.HEADER_WIDTH - style.AXIS_WIDTH)
        self.setAttribute(Qt.WidgetAttribute.WA_OpaquePaintEvent)
        self.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Expanding)
        self.setAccessibleName(control.label)
        self.show_missing("")

    def show_missing(self, why: str) -> None:
        """Disable the row and show why, or enable it if `why` is empty."""
        self.setEnabled(not why)
        self.setToolTip(
            why
            or f"{self.control.label}: {self.control.hint}\n"
            "Double-click: enlarge small movements.\n"
            "Ctrl+click: choose several curves to edit together."
        )

    def show_value(self, value: str, note: str = "", share: str = "") -> None:
        """Show the value at the playhead, and a note on it.

        Args:
            value: in millimetres.
            note: such as what was asked for.
            share: the value as a share of what this face does, such as "62 %".
        """
        if (value, note, share) != (self.value, self.note, self.share):
            self.value, self.note, self.share = value, note, share
            self.setAccessibleDescription(f"{value} at the playhead. {self.control.hint}")
            self.update(self._layout().readout)

    def show_active(self, active: bool) -> None:
        """Highlight the header together with the plot under the pointer."""
        if active != self._active:
            self._active = active
            self.update()

    def show_chosen(self, chosen: bool) -> None:
        """Mark the curve as one of those chosen to be edited together."""
        if chosen != self._chosen:
            self._chosen = chosen
            self.update()

    def match_rows(self, least: int) -> None:
        """Be laid out as the lowest row is, whose height this is."""
        if least != self._least:
            self._least = least
            self.update()

    def _name_color(self) -> str:
        if not self.isEnabled():
            return DISABLED
        return style.TEXT if self._active else style.LABEL

    def _layout(self) -> Layout:
        """Computed once for each size and font."""
        least = min(self._least or self.height(), self.height())
        key = self.width(), self.height(), least, self.font()
        if self._measured is None or self._measured[0] != key:
            self._measured = key, Layout.of(self, self.control.label, least)
        return self._measured[1]

    def _short_name(self, layout: Layout) -> str:
        """The name, without its middle if it has no room; the tooltip has all of it."""
        metrics, room = QFontMetricsF(layout.name_font), layout.name.width()
        return metrics.elidedText(self.control.label, Qt.TextElideMode.ElideMiddle, room)

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Focus the curve; with Ctrl, choose it."""
        if event.button() == Qt.MouseButton.LeftButton:
            self.picked.emit(bool(event.modifiers() & Qt.KeyboardModifier.ControlModifier))
        event.accept()

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        """Enlarge small movements."""
        if event.button() == Qt.MouseButton.LeftButton:
            self.close_up_asked.emit()
        event.accept()

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:
        """Ask for the curve's menu."""
        self.menu_asked.emit(event.globalPos())
        event.accept()

    @guarded
    def paintEvent(self, event: QPaintEvent) -> None:
        """Paint bar, name and value; the name only where it is out of date."""
        layout, color = self._layout(), self.control.color if self.isEnabled() else FAINT
        with QPainter(self) as painter:
            ground = style.PLOT_ACTIVE if self._active else style.PLOT
            painter.fillRect(event.rect(), style.color(ground))
            if self._chosen:
                painter.fillRect(event.rect(), style.color(color, 46))
            bar = QRectF(0, 0, 2 * _BAR if self._chosen else _BAR, self.height())
            painter.fillRect(bar, style.color(color))
            painter.setFont(layout.name_font)
            if layout.name.intersects(event.rect()):
                painter.setPen(style.color(self._name_color()))
                if layout.is_low:
                    painter.drawText(layout.name, _MIDDLE, self._short_name(layout))
                else:
                    painter.drawText(layout.name, _LEFT, self.control.label)
            painter.setPen(style.color(style.MUTED))
            if layout.share is not None and self.share:
                painter.drawText(layout.share, _RIGHT_TOP, self.share)
            if layout.note is not None and self.note:
                painter.drawText(layout.note, _LEFT, self.note)
            painter.setFont(layout.value_font)
            painter.setPen(style.color(style.TEXT if self.isEnabled() else DISABLED))
            if layout.is_low:
                painter.drawText(layout.value, _RIGHT, self.value.removesuffix(UNIT))
            else:
                painter.drawText(layout.value_at, self.value)
