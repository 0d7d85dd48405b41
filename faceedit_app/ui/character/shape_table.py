"""The table of the checklist: ARKit's channels, the shape that makes each, and its strength."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QAbstractTableModel, Qt, QTimer, Signal
from PySide6.QtGui import QColor
from PySide6.QtWidgets import (
    QAbstractItemView,
    QApplication,
    QComboBox,
    QHeaderView,
    QStyledItemDelegate,
    QStyleOptionViewItem,
    QTableView,
    QWidget,
)

from faceedit_app.characters.fitted import FittedCharacter
from faceedit_app.characters.matches import Half
from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.levels import UNCHANGED, Level
from faceedit_app.ui.look.level_fields import LEVEL_HEADS, LEVEL_TIPS, LevelDelegate, changed_level
from faceedit_app.ui.look.model_index import Index
from faceedit_app.ui.look.palette import MUTED, ORANGE
from faceedit_app.ui.look.texts import plain_tip
from faceedit_app.ui.look.widgets import Choice

NO_SHAPE = "– no shape –"
_HEADS = ("Channel", "Shape in the file", *LEVEL_HEADS, "Note")
CHANNEL, SHAPE, MULTIPLIER, OFFSET, LIMIT, NOTE = range(6)
_LEVELS = (MULTIPLIER, OFFSET, LIMIT)
_WIDEST = 260  # pixels of a column: names of shapes can be of any length
_SOON = 20  # ms
_MOST_SHAPES = 16  # shown at once, in the list of a cell


class ShapeModel(QAbstractTableModel):
    """The 52 channels of a character.

    Signals:
        chosen(str, str): a channel, and the shape that the user chose; "" for none.
        levelled(str, object): a channel, and how strongly the character answers it (`Level`).
    """

    chosen = Signal(str, str)
    levelled = Signal(str, object)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._shapes: dict[str, str] = {}
        self._notes: dict[str, str] = {}
        self._levels: dict[str, Level] = {}
        self._channels: tuple[str, ...] = ARKIT_CHANNELS
        self.targets: tuple[str, ...] = ()

    def show_character(self, character: FittedCharacter, only_noted: bool) -> None:
        """Show a character's channels, or only those with a note."""
        self.beginResetModel()
        shares, check = character.match.shares, character.checklist
        self.targets = tuple(sorted(character.character.targets, key=str.casefold))
        self._shapes = {
            channel: " + ".join(
                share.name if share.half is Half.WHOLE else f"{share.name} ({share.half})"
                for share in parts
            )
            for channel, parts in shares.items()
        }
        self._levels = dict(character.mapping.levels)
        self._notes = dict.fromkeys(check.missing, "missing")
        self._notes |= dict.fromkeys(check.several, "made of several")
        self._notes |= dict.fromkeys(check.dead, "moves nothing")
        noted = tuple(c for c in ARKIT_CHANNELS if c in self._notes)
        others = tuple(c for c in ARKIT_CHANNELS if c not in self._notes)
        self._channels = noted if only_noted else noted + others
        self.endResetModel()

    def rowCount(self, parent: Index | None = None) -> int:
        """One row a channel."""
        return 0 if parent is not None and parent.isValid() else len(self._channels)

    def columnCount(self, parent: Index | None = None) -> int:
        """Channel, shape, multiplier, offset, soft limit, note."""
        return len(_HEADS)

    def headerData(
        self, section: int, orientation: Qt.Orientation, role: int = Qt.ItemDataRole.DisplayRole
    ) -> Any:
        """The titles of the columns."""
        if orientation is Qt.Orientation.Horizontal:
            if role == Qt.ItemDataRole.DisplayRole:
                return _HEADS[section]
            if role == Qt.ItemDataRole.ToolTipRole and section in _LEVELS:
                return LEVEL_TIPS[section - MULTIPLIER]
            if role == Qt.ItemDataRole.TextAlignmentRole and section in _LEVELS:
                return Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
        return None

    def data(self, index: Index, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
        """The text of a cell; notes are orange, and what is absent or usual is muted."""
        channel, column = self._channels[index.row()], index.column()
        if column in _LEVELS:
            return self._level_data(channel, column - MULTIPLIER, role)
        if role in (Qt.ItemDataRole.DisplayRole, Qt.ItemDataRole.EditRole):
            texts = {CHANNEL: channel, SHAPE: self._shapes.get(channel, NO_SHAPE)}
            return texts.get(column, self._notes.get(channel, ""))
        if role == Qt.ItemDataRole.ToolTipRole:
            if column == NOTE:
                return self._notes.get(channel)
            shape = self._shapes.get(channel, NO_SHAPE)
            tip = plain_tip(f"{shape}\nDouble-click to choose another shape")
            return tip if column == SHAPE else None
        if role == Qt.ItemDataRole.ForegroundRole:
            if column == NOTE:
                return QColor(ORANGE)
            if column == SHAPE and channel not in self._shapes:
                return QColor(MUTED)
        return None

    def _level_data(self, channel: str, place: int, role: int) -> Any:
        value = self._levels.get(channel, UNCHANGED)[place]
        match role:
            case Qt.ItemDataRole.DisplayRole:
                return f"{value:.2f}"
            case Qt.ItemDataRole.EditRole:
                return value
            case Qt.ItemDataRole.TextAlignmentRole:
                return Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
            case Qt.ItemDataRole.ForegroundRole if value == UNCHANGED[place]:
                return QColor(MUTED)
            case _:
                return None

    def setData(self, index: Index, value: Any, role: int = Qt.ItemDataRole.EditRole) -> bool:
        """Choose another shape for a channel, or another strength."""
        channel, column = self._channels[index.row()], index.column()
        if column in _LEVELS:
            level = self._levels.get(channel, UNCHANGED)
            changed = changed_level(level, column - MULTIPLIER, float(value))
            if changed == level:
                return False
            self.levelled.emit(channel, changed)
            return True
        shape = str(value)
        if shape == self._shapes.get(channel, NO_SHAPE):
            return False
        self.chosen.emit(channel, "" if shape == NO_SHAPE else shape)
        return True

    def flags(self, index: Index) -> Qt.ItemFlag:
        """Shapes can be chosen, and the strength of channels that have one."""
        flags = super().flags(index)
        channel, column = self._channels[index.row()], index.column()
        can = column == SHAPE or (column in _LEVELS and channel in self._shapes)
        return flags | Qt.ItemFlag.ItemIsEditable if can else flags


class ShapeTable(QTableView):
    """Shows a `ShapeModel`; a shape is chosen from a list of all in the file."""

    def __init__(self, model: ShapeModel) -> None:
        super().__init__()
        self.setModel(model)
        self.setItemDelegateForColumn(SHAPE, _ShapeDelegate(self))
        for column in _LEVELS:
            self.setItemDelegateForColumn(column, LevelDelegate(self, MULTIPLIER, is_live=False))
        self.setEditTriggers(
            QAbstractItemView.EditTrigger.DoubleClicked
            | QAbstractItemView.EditTrigger.EditKeyPressed
        )
        self.setTabKeyNavigation(False)  # Tab leaves the table
        self.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
        self.setAlternatingRowColors(True)
        self.setShowGrid(False)
        self.verticalHeader().hide()
        self.verticalHeader().setDefaultSectionSize(24)
        head = self.horizontalHeader()
        head.setDefaultAlignment(Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter)
        head.setSectionResizeMode(CHANNEL, QHeaderView.ResizeMode.ResizeToContents)
        head.setSectionResizeMode(SHAPE, QHeaderView.ResizeMode.Stretch)  # long names are cut
        for column in (NOTE, *_LEVELS):
            head.setSectionResizeMode(column, QHeaderView.ResizeMode.ResizeToContents)
        head.setMaximumSectionSize(_WIDEST)
        self.setAccessibleName("Channels and shapes")


class _ShapeDelegate(QStyledItemDelegate):
    """Edits a shape with a list, which is open at once; letters find a name in it."""

    def createEditor(
        self, parent: QWidget, _option: QStyleOptionViewItem, index: Index
    ) -> QComboBox:
        model = index.model()
        assert isinstance(model, ShapeModel)
        box = Choice()
        box.setParent(parent)
        box.setMaxVisibleItems(_MOST_SHAPES)
        box.addItems([NO_SHAPE, *model.targets])

        def choose() -> None:
            self.commitData.emit(box)
            self.closeEditor.emit(box)

        def open_list() -> None:
            if QApplication.mouseButtons() == Qt.MouseButton.NoButton:
                box.showPopup()
            else:  # the release of the double click would close it
                QTimer.singleShot(_SOON, box, open_list)

        box.activated.connect(choose)
        QTimer.singleShot(0, box, open_list)  # once it has its place and its text
        return box

    def setEditorData(self, editor: QWidget, index: Index) -> None:
        assert isinstance(editor, QComboBox)
        editor.setCurrentText(str(index.data()))

    def setModelData(self, editor: QWidget, model: Any, index: Index) -> None:
        assert isinstance(editor, QComboBox)
        model.setData(index, editor.currentText())
