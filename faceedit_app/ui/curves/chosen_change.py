"""A drag that changes the chosen edit, in place of making a new one."""

from __future__ import annotations

from dataclasses import dataclass, replace

from faceedit_app.editing.edits.edit import Company, Edit, Op
from faceedit_app.ui.curves.scale import Interval
from faceedit_app.ui.curves.tools import Press
from faceedit_app.ui.state.tools import Tool

_LEAST_STRENGTH = 0.25  # of an edit that a drag can change: with less, the hand would do nothing


@dataclass(frozen=True)
class ChosenChange:
    """What a drag changes.

    Attributes:
        row: of the edit in the list.
        old: the edit before the drag.
    """

    row: int
    old: Edit

    def edit(self, added: Edit | None, falloffs: Interval) -> Edit:
        """The edit as changed.

        Args:
            added: the edit that the drag would make by itself; None = nothing yet.
            falloffs: seconds of fading in and out, which it gets as well.
        """
        if self.old.op is Op.RETIME:
            if added is None:
                return self.old
            return replace(self.old, start=added.start, end=added.end, pins=added.pins)
        value = added.value / self.old.strength if added is not None else 0.0
        new = replace(self.old, value=self.old.value + value)
        if (self.old.falloff, self.old.fade_out) != falloffs:
            new = replace(new, falloff=falloffs[0], falloff_out=falloffs[1])
        return new


def change_by(
    tool: Tool, press: Press, chosen: tuple[int, Edit] | None, selection: Interval | None
) -> ChosenChange | None:
    """The change that a press begins, if the chosen edit does the same at its place.

    With the Move tool, it moves the same curves; with Retime, the press is on what it moves.

    Args:
        tool: the tool.
        press: the press.
        chosen: row and edit; None if no edit is chosen.
        selection: the time range between the handles.
    """
    if chosen is None:
        return None
    row, edit = chosen
    if tool is Tool.RETIME:
        return ChosenChange(row, edit) if press.retime is not None else None
    hold = press.span.start, press.span.end
    is_same = (
        tool is Tool.MOVE
        and edit.op is Op.OFFSET
        and edit.companions is Company.YIELD
        and edit.enabled
        and edit.strength >= _LEAST_STRENGTH
        and set(edit.controls) == set(press.controls)
        and hold in (selection, (edit.start, edit.end))
    )
    return ChosenChange(row, edit) if is_same else None
