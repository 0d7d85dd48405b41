"""The list of edits as a Qt model: names, switches, and rows that can be dragged."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from typing import Any

from PySide6.QtCore import (
    QAbstractListModel,
    QMimeData,
    QModelIndex,
    Qt,
    Signal,
)

from faceedit_app.core.fields import clean_text
from faceedit_app.editing.edits.describe import describe, describe_what
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.help.retime import reshaped
from faceedit_app.ui.edits.groups import Key, groups_of, key_of
from faceedit_app.ui.look.model_index import Index
from faceedit_app.ui.look.texts import plain_tip
from faceedit_app.ui.state.document import Document
from faceedit_app.ui.state.time_display import Unit, label, shown_seconds
from faceedit_app.ui.state.timed_rows import TimedRows
from faceedit_app.ui.state.timeline import Timeline
from faceedit_app.ui.state.typed_time import typed_range

COLUMNS = Qt.ItemDataRole.UserRole + 1  # when, on what, how strongly
GROUP = Qt.ItemDataRole.UserRole + 4  # (edits or 0 if not its head, whether open); None if none
STRENGTH, RANGE = (Qt.ItemDataRole.UserRole + i for i in (2, 3))  # to set them
_MIME = "application/x-faceedit-row"
_ROOT = QModelIndex()


class EditsModel(QAbstractListModel):
    """Rows are the session's edits, the oldest on top.

    Signals:
        moving(int): an edit is about to be moved to a row.
        regrouped(): a group was opened or closed.
    """

    moving = Signal(int)
    regrouped = Signal()

    def __init__(self, document: Document, timeline: Timeline) -> None:
        super().__init__(document)
        self._document, self._timeline = document, timeline
        self._open: set[Key] = set()  # groups whose edits are shown
        self._grouped: tuple[Sequence[Edit], dict[int, range]] = (), {}
        self._count = 0  # rows that the view knows

    @property
    def edits(self) -> Sequence[Edit]:
        """The edits, in order."""
        session = self._document.session
        return session.edits if session is not None else ()

    def refresh(self) -> None:
        """The list of edits changed.

        With as many edits as before, the view keeps its rows: after a reset, the release of the
        click that changed one would find no row, and select none.
        """
        self._grouped = (), {}
        count = len(self.edits)
        if count == self._count:
            if count:
                self.dataChanged.emit(self.index(0), self.index(count - 1))
            return
        self.beginResetModel()
        self._count = count
        self.endResetModel()

    # --- groups ------------------------------------------------------------------------------

    @property
    def _groups(self) -> dict[int, range]:
        """The group of each row, by row. Menus may ask before the list knows of a change."""
        edits = self.edits
        if self._grouped[0] is not edits:
            self._grouped = edits, {row: group for group in groups_of(edits) for row in group}
        return self._grouped[1]

    def is_open(self, row: int) -> bool:
        """Whether the edits of a row's group are shown."""
        return key_of(self.edits[row]) in self._open

    def stands_for(self, row: int) -> range:
        """The rows that a row stands for: those of its group, if it is the head of a closed one."""
        group = self._groups.get(row, range(row, row + 1))
        closed = row == group.start and not self.is_open(row)
        return group if closed else range(row, row + 1)

    def is_hidden(self, row: int) -> bool:
        """Whether another row stands for this one."""
        group = self._groups.get(row, range(row, row + 1))
        return row != group.start and not self.is_open(row)

    def counted(self, rows: Iterable[int]) -> str:
        """`edit`, or `3 edits`: as many as the list shows of these rows."""
        shown = sum(not self.is_hidden(row) for row in rows)
        return "edit" if shown == 1 else f"{shown} edits"

    def toggle_group(self, row: int) -> None:
        """Show the edits of a group, or hide them."""
        self._open ^= {key_of(self.edits[row])}
        self.regrouped.emit()

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
                return self._columns_of(index.row())
            case _ if role == GROUP:
                group = self._groups.get(index.row(), range(1))
                if len(group) == 1:
                    return None
                count = len(group) if index.row() == group.start else 0
                return count, self.is_open(index.row())
            case _:
                return None

    def columns(self, edit: Edit) -> tuple[str, str, str]:
        """When an edit acts, on what, and how strongly, with times in the chosen unit."""
        return columns(edit, self._timeline.rows, self._timeline.display.unit)

    def setData(self, index: Index, value: Any, role: int = Qt.ItemDataRole.EditRole) -> bool:
        """Rename an edit, or switch it."""
        row = index.row()
        if role == Qt.ItemDataRole.CheckStateRole:
            on = Qt.CheckState(value) is Qt.CheckState.Checked
            name = "Switch edit on" if on else "Switch edit off"
            self._change(row, lambda edit: replace(edit, enabled=on), name)
            return True
        if role == STRENGTH:
            strength = float(value)
            self._change(row, lambda edit: replace(edit, strength=strength), "Edit strength")
            return True
        if role == RANGE:
            self._change(row, lambda edit: self._limited(edit, value), "Range")
            return True
        if role == Qt.ItemDataRole.EditRole and str(value) != self.data(index):
            typed = clean_text(str(value).strip())
            self._change(row, lambda edit: replace(edit, name=typed), "Rename edit")
            return True
        return False

    def _change(self, row: int, change: Callable[[Edit], Edit], name: str) -> None:
        """Change what a row stands for, as one step."""
        edits = list(self.edits)
        for one in self.stands_for(row):
            edits[one] = change(edits[one])
        if tuple(edits) != tuple(self.edits):
            self._document.act(lambda session: session.put(edits, name))

    def _limited(self, edit: Edit, hold: tuple[float, float]) -> Edit:
        """An edit with another hold; where it no longer reaches the take's end, it fades."""
        fades = edit.falloff, edit.fade_out
        if edit.op is not Op.RETIME:
            fades = self._timeline.softened((edit.start, edit.end), hold, fades)
        return reshaped(edit, *hold, *fades)

    def _columns_of(self, row: int) -> tuple[str, str, str]:
        """The columns of a row, for all that it stands for."""
        edits = [self.edits[one] for one in self.stands_for(row)]
        when, what, strength = self.columns(edits[0])
        if len(edits) > 1:
            what = describe_what(*edits)
            if len({edit.strength for edit in edits}) > 1:
                strength = "–"
        return when, what, strength

    def typed_range(self, text: str, edit: Edit) -> tuple[float, float]:
        """The range that a text such as `1.2 – 3` means, in the unit of `ends`.

        An end that was not changed stays exactly where it is.

        Raises:
            ValueError: what is wrong with the text, in one line for the user.
        """
        line = self._timeline
        rows = line.rows
        assert rows is not None
        (start, end), (first, last) = (
            typed_range(rows, words, line.display.unit, rows.at(line.time))
            for words in (text, self.ends(edit))
        )
        start = edit.start if start == first else start
        end = edit.end if end == last else end
        return min(start, end), max(start, end)

    def ends(self, edit: Edit) -> str:
        """The range of an edit as it is typed, in the unit in which times are shown."""
        rows, unit = self._timeline.rows, self._timeline.display.unit
        if rows is not None and unit is not Unit.SECONDS:
            return " – ".join(label(rows, s, unit) for s in (edit.start, edit.end))
        last = rows.clip.duration if rows is not None else math.inf
        start, end = (min(max(seconds, 0.0), last) for seconds in (edit.start, edit.end))
        return f"{shown_seconds(start)} – {shown_seconds(end)}"

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
        """Move an edit to another row, with all that its row stands for."""
        moved = self.stands_for(row)
        if to > row:  # past what the row at the place stands for
            to = min(to + len(moved) - 1, len(self.edits) - 1)
            to = self._groups[to].stop - 1 if self.is_hidden(to) or to in self._groups else to
            to -= len(moved) - 1
        else:
            to = max(to, 0)
            to = self._groups[to].start if self.is_hidden(to) else to
        edits = list(self.edits)
        block = edits[moved.start : moved.stop]
        del edits[moved.start : moved.stop]
        edits[to:to] = block
        if tuple(edits) != tuple(self.edits):
            self.moving.emit(to)
            self._document.act(lambda session: session.put(edits, "Move edit"))


def columns(
    edit: Edit, rows: TimedRows | None = None, unit: Unit = Unit.SECONDS
) -> tuple[str, str, str]:
    """When it acts, on what, and how strongly.

    Args:
        edit: the edit.
        rows, unit: for times in frames or timecode; otherwise they are in seconds.
    """
    last = rows.clip.duration if rows is not None else math.inf  # a paste may go on beyond the take
    ends = (min(max(seconds, 0.0), last) for seconds in (edit.start, edit.end))
    if rows is None or unit is Unit.SECONDS:
        start, end = map(shown_seconds, ends)
        tail = " s"
    else:
        start, end = (label(rows, seconds, unit) for seconds in ends)
        tail = ""
    return (
        f"{start}{tail}" if start == end else f"{start} – {end}{tail}",
        describe_what(edit),
        f"{100 * edit.strength:.0f} %",
    )
