"""Which edits act on the take and its curves, and which on channels afterwards.

A neutral rest belongs to the take: curves start from the take without it, wherever it stands in the
list of edits. Only behind other edits of its channels does it act in its place among these.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

from faceedit_app.editing.edits.edit import Edit, Op


def divided(edits: Sequence[Edit]) -> tuple[list[Edit], list[Edit]]:
    """The edits that act on the take and its curves, and those that act on channels afterwards."""
    late = are_late(edits)
    first = [edit for edit, is_late in zip(edits, late, strict=True) if not is_late]
    return first, [edit for edit, is_late in zip(edits, late, strict=True) if is_late]


def are_late(edits: Sequence[Edit]) -> list[bool]:
    """Of each edit, whether it acts on channels after the curves are answered."""
    late: list[bool] = []
    then: list[Edit] = []
    for edit in edits:
        is_late = bool(edit.channels) and edit.op is not Op.NEUTRAL
        is_late |= edit.op is Op.NEUTRAL and is_behind(edit.channels, then)
        late.append(is_late)
        if is_late:
            then.append(edit)
    return late


def is_behind(channels: Collection[str], edits: Sequence[Edit]) -> bool:
    """Whether other edits of channels have changed some channels already."""
    return any(
        edit.effect is not None and not set(channels).isdisjoint(edit.channels) for edit in edits
    )
