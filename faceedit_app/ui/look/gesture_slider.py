"""Sliders: a double click goes back to the start; one distinguishes drags from steps."""

from __future__ import annotations

from PySide6.QtCore import QEvent, Qt, Signal
from PySide6.QtGui import QFocusEvent, QMouseEvent
from PySide6.QtWidgets import QSlider


class Slider(QSlider):
    """A horizontal slider; a double click goes back to where it starts."""

    def __init__(self, lowest: int, highest: int, *, start: int, page: int = 10) -> None:
        super().__init__(Qt.Orientation.Horizontal)
        self._start = start
        self.setRange(lowest, highest)
        self.setPageStep(page)

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        """Go back to the start; Qt would press again."""
        if event.button() == Qt.MouseButton.LeftButton:
            self.setValue(self._start)
        event.accept()


class GestureSlider(Slider):
    """A slider that reports where each gesture ends.

    A click does not take the focus, so that the arrows still move the playhead. The steps that the
    first click of a double click made may be merged with it.

    Signals:
        dragged(int): the handle moved and is still held; `sliderReleased` ends the drag.
        stepped(int): a key, the wheel or a click beside the handle: a complete gesture, which
            may be merged with those before it.
        left(): focus or pointer left: the next step is not merged with earlier ones.
    """

    dragged = Signal(int)
    stepped = Signal(int)
    left = Signal()

    def __init__(self, lowest: int, highest: int, width: int, start: int) -> None:
        super().__init__(lowest, highest, start=start)
        self.setFixedWidth(width)
        self.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.valueChanged.connect(self._moved)
        self._is_dropped = False  # the drag was cancelled while the button is down

    def _moved(self, value: int) -> None:
        (self.dragged if self.isSliderDown() else self.stepped).emit(value)

    def cancel_drag(self) -> None:
        """Cancel the drag in progress: ignore the mouse until the button is released."""
        self._is_dropped = self.isSliderDown()
        self.setSliderDown(False)

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Begin a new drag; the release of a cancelled one may have been lost."""
        self._is_dropped = False
        super().mousePressEvent(event)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Move the handle, unless the drag was cancelled."""
        if not self._is_dropped:
            super().mouseMoveEvent(event)

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """End a drag, cancelled or not."""
        self._is_dropped = False
        super().mouseReleaseEvent(event)

    def focusOutEvent(self, event: QFocusEvent) -> None:
        """The focus is lost."""
        super().focusOutEvent(event)
        self.left.emit()

    def leaveEvent(self, event: QEvent) -> None:
        """The pointer left, and the wheel with it."""
        super().leaveEvent(event)
        self.left.emit()
