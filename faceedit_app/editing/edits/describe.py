"""What an edit is called as long as the user has not named it."""

from __future__ import annotations

from collections.abc import Sequence

from faceedit_app.core.regions import CONTROL_IDS, CONTROL_INDEX, CONTROLS
from faceedit_app.editing.edits.edit import Edit, Op

_PAIRS = {
    frozenset({"left_corner", "right_corner"}): "Mouth corners",
    frozenset({"left_eyelid", "right_eyelid"}): "Eye opening",
    frozenset({"upper_lip", "lower_lip"}): "Lip protrusion",
    frozenset(CONTROL_IDS): "All curves",
    frozenset(CONTROL_IDS[:6]): "Mouth",
}


def describe(edit: Edit) -> str:
    """The user's name of an edit, else one such as "Mouth opening +8.0 mm"."""
    if edit.name:
        return edit.name
    what = describe_controls(edit.controls)
    match edit.op:
        case Op.OFFSET:
            return f"{what} {edit.value:+.1f} mm".replace("-", "−")
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


def describe_edits(edits: Sequence[Edit]) -> str:
    """What a step that makes these edits is called: as they are, if they are called alike."""
    names = {describe(edit) for edit in edits}
    return names.pop() if len(names) == 1 else f"{len(edits)} edits"


def _describe_set(edit: Edit, what: str) -> str:
    if edit.value <= 0:
        if edit.controls == ("mouth_opening",):
            return "Close lips"
        if set(edit.controls) <= {"left_eyelid", "right_eyelid"}:
            return "Close eyes" if len(edit.controls) == 2 else f"Close {_lower(what)[:-8]}"
    return f"{what} to {edit.value:.1f} mm"


def describe_controls(controls: Sequence[str]) -> str:
    """A name for some curves, such as "Eye opening" or "Mouth width and 2 more"."""
    if pair := _PAIRS.get(frozenset(controls)):
        return pair
    labels = [
        CONTROLS[CONTROL_INDEX[c]].label for c in sorted(controls, key=CONTROL_INDEX.__getitem__)
    ]
    if len(labels) > 2:
        return f"{labels[0]} and {len(labels) - 1} more"
    return " and ".join([labels[0], *map(_lower, labels[1:])])


def _lower(label: str) -> str:
    return label[:1].lower() + label[1:]
