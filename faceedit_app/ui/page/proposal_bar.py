"""The bar that shows a proposed fix before it is accepted."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QFrame, QHBoxLayout

from faceedit_app.editing.edits.edit import Edit
from faceedit_app.ui.look.theme import GAP, MARGIN
from faceedit_app.ui.look.widgets import Elided, icon_button
from faceedit_app.ui.state.actions import Actions
from faceedit_app.ui.state.document import Document


class ProposalBar(QFrame):
    """Curves and face show what is proposed; any other gesture drops it.

    Signals:
        toggled(): something is proposed, or no longer.
    """

    toggled = Signal()

    def __init__(self, actions: Actions, document: Document) -> None:
        super().__init__()
        self._document = document
        self._showing = False  # what is previewed now is ours
        self._name = ""
        self.setObjectName("proposal")
        self.text = Elided()
        row = QHBoxLayout(self)
        row.setContentsMargins(MARGIN, 4, MARGIN, 4)
        row.setSpacing(GAP // 2)
        row.addWidget(self.text, 1)
        row.addWidget(icon_button(actions["accept_fix"], "accept", "Accept"))
        row.addWidget(icon_button(actions["discard_fix"], "tool", "Discard"))
        document.previewed.connect(self._other)
        document.changed.connect(self._changed)
        document.opened.connect(self._close)
        self._close()

    @property
    def is_open(self) -> bool:
        """Whether something is proposed."""
        return not self.isHidden()

    def offer(self, text: str, edits: Sequence[Edit], name: str) -> None:
        """Show edits as if they were made; `name` is that of the step, should it be accepted."""
        self.discard()
        self._name = name
        self.text.setText(text)
        self.text.setToolTip(text)
        self._show(True)
        self._showing = True
        self._document.preview(*edits)
        self._showing = False

    def accept(self) -> None:
        """Make them: one step."""
        if self.is_open:
            self._close()
            self._document.commit(self._name)

    def discard(self) -> bool:
        """Drop them; False if nothing was proposed."""
        if not self.is_open:
            return False
        self._close()
        self._document.cancel()
        return True

    def _other(self) -> None:
        if self.is_open and not self._showing:
            self._close()

    def _changed(self) -> None:
        """What lies below it is another: a proposal must not stay without its bar."""
        if self.is_open:
            self.discard()

    def _close(self) -> None:
        self._show(False)

    def _show(self, is_open: bool) -> None:
        self.setVisible(is_open)
        self.toggled.emit()
