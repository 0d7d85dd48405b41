"""Items in the view of a plot that are measured once for each view."""

from __future__ import annotations

import pyqtgraph as pg
from PySide6.QtCore import QRectF

from faceedit_app.ui.curves.backdrop import Backdrop


class MeasuredItem(pg.GraphicsItem):
    """Keeps an item's box until the view changes; pyqtgraph's own items measure it each time.

    Attributes:
        backdrop: what draws it; None = the scene.
    """

    _rect: QRectF | None = None
    backdrop: Backdrop | None = None

    def viewTransformChanged(self) -> None:
        """Other seconds or millimetres are in view, or the view has another size."""
        super().viewTransformChanged()
        self.forget()
        if self.backdrop is not None:
            self.backdrop.renew()

    def forget(self) -> None:
        """Measure again what depends on the view."""
        self._rect = None
        self.prepareGeometryChange()

    def move_behind(self, backdrop: Backdrop) -> None:
        """Let a backdrop draw it from now on."""
        self.backdrop = backdrop
        backdrop.add(self)

    def redraw(self) -> None:
        """Draw it again where it is now."""
        if self.backdrop is None:
            self.update()
        elif self.isVisible():
            self.backdrop.renew(self.mapRectToScene(self.boundingRect()))

    def boundingRect(self) -> QRectF:
        """The box, in seconds and millimetres."""
        if self._rect is None:
            view = self.getViewBox()
            if view is None:
                return QRectF()
            self._rect = self._measure(view.viewRect(), view.pixel)
        return self._rect

    def _measure(self, view: QRectF, pixel: float) -> QRectF:
        """The box in this view; `pixel` is its width in seconds."""
        raise NotImplementedError


class ViewItem(MeasuredItem, pg.GraphicsObject):
    """An item as large as its view box.

    As pyqtgraph's `UIGraphicsItem`, which measures a view before it has changed.
    """

    def _measure(self, view: QRectF, _pixel: float) -> QRectF:
        return view
