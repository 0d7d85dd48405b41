"""A slider that says whether its handle is being dragged or stepped."""

from __future__ import annotations

from PySide6.QtCore import QEvent, Qt, Signal
from PySide6.QtGui import QFocusEvent, QMouseEvent
from PySide6.QtWidgets import QSlider


class GestureSlider(QSlider):
    """A horizontal slider whose changes are told apart by where a gesture ends.

    The mouse leaves the focus where it is, so that the arrows go on moving the playhead.

    Signals:
        dragged(int): the handle is elsewhere, and still held; `sliderReleased` ends it.
        stepped(int): a key, the wheel or a click beside the handle: a gesture of its own, that
            belongs to those before it.
        left(): focus or pointer are elsewhere: the next such step belongs to none before it.
    """

    dragged = Signal(int)
    stepped = Signal(int)
    left = Signal()

    def __init__(self, lowest: int, highest: int, width: int) -> None:
        super().__init__(Qt.Orientation.Horizontal)
        self.setRange(lowest, highest)
        self.setPageStep(10)
        self.setFixedWidth(width)
        self.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.valueChanged.connect(self._moved)
        self._is_dropped = False  # the drag, although the button is still down

    def _moved(self, value: int) -> None:
        (self.dragged if self.isSliderDown() else self.stepped).emit(value)

    def drop(self) -> None:
        """End the drag in progress: until the button is up, the mouse moves nothing more."""
        self._is_dropped = self.isSliderDown()
        self.setSliderDown(False)

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """A new drag; the release of a dropped one may have been lost to another window."""
        self._is_dropped = False
        super().mousePressEvent(event)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Bring the handle along, unless its drag was dropped."""
        if not self._is_dropped:
            super().mouseMoveEvent(event)

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """The end of a drag, dropped or not."""
        self._is_dropped = False
        super().mouseReleaseEvent(event)

    def focusOutEvent(self, event: QFocusEvent) -> None:
        """The keyboard goes elsewhere."""
        super().focusOutEvent(event)
        self.left.emit()

    def leaveEvent(self, event: QEvent) -> None:
        """The pointer goes elsewhere, and the wheel with it."""
        super().leaveEvent(event)
        self.left.emit()
