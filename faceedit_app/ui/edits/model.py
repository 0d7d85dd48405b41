"""The list of edits as a Qt model: names, switches, and rows that can be dragged."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from PySide6.QtCore import (
    QAbstractListModel,
    QMimeData,
    QModelIndex,
    QPersistentModelIndex,
    Qt,
    Signal,
)

from faceedit_app.editing.edits.describe import describe, describe_controls
from faceedit_app.editing.edits.edit import Edit
from faceedit_app.ui.look.texts import plain_tip
from faceedit_app.ui.state.document import Document

_MIME = "application/x-faceedit-row"
Index = QModelIndex | QPersistentModelIndex
_ROOT = QModelIndex()


class EditsModel(QAbstractListModel):
    """Rows are the session's edits, the oldest on top.

    Signals:
        moving(int): an edit is about to be moved to a row.
    """

    moving = Signal(int)

    def __init__(self, document: Document) -> None:
        super().__init__(document)
        self._document = document

    @property
    def edits(self) -> Sequence[Edit]:
        """The edits, in order."""
        session = self._document.session
        return session.edits if session is not None else ()

    def refresh(self) -> None:
        """The list of edits changed."""
        self.beginResetModel()
        self.endResetModel()

    def rowCount(self, parent: Index = _ROOT) -> int:
        """The number of edits."""
        return 0 if parent.isValid() else len(self.edits)

    def data(self, index: Index, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
        """Name, switch, and a description for tooltips and screen readers."""
        if not 0 <= index.row() < len(self.edits):
            return None
        edit = self.edits[index.row()]
        match role:
            case Qt.ItemDataRole.DisplayRole | Qt.ItemDataRole.EditRole:
                return describe(edit)
            case Qt.ItemDataRole.CheckStateRole:
                return Qt.CheckState.Checked if edit.enabled else Qt.CheckState.Unchecked
            case Qt.ItemDataRole.ToolTipRole | Qt.ItemDataRole.AccessibleTextRole:
                state = "" if edit.enabled else ", switched off"
                words = f"{describe(edit)}, {', '.join(columns(edit))}{state}"
                return plain_tip(words) if role == Qt.ItemDataRole.ToolTipRole else words
            case Qt.ItemDataRole.UserRole:
                return edit
            case _:
                return None

    def setData(self, index: Index, value: Any, role: int = Qt.ItemDataRole.EditRole) -> bool:
        """Rename an edit, or switch it."""
        row = index.row()
        if role == Qt.ItemDataRole.CheckStateRole:
            on = Qt.CheckState(value) is Qt.CheckState.Checked
            self._document.act(lambda session: session.set_enabled(row, on))
            return True
        if role == Qt.ItemDataRole.EditRole and str(value) != self.data(index):
            self._document.act(lambda session: session.rename(row, str(value)))
            return True
        return False

    def flags(self, index: Index) -> Qt.ItemFlag:
        """What can be done with a row; edits are dropped between rows."""
        flag = Qt.ItemFlag
        if not index.isValid():
            return flag.ItemIsDropEnabled
        return (
            flag.ItemIsEnabled
            | flag.ItemIsSelectable
            | flag.ItemIsEditable
            | flag.ItemIsUserCheckable
            | flag.ItemIsDragEnabled
        )

    # --- dragging rows -----------------------------------------------------------------------

    def supportedDropActions(self) -> Qt.DropAction:
        """Rows are moved, not copied."""
        return Qt.DropAction.MoveAction

    def mimeTypes(self) -> list[str]:
        """Only rows of this list."""
        return [_MIME]

    def mimeData(self, indexes: Sequence[QModelIndex]) -> QMimeData:
        """The dragged row."""
        data = QMimeData()
        data.setData(_MIME, str(indexes[0].row()).encode())
        return data

    def dropMimeData(
        self, data: QMimeData, action: Qt.DropAction, row: int, column: int, parent: Index
    ) -> bool:
        """Move the dragged edit before the row it was dropped on."""
        if not data.hasFormat(_MIME):
            return False
        source = int(bytes(data.data(_MIME).data()).decode())
        to = row if row >= 0 else len(self.edits)
        self.move_edit(source, to - 1 if to > source else to)
        # Qt would remove the source row, but the session has moved it already.
        return False

    def move_edit(self, row: int, to: int) -> None:
        """Move an edit to another row."""
        to = min(max(to, 0), len(self.edits) - 1)
        if row != to:
            self.moving.emit(to)
            self._document.act(lambda session: session.move(row, to))


def columns(edit: Edit) -> tuple[str, str, str]:
    """When it acts, on what, and how strongly."""
    start, end = (f"{max(seconds, 0.0):.2f}" for seconds in (edit.start, edit.end))
    return (
        f"{start} s" if start == end else f"{start} – {end} s",
        describe_controls(edit.controls),
        f"{100 * edit.strength:.0f} %",
    )
