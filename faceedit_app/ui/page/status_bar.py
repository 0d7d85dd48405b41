"""The status bar: facts and remarks about the open take, and the state of the model."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import Signal
from PySide6.QtWidgets import (
    QHBoxLayout,
    QLabel,
    QProgressBar,
    QPushButton,
    QSizePolicy,
    QStatusBar,
    QWidget,
)

from faceedit_app.formats.gaps import gap_notes
from faceedit_app.formats.take import Take
from faceedit_app.formats.timing import counted, format_rate, format_time
from faceedit_app.ui.look.texts import plain_label, plain_tip

_DOT = "   ·   "


class StatusBar(QStatusBar):
    """Facts about the take on the left, the state of the model on the right.

    Signals:
        cancelled(): the user cancelled the computation.
    """

    cancelled = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.setSizeGripEnabled(False)
        self.facts, self.gaps, self.remarks, self.networks = (plain_label() for _ in range(4))
        for label in (self.facts, self.gaps, self.remarks):
            self.addWidget(label)
        self.live = plain_label()
        self.addPermanentWidget(self.live)
        self.work = self._work_display()
        self.addPermanentWidget(self.work)
        self.addPermanentWidget(self.networks)
        self.set_networks("loading")

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
        self.facts.setToolTip(plain_tip(str(take.path)))
        gaps = gap_notes(clip.gaps)
        others = [note for note in take.notes if note not in gaps]
        self._add(self.gaps, gaps[0] if gaps else "", take.notes)
        self._add(self.remarks, counted(len(others), "remark") if others else "", others)
        _mark(self.gaps, True)

    @staticmethod
    def _add(label: QLabel, text: str, details: Sequence[str]) -> None:
        label.setText(f" ·   {text}" if text else "")
        label.setToolTip(plain_tip("\n".join(details)))

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
        self.networks.setToolTip(plain_tip(reason))
        _mark(self.networks, state == "missing")


def _mark(label: QLabel, attention: bool) -> None:
    """Have the style sheet highlight a label."""
    label.setProperty("attention", attention)
    label.style().unpolish(label)
    label.style().polish(label)
