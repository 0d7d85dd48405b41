"""The three face regions: each has one pair of networks, from controls to channels.

Optional controls have regions too, which no network answers; their channels are moved by reach
alone, or, if the control is measured across the face, in proportion (`solving/sideways.py`).
"""

from __future__ import annotations

from dataclasses import dataclass

from faceedit_app.core.controls import CONTROLS, control_named
from faceedit_app.core.texts import listed


@dataclass(frozen=True)
class Region:
    """A part of the face with one pair of networks, if any: controls in, channel weights out.

    Attributes:
        id: the name in files and on the command line.
        label: the name in the window.
        together: the name of its own controls when they are edited as one.
        channels: the K channels that its networks answer with, in this order.
        controls: ids of the controls that its networks take, in the order of `CONTROLS`.
        accompanying: channels that no network answers, and that move with its own in takes that
            use them.
    """

    id: str
    label: str
    together: str
    channels: tuple[str, ...]
    controls: tuple[str, ...]
    accompanying: tuple[str, ...] = ()

    @property
    def own(self) -> tuple[str, ...]:
        """Ids of the controls that its channels move."""
        return tuple(control.id for control in CONTROLS if control.region == self.id)

    @property
    def is_sideways(self) -> bool:
        """Whether its control, of which it then has one, is measured across the face.

        Its channels are then one or two pairs, left before right. The first moves the control; the
        second goes along.
        """
        return any(control_named(name).sideways for name in self.own)


def _region(
    name: str, label: str, together: str, *channels: str, accompanying: tuple[str, ...] = ()
) -> Region:
    heard = tuple(c.id for c in CONTROLS if name in (c.region, *c.heard_by) and not c.optional)
    return Region(name, label, together, channels, heard, accompanying)


def _both(*stems: str) -> tuple[str, ...]:
    return tuple(stem + side for stem in stems for side in ("Left", "Right"))


LOWER = _region(
    "lower",
    "Lower face",
    "Mouth",
    "jawOpen",
    "mouthClose",
    "mouthFunnel",
    "mouthPucker",
    *_both("mouthSmile", "mouthFrown", "mouthStretch", "mouthUpperUp", "mouthLowerDown"),
    "mouthRollUpper",
    "mouthRollLower",
    *_both("mouthPress"),
    accompanying=(
        *_both("mouthDimple", "cheekSquint", "noseSneer"),
        "jawForward",
        "mouthShrugLower",
        "mouthShrugUpper",
        "cheekPuff",
    ),
)
UPPER = _region(
    "upper",
    "Upper face",
    "Brows",
    *_both("browDown"),
    "browInnerUp",
    *_both("browOuterUp"),
)
EYELIDS = _region(
    "eyelids",
    "Eyelids",
    "Eyelids",
    *_both("eyeBlink", "eyeSquint", "eyeWide"),
)

BROWS = _region("brow_region", "Brows", "Brow height", *UPPER.channels)
JAW = _region("jaw_region", "Jaw", "Jaw", *_both("jaw", "mouth"))

REGIONS: tuple[Region, ...] = (LOWER, UPPER, EYELIDS)
OPTIONAL_REGIONS: tuple[Region, ...] = (BROWS, JAW)
# The name of the group of curves that is folded away.
OPTIONAL_LABEL: str = listed(region.label for region in OPTIONAL_REGIONS).capitalize()
MODELLED_CHANNELS: tuple[str, ...] = tuple(c for region in REGIONS for c in region.channels)
