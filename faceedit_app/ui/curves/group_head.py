"""The head of the group of optional curves: a click shows them or folds them away."""

from __future__ import annotations

from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QFontMetricsF, QKeyEvent, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QAbstractButton, QSizePolicy, QWidget

from faceedit_app.core.regions import OPTIONAL_LABEL
from faceedit_app.ui.curves import style
from faceedit_app.ui.look.guard import guarded
from faceedit_app.ui.look.widgets import ENTER

HINT = "Curves that few takes need. Click to show them or fold them away."
EDITED = "edited"
_HEIGHT = 22  # pixels
_ARROW, _ARROW_LEFT, _TEXT_LEFT, _SPACE = 3.5, 14.0, 26.0, 10.0  # pixels


class GroupHead(QAbstractButton):
    """A button as wide as the curves; checked while its group is unfolded."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.note = ""
        self.setCheckable(True)
        self.setObjectName("optional_curves")
        self.setText(OPTIONAL_LABEL)
        self.setAccessibleName(OPTIONAL_LABEL)
        self.setAccessibleDescription(HINT)
        self.setFixedHeight(_HEIGHT)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.setCursor(Qt.CursorShape.PointingHandCursor)
        self.show_missing("")

    def show_missing(self, why: str) -> None:
        """Disable the group and show why, or enable it if `why` is empty."""
        self.setEnabled(not why)
        self.setToolTip(why or HINT)

    def show_note(self, note: str) -> None:
        """Show a note beside the name, such as that these curves have edits."""
        if note != self.note:
            self.note = note
            self.update()

    def sizeHint(self) -> QSize:
        """Any width."""
        return QSize(0, _HEIGHT)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Enter clicks, since Space always plays."""
        if event.key() in ENTER:
            self.click()
        else:
            event.ignore()

    @guarded
    def paintEvent(self, _event: QPaintEvent) -> None:
        """Paint arrow, name and note."""
        lit = self.isEnabled() and (self.underMouse() or self.hasFocus())
        with QPainter(self) as painter:
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            painter.fillRect(self.rect(), style.color(style.PLOT_ACTIVE if lit else style.PLOT))
            painter.setPen(QPen(style.color(style.LABEL), 1.5))
            middle, x, a = 0.5 * self.height(), _ARROW_LEFT, _ARROW
            corners = (
                [(x - a, middle - 0.5 * a), (x, middle + 0.5 * a), (x + a, middle - 0.5 * a)]
                if self.isChecked()
                else [(x - 0.5 * a, middle - a), (x + 0.5 * a, middle), (x - 0.5 * a, middle + a)]
            )
            painter.drawPolyline([QPointF(*corner) for corner in corners])
            font = style.scaled_font(self, 0.92)
            painter.setFont(font)
            painter.setPen(style.color(style.TEXT if lit else style.LABEL))
            wide = QFontMetricsF(font).horizontalAdvance(OPTIONAL_LABEL)
            room = QRectF(_TEXT_LEFT, 0.0, self.width() - _TEXT_LEFT, self.height())
            align = int(Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter)
            painter.drawText(room, align, OPTIONAL_LABEL)
            painter.setPen(style.color(style.MUTED))
            painter.drawText(room.adjusted(wide + _SPACE, 0.0, 0.0, 0.0), align, self.note)
            if self.hasFocus():
                painter.setPen(style.hairline(style.FOCUS))
                painter.setBrush(Qt.BrushStyle.NoBrush)
                painter.drawRect(QRectF(self.rect()).adjusted(0.5, 0.5, -0.5, -0.5))
