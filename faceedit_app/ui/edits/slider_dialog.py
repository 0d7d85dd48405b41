"""A slider between two opposite sets of edits, previewed before they are made."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from PySide6.QtCore import Qt, QTimer
from PySide6.QtWidgets import (
    QDialog,
    QDialogButtonBox,
    QHBoxLayout,
    QLabel,
    QVBoxLayout,
    QWidget,
)

from faceedit_app.ui.edits.preview_dialog import PreviewDialog
from faceedit_app.ui.look.gesture_slider import Slider
from faceedit_app.ui.look.icons import picture
from faceedit_app.ui.look.palette import ACCENT
from faceedit_app.ui.state.document import Document

if TYPE_CHECKING:
    from faceedit_app.editing.edits.edit import Edit

STRONGEST = 150
_LIVE_MS = 40
_LIVE_COST = 0.1  # seconds; slower answers wait for the end of the gesture


@dataclass(frozen=True)
class End:
    """One end of the slider.

    Attributes:
        word: what its value is called, as in “40 % smile”.
        icon: name of the icon beside it.
        edits: at 100 %.
    """

    word: str
    icon: str
    edits: tuple[Edit, ...]


class SliderDialog(PreviewDialog):
    """The face follows the slider; OK makes the edits.

    Args:
        title: of the window, such as “Smile or sad”.
        question: above the slider.
        left, right: what its ends do.
        make: called with the edits to make.
    """

    def __init__(
        self,
        parent: QWidget,
        document: Document,
        title: str,
        question: str,
        left: End,
        right: End,
        make: Callable[[tuple[Edit, ...]], None],
    ) -> None:
        super().__init__(parent, document)
        self._make = make
        self._left, self._right = left, right
        self._cost = 0.0
        self.setWindowTitle(title)
        self.slider = Slider(-STRONGEST, STRONGEST, start=0, page=25)
        self.slider.setAccessibleName(title)
        self.slider.setMinimumWidth(320)
        self.words = QLabel()
        self.words.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self._timer = QTimer(self, singleShot=True, interval=_LIVE_MS)
        self._timer.timeout.connect(self.preview)
        self.slider.valueChanged.connect(self._moved)
        self.slider.sliderReleased.connect(self.preview)
        row = QHBoxLayout()
        for end, at in ((left, 0), (right, 1)):
            sign = QLabel()
            sign.setPixmap(picture(end.icon, ACCENT, 24, self.devicePixelRatioF()))
            row.insertWidget(at, sign)
        row.insertWidget(1, self.slider, 1)
        buttons = QDialogButtonBox(
            QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel
        )
        buttons.accepted.connect(self.accept)
        buttons.rejected.connect(self.reject)
        column = QVBoxLayout(self)
        column.addWidget(QLabel(question))
        column.addLayout(row)
        column.addWidget(self.words)
        column.addWidget(buttons)
        self._moved(0)

    @property
    def edits(self) -> tuple[Edit, ...]:
        """The edits for the slider's value."""
        value = self.slider.value()
        strength = abs(value) / 100
        source = self._end(value).edits
        return tuple(replace(edit, strength=strength) for edit in source) if value else ()

    def _end(self, value: int) -> End:
        return self._right if value > 0 else self._left

    def _moved(self, value: int) -> None:
        self.words.setText("unchanged" if not value else f"{abs(value)} % {self._end(value).word}")
        if self._cost < _LIVE_COST or not self.slider.isSliderDown():
            self._timer.start()

    def preview(self) -> None:
        """Show the face at the slider's value."""
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
