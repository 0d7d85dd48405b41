"""Which edits were chosen when Undo took them away."""

from __future__ import annotations

from collections.abc import Sequence

from faceedit_app.editing.edits.edit import Edit
from faceedit_app.ui.state.document import Document

_Choice = tuple[Sequence[Edit], list[int]]  # all edits, and the chosen rows


class UndoneChoice:
    """Remembers the chosen edits that Undo took away, to choose them when Redo brings them back.

    They are forgotten as soon as the user chooses other edits, or opens another take.
    """

    def __init__(self, document: Document) -> None:
        self._document = document
        self._now: _Choice = (), []
        self._gone: _Choice = (), []  # before Undo
        document.opened.connect(self._forget)

    def note(self, edits: Sequence[Edit], rows: list[int]) -> None:
        """These rows are chosen now."""
        self._now = edits, rows
        if rows:
            self._forget()

    def lose(self) -> None:
        """What is chosen is gone, if anything is; another step than Undo leaves nothing to redo."""
        session = self._document.session
        if self._now[1] and session is not None and session.can_redo:
            self._gone = self._now

    def back(self, edits: Sequence[Edit]) -> list[int]:
        """The rows that were chosen when there were the same edits before; empty if none."""
        before, rows = self._gone
        return rows if tuple(edits) == tuple(before) else []

    def _forget(self) -> None:
        self._gone = (), []
