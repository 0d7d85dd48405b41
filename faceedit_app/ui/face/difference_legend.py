"""The legend of the face's tint, in millimetres, in a corner of the picture."""

from __future__ import annotations

from PySide6.QtCore import QRectF, QSize, Qt
from PySide6.QtGui import QColor, QFont, QLinearGradient, QPainter, QPaintEvent
from PySide6.QtWidgets import QWidget

from faceedit_app.core.rig import Rig
from faceedit_app.render.difference import FULL, ramp
from faceedit_app.ui.look.guard import guarded
from faceedit_app.ui.look.palette import PANEL, TEXT

_STOPS = 9  # colours of the bar; Qt blends between them
_LENGTH, _SHORT, _BAR = 116, 60, 8  # pixels
_PAD = 6


class DifferenceLegend(QWidget):
    """A bar of the tint's colours, from 0 mm to the full tint."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self._length = _LENGTH
        self._colors: list[QColor] = []
        font = QFont(self.font())
        font.setPointSizeF(max(font.pointSizeF() - 1.5, 7.0))
        self.setFont(font)
        # Let mouse events through to the viewport.
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.setAccessibleName("Difference")
        self.setAccessibleDescription(
            f"Distance from the tracked face: no tint is 0 mm, violet is {FULL:g} mm or more."
        )
        self.hide()

    def open(self, rig: Rig) -> None:
        """Show the tint on this character's skin."""
        self._colors = [QColor.fromRgbF(*map(float, color)) for color in ramp(rig, _STOPS)]
        self.update()

    def shorten(self, wanted: bool) -> None:
        """Make the bar short, without the number in the middle, or as long as it was."""
        self._length = _SHORT if wanted else _LENGTH
        self.update()

    def sizeHint(self) -> QSize:
        """Size of the bar and its numbers."""
        return QSize(self._length + 2 * _PAD, _PAD + _BAR + self.fontMetrics().height() + _PAD // 2)

    @guarded
    def paintEvent(self, _event: QPaintEvent) -> None:
        """Paint the bar with its millimetres."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(PANEL))
        painter.drawRoundedRect(self.rect(), 5, 5)
        bar = QRectF(_PAD, _PAD, self._length, _BAR)
        shades = QLinearGradient(bar.topLeft(), bar.topRight())
        for number, color in enumerate(self._colors):
            shades.setColorAt(number / (_STOPS - 1), color)
        painter.fillRect(bar, shades)
        painter.setPen(QColor(TEXT))
        below = QRectF(_PAD, bar.bottom() + 1, self._length, self.fontMetrics().height())
        side = Qt.AlignmentFlag
        for align, text in (
            (side.AlignLeft, "0"),
            (side.AlignHCenter, f"{FULL / 2:g}" if self._length == _LENGTH else ""),
            (side.AlignRight, f"{FULL:g}+ mm"),
        ):
            painter.drawText(below, align, text)
