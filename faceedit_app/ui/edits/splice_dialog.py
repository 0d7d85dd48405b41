"""What is asked before a shorter or longer copy of the take is written."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import Qt
from PySide6.QtWidgets import (
    QCheckBox,
    QDialog,
    QDialogButtonBox,
    QFormLayout,
    QVBoxLayout,
    QWidget,
)

from faceedit_app.ui.look.number import NumberBox, may_accept
from faceedit_app.ui.look.texts import plain_label

_WIDTH = 400  # pixels of the text


class SpliceDialog(QDialog):
    """Says what is written, and asks how much time is inserted.

    Args:
        title: of the window.
        text: what is cut out or inserted, and where.
        seconds: at first and at most, of time to insert; None = nothing is asked.
        unit: in which they are typed, and how many of it are a second.
        media: what the take has: "sound", "film", both or neither.
        make: called with the seconds, and whether the film is written.
    """

    def __init__(
        self,
        parent: QWidget,
        title: str,
        text: str,
        seconds: tuple[float, float] | None,
        unit: tuple[str, float],
        media: tuple[str, ...],
        make: Callable[[float, bool], None],
    ) -> None:
        super().__init__(parent)
        self._make = make
        name, self._per_second = unit
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.setWindowTitle(title)
        with_it = f", and with it its {' and '.join(media)}" if media else ""
        label = plain_label()
        label.setText(
            f"{text}\n\nA new take is written as you see it{with_it}. "
            "The take that is open stays as it is."
        )
        label.setWordWrap(True)
        label.setMinimumWidth(_WIDTH)
        self.number = NumberBox()
        self.number.setDecimals(2 if name == "s" else 1)
        self.number.setSuffix(f" {name}")
        self.number.setSingleStep(0.1 if name == "s" else 1.0)
        self.number.setAccessibleName("Time")
        self.film = QCheckBox("Write the &film too; this takes a while")
        self.film.setChecked(True)
        self.film.setVisible("film" in media)
        form = QFormLayout()
        if seconds is not None:
            self.number.setRange(0.02 * self._per_second, seconds[1] * self._per_second)
            self.number.setValue(seconds[0] * self._per_second)
            self.number.selectAll()
            form.addRow("&Time", self.number)
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Cancel)
        self.write = buttons.addButton("&Write…", QDialogButtonBox.ButtonRole.AcceptRole)
        self.write.setDefault(True)
        buttons.accepted.connect(self.accept)
        buttons.rejected.connect(self.reject)
        column = QVBoxLayout(self)
        column.setSpacing(10)
        column.addWidget(label)
        column.addLayout(form)
        column.addWidget(self.film)
        column.addWidget(buttons)

    def accept(self) -> None:
        """Close, and write, if the time can be taken."""
        if not may_accept(self):
            return
        super().accept()
        self._make(self.number.value() / self._per_second, self.film.isChecked())
