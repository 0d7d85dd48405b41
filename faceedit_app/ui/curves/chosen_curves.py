"""The curves that are chosen by their names, to be edited together."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from faceedit_app.core.controls import CONTROL_IDS
from faceedit_app.ui.curves.header import Header
from faceedit_app.ui.curves.interaction import Interaction


class ChosenCurves:
    """Clicks on names choose curves.

    A plain click chooses none, but its curve is the first of those that Ctrl+clicks then choose, as
    in other lists, unless something else has got the focus meanwhile.
    """

    def __init__(
        self, headers: Sequence[Header], mouse: Interaction, changed: Callable[[], None]
    ) -> None:
        """
        Args:
            headers: the names, which show it.
            mouse: edits the chosen curves.
            changed: called when others are chosen.
        """
        self._headers, self._mouse, self._changed = headers, mouse, changed
        self._clicked: frozenset[str] = frozenset()  # the curve whose name was clicked without Ctrl

    @property
    def controls(self) -> tuple[str, ...]:
        """The ids of the chosen curves, in order."""
        return tuple(control for control in CONTROL_IDS if control in self._mouse.chosen)

    def pick(self, control: str, add: bool) -> None:
        """The name of a curve was clicked; with Ctrl, to choose it as well or to remove it."""
        if add:
            self.toggle(control, self._clicked - {control})
        else:
            self._choose(frozenset())
            self._clicked = frozenset((control,))

    def toggle(self, control: str, before: frozenset[str] = frozenset()) -> None:
        """Choose a curve, or remove it from the chosen ones; `before` if none is chosen."""
        self._choose((self._mouse.chosen or before) ^ {control})

    def keep(self, shown: frozenset[str]) -> None:
        """Choose no curve that is not among these."""
        self._choose(self._mouse.chosen & shown)

    def leave(self, control: str) -> None:
        """A curve has lost the focus: if its name was clicked, that no longer counts."""
        self._clicked -= {control}

    def forget_click(self) -> None:
        """Whichever name was clicked, that no longer counts."""
        self._clicked = frozenset()

    def _choose(self, chosen: frozenset[str]) -> None:
        self._mouse.chosen = chosen
        self.forget_click()
        for header in self._headers:
            header.show_chosen(header.control.id in chosen)
        self._changed()
