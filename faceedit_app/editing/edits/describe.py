"""The names of edits that the user has not named."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from faceedit_app.core.controls import (
    CONTROL_IDS,
    CONTROL_INDEX,
    CONTROLS,
    MAIN_CONTROLS,
    control_named,
)
from faceedit_app.core.regions import REGIONS
from faceedit_app.editing.edits.channels import CHANNELS, is_rotation
from faceedit_app.editing.edits.edit import Edit, Op


def _together() -> Iterator[tuple[frozenset[str], str]]:
    """Groups of curves that have a common name; a later group is preferred to an earlier one."""
    for region in REGIONS:
        yield frozenset(region.own), region.together
    for name in dict.fromkeys(control.together for control in CONTROLS if control.together):
        yield frozenset(c.id for c in CONTROLS if c.together == name), name
    for every in (MAIN_CONTROLS, CONTROL_IDS):
        yield frozenset(every), "All curves"


_SAME = 2e-4  # seconds, twice their rounding
_TOGETHER = {controls: name for controls, name in _together() if len(controls) > 1}


def describe(edit: Edit) -> str:
    """The user's name for an edit, else a description such as "Mouth opening +8.0 mm"."""
    if edit.name:
        return edit.name
    if edit.channels:
        return _describe_channels(edit)
    what = describe_controls(edit.controls)
    match edit.op:
        case Op.OFFSET:
            return f"{what} {signed(edit.value)} mm"
        case Op.SET:
            return _describe_set(edit, what)
        case Op.SCALE:
            return f"{what} × {edit.value:.2f}"
        case Op.SMOOTH:
            return f"Smooth {_lower(what)} ({1000 * edit.value:.0f} ms)"
        case Op.RESET:
            return f"{what} back to tracked"
        case Op.DRAW:
            return f"Draw {_lower(what)}"
        case Op.ADD:
            return f"Add to {_lower(what)}"
        case Op.FILL:
            whole = {*edit.controls}.issuperset(MAIN_CONTROLS)
            return "Fill" if whole else f"Fill {_lower(what)}"
        case Op.RETIME:
            return _describe_retime(edit)
        case Op.LIMIT | Op.NEUTRAL | Op.LEVELS:
            raise ValueError(f"{edit.op} is for channels")


def one_decimal(value: float) -> str:
    """A number as people write it: with a minus sign, and none before zero."""
    return f"{value:z.1f}".replace("-", "−")


def signed(value: float) -> str:
    """The same with a plus sign above zero."""
    return f"{value:+z.1f}".replace("-", "−")


def _describe_channels(edit: Edit) -> str:
    what, turns = name_channels(edit.channels), is_rotation(edit.channels[0])
    match edit.op:
        case Op.OFFSET:
            amount = f"{edit.value:+.1f}°" if turns else f"{edit.value:+.2f}"
            return f"{what} {amount}".replace("-", "−")
        case Op.SCALE if edit.value == 0:
            return f"{what} {'muted' if edit.about == 0 else 'held still'}"
        case Op.SCALE:
            return f"{what} × {edit.value:.2f}{_about(edit)}"
        case Op.SMOOTH:
            return f"Smooth {what} ({1000 * edit.value:.0f} ms)"
        case Op.DRAW:
            return f"Draw {what}"
        case Op.LIMIT:
            amount = f"{edit.value:.1f}°" if turns else f"{edit.value:.2f}"
            return f"{what} at most {amount}"
        case Op.NEUTRAL:
            return f"Neutral rest ({_counted(len(edit.channels))})"
        case _:
            return f"Strength by channel ({_counted(len(edit.channels))})"


def _about(edit: Edit) -> str:
    """What a scale leaves unchanged, unless that is 0."""
    if edit.about is None:
        return " about the median"
    unit = "°" if is_rotation(edit.channels[0]) else ""
    return f" about {edit.about:.2f}{unit}".replace("-", "−") if edit.about else ""


def _counted(channels: int) -> str:
    return "1 channel" if channels == 1 else f"{channels} channels"


def name_channels(channels: Sequence[str]) -> str:
    """A name for some channels, such as "jawOpen", "Head" or "jawOpen and 2 more"."""
    for part in ("head", "leftEye", "rightEye"):
        if set(channels) == {part + axis for axis in ("Yaw", "Pitch", "Roll")}:
            return {"head": "Head", "leftEye": "Left eye", "rightEye": "Right eye"}[part]
    if len(channels) > 2:
        return f"{channels[0]} and {len(channels) - 1} more"
    return " and ".join(channels)


def describe_what(*edits: Edit) -> str:
    """What edits change together: a name for their curves and channels."""
    if all(edit.op is Op.RETIME for edit in edits):
        return "Whole face"
    controls = {name for edit in edits for name in edit.controls}
    channels = {name for edit in edits for name in edit.channels}
    parts = []
    if controls:
        parts.append(describe_controls([name for name in CONTROL_IDS if name in controls]))
    if channels and all(edit.op in (Op.NEUTRAL, Op.LEVELS) for edit in edits):
        parts.append(_counted(len(channels)))  # the first of many says nothing
    elif channels:
        parts.append(name_channels([name for name in CHANNELS if name in channels]))
    return " and ".join(parts)


def describe_edits(edits: Sequence[Edit]) -> str:
    """The name of a step that adds these edits: their common name, else "3 edits"."""
    names = {describe(edit) for edit in edits}
    return names.pop() if len(names) == 1 else f"{len(edits)} edits"


def _describe_set(edit: Edit, what: str) -> str:
    closing = {control_named(name).closes for name in edit.controls}
    if edit.value <= 0 and len(closing) == 1 and None not in closing:
        (part,) = closing
        if len(edit.controls) == sum(control.closes is part for control in CONTROLS):
            return f"Close {part}"
        return f"Close {_lower(what).removesuffix(' opening')}"
    return f"{what} to {one_decimal(edit.value)} mm"


def _describe_retime(edit: Edit) -> str:
    """What the pins do, where it is one simple thing."""
    moves = [now - was for was, now in edit.pins]
    if not edit.pins:
        return "Retime"
    (was, now), (then_was, then_now) = edit.pins[0], edit.pins[:2][-1]
    if len(edit.pins) < 3 and abs(moves[0] - moves[-1]) < _SAME:
        return f"Move in time {moves[0]:+.2f} s".replace("-", "−")
    if abs(then_now - now) < _SAME:
        return f"Cut {then_was - was:.2f} s"
    if abs(then_was - was) < _SAME:
        return f"Pause {then_now - now:.2f} s"
    if len(edit.pins) > 2:
        return "Retime"
    return f"Stretch to {100 * (then_now - now) / (then_was - was):.0f} %"


def describe_controls(controls: Sequence[str]) -> str:
    """A name for some curves, such as "Eye opening" or "Mouth width and 2 more"."""
    if name := _TOGETHER.get(frozenset(controls)):
        return name
    labels = [CONTROLS[i].label for i in sorted(CONTROL_INDEX[name] for name in controls)]
    if len(labels) > 2:
        return f"{labels[0]} and {len(labels) - 1} more"
    return " and ".join([labels[0], *map(_lower, labels[1:])])


def _lower(label: str) -> str:
    return label[:1].lower() + label[1:]
