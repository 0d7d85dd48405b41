"""How a row of the list of edits looks: switch, name, range, curves, strength."""

from __future__ import annotations

from PySide6.QtCore import (
    QAbstractItemModel,
    QEvent,
    QModelIndex,
    QPersistentModelIndex,
    QPointF,
    QRectF,
    QSize,
    Qt,
)
from PySide6.QtGui import QColor, QMouseEvent, QPainter, QPainterPath, QPen
from PySide6.QtWidgets import QStyle, QStyledItemDelegate, QStyleOptionViewItem, QWidget

from faceedit_app.ui.edits_model import columns
from faceedit_app.ui.palette import (
    ACCENT,
    ACCENT_DEEP,
    BACKGROUND,
    BORDER,
    FAINT,
    HOVER,
    MUTED,
    TEXT,
)

ROW = 25
_BOX = 14.0
_LEFT = 32.0  # where the name starts
_STRENGTH = 50.0
_RANGE = 116.0
_NARROW = 400  # pixels below which the curves' names are left out

Index = QModelIndex | QPersistentModelIndex


class EditsDelegate(QStyledItemDelegate):
    """Paints rows, and takes clicks on their switch."""

    def sizeHint(self, option: QStyleOptionViewItem, index: Index) -> QSize:
        """One line."""
        return QSize(200, ROW)

    def paint(self, painter: QPainter, option: QStyleOptionViewItem, index: Index) -> None:
        """Switch, name, range, curves, strength."""
        edit = index.data(Qt.ItemDataRole.UserRole)
        rect, state = QRectF(option.rect), option.state
        painter.save()
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        if state & QStyle.StateFlag.State_Selected:
            painter.fillRect(rect, QColor(ACCENT_DEEP))
        elif state & QStyle.StateFlag.State_MouseOver:
            painter.fillRect(rect, QColor(HOVER))
        if state & QStyle.StateFlag.State_HasFocus:
            painter.setPen(QPen(QColor(ACCENT), 1))
            painter.drawRect(rect.adjusted(0.5, 0.5, -0.5, -0.5))
        self._paint_switch(painter, switch_rect(rect), edit.enabled)
        selected = bool(state & QStyle.StateFlag.State_Selected)
        quiet = QColor(FAINT) if not edit.enabled else QColor(TEXT if selected else MUTED)
        when, what, strength = columns(edit)
        right = rect.right() - 8
        cells = [(strength, _STRENGTH, Qt.AlignmentFlag.AlignRight)]
        if rect.width() >= _NARROW:
            cells.append((what, max(0.26 * rect.width(), 96.0), Qt.AlignmentFlag.AlignLeft))
        cells.append((when, _RANGE, Qt.AlignmentFlag.AlignLeft))
        painter.setPen(quiet)
        for text, width, align in cells:
            self._write(painter, QRectF(right - width, rect.y(), width, rect.height()), text, align)
            right -= width + 8
        painter.setPen(QColor(TEXT if edit.enabled else FAINT))
        name = QRectF(rect.x() + _LEFT, rect.y(), right - rect.x() - _LEFT, rect.height())
        text = str(index.data(Qt.ItemDataRole.DisplayRole))
        self._write(painter, name, text, Qt.AlignmentFlag.AlignLeft)
        painter.restore()

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
        """A click on the switch switches."""
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

    def updateEditorGeometry(
        self, editor: QWidget, option: QStyleOptionViewItem, index: Index
    ) -> None:
        """The name is typed over the name."""
        editor.setGeometry(option.rect.adjusted(int(_LEFT) - 5, 0, -int(_STRENGTH), 0))


def switch_rect(row: QRectF) -> QRectF:
    """Where a row's switch is."""
    return QRectF(row.x() + 9, row.center().y() - _BOX / 2, _BOX, _BOX)
