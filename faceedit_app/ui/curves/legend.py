"""A row over the plots: a legend of the lines, and a hint on what the mouse would do now."""

from __future__ import annotations

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QFontMetricsF, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QWidget

from faceedit_app.core.controls import CONTROLS
from faceedit_app.ui.curves import style
from faceedit_app.ui.look.guard import guarded

_SAMPLE = 22.0  # pixels of line
_SPACE = 16.0
_EXPLANATION = (
    "Thin grey: the curve as tracked. Dashed white: what you asked for. "
    "Solid: what the face does; blue is the lower face, orange the eyelids, purple brows and jaw."
)


class Legend(QWidget):
    """Explains the lines."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.hint = ""
        self._has_character = False
        self.setFixedHeight(style.LEGEND_HEIGHT)
        self.setToolTip(_EXPLANATION)
        self.setAccessibleName("Legend")
        self.setAccessibleDescription(_EXPLANATION)

    def show_hint(self, hint: str) -> None:
        """Show what the mouse would do."""
        if hint != self.hint:
            self.hint = hint
            self.update()

    def show_character(self, shown: bool) -> None:
        """Explain the line of the user's character, or not."""
        self._has_character = shown
        self.update()

    @guarded
    def paintEvent(self, _event: QPaintEvent) -> None:
        """Paint samples with labels, then the hint in the remaining room."""
        painter = QPainter(self)
        painter.fillRect(self.rect(), style.color(style.BACKGROUND))
        painter.setRenderHint(QPainter.RenderHint.Antialiasing, True)
        font = style.scaled_font(self, 0.9)
        painter.setFont(font)
        colors = dict.fromkeys(control.color for control in CONTROLS if not control.optional)
        faces = tuple(style.face_pen(color) for color in colors)
        x = 12.0
        x = self._sample(painter, x, (style.tracked_pen(),), "as tracked")
        x = self._sample(painter, x, (style.asked_pen(),), "asked for")
        x = self._sample(painter, x, faces, "the face")
        if self._has_character:
            x = self._sample(painter, x, (style.character_pen(),), "your character")
        room = QRectF(x, 0, self.width() - x - style.RIGHT_MARGIN, self.height())
        hint = QFontMetricsF(font).elidedText(
            self.hint, Qt.TextElideMode.ElideRight, max(room.width(), 0)
        )
        painter.setPen(style.color(style.MUTED))
        flags = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
        painter.drawText(room, flags, hint)

    def _sample(self, painter: QPainter, x: float, pens: tuple[QPen, ...], words: str) -> float:
        """Paint one line and its label; returns where the next one starts."""
        middle = 0.5 * self.height()
        for i, pen in enumerate(pens):
            painter.setPen(pen)
            start, stop = (x + _SAMPLE * (i + k) / len(pens) for k in (0, 1))
            painter.drawLine(QPointF(start, middle), QPointF(stop, middle))
        width = QFontMetricsF(painter.font()).horizontalAdvance(words) + 2
        painter.setPen(style.color(style.TEXT))
        box = QRectF(x + _SAMPLE + 6, 0, width, self.height())
        painter.drawText(box, Qt.AlignmentFlag.AlignVCenter, words)
        return box.right() + _SPACE
