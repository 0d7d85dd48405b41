"""The list of edits as a Qt model: names, switches, and rows that can be dragged."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from PySide6.QtCore import (
    QAbstractListModel,
    QMimeData,
    QModelIndex,
    QPersistentModelIndex,
    Qt,
    Signal,
)

from faceedit_app.core.clip import Clip
from faceedit_app.editing.edits.describe import describe, describe_controls
from faceedit_app.editing.edits.edit import Edit
from faceedit_app.ui.look.texts import plain_tip
from faceedit_app.ui.state.clock import Unit, label
from faceedit_app.ui.state.document import Document
from faceedit_app.ui.state.timeline import Timeline

COLUMNS = Qt.ItemDataRole.UserRole + 1  # when, on what, how strongly
STRENGTH, RANGE = (Qt.ItemDataRole.UserRole + i for i in (2, 3))  # to set them
_NUMBER = re.compile(r"\d+(?:\.\d*)?|\.\d+", re.ASCII)
_MIME = "application/x-faceedit-row"
Index = QModelIndex | QPersistentModelIndex
_ROOT = QModelIndex()


class EditsModel(QAbstractListModel):
    """Rows are the session's edits, the oldest on top.

    Signals:
        moving(int): an edit is about to be moved to a row.
    """

    moving = Signal(int)

    def __init__(self, document: Document, timeline: Timeline) -> None:
        super().__init__(document)
        self._document, self._timeline = document, timeline

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
                words = f"{describe(edit)}, {', '.join(self.columns(edit))}{state}"
                return plain_tip(words) if role == Qt.ItemDataRole.ToolTipRole else words
            case Qt.ItemDataRole.UserRole:
                return edit
            case _ if role == COLUMNS:
                return self.columns(edit)
            case _:
                return None

    def columns(self, edit: Edit) -> tuple[str, str, str]:
        """When an edit acts, on what, and how strongly, with times in the chosen unit."""
        return columns(edit, self._timeline.clip, self._timeline.clock.unit)

    def setData(self, index: Index, value: Any, role: int = Qt.ItemDataRole.EditRole) -> bool:
        """Rename an edit, or switch it."""
        row = index.row()
        if role == Qt.ItemDataRole.CheckStateRole:
            on = Qt.CheckState(value) is Qt.CheckState.Checked
            self._document.act(lambda session: session.set_enabled(row, on))
            return True
        if role == STRENGTH:
            self._replace(row, replace(self.edits[row], strength=float(value)), "Edit strength")
            return True
        if role == RANGE:
            self._replace(row, self.edits[row].stretched(*value), "Range")
            return True
        if role == Qt.ItemDataRole.EditRole and str(value) != self.data(index):
            self._document.act(lambda session: session.rename(row, str(value)))
            return True
        return False

    def _replace(self, row: int, edit: Edit, name: str) -> None:
        if edit != self.edits[row]:
            self._document.act(lambda session: session.replace_edit(row, edit, name))

    def typed_range(self, text: str) -> tuple[float, float] | None:
        """The range that a text such as `1.2 – 3` means, in the unit of `ends`; None if none."""
        clip, numbers = self._timeline.clip, [float(n) for n in _NUMBER.findall(text)]
        if clip is None or not 1 <= len(numbers) <= 2:
            return None
        if self._timeline.clock.unit is Unit.FRAMES:
            frames = (min(max(round(n), 1), len(clip)) - 1 for n in numbers)
            numbers = [float(clip.times[frame]) for frame in frames]
        first, last = (min(max(n, 0.0), clip.duration) for n in (numbers[0], numbers[-1]))
        return min(first, last), max(first, last)

    def ends(self, edit: Edit) -> str:
        """The range of an edit as it is typed: in frames, or else in seconds."""
        clip = self._timeline.clip
        if clip is not None and self._timeline.clock.unit is Unit.FRAMES:
            return " – ".join(label(clip, s, Unit.FRAMES) for s in (edit.start, edit.end))
        return f"{max(edit.start, 0.0):.3f} – {max(edit.end, 0.0):.3f}"

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


def columns(
    edit: Edit, clip: Clip | None = None, unit: Unit = Unit.SECONDS
) -> tuple[str, str, str]:
    """When it acts, on what, and how strongly.

    Args:
        edit: the edit.
        clip, unit: for times in frames or timecode; otherwise they are in seconds.
    """
    ends = (max(seconds, 0.0) for seconds in (edit.start, edit.end))
    if clip is None or unit is Unit.SECONDS:
        start, end = (f"{seconds:.2f}" for seconds in ends)
        tail = " s"
    else:
        start, end = (label(clip, seconds, unit) for seconds in ends)
        tail = ""
    return (
        f"{start}{tail}" if start == end else f"{start} – {end}{tail}",
        describe_controls(edit.controls),
        f"{100 * edit.strength:.0f} %",
    )
