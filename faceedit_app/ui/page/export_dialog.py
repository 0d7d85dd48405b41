"""The dialog of File > Export as: format and frame rate."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import Qt
from PySide6.QtWidgets import (
    QCheckBox,
    QDialog,
    QDialogButtonBox,
    QFormLayout,
    QLabel,
    QVBoxLayout,
    QWidget,
)

from faceedit_app.editing.exporting import Options, OutFormat, out_formats, own_format
from faceedit_app.formats.rates import COMMON_RATES
from faceedit_app.formats.take import Take
from faceedit_app.formats.timing import format_rate
from faceedit_app.ui.look.texts import Message
from faceedit_app.ui.look.widgets import Choice

_OWN_CHARACTER = "FaceEdit's own, as on screen"


class ExportDialog(QDialog):
    """Asks how to export a take.

    Args:
        take: the take.
        character: the file of the character on screen; None = FaceEdit's own.
    """

    def __init__(self, parent: QWidget | None, take: Take, character: Path | None = None) -> None:
        super().__init__(parent)
        self.setWindowTitle("Export as")
        self.setMinimumWidth(520)
        self._take = take
        own = own_format(take)
        self._formats: list[OutFormat] = [*([own] if own is not None else []), *out_formats()]
        column = QVBoxLayout(self)
        column.setSpacing(12)
        form = QFormLayout()
        form.setLabelAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        form.addRow("&Format", self._format_box(own))
        form.addRow("Frame &rate", self._rate_box())
        self.character = QLabel(_OWN_CHARACTER if character is None else character.name)
        self.character.setTextFormat(Qt.TextFormat.PlainText)
        self.character.setToolTip("The one on screen; File > Character shows another")
        form.addRow("Character", self.character)
        self.compact = QCheckBox("S&maller file: weights in steps of 1/65535")
        form.addRow("", self.compact)
        column.addLayout(form)
        self.hints = Message()
        self.hints.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        column.addWidget(self.hints, stretch=1)
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Cancel)
        export = buttons.addButton("&Export…", QDialogButtonBox.ButtonRole.AcceptRole)
        export.setDefault(True)
        buttons.accepted.connect(self.accept)
        buttons.rejected.connect(self.reject)
        column.addWidget(buttons)
        self.format.currentIndexChanged.connect(self._show_choice)
        self.rate.currentIndexChanged.connect(self._show_choice)
        self._show_choice()

    @property
    def chosen(self) -> OutFormat:
        """The chosen format."""
        return self._formats[self.format.currentIndex()]

    @property
    def options(self) -> Options:
        """The rest of what was chosen."""
        return Options(
            self._chosen_rate, compact=self.compact.isChecked() and self.chosen.is_compact
        )

    @property
    def _chosen_rate(self) -> float | None:
        rate: float | None = self.rate.currentData()
        return rate if self.chosen.takes_any_rate else None

    def _format_box(self, own: OutFormat | None) -> Choice:
        self.format = Choice()
        for form in self._formats:
            name = f"Same as the take: {form.name}" if form == own else form.name
            self.format.addItem(f"{name}  *{form.ending}")
        return self.format

    def _rate_box(self) -> Choice:
        self.rate = Choice()
        own = self._take.clip.rate
        self.rate.addItem(f"Same as the take: {format_rate(own)}", None)
        for rate in COMMON_RATES:
            if abs(rate / own - 1) > 1e-4:
                self.rate.addItem(format_rate(rate), rate)
        return self.rate

    def _show_choice(self) -> None:
        form = self.chosen
        self.character.setEnabled(form.has_character)
        self.compact.setEnabled(form.is_compact)
        self.rate.setEnabled(form.takes_any_rate)
        self.hints.setText("\n".join(form.hints(self._chosen_rate or self._take.clip.rate)))
