"""What lies behind the curves, painted once and kept: in a drag it stays as it is."""

from __future__ import annotations

from collections.abc import Callable, Hashable

from PySide6.QtCore import QPointF, QRectF
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
        looks: Hashable,
        draw: Callable[[QPainter, QRectF], None],
    ) -> None:
        """Paint it, or as much of it as the painter is clipped to.

        Args:
            painter: of the widget.
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
        # Always from the corner: on screens of one and a half dots to the pixel a part would not
        # lie where it lies in the whole.
        painter.drawPixmap(QPointF(), self._picture)
