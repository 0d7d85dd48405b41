"""The whole take on a thin bar: its edits, the part in view, and the playhead."""

from __future__ import annotations

from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QMouseEvent, QPainter, QPaintEvent, QPen, QPixmap, QWheelEvent
from PySide6.QtWidgets import QWidget

from faceedit_app.core.controls import control_named
from faceedit_app.editing.edits.edit import Edit
from faceedit_app.ui.curves import style
from faceedit_app.ui.curves.gestures import zoom_factor
from faceedit_app.ui.look.guard import guarded
from faceedit_app.ui.state.document import Document
from faceedit_app.ui.state.timeline import Timeline

HEIGHT = 14
_LEAST = 3.0  # pixels of an edit
_GRASP = 5.0  # pixels around an end of the part in view
_TIP = (
    "The whole take with its edits; the frame is what the curves show.\n"
    "Drag it to move along the take, or an end of it to show more or less. Double-click: show all."
)


class Overview(QWidget):
    """Moves the view along the take; shows where the edits are, also those out of view."""

    def __init__(self, document: Document, timeline: Timeline) -> None:
        super().__init__()
        self._document, self._timeline = document, timeline
        self._held: tuple[str, float] | None = None  # part, and seconds from its start
        self._painted: tuple[object, QPixmap] | None = None  # see `picture`
        self.setFixedHeight(HEIGHT)
        self.setObjectName("overview")
        self.setAccessibleName("Overview of the take")
        self.setAccessibleDescription(_TIP)
        self.setToolTip(_TIP)
        self.setMouseTracking(True)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        for changed in (document.opened, document.changed, timeline.view_changed):
            changed.connect(self.update)
        timeline.playhead_moved.connect(self.update)

    def x_of(self, seconds: float) -> float:
        """The pixel of a time."""
        return seconds / max(self._timeline.duration, 1e-9) * self.width()

    def _time_at(self, x: float) -> float:
        return x / max(self.width(), 1) * self._timeline.duration

    def _part_at(self, x: float) -> str:
        """`start` or `end` of the part in view, or `view` for anywhere else."""
        first, last = (self.x_of(seconds) for seconds in self._timeline.view)
        if last - first > 4 * _GRASP:
            for part, at in (("start", first), ("end", last)):
                if abs(x - at) <= _GRASP:
                    return part
        return "view"

    # --- mouse -------------------------------------------------------------------------------

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Take the part in view; beside it, bring it there first."""
        if event.button() != Qt.MouseButton.LeftButton:
            return
        seconds, part = self._time_at(event.position().x()), self._part_at(event.position().x())
        first, last = self._timeline.view
        if part == "view" and not first <= seconds <= last:
            width = last - first
            self._timeline.show_range(seconds - width / 2, seconds + width / 2)
            first = self._timeline.view[0]
        self._held = part, seconds - first

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Move the part in view, or one of its ends."""
        x = event.position().x()
        if not event.buttons():
            self._held = None
        if self._held is None:
            sideways = self._part_at(x) != "view"
            self.setCursor(
                Qt.CursorShape.SizeHorCursor if sideways else Qt.CursorShape.OpenHandCursor
            )
            return
        part, offset = self._held
        seconds, (first, last) = self._time_at(x), self._timeline.view
        if part == "start":
            self._timeline.show_range(min(seconds, last), last)
        elif part == "end":
            self._timeline.show_range(first, max(seconds, first))
        else:
            self._timeline.show_range(seconds - offset, seconds - offset + last - first)

    def mouseReleaseEvent(self, _event: QMouseEvent) -> None:
        """Let go."""
        self._held = None

    def mouseDoubleClickEvent(self, _event: QMouseEvent) -> None:
        """Show the whole take."""
        self._timeline.show_range(0.0, self._timeline.duration)

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Zoom around the time under the pointer."""
        notches = event.angleDelta().y() / 120
        self._timeline.zoom(zoom_factor(notches), self._time_at(event.position().x()))
        event.accept()

    # --- painting ------------------------------------------------------------------------------

    @guarded
    def paintEvent(self, _event: QPaintEvent) -> None:
        """Paint edits, the part in view and the playhead."""
        painter = QPainter(self)
        painter.fillRect(self.rect(), style.color(style.BACKGROUND))
        session = self._document.session
        if session is None:
            return
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(style.color(style.GRID))
        painter.drawRoundedRect(QRectF(self.rect()), 3, 3)
        first, last = (self.x_of(seconds) for seconds in self._timeline.view)
        frame = QRectF(first + 0.5, 0.5, max(last - first - 1.0, 3.0), HEIGHT - 1.0)
        painter.setPen(QPen(style.color(style.MUTED), 1.0))
        painter.setBrush(style.color(style.GRID))
        painter.drawRoundedRect(frame, 3, 3)
        painter.drawPixmap(0, 0, self.picture(session.edits))
        x = round(self.x_of(self._timeline.time)) + 0.5
        painter.setPen(QPen(style.color(style.PLAYHEAD), 1.0))
        painter.drawLine(QPointF(x, 0), QPointF(x, HEIGHT))

    def picture(self, edits: tuple[Edit, ...]) -> QPixmap:
        """The edits; painted again when they or the bar change, but not as the playhead moves."""
        ratio = self.devicePixelRatioF()
        key = edits, self.size(), ratio, self._timeline.duration
        if self._painted is None or self._painted[0] != key:
            picture = QPixmap(self.size() * ratio)
            picture.setDevicePixelRatio(ratio)
            picture.fill(Qt.GlobalColor.transparent)
            with QPainter(picture) as painter:
                self._paint_edits(painter, edits)
            self._painted = key, picture
        return self._painted[1]

    def _paint_edits(self, painter: QPainter, edits: tuple[Edit, ...]) -> None:
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(Qt.PenStyle.NoPen)
        for edit in edits:
            color = style.TICK
            if edit.enabled:
                color = control_named(edit.controls[0]).color if edit.controls else style.MUTED
            left, right = (self.x_of(seconds) for seconds in edit.span)
            place = QRectF(left, 4.5, max(right - left, _LEAST), HEIGHT - 9.0)
            painter.setBrush(style.color(color, 150))
            painter.drawRoundedRect(place & QRectF(self.rect()), 2, 2)

    def sizeHint(self) -> QSize:
        """A thin bar."""
        return QSize(400, HEIGHT)
