"""A number that says how a retime goes, previewed before it is made."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from PySide6.QtWidgets import (
    QCheckBox,
    QDialog,
    QDialogButtonBox,
    QFormLayout,
    QLabel,
    QVBoxLayout,
    QWidget,
)

from faceedit_app.core.errors import FaceEditError
from faceedit_app.ui.edits.preview_dialog import PreviewDialog
from faceedit_app.ui.look.number import NumberBox
from faceedit_app.ui.look.texts import Message
from faceedit_app.ui.state.document import Document

if TYPE_CHECKING:
    from faceedit_app.editing.edits.edit import Edit


@dataclass(frozen=True)
class Number:
    """The field of a dialog.

    Attributes:
        label: beside it.
        unit: behind the number.
        value: at first.
        low, high: the least and the greatest number.
        step: of the arrows beside the field.
        decimals: of the number.
    """

    label: str
    unit: str
    value: float
    low: float
    high: float
    step: float
    decimals: int = 2


@dataclass(frozen=True)
class Asked:
    """What a dialog asks for.

    Attributes:
        title: of the window, such as “Stretch”.
        question: above the field.
        number: what is typed into the field.
        option: a box to tick below it; empty = none.
    """

    title: str
    question: str
    number: Number
    option: str = ""


class RetimeDialog(PreviewDialog):
    """The face follows the number; OK makes the edits.

    Args:
        asked: what is asked for.
        edits_for: the edits for a number, and whether the box is ticked; raises a `FaceEditError`
            that says why there are none.
        shown_range: writes a range of seconds for people.
        make: called with the edits to make.
    """

    def __init__(
        self,
        parent: QWidget,
        document: Document,
        asked: Asked,
        edits_for: Callable[[float, bool], tuple[Edit, ...]],
        shown_range: Callable[[float, float], str],
        make: Callable[[tuple[Edit, ...]], None],
    ) -> None:
        super().__init__(parent, document)
        self._edits_for, self._make = edits_for, make
        self._shown_range = shown_range
        self._edits: tuple[Edit, ...] = ()
        self.setWindowTitle(asked.title)
        self.number = _spin_box(asked.number)
        self.option = QCheckBox(asked.option)
        self.option.setVisible(bool(asked.option))
        self.message = Message()
        self.message.setMinimumWidth(360)
        buttons = QDialogButtonBox(
            QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel
        )
        self.ok = buttons.button(QDialogButtonBox.StandardButton.Ok)
        buttons.accepted.connect(self.accept)
        buttons.rejected.connect(self.reject)
        form = QFormLayout()
        form.addRow(asked.number.label, self.number)
        column = QVBoxLayout(self)
        column.addWidget(QLabel(asked.question))
        column.addLayout(form)
        column.addWidget(self.option)
        column.addWidget(self.message)
        column.addWidget(buttons)
        self.number.valueChanged.connect(self.preview)
        self.number.lineEdit().textChanged.connect(self._typed)
        self.option.toggled.connect(self.preview)
        self.preview()

    def preview(self) -> None:
        """Show the take with this number, or say why that cannot be."""
        try:
            self._edits = self._edits_for(self.number.value(), self.option.isChecked())
            text = ""
        except FaceEditError as error:
            self._edits, text = (), f"{error}."
        if self._edits:
            edit = self._edits[0]
            where = self._shown_range(edit.start, edit.end)
            text = f"Changes {where}; all that follows keeps its time."
        self.message.setText(text)
        self.ok.setEnabled(bool(self._edits))
        self._document.preview(*self._edits)

    def _typed(self) -> None:
        """Say nothing of a number that is being typed over by what is none."""
        if not self.number.hasAcceptableInput():
            self.message.setText("")
        elif not self.message.text():
            self.preview()

    def done(self, result: int) -> None:
        """Make the edits, or leave the take unchanged."""
        if result == QDialog.DialogCode.Accepted and self._edits:
            self._make(self._edits)
        else:
            self._document.cancel()
        super().done(result)


def _spin_box(number: Number) -> NumberBox:
    box = NumberBox()
    box.setDecimals(number.decimals)
    box.setRange(number.low, number.high)
    box.setSingleStep(number.step)
    box.setSuffix(f" {number.unit}")
    box.setValue(number.value)
    box.setAccessibleName(number.label)
    box.selectAll()
    return box
