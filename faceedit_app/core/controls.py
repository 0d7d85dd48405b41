"""The controls: the distances on a face that people edit as curves (paper, section 3.1).

`CONTROLS` has one row for each control, with everything that FaceEdit knows about it; the rest of
the code asks the rows which controls are mouth corners, eyelids or lip openings. To add a control,
add a row here, its control points to a character (`Rig.control_pairs`), and a model trained with
it. Characters and models without it keep working, without its curve. CONTRIBUTING.md has the
whole list.

Optional controls are for what few takes need, such as a raised brow. Their curves are folded away,
no network listens to them, and what is edited without naming them leaves them alone.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class Closes(StrEnum):
    """What touches when a control is 0."""

    LIPS = "lips"
    EYES = "eyes"


@dataclass(frozen=True)
class Control:
    """A distance between two vertices of a rig, in millimetres.

    One that is `sideways` is the part of it across the face: 0 in the middle, above 0 towards the
    character's left, and below 0 towards the right.

    Attributes:
        id: the name in files and on the command line; it never changes.
        label: the name in the window; a higher value means more of it.
        hint: what the control does to the face; shown as a tooltip.
        region: `Region.id` of the region whose channels move it.
        heard_by: other regions whose networks take it as an input too.
        key: the key that focuses its curve.
        color: the colour of its curve, one of `COLORS`.
        mirror: the same control on the other side of the face, if there is one.
        together: the name for it and the others with the same text when they are edited as one.
        leads: controls that follow when it is edited; see `solving.companions`.
        expressive: whether it also follows one-click expressions of its region.
        closes: what touches when it is 0, if anything.
        shuts: whether the two vertices can pass each other; the distance is then 0.
        between: names of its two control points, which are looked for on a character that does
            not say where they are (`characters/points.py`); None = only its own file can say.
        handle: which of the two, 0 or 1, is dragged on the face; None if it would lie on that of
            another control.
        optional: whether it belongs to the group of curves that is folded away.
        sideways: whether only the part across the face counts, with its sign.
    """

    id: str
    label: str
    hint: str
    region: str
    key: str
    color: str
    heard_by: tuple[str, ...] = ()
    mirror: str = ""
    together: str = ""
    leads: tuple[str, ...] = ()
    expressive: bool = False
    closes: Closes | None = None
    shuts: bool = False
    between: tuple[str, str] | None = None
    handle: int | None = None
    optional: bool = False
    sideways: bool = False


_SKY, _ORANGE, _PURPLE = "#56b4e9", "#e69f00", "#cc79a7"
# The colours of curves, and what the legend calls them. They are Okabe and Ito's, distinguishable
# with any kind of colour blindness, without green, in which the user's character is drawn, and
# without dark blue, which is hard to see on dark grey.
COLORS: dict[str, str] = {
    _SKY: "blue",
    _ORANGE: "orange",
    _PURPLE: "purple",
    "#f0e442": "yellow",
    "#d55e00": "red",
}
_CORNERS, _WIDTH = ("left_corner", "right_corner"), "mouth_width"

CONTROLS: tuple[Control, ...] = (
    Control(
        "mouth_opening",
        "Mouth opening",
        "Distance between the inner lips. Up opens the jaw, down closes the mouth.",
        between=("inner_upper_lip", "inner_lower_lip"),
        handle=1,
        region="lower",
        key="1",
        color=_SKY,
        closes=Closes.LIPS,
    ),
    Control(
        _WIDTH,
        "Mouth width",
        "Distance between the mouth corners. Up widens the mouth, down puckers the lips.",
        between=("left_mouth_corner", "right_mouth_corner"),
        region="lower",
        key="2",
        color=_SKY,
        leads=_CORNERS,
    ),
    Control(
        "left_corner",
        "Left mouth corner",
        "Upper lip to the character's left mouth corner. Up smiles on that side.",
        between=("upper_lip", "left_mouth_corner"),
        handle=1,
        region="lower",
        key="3",
        color=_SKY,
        mirror="right_corner",
        together="Mouth corners",
        leads=(_WIDTH,),
    ),
    Control(
        "right_corner",
        "Right mouth corner",
        "Upper lip to the character's right mouth corner. Up smiles on that side.",
        between=("upper_lip", "right_mouth_corner"),
        handle=1,
        region="lower",
        key="4",
        color=_SKY,
        mirror="left_corner",
        together="Mouth corners",
        leads=(_WIDTH,),
    ),
    Control(
        "upper_lip",
        "Upper lip drop",
        "Nose bridge to upper lip. Up lowers the lip and tucks it in, down lifts it and pushes it "
        "out.",
        between=("nose_bridge", "upper_lip"),
        handle=1,
        region="lower",
        key="5",
        color=_SKY,
        together="Lips",
        expressive=True,
    ),
    Control(
        "lower_lip",
        "Lower lip rise",
        "Chin to lower lip. Up raises the lip or tucks it in, down lowers it and pushes it out.",
        between=("chin", "lower_lip"),
        region="lower",
        key="6",
        color=_SKY,
        together="Lips",
        expressive=True,
    ),
    Control(
        "left_eyelid",
        "Left eye opening",
        "Distance between the lids of the character's left eye. Up opens the eye, down closes it.",
        between=("left_upper_lid", "left_lower_lid"),
        handle=0,
        region="eyelids",
        heard_by=("upper",),
        key="7",
        color=_ORANGE,
        mirror="right_eyelid",
        together="Eye opening",
        closes=Closes.EYES,
        shuts=True,
    ),
    Control(
        "right_eyelid",
        "Right eye opening",
        "Distance between the lids of the character's right eye. Up opens the eye, down closes it.",
        between=("right_upper_lid", "right_lower_lid"),
        handle=0,
        region="eyelids",
        heard_by=("upper",),
        key="8",
        color=_ORANGE,
        mirror="left_eyelid",
        together="Eye opening",
        closes=Closes.EYES,
        shuts=True,
    ),
    Control(
        "left_brow",
        "Left brow height",
        "Inner corner of the character's left eye to the brow. Up raises the brow, down frowns.",
        between=("left_eye_corner", "left_brow"),
        handle=1,
        region="brow_region",
        key="",
        color=_PURPLE,
        mirror="right_brow",
        together="Brow height",
        optional=True,
    ),
    Control(
        "right_brow",
        "Right brow height",
        "Inner corner of the character's right eye to the brow. Up raises the brow, down frowns.",
        between=("right_eye_corner", "right_brow"),
        handle=1,
        region="brow_region",
        key="",
        color=_PURPLE,
        mirror="left_brow",
        together="Brow height",
        optional=True,
    ),
    Control(
        "jaw_side",
        "Jaw to the side",
        "How far the chin is from the middle. Up moves the jaw to the character's left, down to "
        "the right.",
        between=("nose_bridge", "chin"),
        handle=1,
        region="jaw_region",
        key="",
        color=_PURPLE,
        optional=True,
        sideways=True,
    ),
)

CONTROL_IDS: tuple[str, ...] = tuple(control.id for control in CONTROLS)
MAIN_CONTROLS: tuple[str, ...] = tuple(c.id for c in CONTROLS if not c.optional)
OPTIONAL_CONTROLS: tuple[str, ...] = tuple(c.id for c in CONTROLS if c.optional)
CONTROL_INDEX: dict[str, int] = {name: i for i, name in enumerate(CONTROL_IDS)}
MIRRORED_CONTROL: dict[str, str] = {
    control.id: control.mirror or control.id for control in CONTROLS
}
SIDED_CONTROLS: tuple[str, ...] = tuple(c.id for c in CONTROLS if c.mirror or c.sideways)
SIGNED_CONTROLS: tuple[str, ...] = tuple(c.id for c in CONTROLS if c.sideways)


def control_named(name: str) -> Control:
    """The control with this id."""
    return CONTROLS[CONTROL_INDEX[name]]


# The groups of controls that other code asks for.
(LIP_OPENING,) = (c.id for c in CONTROLS if c.closes is Closes.LIPS)
LIDS: tuple[str, ...] = tuple(c.id for c in CONTROLS if c.closes is Closes.EYES)
MOUTH_WIDTH, MOUTH_CORNERS = _WIDTH, _CORNERS
