"""Which curves are shown: the user may hide some, and the optional ones are folded away."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from PySide6.QtCore import QObject, Signal

from faceedit_app.core.controls import CONTROL_IDS, CONTROL_INDEX, MAIN_CONTROLS, OPTIONAL_CONTROLS
from faceedit_app.editing.edits.edit import Edit
from faceedit_app.ui.curves.group_head import EDITED, GroupHead
from faceedit_app.ui.curves.rows import CurveRows

_MAIN, _OPTIONAL = frozenset(MAIN_CONTROLS), frozenset(OPTIONAL_CONTROLS)


class ShownCurves(QObject):
    """Shows and hides the rows of the curves panel.

    Signals:
        changed(): other rows are shown.
        unfolded(bool): the optional curves were unfolded, or folded away.
    """

    changed = Signal()
    unfolded = Signal(bool)

    def __init__(self, rows: CurveRows, head: GroupHead, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._rows, self._head = rows, head
        self._chosen = frozenset(CONTROL_IDS)  # not hidden by the user
        self._possible = frozenset(CONTROL_IDS)
        self._edits: Sequence[Edit] = ()
        head.clicked.connect(self.unfold)
        rows.show_rows(self.controls)

    @property
    def is_unfolded(self) -> bool:
        """Whether the optional curves are shown."""
        return self._head.isChecked()

    @property
    def open_group(self) -> frozenset[str]:
        """Ids of the curves that are not folded away, hidden ones included."""
        return frozenset(CONTROL_IDS) if self.is_unfolded else _MAIN

    @property
    def controls(self) -> frozenset[str]:
        """Ids of the curves that are shown."""
        return self._chosen & self.open_group

    @property
    def columns(self) -> list[int]:
        """The columns of the curves that are not folded away, in the order of the table."""
        return sorted(CONTROL_INDEX[control] for control in self.open_group)

    @property
    def hides_any(self) -> bool:
        """Whether a curve that the character has is hidden, though not folded away."""
        return bool((self._possible & self.open_group) - self._chosen)

    def allow(self, missing: Iterable[str], why: str) -> None:
        """Note which curves the character lacks, and why."""
        self._possible = frozenset(CONTROL_IDS) - frozenset(missing)
        lacks_all = bool(_OPTIONAL) and not _OPTIONAL & self._possible
        self._head.show_missing(why if lacks_all else "")
        if lacks_all and self.is_unfolded:
            self._fold(False)

    def note_edits(self, edits: Sequence[Edit]) -> None:
        """Say at the head of the group whether its curves are edited."""
        if edits is not self._edits:
            self._edits = edits
            edited = any(not _OPTIONAL.isdisjoint(edit.controls) for edit in edits)
            self._head.show_note(EDITED if edited else "")

    def show(self, controls: Iterable[str]) -> None:
        """Show these curves and hide all others that are not folded away."""
        folded = frozenset(CONTROL_IDS) - self.open_group
        self._show((self._chosen & folded) | frozenset(controls))

    def show_all(self) -> None:
        """Show all curves that the character has, but for those folded away."""
        self.show(self._possible)

    def reveal(self, control: str) -> None:
        """Show a curve, whatever hides it, if the character has it."""
        if control not in self._possible:
            return
        if control not in self.open_group:
            self.unfold(True)
        if control not in self._chosen:
            self._show(self._chosen | {control})
        self._rows.scroll_to({control})

    @property
    def spare_height(self) -> int:
        """Pixels that the panel could do without and still show all of these curves."""
        return self._rows.spare_height

    def unfold(self, wanted: bool) -> None:
        """Show the optional curves, or fold them away; the user wants it so from now on."""
        if self._head.isEnabled():
            self._fold(wanted)
            if wanted:
                self._rows.scroll_to(_OPTIONAL)
            self.unfolded.emit(wanted)

    def _fold(self, wanted: bool) -> None:
        self._head.setChecked(wanted)
        chosen = self._chosen
        if wanted:
            chosen |= _OPTIONAL
        elif not chosen & _MAIN:  # something has to be left
            chosen |= _MAIN
        self._show(chosen)

    def _show(self, chosen: frozenset[str]) -> None:
        self._chosen = chosen
        self._rows.show_rows(self.controls)
        self.changed.emit()
