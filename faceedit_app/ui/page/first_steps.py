"""The first steps, shown over the window once: its main parts and what they are for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from PySide6.QtCore import QEvent, QObject, QPoint, QRect, QRectF, Qt, Signal
from PySide6.QtGui import (
    QColor,
    QKeyEvent,
    QMouseEvent,
    QPainter,
    QPainterPath,
    QPaintEvent,
    QPen,
    QRegion,
)
from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractSlider,
    QAbstractSpinBox,
    QComboBox,
    QFrame,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QTabBar,
    QVBoxLayout,
    QWidget,
)

from faceedit_app.core.arrays import Doubles
from faceedit_app.ui.look.guard import guarded
from faceedit_app.ui.look.palette import ACCENT
from faceedit_app.ui.look.theme import GAP

_SHADE = 150  # of 255: how dark the rest of the window becomes
_WIDTH = 380
_APART = 14  # pixels between the card and its target
_CHANGES = QEvent.Type.Resize, QEvent.Type.Move, QEvent.Type.Show, QEvent.Type.Hide
_STEP = 8  # pixels between two places that are tried for the card
CLICKED = QAbstractButton | QAbstractSpinBox | QAbstractSlider | QComboBox | QTabBar


@dataclass(frozen=True)
class Card:
    """One card.

    Attributes:
        title, text: its heading and body.
        targets: the widgets that it explains, which can be used meanwhile; hidden ones do not
            count.
        shown: widgets in which people see what that does: they are not darkened either.
    """

    title: str
    text: str
    targets: tuple[QWidget, ...]
    shown: tuple[QWidget, ...] = ()


def _stops(first: int, last: int) -> Doubles:
    """Places from the first to the last, in pixels; only the first if the last lies before it."""
    steps: Doubles = np.append(np.arange(first, last, _STEP), max(first, last)).astype(np.float64)
    return steps


class HintLayer(QWidget):
    """Darkens all but the targets of a step, and explains them.

    Signals:
        began(): the first step is shown.
        closed(): the last step was read, or the rest was skipped.
    """

    began = Signal()
    closed = Signal()

    def __init__(self, parent: QWidget, steps: Sequence[Card]) -> None:
        super().__init__(parent)
        self._steps, self.step = tuple(steps), 0
        self.setObjectName("hints")
        self.setAccessibleName("First steps")
        self.card = QFrame(self)
        self.card.setObjectName("hint")
        self.card.setFixedWidth(_WIDTH)
        self.title, self.text, self._count = QLabel(), QLabel(), QLabel()
        self.title.setObjectName("hint_title")
        self.text.setWordWrap(True)
        self._count.setObjectName("caption")
        self.next_button, self.skip_button = QPushButton("Next"), QPushButton("Skip")
        self.next_button.setObjectName("primary")
        self.skip_button.setObjectName("secondary")
        self.next_button.clicked.connect(self.forward)
        self.skip_button.clicked.connect(self.finish)
        for button in (self.next_button, self.skip_button):
            button.setAutoDefault(True)  # Enter presses it; Space belongs to the transport
        row = QHBoxLayout()
        row.addWidget(self._count)
        row.addStretch()
        row.addWidget(self.skip_button)
        row.addWidget(self.next_button)
        column = QVBoxLayout(self.card)
        column.setContentsMargins(18, 16, 18, 14)
        column.setSpacing(GAP)
        column.addWidget(self.title)
        column.addWidget(self.text)
        column.addSpacing(GAP // 2)
        column.addLayout(row)
        lit = (part for step in self._steps for part in (*step.targets, *step.shown))
        for watched in {parent, *lit}:
            watched.installEventFilter(self)
        self.hide()

    def begin(self) -> None:
        """Show the first step."""
        self.step = 0
        self.setGeometry(self._parent.rect())
        self.show()
        self.raise_()
        self._show_step()
        self.next_button.setFocus()
        self.began.emit()

    @property
    def _parent(self) -> QWidget:
        parent = self.parentWidget()
        assert parent is not None
        return parent

    def forward(self) -> None:
        """Go to the next step, or close after the last."""
        if self.step + 1 < len(self._steps):
            self.step += 1
            self._show_step()
        else:
            self.finish()

    def use(self) -> None:
        """What a step explains has been used: go to the next one, but leave the last to be read."""
        if self.isVisible() and self.step + 1 < len(self._steps):
            self.forward()
            self.next_button.setFocus()  # for those who go on by keyboard

    def finish(self) -> bool:
        """Close; False if it is not shown."""
        if self.isHidden():
            return False
        self.hide()
        self.closed.emit()
        return True

    def _show_step(self) -> None:
        step = self._steps[self.step]
        self.title.setText(step.title)
        self.text.setText(step.text)
        self.setAccessibleDescription(f"{step.title}. {step.text}")
        self._count.setText(f"{self.step + 1} of {len(self._steps)} · Esc: end the tour")
        is_last = self.step + 1 == len(self._steps)
        self.next_button.setText("Start editing" if is_last else "Next")
        self.skip_button.setVisible(not is_last)
        self.card.adjustSize()
        hole, shown = self._hole(), self._shown()
        self.card.move(self._place(hole, shown))
        # Without this the layer would take the mouse from what the card tells people to use.
        lit = QRegion(hole) + QRegion(shown)
        self.setMask(QRegion(self.rect()) - lit + QRegion(self.card.geometry()))
        self.update()

    def _hole(self) -> QRect:
        """The part of the window that the step explains."""
        return self._around(self._steps[self.step].targets)

    def _shown(self) -> QRect:
        """The part of the window in which people see what they do."""
        return self._around(self._steps[self.step].shown)

    def _around(self, parts: Sequence[QWidget]) -> QRect:
        around = QRect()
        for part in parts:
            if part.isVisible():
                place = part.mapTo(self._parent, QPoint(0, 0))
                around = around.united(QRect(place, part.size()))
        return around.intersected(self.rect())

    def _place(self, hole: QRect, shown: QRect) -> QPoint:
        """Near the hole, where the card covers nothing that can be clicked, nor what is explained.

        Where that cannot be had, it covers as little of it as can be.
        """
        card, room = self.card.size(), self.rect().adjusted(8, 8, -8, -8)
        last = room.right() + 1 - card.width(), room.bottom() + 1 - card.height()
        x, y = np.meshgrid(_stops(room.left(), last[0]), _stops(room.top(), last[1]))
        left, top = x.ravel(), y.ravel()

        def covered(part: QRect) -> Doubles:
            wide = np.minimum(left + card.width(), part.right() + 1) - np.maximum(left, part.left())
            high = np.minimum(top + card.height(), part.bottom() + 1) - np.maximum(top, part.top())
            area: Doubles = np.maximum(wide, 0) * np.maximum(high, 0) / 1.0
            return area

        beyond_x = np.maximum(hole.left() - left - card.width(), left - hole.right() - 1)
        beyond_y = np.maximum(hole.top() - top - card.height(), top - hole.bottom() - 1)
        apart = np.hypot(np.maximum(beyond_x, 0), np.maximum(beyond_y, 0))
        aside = np.hypot(left + card.width() / 2 - hole.center().x(), 0.1 * (top - hole.top()))
        cost = np.abs(apart - _APART) + 0.1 * aside
        for part in (hole, shown):
            cost = cost + 0.5 * covered(part)
        for part in self._clickable():
            cost = cost + 5.0 * covered(part)
        best = int(cost.argmin())
        return QPoint(int(left[best]), int(top[best]))

    def _clickable(self) -> list[QRect]:
        """The places of buttons, fields, sliders and tabs."""
        return [
            QRect(part.mapTo(self._parent, QPoint(0, 0)), part.size())
            for part in self._parent.findChildren(QWidget)
            if isinstance(part, CLICKED)
            and part.isVisible()
            and part.isEnabled()
            and not self.isAncestorOf(part)
        ]

    # --- events ------------------------------------------------------------------------------

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Keep the size of the window, and the hole where the targets are."""
        if event.type() in _CHANGES and self.isVisible():
            self.setGeometry(self._parent.rect())
            self._show_step()
        return False

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """A click beside what is explained goes to the next step."""
        self.forward()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Esc ends the tour."""
        if event.key() == Qt.Key.Key_Escape:
            self.finish()

    @guarded
    def paintEvent(self, _event: QPaintEvent) -> None:
        """Darken all but the hole and what is shown."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        hole = QRectF(self._hole()).adjusted(-3, -3, 3, 3)
        shade, inner, shown = QPainterPath(), QPainterPath(), QPainterPath()
        shade.addRect(QRectF(self.rect()))
        inner.addRoundedRect(hole, 6, 6)
        shown.addRect(QRectF(self._shown()))
        painter.fillPath(shade.subtracted(inner).subtracted(shown), QColor(0, 0, 0, _SHADE))
        painter.setPen(QPen(QColor(ACCENT), 2))
        painter.drawPath(inner)
