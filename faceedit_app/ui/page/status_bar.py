"""The status bar: facts and remarks about the open take, and the state of the model."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QMouseEvent
from PySide6.QtWidgets import (
    QHBoxLayout,
    QLabel,
    QProgressBar,
    QPushButton,
    QSizePolicy,
    QStatusBar,
    QToolTip,
    QWidget,
)

from faceedit_app.formats.gaps import gap_notes
from faceedit_app.formats.take import Take
from faceedit_app.formats.timing import counted, format_rate, format_time
from faceedit_app.ui.look.texts import plain_label, plain_tip

_DOT = "   ·   "
_MESSAGE_MS = 6000
_READ = 60_000  # ms that a tooltip stays after a click, while the pointer does


class _Fact(QLabel):
    """A fact whose tooltip says more; a click shows it at once and for as long as it is read."""

    def __init__(self) -> None:
        super().__init__()
        self.setTextFormat(Qt.TextFormat.PlainText)

    def explain(self, tip: str) -> None:
        """Set the tooltip, and a pointer that shows that there is one."""
        self.setToolTip(tip)
        shape = Qt.CursorShape.PointingHandCursor if tip else Qt.CursorShape.ArrowCursor
        self.setCursor(shape)

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Take the click."""
        event.accept()

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """Show the tooltip. Pressing or releasing the mouse hides one that is there already."""
        place = event.globalPosition().toPoint()
        QToolTip.showText(place, self.toolTip(), self, self.rect(), _READ)


class StatusBar(QStatusBar):
    """Facts about the take on the left, the state of the model on the right.

    Signals:
        cancelled(): the user cancelled the computation.
    """

    cancelled = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.setSizeGripEnabled(False)
        self.facts, self.gaps, self.remarks, self.networks = (_Fact() for _ in range(4))
        about = QWidget()
        row = QHBoxLayout(about)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(0)  # the dots between them are all as far apart
        for label in (self.facts, self.gaps, self.remarks):
            row.addWidget(label)
        self.addWidget(about)
        self.live = plain_label()
        self.addPermanentWidget(self.live)
        self.work = self._work_display()
        self.addPermanentWidget(self.work)
        self.addPermanentWidget(self.networks)
        self.set_networks("loading")

    def say(self, text: str) -> None:
        """Show a message for some seconds."""
        self.showMessage(text, _MESSAGE_MS)

    def say_if_idle(self, text: str) -> None:
        """Show a message, unless another one, which matters more, is shown."""
        if not self.currentMessage():
            self.say(text)

    def retract(self, text: str) -> None:
        """Stop showing a message, if it is the one that is shown."""
        if self.currentMessage() == text:
            self.clearMessage()

    def set_take(self, take: Take) -> None:
        """Show facts about another take."""
        clip = take.clip
        parts = [
            take.format,
            format_rate(clip.rate),
            counted(len(clip), "frame"),
            format_time(clip.duration),
        ]
        self.facts.setText(_DOT.join(parts))
        self.facts.explain(plain_tip(str(take.path)))
        gaps = gap_notes(clip.gaps)
        others = [note for note in take.notes if note not in gaps]
        self._add(self.gaps, gaps[0] if gaps else "", take.notes)
        self._add(self.remarks, counted(len(others), "remark") if others else "", others)
        self.put_aside(False)
        _mark(self.gaps, True)

    def put_aside(self, on: bool) -> None:
        """Hide the facts while another take is read, or show them again."""
        for fact in (self.facts, self.gaps, self.remarks):
            fact.setVisible(bool(fact.text()) and not on)

    @staticmethod
    def _add(fact: _Fact, text: str, details: Sequence[str]) -> None:
        fact.setText(f"{_DOT.lstrip()}{text}" if text else "")  # a label has a margin of its own
        fact.explain(plain_tip("\n".join(details)))

    def _work_display(self) -> QWidget:
        display = QWidget()
        row = QHBoxLayout(display)
        row.setContentsMargins(0, 0, 0, 0)
        self.bar = QProgressBar()
        self.bar.setFixedWidth(140)
        self.bar.setFormat("Computing %p %")
        self.bar.setAccessibleName("Progress of the edit")
        cancel = QPushButton("Cancel")
        cancel.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Fixed)
        cancel.setFlat(True)
        cancel.setToolTip("Stop computing and undo this edit")
        cancel.clicked.connect(self.cancelled)
        row.addWidget(self.bar)
        row.addWidget(cancel)
        display.hide()
        return display

    def show_work(self, done: int = 0, total: int = 0) -> None:
        """Show how much of an edit has been computed, and nothing once it is done."""
        self.bar.setMaximum(max(total, 1))
        self.bar.setValue(done)
        self.work.setVisible(done < total)

    def set_live(self, text: str) -> None:
        """Show where the face is sent."""
        self.live.setText(text)
        _mark(self.live, bool(text))

    def set_networks(self, state: str, reason: str = "") -> None:
        """Show the state of the model, `loading`, `ready` or `missing`, and why."""
        texts = {
            "loading": "Loading the face model…",
            "ready": "",
            "missing": "No face model: edits look less natural",
        }
        self.networks.setText(texts[state])
        self.networks.explain(plain_tip(reason))
        _mark(self.networks, state == "missing")


def _mark(label: QLabel, attention: bool) -> None:
    """Have the style sheet highlight a label."""
    label.setProperty("attention", attention)
    label.style().unpolish(label)
    label.style().polish(label)
