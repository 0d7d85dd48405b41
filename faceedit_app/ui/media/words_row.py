"""The row of the words: a field to search them, a button, and the strip."""

from __future__ import annotations

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QHBoxLayout, QLineEdit, QWidget

from faceedit_app.ui.curves import style
from faceedit_app.ui.look.widgets import icon_button
from faceedit_app.ui.media.words_strip import HEIGHT, WordsStrip
from faceedit_app.ui.state.actions import Actions
from faceedit_app.ui.state.document import Document
from faceedit_app.ui.state.timeline import Timeline


class WordsRow(QWidget):
    """Under the waveform, aligned with the plots; hidden unless the take has words."""

    def __init__(self, actions: Actions, document: Document, timeline: Timeline) -> None:
        super().__init__()
        self._document = document
        self.strip = WordsStrip(document, timeline)
        self.search = QLineEdit()
        self.search.setObjectName("find_word")
        self.search.setPlaceholderText("Find a word")
        self.search.setAccessibleName("Find a word")
        self.search.setToolTip("Type the beginning of a word; Enter selects it, then the next one.")
        self.search.setClearButtonEnabled(True)
        self.search.setFocusPolicy(Qt.FocusPolicy.ClickFocus)  # the keys belong to the curves
        self.search.setAcceptDrops(False)  # dropped files go to the window
        self.search.returnPressed.connect(self._find)
        self.search.textEdited.connect(lambda _text: self._show_found(True))
        head = QWidget()
        head.setObjectName("sound_head")
        head.setAttribute(Qt.WidgetAttribute.WA_StyledBackground)
        head.setFixedWidth(style.HEADER_WIDTH)
        line = QHBoxLayout(head)
        line.setContentsMargins(8, 2, 4, 2)
        line.setSpacing(2)
        line.addWidget(self.search, 1)
        line.addWidget(icon_button(actions["close_on_words"], "small"))
        row = QHBoxLayout(self)
        row.setContentsMargins(0, style.ROW_GAP, style.RIGHT_MARGIN, style.ROW_GAP)
        row.setSpacing(0)
        row.addWidget(head)
        row.addWidget(self.strip, 1)
        self.setFixedHeight(HEIGHT + 2 * style.ROW_GAP)
        self.setObjectName("words_row")
        for changed in (document.opened, document.changed, document.previewed):
            changed.connect(self.sync)
        self.sync()

    def sync(self) -> None:
        """Show the take's words, or hide."""
        has_words = self.strip.words is not None
        if self.isHidden() == has_words:
            self.setVisible(has_words)
        if has_words:
            self.strip.renew()

    def _find(self) -> None:
        self._show_found(self.strip.find(self.search.text()))

    def _show_found(self, found: bool) -> None:
        """Show in the field whether the word was found."""
        self.search.setStyleSheet("" if found else f"color: {style.GAP}")
