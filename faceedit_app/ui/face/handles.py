"""Handles on the face: drag a mouth corner, a lip or a lid, and its curve follows."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from PySide6.QtCore import QEvent, QObject, QPointF, QSize, Qt
from PySide6.QtGui import QColor, QMouseEvent, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QWidget

from faceedit_app.core.arrays import Doubles
from faceedit_app.core.controls import CONTROL_INDEX, CONTROLS, LIP_OPENING, control_named
from faceedit_app.core.rig import Rig
from faceedit_app.ui.face.viewport import Viewport
from faceedit_app.ui.look.guard import guarded
from faceedit_app.ui.look.palette import BACKGROUND, TEXT

# The control point of each control that is its handle.
POINTS = {c.id: c.handle for c in CONTROLS if c.handle is not None}
GRASP = 11.0  # pixels around a handle
_SLOP = 3.0  # pixels that the pointer may move before a drag begins
_FINE = 0.1  # with Shift
_SIZE = 4.5  # pixels
_PROBE = 1.0  # mm, to find out which way a handle goes
_FAR_PROBE = 8.0  # mm, past lips that are shut
_LEAST = 0.3  # pixels per mm: less cannot be dragged


class Hand(Protocol):
    """Makes the edit of a drag on the face: the same as one on the plot."""

    @property
    def is_held(self) -> bool:
        """Whether a gesture is in progress."""

    def grab(self, control: str, one_side: bool) -> bool:
        """Take a control at the frame on screen; False if it cannot be edited."""

    def probe(self, millimetres: float) -> None:
        """Preview a move, to see which way the face goes."""

    def end_probe(self) -> None:
        """End the preview."""

    def pull(self, millimetres: float, snap: bool) -> None:
        """Move by this much since the grab."""

    def let_go(self) -> None:
        """Keep the edit."""

    def cancel(self) -> None:
        """Let go without an edit."""


class FaceHandles(QWidget):
    """Shows the handles while the pointer is on the face, and drags them.

    It lies on the viewport and looks at its mouse events first: what is not for a handle moves the
    camera.
    """

    def __init__(self, viewport: Viewport) -> None:
        super().__init__(viewport)
        self._viewport = viewport
        self.hand: Hand | None = None
        self.is_wanted = True  # the edited face is shown
        self._rig: Rig | None = None
        self._over: str | None = None  # control of the handle under the pointer
        self._is_near = False  # the pointer is on the face
        self._held: str | None = None
        self._from = self._last = QPointF()
        self._way: Doubles | None = None  # (2,) pixels per mm, once the drag has begun
        self._pulled = 0.0  # mm
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        viewport.installEventFilter(self)
        viewport.drawn.connect(self._follow)
        self.hide()

    def use_rig(self, rig: Rig) -> None:
        """Show the handles of a character."""
        self._rig = rig

    @property
    def places(self) -> dict[str, QPointF]:
        """Where each handle is, in pixels of the viewport, by control."""
        if self._rig is None or not self._viewport.can_draw or not self.is_wanted:
            return {}
        pairs = self._rig.control_pairs
        names = [name for name in POINTS if pairs[CONTROL_INDEX[name]].min() >= 0]
        seen = self._viewport.project([self._vertex(name) for name in names])
        if seen is None:
            return {}
        return {name: QPointF(x, y) for name, (x, y, _) in zip(names, seen.tolist(), strict=True)}

    def _vertex(self, control: str) -> int:
        assert self._rig is not None
        return int(self._rig.control_pairs[CONTROL_INDEX[control], POINTS[control]])

    def handle_at(self, place: QPointF) -> str | None:
        """The control whose handle is under a pixel."""
        near = {
            name: float(np.hypot(at.x() - place.x(), at.y() - place.y()))
            for name, at in self.places.items()
        }
        nearest = min(near, key=lambda name: near[name], default=None)
        return nearest if nearest is not None and near[nearest] <= GRASP else None

    # --- the mouse -----------------------------------------------------------------------------

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Take the events that are for a handle."""
        match event.type():
            case QEvent.Type.Resize:
                self.resize(self._viewport.size())
            case QEvent.Type.Leave:
                self._hover(None, False)
            case _ if isinstance(event, QMouseEvent) and self.hand is not None:
                return self._mouse(event, self.hand)
        return False

    def _mouse(self, event: QMouseEvent, hand: Hand) -> bool:
        at, left = event.position(), Qt.MouseButton.LeftButton
        if self._held is not None and not hand.is_held:
            self._drop()  # Esc cancelled it, or the release was lost
        match event.type():
            case QEvent.Type.MouseButtonPress if event.button() == left:
                return self._press(at, event.modifiers(), hand)
            case QEvent.Type.MouseMove if self._held is not None:
                self._drag(at, event.modifiers(), hand)
                return True
            case QEvent.Type.MouseMove if not event.buttons():
                self._viewport.mouse_lost()
                self._hover(self.handle_at(at), True)
                return self._over is not None
            case QEvent.Type.MouseButtonRelease if self._held is not None:
                self._drop()
                hand.let_go()
                self._hover(self.handle_at(at), True)
                return True
            case QEvent.Type.MouseButtonDblClick:
                return self.handle_at(at) is not None
        return False

    def _press(self, at: QPointF, keys: Qt.KeyboardModifier, hand: Hand) -> bool:
        control = self.handle_at(at)
        one_side = _holds(keys, Qt.KeyboardModifier.AltModifier) or (_shift(keys) and _ctrl(keys))
        if control is None or not hand.grab(control, one_side):
            return False
        self._held, self._from, self._last = control, at, at
        self._way, self._pulled = None, 0.0
        return True

    def _drag(self, at: QPointF, keys: Qt.KeyboardModifier, hand: Hand) -> None:
        if self._way is None:
            moved = at - self._from
            if np.hypot(moved.x(), moved.y()) <= _SLOP:
                return
            assert self._held is not None
            is_down = abs(moved.y()) > abs(moved.x())
            if is_down and control_named(self._held).sideways:  # a chin pulled down opens the mouth
                hand.cancel()
                self._held = LIP_OPENING
                if not hand.grab(LIP_OPENING, False):
                    self._drop()
                    return
            self._way = self._find_way(hand)
        step = at - self._last
        self._last = at
        along = float(self._way @ (step.x(), step.y()) / (self._way @ self._way))
        both = _shift(keys) and _ctrl(keys)
        self._pulled += along * (_FINE if _shift(keys) and not both else 1.0)
        hand.pull(self._pulled, _ctrl(keys) and not both)

    def _find_way(self, hand: Hand) -> Doubles:
        """(2,) pixels that the held handle moves per millimetre of its control."""
        assert self._held is not None
        way = self._moved(hand, _PROBE)
        if self._held == LIP_OPENING:
            # Shut lips close on the user's character first, which can move them the other way.
            far = self._moved(hand, _FAR_PROBE)
            way = far if way @ far <= 0 else way
        if np.hypot(*way) >= _LEAST:
            return way
        if control_named(self._held).sideways:
            return np.array([1.0, 0.0])
        return np.array([0.0, 1.0 if self._held == LIP_OPENING else -1.0])

    def _moved(self, hand: Hand, millimetres: float) -> Doubles:
        """(2,) pixels per millimetre that a pull of this much moves the held handle."""
        assert self._held is not None
        vertex = [self._vertex(self._held)]
        before = self._viewport.project(vertex)
        hand.probe(millimetres)
        after = self._viewport.project(vertex)
        hand.end_probe()
        if before is None or after is None:
            return np.zeros(2)
        way: Doubles = (after - before)[0, :2] / millimetres
        return way

    def _drop(self) -> None:
        self._held, self._way = None, None

    def _hover(self, control: str | None, is_near: bool) -> None:
        if control is not None:
            self._viewport.setCursor(Qt.CursorShape.OpenHandCursor)
        if (control, is_near) == (self._over, self._is_near):
            return
        self._over, self._is_near = control, is_near
        self.setVisible(is_near and bool(self.places))
        if control is not None:
            self._viewport.setToolTip(f"{control_named(control).label}: drag to change it")
        else:
            self._viewport.unsetCursor()
            self._viewport.setToolTip("")
        self.update()

    def _follow(self) -> None:
        """The face was drawn: its handles have moved."""
        if self.isVisible():
            self.update()

    # --- painting ------------------------------------------------------------------------------

    @guarded
    def paintEvent(self, _event: QPaintEvent) -> None:
        """Paint a ring for each handle, filled under the pointer."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        colors = {control.id: control.color for control in CONTROLS}
        for name, place in self.places.items():
            lit = name in (self._held, self._over)
            painter.setPen(QPen(QColor(BACKGROUND), 3.0))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawEllipse(place, _SIZE, _SIZE)
            painter.setPen(QPen(QColor(TEXT if lit else colors[name]), 1.6))
            if lit:
                painter.setBrush(QColor(colors[name]))
            painter.drawEllipse(place, _SIZE, _SIZE)

    def sizeHint(self) -> QSize:
        """As large as the viewport."""
        return self._viewport.size()


def _holds(keys: Qt.KeyboardModifier, key: Qt.KeyboardModifier) -> bool:
    return bool(keys & key)


def _shift(keys: Qt.KeyboardModifier) -> bool:
    return _holds(keys, Qt.KeyboardModifier.ShiftModifier)


def _ctrl(keys: Qt.KeyboardModifier) -> bool:
    return _holds(keys, Qt.KeyboardModifier.ControlModifier)
