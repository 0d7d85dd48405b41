"""Fields for the strength of a channel in a table: multiplier, offset and soft limit."""

from __future__ import annotations

from PySide6.QtCore import (
    QAbstractItemModel,
    QObject,
    QSignalBlocker,
    Qt,
)
from PySide6.QtWidgets import QStyleOptionViewItem, QWidget

from faceedit_app.core.levels import STRONGEST_LEVEL, Level
from faceedit_app.ui.look.model_index import Index
from faceedit_app.ui.look.number import NumberBox, NumberDelegate

LEVEL_HEADS = ("Multiplier", "Offset", "Soft limit")
LEVEL_TIPS = (
    "1 leaves the channel as it is, 0 mutes it",
    "Added after the multiplier; from -1 to 1",
    "The weight that is approached smoothly and never passed; 1 does not limit",
)
# Lowest, highest and step of each number.
_RANGES = ((0.0, STRONGEST_LEVEL, 0.05), (-1.0, 1.0, 0.01), (0.05, 1.0, 0.05))


def changed_level(level: Level, place: int, value: float) -> Level:
    """A level with one of its three numbers replaced by a value within its range."""
    low, high, _ = _RANGES[place]
    numbers = list(level)
    numbers[place] = round(min(max(value, low), high), 4)
    return numbers[0], numbers[1], numbers[2]


class LevelDelegate(NumberDelegate):
    """Edits one of the three numbers of a level.

    Args:
        first: the column of the multiplier; offset and soft limit follow.
        is_live: whether each step of the arrows counts, not only the finished number.
    """

    def __init__(self, parent: QObject, first: int, is_live: bool) -> None:
        super().__init__(parent)
        self._first, self._is_live = first, is_live

    def createEditor(
        self, parent: QWidget, option: QStyleOptionViewItem, index: Index
    ) -> NumberBox:
        """A field with arrows."""
        low, high, step = _RANGES[index.column() - self._first]
        field = NumberBox(parent)
        field.setRange(low, high)
        field.setSingleStep(step)
        field.setDecimals(2)
        field.setFrame(False)
        if self._is_live:
            field.valueChanged.connect(lambda _value: self.commitData.emit(field))
        return field

    def setEditorData(self, editor: QWidget, index: Index) -> None:
        """Show the number, unless it is the one that was just typed."""
        value = index.data(Qt.ItemDataRole.EditRole)
        if isinstance(editor, NumberBox) and editor.value() != value:
            with QSignalBlocker(editor):
                editor.setValue(value)

    def setModelData(self, editor: QWidget, model: QAbstractItemModel, index: Index) -> None:
        """Take the number."""
        if isinstance(editor, NumberBox) and not self.refuses(editor):
            editor.interpretText()
            model.setData(index, editor.value(), Qt.ItemDataRole.EditRole)
