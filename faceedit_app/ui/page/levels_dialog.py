"""Strength by channel: a table of multipliers, offsets and ceilings, previewed on the face."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from PySide6.QtCore import (
    QAbstractTableModel,
    QModelIndex,
    QSortFilterProxyModel,
    Qt,
    QTimer,
)
from PySide6.QtGui import QFont
from PySide6.QtWidgets import (
    QAbstractItemView,
    QDialog,
    QDialogButtonBox,
    QHeaderView,
    QLabel,
    QLineEdit,
    QTableView,
    QVBoxLayout,
    QWidget,
)

from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.levels import UNCHANGED, Level
from faceedit_app.editing.edits.edit import Edit
from faceedit_app.ui.edits.preview_dialog import PreviewDialog
from faceedit_app.ui.look.level_fields import LEVEL_HEADS, LEVEL_TIPS, LevelDelegate, changed_level
from faceedit_app.ui.look.model_index import Index
from faceedit_app.ui.state.document import Document

_ROOT = QModelIndex()
_HEADS = ("Channel", *LEVEL_HEADS)
_TIPS = ("ARKit's name of the channel", *LEVEL_TIPS)
_LIVE_MS = 60


class LevelsModel(QAbstractTableModel):
    """The channels of a take with their multiplier, offset and soft limit."""

    def __init__(self, channels: Sequence[str], parent: QWidget) -> None:
        super().__init__(parent)
        self.channels = [name for name in ARKIT_CHANNELS if name in channels]
        self.levels: dict[str, Level] = dict.fromkeys(self.channels, UNCHANGED)

    def rowCount(self, parent: Index = _ROOT) -> int:
        """One row a channel."""
        return 0 if parent.isValid() else len(self.channels)

    def columnCount(self, parent: Index = _ROOT) -> int:
        """Channel, multiplier, offset, soft limit."""
        return 0 if parent.isValid() else len(_HEADS)

    def headerData(
        self, section: int, orientation: Qt.Orientation, role: int = Qt.ItemDataRole.DisplayRole
    ) -> Any:
        """The titles of the columns."""
        if orientation is Qt.Orientation.Horizontal:
            if role == Qt.ItemDataRole.DisplayRole:
                return _HEADS[section]
            if role == Qt.ItemDataRole.ToolTipRole:
                return _TIPS[section]
        return None

    def data(self, index: Index, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
        """A name or a number; channels that change are bold."""
        name = self.channels[index.row()]
        level = self.levels[name]
        match role:
            case Qt.ItemDataRole.DisplayRole:
                return f"{level[index.column() - 1]:.2f}" if index.column() else name
            case Qt.ItemDataRole.EditRole:
                return level[index.column() - 1] if index.column() else name
            case Qt.ItemDataRole.FontRole if level != UNCHANGED:
                font = QFont()
                font.setBold(True)
                return font
            case Qt.ItemDataRole.TextAlignmentRole if index.column():
                return Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
            case _:
                return None

    def setData(self, index: Index, value: Any, role: int = Qt.ItemDataRole.EditRole) -> bool:
        """Change a number."""
        if role != Qt.ItemDataRole.EditRole or not index.column():
            return False
        name = self.channels[index.row()]
        self.levels[name] = changed_level(self.levels[name], index.column() - 1, float(value))
        self.dataChanged.emit(self.index(index.row(), 0), self.index(index.row(), 3))
        return True

    def flags(self, index: Index) -> Qt.ItemFlag:
        """Numbers can be edited."""
        flags = Qt.ItemFlag.ItemIsEnabled | Qt.ItemFlag.ItemIsSelectable
        return flags | Qt.ItemFlag.ItemIsEditable if index.column() else flags


class LevelsDialog(PreviewDialog):
    """The face follows the table; OK makes one edit.

    Args:
        channels: those of the take.
        where: the time range in which it acts, for the user.
        edit_of: the edit for some levels; None if they change nothing.
        make: called with the edit to make.
    """

    def __init__(
        self,
        parent: QWidget,
        document: Document,
        channels: Sequence[str],
        where: str,
        edit_of: Callable[[Mapping[str, Level]], Edit | None],
        make: Callable[[Edit], None],
    ) -> None:
        super().__init__(parent, document)
        self._edit_of, self._make = edit_of, make
        self.setWindowTitle("Strength by channel")
        self.model = LevelsModel(channels, self)
        self.search = QLineEdit()
        self.search.setObjectName("search")
        self.search.setPlaceholderText("Search channels")
        self.search.setAccessibleName("Search channels")
        self.search.setClearButtonEnabled(True)
        self.found = QSortFilterProxyModel(self)
        self.found.setSourceModel(self.model)
        self.found.setFilterCaseSensitivity(Qt.CaseSensitivity.CaseInsensitive)
        self.search.textChanged.connect(self.found.setFilterFixedString)
        self.table = QTableView()
        self.table.setModel(self.found)
        self.table.setItemDelegate(LevelDelegate(self.table, 1, is_live=True))
        self.table.setAccessibleName("Channels")
        trigger = QAbstractItemView.EditTrigger
        self.table.setEditTriggers(trigger.EditKeyPressed | trigger.AnyKeyPressed)
        self.table.clicked.connect(self._type)
        self.table.setTabKeyNavigation(False)  # Tab leaves the table, unless a number is typed
        self.table.verticalHeader().hide()
        head = self.table.horizontalHeader()
        head.setSectionResizeMode(0, QHeaderView.ResizeMode.Stretch)
        self._timer = QTimer(self, singleShot=True, interval=_LIVE_MS)
        self._timer.timeout.connect(self.preview)
        self.model.dataChanged.connect(lambda *_: self._timer.start())
        standard = QDialogButtonBox.StandardButton
        self.buttons = QDialogButtonBox(standard.Ok | standard.Cancel | standard.Reset)
        self.buttons.accepted.connect(self.accept)
        self.buttons.rejected.connect(self.reject)
        self.buttons.button(standard.Reset).clicked.connect(self._reset)
        column = QVBoxLayout(self)
        column.addWidget(QLabel(f"Strength of each channel, {where}:"))
        column.addWidget(self.search)
        column.addWidget(self.table, 1)
        column.addWidget(self.buttons)
        self.resize(520, 560)

    @property
    def edit(self) -> Edit | None:
        """The edit for the numbers in the table."""
        return self._edit_of(self.model.levels)

    def preview(self) -> None:
        """Show the face with the numbers in the table."""
        edit = self.edit
        if edit is None:
            self._document.cancel()
        else:
            self._document.preview(edit)

    def _type(self, index: QModelIndex) -> None:
        """A click on a number types another."""
        if index.column():
            self.table.edit(index)

    def _reset(self) -> None:
        """Leave all channels as they are."""
        self.model.beginResetModel()
        self.model.levels = dict.fromkeys(self.model.channels, UNCHANGED)
        self.model.endResetModel()
        self._timer.start()

    def done(self, result: int) -> None:
        """Make the edit, or leave the take unchanged."""
        self._timer.stop()
        edit = self.edit
        self._document.cancel()
        if result == QDialog.DialogCode.Accepted and edit is not None:
            self._make(edit)
        super().done(result)
