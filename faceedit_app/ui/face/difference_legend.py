"""What the tint of the face means, in millimetres, in a corner of the picture."""

from __future__ import annotations

from PySide6.QtCore import QRectF, QSize, Qt
from PySide6.QtGui import QColor, QFont, QLinearGradient, QPainter, QPaintEvent
from PySide6.QtWidgets import QWidget

from faceedit_app.core.rig import Rig
from faceedit_app.render.difference import FULL, ramp
from faceedit_app.ui.look.palette import PANEL, TEXT

_STOPS = 9  # colours of the bar; between them Qt mixes, which is too little to be seen
_LENGTH, _BAR = 116, 8  # pixels
_PAD = 6


class DifferenceLegend(QWidget):
    """A bar of the tint's colours, from 0 mm to where it is full."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self._colors: list[QColor] = []
        font = QFont(self.font())
        font.setPointSizeF(max(font.pointSizeF() - 1.5, 7.0))
        self.setFont(font)
        # The face beneath it can be turned there too.
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.setAccessibleName("Difference")
        self.setAccessibleDescription(
            f"How far the face is from the tracked one: plain is 0 mm, violet {FULL:g} mm or more."
        )
        self.hide()

    def open(self, rig: Rig) -> None:
        """Explain the tint on this character's skin."""
        self._colors = [QColor.fromRgbF(*map(float, color)) for color in ramp(rig, _STOPS)]
        self.update()

    def sizeHint(self) -> QSize:
        """The bar above its numbers."""
        return QSize(_LENGTH + 2 * _PAD, _PAD + _BAR + self.fontMetrics().height() + _PAD // 2)

    def paintEvent(self, _event: QPaintEvent) -> None:
        """The bar with its millimetres."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(PANEL))
        painter.drawRoundedRect(self.rect(), 5, 5)
        bar = QRectF(_PAD, _PAD, _LENGTH, _BAR)
        shades = QLinearGradient(bar.topLeft(), bar.topRight())
        for number, color in enumerate(self._colors):
            shades.setColorAt(number / (_STOPS - 1), color)
        painter.fillRect(bar, shades)
        painter.setPen(QColor(TEXT))
        below = QRectF(_PAD, bar.bottom() + 1, _LENGTH, self.fontMetrics().height())
        side = Qt.AlignmentFlag
        for align, text in (
            (side.AlignLeft, "0"),
            (side.AlignHCenter, f"{FULL / 2:g}"),
            (side.AlignRight, f"{FULL:g}+ mm"),
        ):
            painter.drawText(below, align, text)
