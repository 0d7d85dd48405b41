"""The slider from natural to exact, which applies to all edits."""

from __future__ import annotations

import time

from PySide6.QtCore import QObject, QSignalBlocker, QTimer

from faceedit_app.editing.edits.settings import Settings
from faceedit_app.ui.look.gesture_slider import GestureSlider
from faceedit_app.ui.state.document import Document

_LIVE_MS = 40  # least time between two previews of a drag
NAME = "Natural to exact"
_LIVE_COST = 0.1  # seconds; slower answers wait for the release


class SettingSlider(QObject):
    """`Settings.exactness`; a drag is one step, and so is a run of keys or wheel ticks.

    Args:
        document: whose settings it changes.
        tip: the tooltip.

    Attributes:
        cost: seconds that the last preview took.
    """

    def __init__(self, document: Document, tip: str) -> None:
        super().__init__()
        self._document = document
        self.slider = GestureSlider(0, 100, 100, start=self._percent_of(Settings()))
        self.slider.setToolTip(tip)
        self.slider.dragged.connect(self._dragged)
        self.slider.sliderReleased.connect(self._released)
        self.slider.stepped.connect(self._stepped)
        self.slider.left.connect(document.seal)
        self._is_dragged, self.cost = False, 0.0
        self._live = QTimer(self, singleShot=True, interval=_LIVE_MS)
        self._live.timeout.connect(self._preview)

    def _dragged(self) -> None:
        self._is_dragged = True
        if self.cost < _LIVE_COST and not self._live.isActive():
            self._live.start()

    def _preview(self) -> None:
        began = time.perf_counter()
        self._document.act(lambda session: session.preview_settings(self._wanted(session.settings)))
        self.cost = time.perf_counter() - began

    def settle(self) -> None:
        """Commit the drag."""
        self._live.stop()
        if self._is_dragged:
            self._is_dragged = False
            self._preview()
            self._document.commit(NAME)

    def cancel(self) -> bool:
        """Drop the drag in progress; False if there is none."""
        if not self._is_dragged:
            return False
        self._live.stop()
        self._is_dragged = False
        self.slider.cancel_drag()
        self._document.cancel()
        self.sync()
        return True

    def _released(self) -> None:
        self.settle()
        self.sync()

    def _stepped(self) -> None:
        self._document.act(lambda session: session.configure(self._wanted(session.settings), NAME))

    def _wanted(self, settings: Settings) -> Settings:
        """The settings at the slider's place; unchanged if it shows the same place."""
        percent = self.slider.value()
        if percent == self._percent_of(settings):
            return settings
        return settings.with_exactness(percent / 100)

    @staticmethod
    def _percent_of(settings: Settings) -> int:
        return round(100 * settings.exactness)

    def sync(self) -> None:
        """Show the open take's setting."""
        session = self._document.session
        self.slider.setEnabled(session is not None)
        if self._is_dragged or self.slider.isSliderDown():
            return
        settings = Settings() if session is None else session.settings
        with QSignalBlocker(self.slider):
            self.slider.setValue(self._percent_of(settings))
