"""What lies behind the curves of a plot: selection, gaps and grid."""

from __future__ import annotations

from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QPainter
from PySide6.QtWidgets import QGraphicsItem, QGraphicsScene, QGraphicsView, QStyleOptionGraphicsItem

from faceedit_app.ui.look.guard import guarded, saved

_EDGE = 2.0  # greatest pixels by which an item is larger than its box
_BACKGROUND = QGraphicsScene.SceneLayer.BackgroundLayer


class Backdrop:
    """Draws items into the background of a plot, which Qt keeps as a picture until they change.

    In the scene, they would be asked for their places and painted with each step of a drag,
    although they stay as they are.

    Args:
        plot: the plot, which caches its background, as all of pyqtgraph's do.
        view: its view box, to which the items belong.
    """

    def __init__(self, plot: QGraphicsView, view: QGraphicsItem) -> None:
        self._plot, self._view = plot, view
        self._items: list[QGraphicsItem] = []
        self._option = QStyleOptionGraphicsItem()

    def add(self, item: QGraphicsItem) -> None:
        """Draw an item of the view here, and not in the scene, from now on."""
        item.setFlag(QGraphicsItem.GraphicsItemFlag.ItemHasNoContents)
        self._items.append(item)
        self._items.sort(key=QGraphicsItem.zValue)

    def renew(self, box: QRectF | None = None) -> None:
        """Draw a box again, in pixels of the plot; None = all of it."""
        box = self._view.sceneBoundingRect() if box is None else box
        box = box.adjusted(-_EDGE, -_EDGE, _EDGE, _EDGE)
        self._plot.invalidateScene(box, _BACKGROUND)

    @guarded
    def paint(self, painter: QPainter) -> None:
        """Draw the items that are shown, from back to front."""
        with saved(painter):
            box = self._view.sceneBoundingRect()
            painter.setClipRect(box, Qt.ClipOperation.IntersectClip)
            place = painter.transform()
            for item in self._items:
                if item.isVisible():
                    item.boundingRect()  # Qt, too, asks before it paints: it is measured then
                    painter.setTransform(item.sceneTransform() * place)
                    item.paint(painter, self._option, None)
