"""Every number of the character that was tuned by eye, with its unit.

Lengths are millimetres and angles degrees unless a comment says otherwise; colours are sRGB
hex. There is one frozen dataclass for each module that reads them.
"""

from assets.builder.settings.face import (
    ATTRIBUTION,
    MATERIALS,
    NAME,
    LipSides,
    LowerLip,
    Neutral,
    Output,
    RoundLips,
    Shapes,
    Skin,
)
from assets.builder.settings.features import (
    Brows,
    Eyes,
    Hair,
    Jaw,
    Lashes,
    LashRow,
    Ring,
    Teeth,
)
from assets.builder.settings.paint import Colour

NEUTRAL = Neutral()
SHAPES = Shapes()
LOWER_LIP = LowerLip()
ROUND_LIPS = RoundLips()
SKIN = Skin()
OUTPUT = Output()
HAIR = Hair()
BROWS = Brows()
LASHES = Lashes()
EYES = Eyes()
TEETH = Teeth()
COLOUR = Colour()

__all__ = [
    "ATTRIBUTION",
    "BROWS",
    "COLOUR",
    "EYES",
    "HAIR",
    "LASHES",
    "LOWER_LIP",
    "MATERIALS",
    "NAME",
    "NEUTRAL",
    "OUTPUT",
    "ROUND_LIPS",
    "SHAPES",
    "SKIN",
    "TEETH",
    "Jaw",
    "LashRow",
    "LipSides",
    "Ring",
]
