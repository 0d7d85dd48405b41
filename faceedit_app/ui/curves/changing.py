"""What a drag at the place of the chosen edit does to that edit, in place of making a new one."""

from __future__ import annotations

from dataclasses import replace

from faceedit_app.editing.edits.edit import Company, Edit, Op
from faceedit_app.ui.curves.tools import Press
from faceedit_app.ui.state.tools import Tool

_LEAST_STRENGTH = 0.25  # of an edit that a drag can change: with less, the hand would do nothing

Chosen = tuple[int, Edit]  # its row, and the edit


def changed_by(
    chosen: Chosen | None, tool: Tool, press: Press, selection: tuple[float, float] | None
) -> Chosen | None:
    """The chosen edit, if a press with a tool changes it: the same curves at the same place."""
    if chosen is None:
        return None
    edit, hold = chosen[1], (press.span.start, press.span.end)
    if tool is Tool.RETIME:
        return chosen if press.retime is not None else None
    is_same = (
        tool is Tool.MOVE
        and edit.op is Op.OFFSET
        and edit.companions is Company.YIELD
        and edit.enabled
        and edit.strength >= _LEAST_STRENGTH
        and set(edit.controls) == set(press.controls)
        and hold in (selection, (edit.start, edit.end))
    )
    return chosen if is_same else None


def changed(old: Edit, added: Edit | None, falloffs: tuple[float, float]) -> Edit:
    """The chosen edit with what a drag adds to it.

    Args:
        added: the drag's edit; None while it changes nothing.
        falloffs: of the drag, in and out.
    """
    if old.op is Op.RETIME:
        if added is None:
            return old
        return replace(old, start=added.start, end=added.end, pins=added.pins)
    more = added.value / old.strength if added is not None else 0.0
    new = replace(old, value=old.value + more)
    if (old.falloff, old.fade_out) != falloffs:
        new = replace(new, falloff=falloffs[0], falloff_out=falloffs[1])
    return new
