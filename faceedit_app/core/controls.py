"""The controls: the distances on a face that people edit as curves (paper, section 3.1).

A control is one row of `CONTROLS`. All that FaceEdit knows of it stands there; what is called a
mouth corner, an eyelid or the opening of the lips anywhere else follows from the rows. Another
control takes a row here, its two vertices in a character (`Rig.control_pairs`), and a model that
listens to it. Characters and models without it go on working, without its curve.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class Closes(StrEnum):
    """What touches where a control is 0."""

    LIPS = "lips"
    EYES = "eyes"


@dataclass(frozen=True)
class Control:
    """A distance between two vertices, in millimetres on the rig.

    Attributes:
        id: the name in files and on the command line; it never changes.
        label: the name in the window. Up on the curve is more of what it says.
        hint: what the control does to the face, for tooltips.
        region: the `Region.id` whose channels bring it to what is asked.
        heard_by: other regions whose networks listen to it too.
        key: gives the keyboard to its curve.
        color: of its curve, as `#rrggbb`.
        mirror: the control of the other half of the face, if there is one.
        together: what it and others that say the same are called when edited as one.
        leads: controls that go along when it is edited; see `solving.companions`.
        expressive: it also goes along with one-click expressions of its region.
        closes: what touches where it is 0, if anything does.
        shuts: the two vertices can pass each other; from touching on the distance is 0.
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


# Okabe and Ito's colours are told apart with any kind of colour blindness.
_SKY, _ORANGE = "#56b4e9", "#e69f00"
_CORNERS, _WIDTH = ("left_corner", "right_corner"), "mouth_width"

CONTROLS: tuple[Control, ...] = (
    Control(
        "mouth_opening",
        "Mouth opening",
        "Distance between the inner lips. Up opens the jaw, down closes the mouth.",
        region="lower",
        key="1",
        color=_SKY,
        closes=Closes.LIPS,
    ),
    Control(
        _WIDTH,
        "Mouth width",
        "Distance between the mouth corners. Up widens the mouth, down puckers the lips.",
        region="lower",
        key="2",
        color=_SKY,
        leads=_CORNERS,
    ),
    Control(
        "left_corner",
        "Left mouth corner",
        "Upper lip to the character's left mouth corner. Up smiles on that side.",
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
        region="eyelids",
        heard_by=("upper",),
        key="8",
        color=_ORANGE,
        mirror="left_eyelid",
        together="Eye opening",
        closes=Closes.EYES,
        shuts=True,
    ),
)

CONTROL_IDS: tuple[str, ...] = tuple(control.id for control in CONTROLS)
CONTROL_INDEX: dict[str, int] = {name: i for i, name in enumerate(CONTROL_IDS)}
MIRRORED_CONTROL: dict[str, str] = {
    control.id: control.mirror or control.id for control in CONTROLS
}
SIDED_CONTROLS: tuple[str, ...] = tuple(c.id for c in CONTROLS if c.mirror)


def control_named(name: str) -> Control:
    """The row of a control's id."""
    return CONTROLS[CONTROL_INDEX[name]]


# What code elsewhere is about: closures, blinks and expressions.
(LIP_OPENING,) = (c.id for c in CONTROLS if c.closes is Closes.LIPS)
LIDS: tuple[str, ...] = tuple(c.id for c in CONTROLS if c.closes is Closes.EYES)
MOUTH_WIDTH, MOUTH_CORNERS = _WIDTH, _CORNERS
