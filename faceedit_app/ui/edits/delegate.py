"""Draws the rows of the list of edits."""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum

from PySide6.QtCore import (
    QAbstractItemModel,
    QEvent,
    QPointF,
    QRect,
    QRectF,
    QSize,
    Qt,
)
from PySide6.QtGui import QColor, QFontMetrics, QMouseEvent, QPainter, QPainterPath, QPen, QPolygonF
from PySide6.QtWidgets import (
    QLineEdit,
    QStyle,
    QStyleOptionViewItem,
    QWidget,
)

from faceedit_app.ui.edits.model import COLUMNS, GROUP, RANGE, STRENGTH, EditsModel
from faceedit_app.ui.look.guard import guarded, saved
from faceedit_app.ui.look.model_index import Index
from faceedit_app.ui.look.number import NumberBox, NumberDelegate
from faceedit_app.ui.look.palette import (
    ACCENT,
    ACCENT_DEEP,
    BACKGROUND,
    BORDER,
    DISABLED,
    LABEL,
    MUTED,
    RAISED,
    TEXT,
)
from faceedit_app.ui.look.refused import show_refused

STRONGEST = 150  # per cent
ROW = 25
_BOX = 14.0
_LEFT = 32.0  # pixels left of the name
_ARROW = 14.0  # of a group
_RIGHT = 8.0
_STRENGTH = 50.0
_RANGE = 122.0  # at least: as long as two times below 100 s
_LEAST_NAME = 96.0  # beside a wider range
_NARROW = 470  # pixels below which the curves' names would leave the edit's no room


class RowField(Enum):
    """What can be typed in a row."""

    NAME = "name"
    RANGE = "range"
    STRENGTH = "strength"


class _RangeField(QLineEdit):
    """A field for the range of an edit.

    Args:
        read: the range that a text means, seconds; raises ValueError with the reason.
    """

    def __init__(self, parent: QWidget, read: Callable[[str], tuple[float, float]]) -> None:
        super().__init__(parent)
        self._read = read
        self.setAccessibleName("Range")
        self.textEdited.connect(lambda: show_refused(self, ""))

    @property
    def range(self) -> tuple[float, float]:
        """The range that was typed, seconds.

        Raises:
            ValueError: it is none.
        """
        return self._read(self.text())

    def refuses(self) -> bool:
        """Whether what is typed cannot be taken; the reason is shown then."""
        try:
            self._read(self.text())
        except ValueError as error:
            show_refused(self, str(error))
            self.selectAll()
            return True
        return False


class EditsDelegate(NumberDelegate):
    """Paints rows, and handles clicks on their switches.

    Attributes:
        edits: the part of a row that is edited next.
    """

    edits = RowField.NAME

    def sizeHint(self, option: QStyleOptionViewItem, index: Index) -> QSize:
        """One line."""
        return QSize(200, ROW)

    @guarded
    def paint(self, painter: QPainter, option: QStyleOptionViewItem, index: Index) -> None:
        """Paint switch, name, curves, range and strength."""
        with saved(painter):
            self._paint_row(painter, option, index)

    def _paint_row(self, painter: QPainter, option: QStyleOptionViewItem, index: Index) -> None:
        edit = index.data(Qt.ItemDataRole.UserRole)
        rect, state = QRectF(option.rect), option.state
        if state & QStyle.StateFlag.State_Selected:
            painter.fillRect(rect, QColor(ACCENT_DEEP))
        elif state & QStyle.StateFlag.State_MouseOver:
            painter.fillRect(rect, QColor(RAISED))
        # Rows that end between two pixels of the screen would leave a line behind.
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        if state & QStyle.StateFlag.State_HasFocus:
            painter.setPen(QPen(QColor(ACCENT), 1))
            painter.drawRect(rect.adjusted(0.5, 0.5, -0.5, -0.5))
        self._paint_switch(painter, switch_rect(rect), edit.enabled)
        selected = bool(state & QStyle.StateFlag.State_Selected)
        hovered = bool(state & QStyle.StateFlag.State_MouseOver)
        off = MUTED if hovered else DISABLED
        if selected:
            off = LABEL
        quiet = QColor(off) if not edit.enabled else QColor(TEXT if selected else MUTED)
        name, group = str(index.data(Qt.ItemDataRole.DisplayRole)), index.data(GROUP)
        if group is not None and group[0]:
            name = f"{name}  ({group[0]})"
        columns = index.data(COLUMNS)
        ranged = range_width(rect, option.fontMetrics, columns[0])
        indent = _ARROW if group is not None else 0.0
        (text, room), *others = cells(
            rect, name, *columns, ranged=ranged, indent=indent, metrics=option.fontMetrics
        )
        painter.setPen(QColor(TEXT if edit.enabled else off))
        if group is not None and group[0]:
            self._paint_arrow(painter, arrow_rect(rect), group[1])
        self._write(painter, room, text, Qt.AlignmentFlag.AlignLeft)
        painter.setPen(quiet)
        for text, room in others:
            last = room.right() >= rect.right() - _RIGHT
            align = Qt.AlignmentFlag.AlignRight if last else Qt.AlignmentFlag.AlignLeft
            self._write(painter, room, text, align)

    @staticmethod
    def _paint_arrow(painter: QPainter, box: QRectF, is_open: bool) -> None:
        """Paint a triangle that points at what it opens."""
        x, y = box.center().x(), box.center().y()
        downwards = ((-3.5, -2.0), (3.5, -2.0), (0.0, 3.0))
        corners = [
            QPointF(x + across, y + down) if is_open else QPointF(x + down, y + across)
            for across, down in downwards
        ]
        with saved(painter):
            painter.setBrush(painter.pen().color())
            painter.setPen(Qt.PenStyle.NoPen)
            painter.drawPolygon(QPolygonF(corners))

    @staticmethod
    def _write(painter: QPainter, room: QRectF, text: str, align: Qt.AlignmentFlag) -> None:
        metrics = painter.fontMetrics()
        shown = metrics.elidedText(text, Qt.TextElideMode.ElideRight, int(room.width()))
        painter.drawText(room, align | Qt.AlignmentFlag.AlignVCenter, shown)

    @staticmethod
    def _paint_switch(painter: QPainter, box: QRectF, on: bool) -> None:
        painter.setPen(QPen(QColor(ACCENT if on else BORDER), 1.2))
        painter.setBrush(QColor(ACCENT if on else BACKGROUND))
        painter.drawRoundedRect(box, 3, 3)
        if on:
            tick = QPainterPath(QPointF(box.x() + 3, box.center().y()))
            tick.lineTo(box.x() + 5.8, box.bottom() - 3.8)
            tick.lineTo(box.right() - 2.8, box.y() + 4)
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.setPen(QPen(QColor(BACKGROUND), 1.8))
            painter.drawPath(tick)

    def editorEvent(
        self,
        event: QEvent,
        model: QAbstractItemModel,
        option: QStyleOptionViewItem,
        index: Index,
    ) -> bool:
        """A click on the switch toggles it; a double click edits what it is on.

        A click on the arrow opens or closes a group.
        """
        group = index.data(GROUP)
        if (
            isinstance(event, QMouseEvent)
            and isinstance(model, EditsModel)
            and group is not None
            and group[0]
            and arrow_rect(QRectF(option.rect)).contains(event.position())
        ):
            if event.type() == QEvent.Type.MouseButtonRelease:
                model.toggle_group(index.row())
            return event.type() != QEvent.Type.MouseButtonPress
        if isinstance(event, QMouseEvent) and event.type() == QEvent.Type.MouseButtonDblClick:
            row = QRectF(option.rect)
            ranged = range_width(row, option.fontMetrics, index.data(COLUMNS)[0])
            self.edits = self._part_at(row, event.position().x(), ranged)
        if (
            isinstance(event, QMouseEvent)
            and event.type() == QEvent.Type.MouseButtonRelease
            and switch_rect(QRectF(option.rect)).adjusted(-6, -6, 6, 6).contains(event.position())
        ):
            edit = index.data(Qt.ItemDataRole.UserRole)
            check = Qt.CheckState
            value = check.Unchecked if edit.enabled else check.Checked
            return bool(
                model.setData(model.index(index.row(), 0), value, Qt.ItemDataRole.CheckStateRole)
            )
        return False

    @staticmethod
    def _part_at(row: QRectF, x: float, ranged: float) -> RowField:
        from_right = row.right() - x
        if from_right <= _STRENGTH + _RIGHT:
            return RowField.STRENGTH
        return RowField.RANGE if from_right <= _STRENGTH + ranged + _RIGHT + 8 else RowField.NAME

    def createEditor(self, parent: QWidget, option: QStyleOptionViewItem, index: Index) -> QWidget:
        """A number field for the strength, a text field for name and range."""
        if self.edits is RowField.STRENGTH:
            box = NumberBox(parent)
            box.setDecimals(0)
            box.setMaximum(STRONGEST)
            box.setSuffix(" %")
            box.setAccessibleName("Strength")
            return box
        if self.edits is RowField.NAME:
            name = QLineEdit(parent)
            name.setAccessibleName("Name")
            return name
        model, edit = index.model(), index.data(Qt.ItemDataRole.UserRole)
        assert isinstance(model, EditsModel)
        return _RangeField(parent, lambda text: model.typed_range(text, edit))

    def refuses(self, editor: QWidget) -> bool:
        """Whether what is typed into a field cannot be taken; the reason is shown then."""
        return editor.refuses() if isinstance(editor, _RangeField) else super().refuses(editor)

    def setEditorData(self, editor: QWidget, index: Index) -> None:
        """Fill the field."""
        model, edit = index.model(), index.data(Qt.ItemDataRole.UserRole)
        if isinstance(editor, NumberBox):
            editor.setValue(round(100 * edit.strength))
        elif isinstance(editor, QLineEdit) and isinstance(model, EditsModel):
            is_range = self.edits is RowField.RANGE
            editor.setText(model.ends(edit) if is_range else index.data(Qt.ItemDataRole.EditRole))
            editor.selectAll()

    def setModelData(self, editor: QWidget, model: QAbstractItemModel, index: Index) -> None:
        """Take what was typed, unless it cannot be."""
        place = model.index(index.row(), 0)
        if self.refuses(editor):
            return
        edit = index.data(Qt.ItemDataRole.UserRole)
        if isinstance(editor, NumberBox):
            if editor.value() != round(100 * edit.strength):  # which may have more digits
                model.setData(place, editor.value() / 100, STRENGTH)
        elif isinstance(editor, _RangeField):
            typed = editor.range
            if typed != (edit.start, edit.end):
                model.setData(place, typed, RANGE)
        elif isinstance(editor, QLineEdit):
            model.setData(place, editor.text())

    def updateEditorGeometry(
        self, editor: QWidget, option: QStyleOptionViewItem, index: Index
    ) -> None:
        """Put the field over what it edits."""
        rect, right = QRect(option.rect), round(_STRENGTH + _RIGHT)
        if self.edits is RowField.STRENGTH:
            editor.setGeometry(rect.adjusted(rect.width() - right - 6, 0, 0, 0))
            return
        if self.edits is RowField.RANGE:
            when, model = index.data(COLUMNS)[0], index.model()
            ranged = range_width(QRectF(rect), option.fontMetrics, when)
            if isinstance(model, EditsModel):  # of one moment, both ends can be typed
                typed = model.ends(index.data(Qt.ItemDataRole.UserRole))
                ranged = max(ranged, option.fontMetrics.horizontalAdvance(typed) + 6.0)
            left = max(rect.width() - right - round(ranged) - 14, round(_LEFT))
            editor.setGeometry(rect.adjusted(left, 0, -right, 0))
            return
        editor.setGeometry(option.rect.adjusted(int(_LEFT) - 5, 0, -int(_STRENGTH), 0))


def range_width(row: QRectF, metrics: QFontMetrics, when: str) -> float:
    """Pixels of the column of a range: timecodes get more, as far as the name can spare them."""
    spare = row.width() - _LEFT - _LEAST_NAME - _STRENGTH - _RIGHT - 16.0
    return max(min(metrics.horizontalAdvance(when) + 2.0, spare), _RANGE)


def cells(
    row: QRectF,
    name: str,
    when: str,
    what: str,
    strength: str,
    *,
    ranged: float = _RANGE,
    indent: float = 0.0,
    metrics: QFontMetrics | None = None,
) -> list[tuple[str, QRectF]]:
    """The texts of a row and their places, the name first.

    A name that contains its curve also takes the column of the curve. A long one takes what the
    name of the curve leaves of it.

    Args:
        ranged: pixels of the column of the range.
        indent: pixels left of the name, in a group.
        metrics: of the texts; without, all columns are as wide as in other rows.
    """
    left, right = row.x() + _LEFT + indent, row.right() - _RIGHT
    out = []
    for text, width in ((strength, _STRENGTH), (when, ranged)):
        out.append((text, QRectF(right - width, row.y(), width, row.height())))
        right -= width + 8
    if row.width() >= _NARROW and what.lower() not in name.lower():
        width = max(0.26 * row.width(), 96.0)
        if metrics is not None:
            spare = right - left - 8 - metrics.horizontalAdvance(name) - 1.0
            width = min(width, max(spare, metrics.horizontalAdvance(what) + 1.0))
        out.append((what, QRectF(right - width, row.y(), width, row.height())))
        right -= width + 8
    return [(name, QRectF(left, row.y(), right - left, row.height())), *out]


def arrow_rect(row: QRectF) -> QRectF:
    """The place of the arrow of a group."""
    return QRectF(row.x() + _LEFT - 4, row.y(), _ARROW + 2, row.height())


def switch_rect(row: QRectF) -> QRectF:
    """The place of a row's switch."""
    return QRectF(row.x() + 9, row.center().y() - _BOX / 2, _BOX, _BOX)
