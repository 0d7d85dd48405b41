"""What fills the view of a plot, whatever is in view."""

from __future__ import annotations

import pyqtgraph as pg
from PySide6.QtCore import QRectF


class ViewItem(pg.GraphicsObject):
    """An item as large as its view box, in seconds and millimetres.

    As pyqtgraph's `UIGraphicsItem`, which measures a view before it has changed.
    """

    def __init__(self) -> None:
        super().__init__()
        self._rect: QRectF | None = None

    def viewTransformChanged(self) -> None:
        """Other seconds or millimetres are in view, or the view has another size."""
        super().viewTransformChanged()
        self.forget()

    def forget(self) -> None:
        """Measure again what depends on the view."""
        self._rect = None
        self.prepareGeometryChange()

    def boundingRect(self) -> QRectF:
        """All that is in view."""
        if self._rect is None:
            view = self.getViewBox()
            if view is None:
                return QRectF()
            self._rect = view.viewRect()
        return self._rect
