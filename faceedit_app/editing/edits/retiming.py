"""Edits of a take whose frame rate changes: they stay on the frames that they were made for."""

from __future__ import annotations

from dataclasses import replace

from faceedit_app.editing.edits.edit import LONGEST_SMOOTH, Edit, Op, at_times


def retimed(edit: Edit, factor: float) -> Edit:
    """The edit in a take whose times are `factor` times what they were.

    Falloffs and the width of a smooth are times too; all of it reaches the same frames.
    """
    later = None if edit.falloff_out is None else edit.falloff_out * factor
    value = edit.value
    if edit.op is Op.SMOOTH:
        value = min(value * factor, LONGEST_SMOOTH)
    return replace(
        edit,
        start=edit.start * factor,
        end=edit.end * factor,
        falloff=edit.falloff * factor,
        falloff_out=later,
        value=value,
        points=at_times((time * factor for time, _ in edit.points), edit.points),
        pins=tuple((was * factor, now * factor) for was, now in edit.pins),
    )
