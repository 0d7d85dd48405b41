"""The dialog of File > Export as: format, frame rate and character."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from PySide6.QtCore import Qt
from PySide6.QtWidgets import (
    QCheckBox,
    QDialog,
    QDialogButtonBox,
    QFormLayout,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from faceedit_app.editing.exporting import Options, OutFormat, out_formats, own_format
from faceedit_app.formats.take import Take
from faceedit_app.formats.timing import COMMON_RATES, format_rate
from faceedit_app.ui.look.widgets import Choice

_OWN_CHARACTER = "FaceEdit’s own"


class ExportDialog(QDialog):
    """Asks how to export a take.

    Args:
        take: the take.
        choose_character: asks for the file of a character.
    """

    def __init__(
        self,
        parent: QWidget | None,
        take: Take,
        choose_character: Callable[[QWidget], Path | None],
    ) -> None:
        super().__init__(parent)
        self.setWindowTitle("Export as")
        self.setMinimumWidth(520)
        self._take, self._choose_character = take, choose_character
        self._character: Path | None = None
        own = own_format(take)
        others = [form for form in out_formats() if form != own]
        self._formats: list[OutFormat] = [*([own] if own is not None else []), *others]
        column = QVBoxLayout(self)
        column.setSpacing(12)
        form = QFormLayout()
        form.setLabelAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        form.addRow("&Format", self._format_box(own))
        form.addRow("Frame &rate", self._rate_box())
        label = QLabel("&Character")
        form.addRow(label, self._character_row())
        label.setBuddy(self.choose)
        self.compact = QCheckBox("S&maller file: weights in steps of 1/65535")
        form.addRow("", self.compact)
        column.addLayout(form)
        self.hints = QLabel()
        self.hints.setTextFormat(Qt.TextFormat.PlainText)
        self.hints.setWordWrap(True)
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
        character = self._character if self.chosen.has_character else None
        return Options(self._chosen_rate, character, self.compact.isChecked())

    @property
    def _chosen_rate(self) -> float | None:
        rate: float | None = self.rate.currentData()
        return rate

    def _format_box(self, own: OutFormat | None) -> Choice:
        self.format = Choice()
        for form in self._formats:
            note = " (as the take came)" if form == own else ""
            self.format.addItem(f"{form.name}{note}  *{form.ending}")
        return self.format

    def _rate_box(self) -> Choice:
        self.rate = Choice()
        own = self._take.clip.rate
        self.rate.addItem(f"As the take: {format_rate(own)}", None)
        for rate in COMMON_RATES:
            if abs(rate / own - 1) > 1e-4:
                self.rate.addItem(format_rate(rate), rate)
        return self.rate

    def _character_row(self) -> QHBoxLayout:
        row = QHBoxLayout()
        self._character_name = QLabel(_OWN_CHARACTER)
        self._character_name.setTextFormat(Qt.TextFormat.PlainText)
        self.choose = QPushButton("C&hoose…")
        self.choose.setAutoDefault(False)
        self.choose.setToolTip("A GLB, VRM, FBX or OBJ with blendshapes")
        self.choose.clicked.connect(self._ask_character)
        row.addWidget(self._character_name, stretch=1)
        row.addWidget(self.choose)
        return row

    def _ask_character(self) -> None:
        path = self._choose_character(self)
        if path is not None:
            self._character = path
            self._character_name.setText(path.name)
            self._character_name.setToolTip(str(path))

    def _show_choice(self) -> None:
        form = self.chosen
        self.choose.setEnabled(form.has_character)
        self._character_name.setEnabled(form.has_character)
        self.compact.setEnabled(form.is_compact)
        self.hints.setText("\n".join(form.hints(self._chosen_rate or self._take.clip.rate)))
