"""The dialog that asks for a frame rate: a common one or any other."""

from __future__ import annotations

from PySide6.QtWidgets import (
    QButtonGroup,
    QDialog,
    QDialogButtonBox,
    QHBoxLayout,
    QLabel,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from faceedit_app.formats.rates import COMMON_RATES, exact_rate
from faceedit_app.formats.timing import counted, format_rate, format_time
from faceedit_app.ui.look.number import NumberBox, may_accept
from faceedit_app.ui.look.refused import show_refused
from faceedit_app.ui.look.texts import plain_label

_LOWEST, _HIGHEST = 1.0, 1000.0
_DECIMALS = 3
_SHOWN_RATES = tuple(rate for rate in COMMON_RATES if rate <= 60)


class RateDialog(QDialog):
    """Asks for a take's frame rate, and shows how long the take would be.

    Args:
        question: why the rate is needed, for the user.
        frames: the duration of the take in frames, with those of its gaps; not a whole number if
            its times are uneven.
        rate: the initial choice.
    """

    def __init__(self, parent: QWidget | None, question: str, frames: float, rate: float) -> None:
        super().__init__(parent)
        self.setWindowTitle("Frame rate")
        self._frames = frames
        column = QVBoxLayout(self)
        column.setSpacing(12)
        text = plain_label(question)
        text.setWordWrap(True)
        text.setMinimumWidth(380)
        column.addWidget(text)
        column.addLayout(self._common_rates())
        column.addLayout(self._any_rate())
        self.length = QLabel()
        column.addWidget(self.length)
        buttons = QDialogButtonBox(
            QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel
        )
        buttons.accepted.connect(self.accept)
        buttons.rejected.connect(self.reject)
        column.addWidget(buttons)
        for changed in (self.spin.valueChanged, self.spin.lineEdit().textChanged):
            changed.connect(self._show_rate)
        self.spin.setValue(rate)
        self._show_rate()
        self.spin.setFocus()
        self.spin.selectAll()

    @property
    def rate(self) -> float:
        """The chosen rate."""
        return exact_rate(self.spin.value())

    def accept(self) -> None:
        """Close, if the number can be taken."""
        if may_accept(self):
            super().accept()

    def _common_rates(self) -> QHBoxLayout:
        row = QHBoxLayout()
        self.group = QButtonGroup(self)
        for rate in _SHOWN_RATES:
            button = QToolButton()
            button.setText(format_rate(rate).removesuffix(" fps"))
            button.setCheckable(True)
            button.setAccessibleName(format_rate(rate))
            button.clicked.connect(lambda _checked=False, chosen=rate: self._choose(chosen))
            self.group.addButton(button)
            row.addWidget(button)
        return row

    def _any_rate(self) -> QHBoxLayout:
        row = QHBoxLayout()
        label = QLabel("&Frames per second")
        self.spin = NumberBox()
        self.spin.setRange(_LOWEST, _HIGHEST)
        self.spin.setDecimals(_DECIMALS)
        self.spin.setAccessibleName("Frames per second")
        label.setBuddy(self.spin)
        row.addWidget(label)
        row.addWidget(self.spin)
        row.addStretch(1)
        return row

    def _choose(self, rate: float) -> None:
        self.spin.setValue(rate)
        self._show_rate()  # also if only what was typed was another

    def _show_rate(self) -> None:
        """Show how long the take would be; while no rate is typed, say so in place of that."""
        rate, wrong = self.rate, self.spin.why_not(self.spin.text())
        self.group.setExclusive(False)  # so that none can be checked
        for button, common in zip(self.group.buttons(), _SHOWN_RATES, strict=True):
            button.setChecked(not wrong and abs(common - rate) < 10**-_DECIMALS)
        self.group.setExclusive(True)
        length = format_time(self._frames / rate)
        self.length.setText("" if wrong else f"At {format_rate(rate)} the take lasts {length}.")
        self.length.setToolTip(counted(round(self._frames), "frame"))
        if wrong:
            show_refused(self.spin, wrong)
