"""The bar to accept or discard a proposal."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QFrame, QHBoxLayout, QLabel

from faceedit_app.editing.edits.edit import Edit
from faceedit_app.editing.help.problems import Problem
from faceedit_app.ui.look.texts import plain_tip
from faceedit_app.ui.look.theme import GAP, MARGIN
from faceedit_app.ui.look.widgets import Elided, icon_button
from faceedit_app.ui.page.fix_trials import FixTrials
from faceedit_app.ui.state.actions import Actions
from faceedit_app.ui.state.document import Document


class ProposalBar(QFrame):
    """Curves and face preview the proposal; any other gesture discards it.

    Attributes:
        problem: the one that it fixes, if it is for a single one.
        is_for_all: whether it fixes the problems that are ticked in the list.
        variation: which of its `variations` is shown, from 0.
        waits: whether it was accepted, and is made when its fixes have been tried.

    Signals:
        toggled(): a proposal was shown or closed.
        dropped(str): nothing of what was accepted is left, and why.
    """

    toggled = Signal()
    dropped = Signal(str)

    def __init__(self, actions: Actions, document: Document) -> None:
        super().__init__()
        self._document = document
        self._showing = False  # the current preview is the proposal
        self._name = ""
        self.problem: Problem | None = None
        self.is_for_all = self.waits = False
        self.variation = 0
        self._variations: tuple[tuple[Edit, ...], ...] = ()
        self.setObjectName("proposal")
        self.text, self.count = Elided(), QLabel()
        row = QHBoxLayout(self)
        row.setContentsMargins(MARGIN, 1, GAP // 2, 1)
        row.setSpacing(GAP // 2)
        row.addWidget(self.text, 1)
        self._steps = (
            icon_button(actions["previous_variation"], "proposal_button", repeats=True),
            self.count,
            icon_button(actions["next_variation"], "proposal_button", repeats=True),
        )
        for step in self._steps:
            row.addWidget(step)
        accept = icon_button(actions["accept_fix"], "accept", "Accept")
        row.addWidget(accept)
        row.addWidget(icon_button(actions["discard_fix"], "proposal_button", "Discard"))
        document.previewed.connect(self._other)
        document.changed.connect(self._changed)
        document.opened.connect(self._close)
        self._close()

    @property
    def is_open(self) -> bool:
        """Whether there is a proposal."""
        return not self.isHidden()

    def offer(
        self,
        text: str,
        edits: Sequence[Edit],
        name: str,
        problem: Problem | None = None,
        *,
        short: str = "",
        variations: Sequence[Sequence[Edit]] = (),
    ) -> None:
        """Preview edits.

        Args:
            text: says what is proposed.
            edits: the proposal.
            name: of the step if they are accepted.
            problem: the one that they fix; None = all that are ticked, or none if there are
                variations.
            short: shown in place of a text that does not fit; the tooltip has all of it.
            variations: other edits for the same, which the user can step through; the first
                replaces `edits`.
        """
        wanted = tuple(map(tuple, variations)) or (tuple(edits),)
        is_shown = self.is_open and self.is_for_all and wanted == self._variations
        if not is_shown:
            self.discard()
        self._name, self.problem = name, problem
        self.is_for_all = problem is None and not variations
        self._variations = wanted
        self._say(text, short)
        for step in self._steps:
            step.setVisible(len(self._variations) > 1)
        if not is_shown:
            self._show(True)
            self.vary(0)

    @property
    def has_variations(self) -> bool:
        """Whether there is more than one proposal to choose from."""
        return self.is_open and len(self._variations) > 1

    def vary(self, to: int) -> None:
        """Preview a variation, counted from 0; after the last comes the first."""
        self.variation = to % len(self._variations)
        self.count.setText(f"{self.variation + 1} of {len(self._variations)}")
        self._showing = True
        self._document.preview(*self._variations[self.variation])
        self._showing = False

    def waits_for(self, trials: FixTrials) -> bool:
        """Whether what is accepted now has to wait until it is known which fixes stay ticked."""
        self.waits = self.is_open and self.is_for_all and trials.is_trying
        if self.waits:
            self._say(
                "Trying the fixes… Those that make no other problem are made after that;"
                " Esc discards them.",
                "Trying the fixes…",
            )
        return self.waits

    def accept(self) -> None:
        """Make the proposed edits as one step."""
        if self.is_open:
            self._close()
            self._document.commit(self._name)

    def discard(self) -> bool:
        """Drop the proposed edits; False if there are none."""
        if not self.is_open:
            return False
        self._close()
        self._document.cancel()
        return True

    def _other(self) -> None:
        if self.is_open and not self._showing:
            self._close()

    def _changed(self) -> None:
        """The take changed under the proposal: close the bar with it."""
        if self.is_open:
            self.discard()

    def _say(self, text: str, short: str) -> None:
        self.text.short = short
        self.text.setText(text)
        self.text.setToolTip(plain_tip(text))

    def _close(self) -> None:
        self.waits = False
        self._show(False)

    def _show(self, is_open: bool) -> None:
        self.setVisible(is_open)
        self.toggled.emit()
