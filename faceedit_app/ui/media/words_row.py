"""The row of the words: a field to search them, a button, and the strip."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QPoint, Qt, Signal
from PySide6.QtGui import QFocusEvent, QKeyEvent
from PySide6.QtWidgets import QHBoxLayout, QLineEdit

from faceedit_app.ui.look.refused import show_refused
from faceedit_app.ui.look.widgets import context_menu, icon_button
from faceedit_app.ui.media.strip_row import StripRow
from faceedit_app.ui.media.words_strip import HEIGHT, WordsStrip
from faceedit_app.ui.state.actions import Actions
from faceedit_app.ui.state.document import Document
from faceedit_app.ui.state.timeline import Timeline
from faceedit_app.words.transcript import Transcript

_LONGEST = 30  # letters of what was searched, in the message that it was not found
_MENU = (
    ("play_around", "loop"),
    ("close_on_words", "shape_on_words", "say_clearly"),
    ("words", "match_sound", "remove_words"),
    ("tool_retime", "stretch_time", "move_time", "cut_time", "insert_pause"),
    ("cut_shorter", "insert_longer"),
)


class _Search(QLineEdit):
    """A field whose Esc gives the keys back to the curves.

    Signals:
        left(): it has lost the focus.
    """

    left = Signal()

    def focusOutEvent(self, event: QFocusEvent) -> None:
        """Say that it was left."""
        super().focusOutEvent(event)
        self.left.emit()

    def event(self, event: QEvent) -> bool:
        """While typing, Esc is not a shortcut."""
        if (
            event.type() == QEvent.Type.ShortcutOverride
            and isinstance(event, QKeyEvent)
            and event.key() == Qt.Key.Key_Escape
        ):
            event.accept()
            return True
        return super().event(event)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Esc leaves the field."""
        if event.key() == Qt.Key.Key_Escape:
            self.window().setFocus()
        else:
            super().keyPressEvent(event)


class WordsRow(StripRow):
    """Under the waveform, aligned with the plots; hidden unless the take has words."""

    def __init__(self, actions: Actions, document: Document, timeline: Timeline) -> None:
        self.strip = WordsStrip(document, timeline)
        super().__init__(self.strip, HEIGHT)
        self._actions = actions
        self._shown: Transcript | None = None
        self.strip.menu_asked.connect(self._show_menu)
        self.search = _Search()
        self.search.setObjectName("find_word")
        self.search.setPlaceholderText("Find a word")
        self.search.setAccessibleName("Find a word")
        self.search.setToolTip(
            "Type the beginning of a word; Enter selects it, then the next one; Esc leaves."
        )
        self.search.setClearButtonEnabled(True)
        self.search.setFocusPolicy(Qt.FocusPolicy.ClickFocus)  # the keys belong to the curves
        self.search.setAcceptDrops(False)  # dropped files go to the window
        self.search.returnPressed.connect(self._find)
        for news in (self.search.textEdited, self.search.left):
            news.connect(lambda: show_refused(self.search, ""))
        line = QHBoxLayout(self.head)
        line.setContentsMargins(8, 2, 4, 2)
        line.setSpacing(2)
        line.addWidget(self.search, 1)
        line.addWidget(icon_button(actions["close_on_words"], "small"))
        for changed in (document.opened, document.changed, document.previewed):
            changed.connect(self.sync)
        self.sync()

    def sync(self) -> None:
        """Show the take's words, or hide; a drag of a curve leaves them as they are."""
        words = self.strip.words
        if words is self._shown:
            return
        self._shown = words
        self.want(words is not None)
        self.strip.renew()

    def _show_menu(self, place: QPoint) -> None:
        self._actions.refresh()
        groups = [[self._actions[name] for name in group] for group in _MENU]
        context_menu(self, *groups).popup(place)

    def _find(self) -> None:
        """Select the next word with this beginning, or say that there is none."""
        text = self.search.text().strip()
        why = f"No word begins with “{text[:_LONGEST]}”" if text else "Type the beginning of a word"
        show_refused(self.search, "" if self.strip.find(text) else why)
