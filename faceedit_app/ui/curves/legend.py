"""A row over the plots: a legend of the lines, and a hint on what the mouse would do now."""

from __future__ import annotations

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QFontMetricsF, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QWidget

from faceedit_app.core.controls import COLORS, CONTROLS
from faceedit_app.core.regions import OPTIONAL_REGIONS, REGIONS
from faceedit_app.core.texts import listed
from faceedit_app.ui.curves import style
from faceedit_app.ui.look.guard import guarded

_SAMPLE = 22.0  # pixels of line
_BESIDE = 6.0  # from a line to its words
_SPACE = 16.0
_LEFT = 12.0
_WORDS = "as tracked", "asked for", "the face", "your character"
_SHORT_WORDS = "tracked", "asked", "face", "yours"


def _explanation() -> str:
    """What the lines are, and which colour is which part of the face."""
    labels = {region.id: region.label.lower() for region in (*REGIONS, *OPTIONAL_REGIONS)}
    meanings = (
        f"{COLORS[color]} for {listed(labels[c.region] for c in CONTROLS if c.color == color)}"
        for color in dict.fromkeys(control.color for control in CONTROLS)
    )
    return (
        "Thin grey: the curve as tracked. Dashed white: what you asked for. "
        f"Solid: what the face does; {listed(meanings)}."
    )


class Legend(QWidget):
    """Explains the lines."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.hint = ""
        self._has_character = False
        self.setFixedHeight(style.LEGEND_HEIGHT)
        self.setToolTip(_explanation())
        self.setAccessibleName("Legend")
        self.setAccessibleDescription(_explanation())

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
        metrics = QFontMetricsF(font)
        samples = self._samples(metrics)
        x = _LEFT
        for pens, words in samples:
            x = self._sample(painter, x, pens, words)
        room = QRectF(x, 0, self.width() - x - style.RIGHT_MARGIN, self.height())
        hint = metrics.elidedText(self.hint, Qt.TextElideMode.ElideRight, max(room.width(), 0))
        painter.setPen(style.color(style.MUTED))
        flags = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
        painter.drawText(room, flags, hint)

    def _samples(self, metrics: QFontMetricsF) -> list[tuple[tuple[QPen, ...], str]]:
        """Pens and words of the lines: short words, or none, if the hint needs the room."""
        colors = dict.fromkeys(control.color for control in CONTROLS if not control.optional)
        pens = [
            (style.tracked_pen(),),
            (style.asked_pen(),),
            tuple(style.face_pen(color) for color in colors),
            (style.character_pen(),),
        ]
        shown = len(pens) if self._has_character else len(pens) - 1
        free = self.width() - _LEFT - style.RIGHT_MARGIN - metrics.horizontalAdvance(self.hint)
        for words in (_WORDS, _SHORT_WORDS):
            used = sum(_advance(metrics, text) for text in words[:shown])
            if used <= free:
                return list(zip(pens, words[:shown], strict=False))
        return []

    def _sample(self, painter: QPainter, x: float, pens: tuple[QPen, ...], words: str) -> float:
        """Paint one line and its label; returns where the next one starts."""
        middle = 0.5 * self.height()
        for i, pen in enumerate(pens):
            painter.setPen(style.in_dots(pen, self.devicePixelRatioF()))
            start, stop = (x + _SAMPLE * (i + k) / len(pens) for k in (0, 1))
            painter.drawLine(QPointF(start, middle), QPointF(stop, middle))
        stop = x + _advance(QFontMetricsF(painter.font()), words)
        painter.setPen(style.color(style.TEXT))
        box = QRectF(x + _SAMPLE + _BESIDE, 0, stop - x, self.height())
        painter.drawText(box, Qt.AlignmentFlag.AlignVCenter, words)
        return stop


def _advance(metrics: QFontMetricsF, words: str) -> float:
    """Pixels from the start of a line's sample to that of the next one."""
    return _SAMPLE + _BESIDE + metrics.horizontalAdvance(words) + 2 + _SPACE
