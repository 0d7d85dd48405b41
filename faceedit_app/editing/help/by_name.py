"""Edits from names and numbers, as they are given in Python."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

from faceedit_app.core.clip import Clip
from faceedit_app.core.controls import CONTROL_IDS, CONTROLS
from faceedit_app.core.errors import FaceEditError
from faceedit_app.core.given import number, number_or_none
from faceedit_app.core.texts import did_you_mean
from faceedit_app.editing.edits.channels import CHANNEL_INDEX
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.solving.channel_edits import missing_channels

_WAYS = {Op.OFFSET: "by", Op.SET: "to", Op.SCALE: "times", Op.SMOOTH: "smooth"}


def control_by_name(name: str) -> str:
    """The id of a curve by its id or label.

    Raises:
        FaceEditError: there is none.
    """
    for control in CONTROLS:
        if name in (control.id, control.label):
            return control.id
    near = did_you_mean(name, CONTROL_IDS)
    raise FaceEditError(
        f"{name}: there is no such curve{near}; use one of {', '.join(CONTROL_IDS)}"
    )


def edit_by_name(
    clip: Clip,
    curves: str | Iterable[str],
    ways: Mapping[Op, float | None],
    span: tuple[float, float | None],
    falloff: float,
    strength: float,
) -> Edit:
    """An edit of curves, or of channels.

    Args:
        clip: the take.
        curves: one name or more, of curves or of channels.
        ways: what may be done, and by how much; exactly one of them is not None.
        span: first and last second of the hold; None = the end of the take.

    Raises:
        FaceEditError: a name or a number is wrong, or the times are outside the take.
    """
    given = [(op, number(_WAYS[op], value)) for op, value in ways.items() if value is not None]
    if len(given) != 1:
        raise FaceEditError("An edit needs exactly one of by, to, times and smooth")
    [(op, value)] = given
    many = curves if isinstance(curves, Iterable) else ()
    names = (curves,) if isinstance(curves, str) else tuple(many)
    if not names or not all(isinstance(name, str) for name in names):
        raise FaceEditError(f"{curves!r:.40}: must be names of curves or channels")
    channels = tuple(name for name in names if name in CHANNEL_INDEX)
    controls = tuple(control_by_name(name) for name in names if name not in channels)
    if channels and controls:
        raise FaceEditError(
            f"{controls[0]} is a curve and {channels[0]} a channel, which cannot be mixed in one "
            "edit: make one of each"
        )
    last = number_or_none("end", span[1])
    start, end = number("start", span[0]), float(clip.times[-1]) if last is None else last
    falloff, strength = number("falloff", falloff), number("strength", strength)
    try:
        edit = Edit(controls, op, start, end, falloff, value, strength=strength, channels=channels)
    except ValueError as error:
        raise FaceEditError(f"The edit cannot be made: {error}") from error
    if missing := missing_channels([edit], clip):
        raise FaceEditError(f"The edit cannot be made: {missing}")
    check_inside(clip, start, end)
    return edit


def check_inside(clip: Clip, start: float, end: float) -> None:
    """Refuse what acts nowhere, such as frame numbers given as seconds.

    Raises:
        FaceEditError: the range is outside the take.
    """
    first, last = float(clip.times[0]), float(clip.times[-1])
    if start > last or end < first:
        raise FaceEditError(
            f"{start:g} to {end:g} s is outside the take: it lasts from {first:g} to {last:g} s"
        )


def with_strength(edit: Edit, strength: float) -> Edit:
    """An edit of a preset with a strength.

    Raises:
        FaceEditError: it cannot have it.
    """
    try:
        return replace(edit, strength=strength)
    except ValueError as error:
        raise FaceEditError(f"The preset cannot be applied: {error}") from error
