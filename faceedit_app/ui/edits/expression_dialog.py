"""The slider from sad to smiling, previewed before it becomes an edit."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

from PySide6.QtCore import Qt, QTimer
from PySide6.QtWidgets import (
    QDialog,
    QDialogButtonBox,
    QHBoxLayout,
    QLabel,
    QSlider,
    QVBoxLayout,
    QWidget,
)

from faceedit_app.ui.look.icons import picture
from faceedit_app.ui.look.palette import ACCENT
from faceedit_app.ui.state.document import Document

if TYPE_CHECKING:
    from faceedit_app.editing.edits.edit import Edit

STRONGEST = 150
_LIVE_MS = 40
_LIVE_COST = 0.1  # seconds; slower answers wait for the end of the gesture


class ExpressionDialog(QDialog):
    """Sad on the left, smiling on the right; the face follows.

    Args:
        edits_of: the edits of the shipped preset with a given id, in the range that applies.
        where: that range in words.
        accepted_edits: called with the edits to make.
    """

    def __init__(
        self,
        parent: QWidget,
        document: Document,
        edits_of: Callable[[str], tuple[Edit, ...]],
        where: str,
        make: Callable[[tuple[Edit, ...]], None],
    ) -> None:
        super().__init__(parent)
        self._document, self._make = document, make
        self._sources = {name: edits_of(name) for name in ("smile", "sad_mouth")}
        self._cost = 0.0
        self.setWindowTitle("Smile or sad")
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.slider = QSlider(Qt.Orientation.Horizontal)
        self.slider.setRange(-STRONGEST, STRONGEST)
        self.slider.setPageStep(25)
        self.slider.setAccessibleName("From sad to smiling")
        self.slider.setMinimumWidth(320)
        self.words = QLabel()
        self.words.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self._timer = QTimer(self, singleShot=True, interval=_LIVE_MS)
        self._timer.timeout.connect(self._preview)
        self.slider.valueChanged.connect(self._moved)
        self.slider.sliderReleased.connect(self._preview)
        row = QHBoxLayout()
        for name, at in (("sad", 0), ("smile", 1)):
            sign = QLabel()
            sign.setPixmap(picture(name, ACCENT, 24, self.devicePixelRatioF()))
            row.insertWidget(at, sign)
        row.insertWidget(1, self.slider, 1)
        buttons = QDialogButtonBox(
            QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel
        )
        buttons.accepted.connect(self.accept)
        buttons.rejected.connect(self.reject)
        column = QVBoxLayout(self)
        column.addWidget(QLabel(f"How happy the mouth looks {where}:"))
        column.addLayout(row)
        column.addWidget(self.words)
        column.addWidget(buttons)
        self._moved(0)

    @property
    def edits(self) -> tuple[Edit, ...]:
        """The edits for the slider's value."""
        value = self.slider.value()
        source = self._sources["smile" if value > 0 else "sad_mouth"]
        strength = abs(value) / 100
        return tuple(replace(edit, strength=strength) for edit in source) if value else ()

    def _moved(self, value: int) -> None:
        self.words.setText("unchanged" if not value else f"{abs(value)} % {_word(value)}")
        if self._cost < _LIVE_COST or not self.slider.isSliderDown():
            self._timer.start()

    def _preview(self) -> None:
        began = time.perf_counter()
        self._timer.stop()
        self._document.preview(*self.edits)
        self._cost = time.perf_counter() - began

    def done(self, result: int) -> None:
        """Make the edits, or leave the take unchanged."""
        self._timer.stop()
        edits = self.edits
        if result == QDialog.DialogCode.Accepted and edits:
            self._make(edits)
        else:
            self._document.cancel()
        super().done(result)


def _word(value: int) -> str:
    return "smile" if value > 0 else "sad"
