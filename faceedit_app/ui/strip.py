"""The strip above the curves: undo, reset, and how edits are answered."""

from __future__ import annotations

import time
from dataclasses import replace

from PySide6.QtCore import QSignalBlocker, Qt, QTimer
from PySide6.QtWidgets import QLabel, QSizePolicy, QSlider, QWidget

from faceedit_app.formats.timing import counted
from faceedit_app.ui.actions import Actions
from faceedit_app.ui.document import Document
from faceedit_app.ui.theme import GAP
from faceedit_app.ui.widgets import bar_row, caption, divider, icon_button, segments

_LIVE_MS = 40  # a gesture on the slider is answered at most this often
_LIVE_COST = 0.1  # seconds; when an answer takes longer, it waits for the end of the gesture
_KEYS_MS = 500  # key presses closer together than this are one gesture

PRESERVE_TIP = (
    "Preserve the take: only what your edits reach changes,\n"
    "every other frame stays exactly as recorded."
)
RESYNTHESIZE_TIP = (
    "Resynthesize: the networks make the edited regions of the face anew\n"
    "from the eight curves, over the whole take; every frame changes a little."
)
NATURAL_TIP = (
    "How believable the answer to an edit must be.\n"
    "0 %: obey the curve to the letter. 100 %: stay within what real faces do."
)


class SettingsStrip(QWidget):
    """Undo, redo, reset; mode and naturalness; how much was edited."""

    def __init__(self, actions: Actions, document: Document) -> None:
        super().__init__()
        self._document, self._actions = document, actions
        actions["preserve"].setToolTip(PRESERVE_TIP)
        actions["resynthesize"].setToolTip(RESYNTHESIZE_TIP)
        self.natural = self._natural_slider()
        self.percent = QLabel()
        self.percent.setAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        self.percent.setMinimumWidth(self.percent.fontMetrics().horizontalAdvance("100 %"))
        self.edits = caption("")
        # In a narrow window it is cut off rather than the window widened.
        self.edits.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        self._stepped, self._pending, self._cost = False, False, 0.0
        self._live = QTimer(self, singleShot=True, interval=_LIVE_MS)
        self._live.timeout.connect(self._configure)
        self._gesture = QTimer(self, singleShot=True, interval=_KEYS_MS)
        self._gesture.timeout.connect(self._end_gesture)
        self._lay_out()
        document.opened.connect(self.sync)
        document.changed.connect(self.sync)
        self.sync()

    def _lay_out(self) -> None:
        row = bar_row(self, "bar")
        row.addWidget(icon_button(self._actions["open"]))
        row.addWidget(icon_button(self._actions["export"], text="Export"))
        row.addWidget(divider())
        row.addWidget(icon_button(self._actions["undo"]))
        row.addWidget(icon_button(self._actions["redo"]))
        row.addWidget(icon_button(self._actions["reset_range"], text="Reset range"))
        row.addWidget(divider())
        row.addSpacing(GAP // 2)
        row.addWidget(self.edits, 1)
        row.addWidget(
            segments(
                (self._actions["preserve"], "Preserve the take"),
                (self._actions["resynthesize"], "Resynthesize"),
            )
        )
        row.addSpacing(GAP * 2)
        row.addWidget(caption("Naturalness", self.natural))
        row.addSpacing(GAP // 2)
        row.addWidget(self.natural)
        row.addSpacing(GAP // 2)
        row.addWidget(self.percent)

    def _natural_slider(self) -> QSlider:
        slider = QSlider(Qt.Orientation.Horizontal)
        slider.setRange(0, 100)
        slider.setPageStep(10)
        slider.setFixedWidth(120)
        slider.setToolTip(NATURAL_TIP)
        # The mouse leaves the focus where it is, so that the arrows go on moving the playhead.
        slider.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        slider.valueChanged.connect(self._moved)
        slider.sliderReleased.connect(self._released)
        return slider

    # --- one undo step per gesture -----------------------------------------------------------

    def _moved(self, value: int) -> None:
        self.percent.setText(f"{value} %")
        self._pending = True
        affordable = self._cost < _LIVE_COST or not self.natural.isSliderDown()
        if affordable and not self._live.isActive():
            self._live.start()
        if not self.natural.isSliderDown():
            self._gesture.start()

    def _released(self) -> None:
        self.settle()

    def settle(self) -> None:
        """Bring a gesture on the slider to its end now."""
        self._live.stop()
        if self._pending:
            self._configure()
        self._end_gesture()

    def _configure(self) -> None:
        session, began = self._document.session, time.perf_counter()
        self._pending = False
        if session is not None:
            settings = replace(session.settings, naturalness=self.natural.value() / 100)
            self._stepped = self._document.configure(settings, replace_step=self._stepped)
        self._cost = time.perf_counter() - began

    def _end_gesture(self) -> None:
        self._gesture.stop()
        self._stepped = False

    # --- what it shows -----------------------------------------------------------------------

    def sync(self) -> None:
        """Show what the open take is answered by."""
        session = self._document.session
        self.natural.setEnabled(session is not None)
        self._actions["undo"].setEnabled(session is not None and session.can_undo)
        self._actions["redo"].setEnabled(session is not None and session.can_redo)
        has_edits = session is not None and bool(session.edits)
        for name in ("reset_range", "reset_curve"):
            self._actions[name].setEnabled(has_edits)
        resynthesizes = session is not None and session.settings.mode == "resynthesize"
        self._actions["preserve"].setChecked(not resynthesizes)
        self._actions["resynthesize"].setChecked(resynthesizes)
        naturalness = 100 if session is None else round(session.settings.naturalness * 100)
        if not (self._pending or self.natural.isSliderDown()):
            with QSignalBlocker(self.natural):
                self.natural.setValue(naturalness)
            self.percent.setText(f"{naturalness} %")
        self._count()

    def _count(self) -> None:
        session, text = self._document.session, ""
        if session is not None and not session.edits:
            text = "No edits"
        elif session is not None:
            frames = counted(session.changed_frames(), "frame")
            text = f"{counted(len(session.edits), 'edit')} · {frames} changed"
        self.edits.setText(text)
        self.edits.setToolTip(text)
