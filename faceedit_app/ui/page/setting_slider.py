"""A slider for one of the numbers that all edits are answered by."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import Literal

from PySide6.QtCore import QObject, QSignalBlocker, Qt, QTimer
from PySide6.QtWidgets import QLabel, QSlider

from faceedit_app.ui.state.document import Document

_LIVE_MS = 40  # a gesture on the slider is answered at most this often
_LIVE_COST = 0.1  # seconds; when an answer takes longer, it waits for the end of the gesture
_KEYS_MS = 500  # key presses closer together than this are one gesture


class SettingSlider(QObject):
    """0 to 100 %; a gesture on it is one undo step.

    Args:
        document: whose settings it changes.
        setting: which of them.
        tip: what it does, for the tooltip.

    Attributes:
        cost: seconds that the last answer took.
    """

    def __init__(
        self, document: Document, setting: Literal["naturalness", "reach"], tip: str
    ) -> None:
        super().__init__()
        self._document, self._setting = document, setting
        self.slider = QSlider(Qt.Orientation.Horizontal)
        self.slider.setRange(0, 100)
        self.slider.setPageStep(10)
        self.slider.setFixedWidth(88)
        self.slider.setToolTip(tip)
        # The mouse leaves the focus where it is, so that the arrows go on moving the playhead.
        self.slider.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.slider.valueChanged.connect(self._moved)
        self.slider.sliderReleased.connect(self.settle)
        self.percent = QLabel()
        self.percent.setAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        self.percent.setMinimumWidth(self.percent.fontMetrics().horizontalAdvance("100 %"))
        self._stepped, self._pending, self.cost = False, False, 0.0
        self._live = QTimer(self, singleShot=True, interval=_LIVE_MS)
        self._live.timeout.connect(self._configure)
        self._gesture = QTimer(self, singleShot=True, interval=_KEYS_MS)
        self._gesture.timeout.connect(self._end_gesture)

    def _moved(self, value: int) -> None:
        self.percent.setText(f"{value} %")
        self._pending = True
        affordable = self.cost < _LIVE_COST or not self.slider.isSliderDown()
        if affordable and not self._live.isActive():
            self._live.start()
        if not self.slider.isSliderDown():
            self._gesture.start()

    def settle(self) -> None:
        """Bring a gesture on the slider to its end now."""
        self._live.stop()
        if self._pending:
            self._configure()
        self._end_gesture()

    def _configure(self) -> None:
        session, began = self._document.session, time.perf_counter()
        self._pending = False
        if session is None:
            return
        share = self.slider.value() / 100
        if self._setting == "reach":
            settings = replace(session.settings, reach=share)
        else:
            settings = replace(session.settings, naturalness=share)
        self._stepped = self._document.configure(settings, replace_step=self._stepped)
        self.cost = time.perf_counter() - began

    def _end_gesture(self) -> None:
        self._gesture.stop()
        self._stepped = False

    def sync(self) -> None:
        """Show what the open take is answered by."""
        session = self._document.session
        self.slider.setEnabled(session is not None)
        percent = 100 if session is None else round(100 * getattr(session.settings, self._setting))
        if not (self._pending or self.slider.isSliderDown()):
            with QSignalBlocker(self.slider):
                self.slider.setValue(percent)
            self.percent.setText(f"{percent} %")
