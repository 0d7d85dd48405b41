"""What lies behind the curves, painted once and kept: in a drag it stays as it is."""

from __future__ import annotations

from collections.abc import Callable, Hashable

from PySide6.QtCore import QRect, QRectF
from PySide6.QtGui import QPainter, QPixmap
from PySide6.QtWidgets import QWidget


class Backdrop:
    """The picture behind a widget's moving parts.

    Gradients and hatching take longer to paint than the curves do, and a curve that moves makes
    everything behind it to be painted again.

    Args:
        widget: whose backdrop it is.
    """

    def __init__(self, widget: QWidget) -> None:
        self._widget = widget
        self._key: Hashable = None
        self._picture = QPixmap()

    def paint(
        self,
        painter: QPainter,
        rect: QRect,
        looks: Hashable,
        draw: Callable[[QPainter, QRectF], None],
    ) -> None:
        """Paint a part of it.

        Args:
            painter: of the widget.
            rect: the part, in the widget's pixels.
            looks: all that the picture depends on, besides its size.
            draw: paints the whole of it, if it looks otherwise than before.
        """
        size, ratio = self._widget.size(), self._widget.devicePixelRatioF()
        key = (size.toTuple(), ratio, looks)
        if key != self._key:
            self._picture = QPixmap(size * ratio)
            self._picture.setDevicePixelRatio(ratio)
            with QPainter(self._picture) as inside:
                draw(inside, QRectF(0.0, 0.0, size.width(), size.height()))
            self._key = key
        part = QRectF(rect)
        source = QRectF(
            ratio * part.x(), ratio * part.y(), ratio * part.width(), ratio * part.height()
        )
        painter.drawPixmap(part, self._picture, source)
