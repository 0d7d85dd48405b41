"""What the window shows while no take is open."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import (
    QFrame,
    QHBoxLayout,
    QLabel,
    QProgressBar,
    QPushButton,
    QStackedLayout,
    QVBoxLayout,
    QWidget,
)

from faceedit_app.ui.look.icons import picture
from faceedit_app.ui.look.palette import ACCENT
from faceedit_app.ui.look.texts import name_entry, plain_label, plain_tip
from faceedit_app.ui.look.theme import GAP
from faceedit_app.ui.state.actions import Actions, shown_keys

_RECENT_SHOWN = 4


class StartPage(QWidget):
    """Invites to open a take, try the demo or drop a file; lists recent takes.

    Signals:
        chosen(Path): a recent take was clicked.
    """

    chosen = Signal(object)

    def __init__(self, actions: Actions) -> None:
        super().__init__()
        self.loading = plain_label()
        self.loading.setObjectName("lead")
        self.loading.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self._drop = QFrame()
        self._drop.setObjectName("drop")
        self._recent = QVBoxLayout()
        self._recent.setSpacing(0)
        self._fill(actions)
        self._pages = QStackedLayout(self)
        self._pages.addWidget(self._centered(self._drop))
        self._pages.addWidget(self._loading_page())

    def _loading_page(self) -> QWidget:
        page, bar = QWidget(), QProgressBar()
        bar.setRange(0, 0)  # how long it takes is not known
        bar.setTextVisible(False)
        bar.setFixedSize(220, 6)
        bar.setAccessibleName("Opening")
        column = QVBoxLayout(page)
        column.addStretch()
        column.addWidget(self.loading)
        column.addSpacing(GAP)
        column.addWidget(bar, 0, Qt.AlignmentFlag.AlignCenter)
        column.addStretch()
        return page

    def _fill(self, actions: Actions) -> None:
        sign = QLabel()
        sign.setPixmap(picture("drop", ACCENT, 56, self.devicePixelRatioF()))
        title = QLabel("Open a tracked face")
        title.setObjectName("title")
        lead = QLabel(
            "Drop a Live Link Face CSV or a film of a face here, or choose one.\n"
            "Then drag its curves: the face follows, and the rest stays as it was."
        )
        lead.setObjectName("lead")
        for label in (sign, title, lead):
            label.setAlignment(Qt.AlignmentFlag.AlignCenter)
        open_button = QPushButton(f"Open…   {shown_keys('Ctrl+O')}")
        open_button.setObjectName("primary")
        open_button.clicked.connect(actions["open"].trigger)
        track = QPushButton("Track a film…")
        track.clicked.connect(actions["track_film"].trigger)
        demo = QPushButton("Open the demo take")
        demo.clicked.connect(actions["open_demo"].trigger)
        for button in (track, demo):
            button.setObjectName("secondary")
        for button in (open_button, track, demo):
            button.setAutoDefault(True)  # Enter presses it; Space belongs to the transport
        buttons = QHBoxLayout()
        buttons.setSpacing(GAP)
        buttons.addStretch()
        for button in (open_button, track, demo):
            buttons.addWidget(button)
        buttons.addStretch()
        column = QVBoxLayout(self._drop)
        column.setContentsMargins(56, 44, 56, 36)
        column.setSpacing(GAP * 2)
        column.addWidget(sign)
        column.addWidget(title)
        column.addWidget(lead)
        column.addSpacing(GAP)
        column.addLayout(buttons)
        column.addLayout(self._recent)

    @staticmethod
    def _centered(card: QWidget) -> QWidget:
        page = QWidget()
        row = QHBoxLayout(page)
        row.addWidget(card, 0, Qt.AlignmentFlag.AlignCenter)
        return page

    def show_recent(self, takes: list[Path]) -> None:
        """List recent takes."""
        while (item := self._recent.takeAt(0)) is not None:
            if (widget := item.widget()) is not None:
                widget.deleteLater()
        if takes:
            heading = QLabel("Recent")
            heading.setObjectName("caption")
            self._recent.addSpacing(GAP)
            self._recent.addWidget(heading)
        for path in takes[:_RECENT_SHOWN]:
            button = QPushButton(name_entry(path.name))
            button.setObjectName("link")
            button.setToolTip(plain_tip(str(path)))
            button.setAutoDefault(True)
            button.clicked.connect(lambda _checked=False, p=path: self.chosen.emit(p))
            self._recent.addWidget(button, 0, Qt.AlignmentFlag.AlignLeft)

    def show_loading(self, text: str | None) -> None:
        """Show what is being opened; None shows the invitation again."""
        self.loading.setText(text or "")
        self._pages.setCurrentIndex(0 if text is None else 1)

    def show_drop(self, active: bool) -> None:
        """Highlight the card while a file hovers over the window."""
        self._drop.setProperty("active", active)
        self._drop.style().unpolish(self._drop)
        self._drop.style().polish(self._drop)
