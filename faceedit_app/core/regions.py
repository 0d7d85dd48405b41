"""The eight controls and the three face regions they drive (paper, section 3.1)."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Control:
    """One of the eight inter-vertex distances, in millimetres on the rig.

    Attributes:
        id: the name in files and on the command line.
        label: the name in the window.
        region: the `Region.id` whose networks answer to it.
        hint: what the control does to the face, for tooltips.
        shuts: the two vertices can pass each other; from touching on the distance is 0.
    """

    id: str
    label: str
    region: str
    hint: str
    shuts: bool = False


CONTROLS: tuple[Control, ...] = (
    Control(
        "mouth_opening",
        "Mouth opening",
        "lower",
        "Distance between the inner lips. Down closes the mouth, up opens the jaw.",
    ),
    Control(
        "mouth_width",
        "Mouth width",
        "lower",
        "Distance between the mouth corners. Down puckers the lips, up widens the mouth.",
    ),
    Control(
        "left_corner",
        "Left mouth corner",
        "lower",
        "Upper lip to the character's left mouth corner. Up smiles on that side.",
    ),
    Control(
        "right_corner",
        "Right mouth corner",
        "lower",
        "Upper lip to the character's right mouth corner. Up smiles on that side.",
    ),
    Control(
        "upper_lip",
        "Upper lip protrusion",
        "lower",
        "Nose bridge to upper lip. Down lifts and pushes out the upper lip, up tucks it in.",
    ),
    Control(
        "lower_lip",
        "Lower lip protrusion",
        "lower",
        "Chin to lower lip. Down drops and pushes out the lower lip, up raises or tucks it in.",
    ),
    Control(
        "left_eyelid",
        "Left eye opening",
        "eyelids",
        "Distance between the lids of the character's left eye. Down closes the eye.",
        shuts=True,
    ),
    Control(
        "right_eyelid",
        "Right eye opening",
        "eyelids",
        "Distance between the lids of the character's right eye. Down closes the eye.",
        shuts=True,
    ),
)

CONTROL_IDS: tuple[str, ...] = tuple(control.id for control in CONTROLS)
CONTROL_INDEX: dict[str, int] = {name: i for i, name in enumerate(CONTROL_IDS)}
MIRRORED_CONTROL: dict[str, str] = {
    name: name.replace("left", "#").replace("right", "left").replace("#", "right")
    for name in CONTROL_IDS
}


@dataclass(frozen=True)
class Region:
    """A part of the face with one pair of networks: controls in, channel weights out."""

    id: str
    label: str
    controls: tuple[str, ...]
    channels: tuple[str, ...]


def _both(*stems: str) -> tuple[str, ...]:
    return tuple(stem + side for stem in stems for side in ("Left", "Right"))


_LOWER_CONTROLS = CONTROL_IDS[:6]
_EYELID_CONTROLS = CONTROL_IDS[6:]

REGIONS: tuple[Region, ...] = (
    Region(
        "lower",
        "Lower face",
        _LOWER_CONTROLS,
        (
            "jawOpen",
            "mouthClose",
            "mouthFunnel",
            "mouthPucker",
            *_both("mouthSmile", "mouthFrown", "mouthStretch", "mouthUpperUp", "mouthLowerDown"),
            "mouthRollUpper",
            "mouthRollLower",
            *_both("mouthPress"),
        ),
    ),
    Region(
        "upper",
        "Upper face",
        _EYELID_CONTROLS,
        (*_both("browDown"), "browInnerUp", *_both("browOuterUp")),
    ),
    Region(
        "eyelids",
        "Eyelids",
        _EYELID_CONTROLS,
        _both("eyeBlink", "eyeSquint", "eyeWide"),
    ),
)

MODELLED_CHANNELS: tuple[str, ...] = tuple(c for region in REGIONS for c in region.channels)
