"""A picture of a scan with its control points, which can be dragged."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from PySide6.QtCore import QSize, Signal
from PySide6.QtGui import QColor, QImage, QPainter, QPaintEvent
from PySide6.QtWidgets import QWidget

from faceedit_app.core.arrays import Doubles, Floats, Pixels
from faceedit_app.render import Camera
from faceedit_app.ui.look.guard import guarded
from faceedit_app.ui.look.palette import PANEL

SIZE = 360  # pixels of a side


class Picture(QWidget):
    """A square picture.

    Signals:
        drawn(): another picture is shown.
    """

    drawn = Signal()

    def __init__(self, name: str) -> None:
        super().__init__()
        self._image: QImage | None = None
        self.setFixedSize(SIZE, SIZE)
        self.setAccessibleName(name)

    @property
    def pixels(self) -> int:
        """The side of a picture that is shown one to one."""
        return round(SIZE * self.devicePixelRatioF())

    def show_picture(self, pixels: Pixels) -> None:
        """Show a picture (S, S, 3), RGB."""
        side = len(pixels)
        kept = np.ascontiguousarray(pixels)
        image = QImage(kept.data, side, side, 3 * side, QImage.Format.Format_RGB888)
        self._image = image.copy()  # the array is not kept
        self.update()
        self.drawn.emit()

    @property
    def is_empty(self) -> bool:
        """Whether there is no picture yet."""
        return self._image is None

    @guarded
    def paintEvent(self, _event: QPaintEvent) -> None:
        """Paint the picture."""
        painter = QPainter(self)
        painter.fillRect(self.rect(), QColor(PANEL))
        if self._image is not None:
            painter.drawImage(self.rect(), self._image)

    def sizeHint(self) -> QSize:
        """The size of the picture."""
        return QSize(SIZE, SIZE)


class ScanView(Picture):
    """A picture of a scan, whose vertices are known to a `PointsOverlay`."""

    def __init__(self) -> None:
        super().__init__("The scan")
        self._vertices: Floats | None = None
        self._camera = Camera()

    def look(self, vertices: Floats, camera: Camera) -> None:
        """Where the vertices (V, 3), metres, are and are seen from in the next picture."""
        self._vertices, self._camera = vertices, camera

    def project(self, vertices: Sequence[int] | None) -> Doubles | None:
        """Where vertices are in the picture; see `Viewport.project`."""
        if self._vertices is None:
            return None
        chosen = self._vertices if vertices is None else self._vertices[list(vertices)]
        return self._camera.project(chosen, SIZE, SIZE)
