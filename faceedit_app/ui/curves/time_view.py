"""The view box of everything on the time axis: pyqtgraph's, in sync with the timeline."""

from __future__ import annotations

import math
from typing import Any

import pyqtgraph as pg
from PySide6.QtCore import QEvent, QPoint, QPointF, Qt, Signal
from PySide6.QtGui import QMouseEvent
from PySide6.QtWidgets import (
    QGraphicsSceneHoverEvent,
    QGraphicsSceneMouseEvent,
    QGraphicsSceneWheelEvent,
)

from faceedit_app.ui.curves.gestures import PAN_STEP, ZOOM_STEP, Pointer, WheelAction, wheel_action
from faceedit_app.ui.curves.scale import Scale
from faceedit_app.ui.curves.value_range import LARGEST, SMALLEST
from faceedit_app.ui.state.timeline import Timeline

LEFT, RIGHT = Qt.MouseButton.LeftButton, Qt.MouseButton.RightButton
_NOTCH = 120  # of the wheel, in Qt's units
_TIME, _VALUES = 0, 1  # pyqtgraph's numbers of the axes


class Mouse:
    """What left button, wheel and pointer do in a `TimeView`: nothing, until overridden."""

    @property
    def takes_wheel(self) -> bool:
        """Whether it handles the wheel, instead of the view."""
        return False

    def pressed(self, pointer: Pointer) -> None:
        """The left button went down."""

    def double_clicked(self, pointer: Pointer) -> None:
        """The left button was double-clicked."""
        self.pressed(pointer)

    def dragged(self, pointer: Pointer) -> None:
        """The pointer moved with the button down."""

    def released(self, pointer: Pointer) -> None:
        """The left button went up."""

    def mouse_lost(self) -> None:
        """The release was lost."""

    def hovered(self, pointer: Pointer) -> None:
        """The pointer moved without a button."""

    def left(self) -> None:
        """The pointer left the view."""

    def turned(self, pointer: Pointer, notches: float) -> None:
        """The wheel was turned."""

    def cancel(self) -> None:
        """The right button went down during a gesture."""


class TimeView(pg.ViewBox):
    """Shows the timeline's visible range; the left button is for gestures.

    pyqtgraph zooms and pans with the wheel, the right and the middle button, and with all of them
    on the axes. Time is linked through the timeline: pyqtgraph's `setXLink` aligns views by their
    position on the screen, and so shifts hidden ones and those without a value axis.

    Signals:
        values_chosen(): the user zoomed or moved the values.
        menu_asked(x, y, place): a right click: its pixel, and its place on the screen.
    """

    values_chosen = Signal()
    menu_asked = Signal(float, float, QPoint)

    def __init__(self, timeline: Timeline, mouse: Mouse, has_values: bool = True) -> None:
        super().__init__(enableMenu=False, defaultPadding=0.0)
        self._timeline, self._mouse, self._has_values = timeline, mouse, has_values
        self._axis = _TIME
        self._is_held = False  # by the left button
        self.disableAutoRange()
        self.setMouseEnabled(x=True, y=has_values)
        self.setLimits(minYRange=SMALLEST, maxYRange=LARGEST)
        self.state["wheelScaleFactor"] = math.log(ZOOM_STEP, 1.02) / _NOTCH
        self.setFlag(self.GraphicsItemFlag.ItemHasNoContents)  # the border is an item of its own
        self.setAcceptHoverEvents(True)
        timeline.view_changed.connect(self._follow)
        self.sigRangeChangedManually.connect(self._lead)
        self._follow()

    @property
    def scale_now(self) -> Scale:
        """How its pixels map to seconds and millimetres."""
        (first, last), (low, high) = self.viewRange()
        return Scale(self.width(), self.height(), (first, last), (low, high))

    @property
    def pixel(self) -> float:
        """Seconds per pixel.

        The same as pyqtgraph's `viewPixelSize`, which inverts a matrix after each change.
        """
        first, last = self.viewRange()[0]
        seconds: float = (last - first) / max(self.width(), 1.0)
        return seconds

    def setRange(self, *args: Any, **named: Any) -> None:
        """Show another range; pyqtgraph would move the items only while it paints."""
        super().setRange(*args, **named)
        self.updateMatrix()

    def _follow(self) -> None:
        self.setXRange(*self._timeline.view, padding=0)

    def _lead(self, changed: list[bool]) -> None:
        """The user moved the view; the timeline decides what is visible."""
        if changed[_TIME]:
            self._timeline.show_range(*self.viewRange()[0])
            self._follow()
        if changed[_VALUES]:
            self.values_chosen.emit()

    # --- the mouse: the left button -----------------------------------------------------------

    def mousePressEvent(self, event: QGraphicsSceneMouseEvent) -> None:
        """Handle the left button; events not accepted become pyqtgraph's drag or click."""
        if event.button() == LEFT:
            self._is_held = True
            self._mouse.pressed(_pointer_of(event))
        elif not self._is_held:
            event.ignore()
        elif event.button() == RIGHT:
            self._mouse.cancel()

    def mouseDoubleClickEvent(self, event: QGraphicsSceneMouseEvent) -> None:
        """Handle a double click."""
        if event.button() == LEFT:
            self._is_held = True
            self._mouse.double_clicked(_pointer_of(event))
        else:
            self.mousePressEvent(event)

    def drag_on(self, event: QMouseEvent) -> bool:
        """Continue a gesture of the left button; False if there is none.

        The scene would also look for items under the mouse at each move.
        """
        if not self._is_held or not event.buttons() & LEFT:
            return False
        self._mouse.dragged(_pointer(self.mapFromScene(event.position()), event.modifiers()))
        return True

    def mouseMoveEvent(self, event: QGraphicsSceneMouseEvent) -> None:
        """Continue the gesture."""
        self._mouse.dragged(_pointer_of(event))

    def mouseReleaseEvent(self, event: QGraphicsSceneMouseEvent) -> None:
        """End the gesture."""
        if event.button() == LEFT:
            self._is_held = False
            self._mouse.released(_pointer_of(event))

    def ungrabMouseEvent(self, event: QEvent) -> None:
        """Qt noticed that the button is up, although no release arrived."""
        if self._is_held:
            self._is_held = False
            self._mouse.mouse_lost()
        super().ungrabMouseEvent(event)

    def hoverMoveEvent(self, event: QGraphicsSceneHoverEvent) -> None:
        """Show what a press would do."""
        self._mouse.hovered(_pointer_of(event))

    def hoverLeaveEvent(self, _event: QGraphicsSceneHoverEvent) -> None:
        """The pointer left."""
        self._mouse.left()

    # --- the mouse: pyqtgraph's part ----------------------------------------------------------

    def wheelEvent(self, event: QGraphicsSceneWheelEvent, axis: int | None = None) -> None:
        """Set the falloff during a gesture, else zoom or pan; `axis` is under the pointer."""
        event.accept()
        self.updateMatrix()
        notches = event.delta() / _NOTCH
        sideways = event.orientation() == Qt.Orientation.Horizontal
        pointer = _pointer_of(event)
        means = wheel_action(self._mouse.takes_wheel, pointer.fine or sideways, pointer.snap)
        if means is WheelAction.FALLOFF:
            self._mouse.turned(pointer, notches)
        elif axis == _VALUES or (means is WheelAction.ZOOM_VALUES and self._has_values):
            super().wheelEvent(event, _VALUES)
        elif means is WheelAction.PAN:
            (first, last), _ = self.viewRange()
            self.translateBy(x=-notches * PAN_STEP * (last - first))
            self.sigRangeChangedManually.emit([True, False])
        else:
            super().wheelEvent(event, _TIME)

    def mouseDragEvent(
        self, event: pg.GraphicsScene.mouseEvents.MouseDragEvent, axis: int | None = None
    ) -> None:
        """The middle button pans time; the right one zooms along its first direction."""
        if event.isStart():
            way = event.pos() - event.buttonDownPos()
            upwards = event.button() == RIGHT and abs(way.y()) > abs(way.x())
            self._axis = _VALUES if upwards and self._has_values else _TIME
        self._axis = self._axis if axis is None else axis
        self.setMouseEnabled(x=self._axis == _TIME, y=self._axis == _VALUES)
        super().mouseDragEvent(event, self._axis)
        self.setMouseEnabled(x=True, y=self._has_values)

    def mouseClickEvent(self, event: pg.GraphicsScene.mouseEvents.MouseClickEvent) -> None:
        """A right click asks for the menu."""
        if event.button() == RIGHT:
            event.accept()
            place = event.screenPos().toPoint()
            self.menu_asked.emit(event.pos().x(), event.pos().y(), place)


def _pointer_of(
    event: QGraphicsSceneMouseEvent | QGraphicsSceneHoverEvent | QGraphicsSceneWheelEvent,
) -> Pointer:
    """The event's position and keys."""
    return _pointer(event.pos(), event.modifiers())


def _pointer(at: QPointF, keys: Qt.KeyboardModifier) -> Pointer:
    key = Qt.KeyboardModifier
    shift, ctrl = bool(keys & key.ShiftModifier), bool(keys & key.ControlModifier)
    # Many window managers take Alt with the mouse; Shift and Ctrl together do the same.
    both = shift and ctrl
    return Pointer(
        at.x(),
        at.y(),
        fine=shift and not both,
        snap=ctrl and not both,
        one_side=both or bool(keys & key.AltModifier),
    )
