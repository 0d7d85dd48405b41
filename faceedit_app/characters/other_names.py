"""Other names of ARKit's shapes, as they are spelt by character makers."""

from __future__ import annotations

# Other names of the same shape; `#` stands for the side.
_SYNONYMS = {
    "browraiseinner#": "browInnerUp",
    "browinnerraise#": "browInnerUp",
    "innerbrowraise#": "browInnerUp",
    "browinnerup#": "browInnerUp",
    "browsinnerup": "browInnerUp",
    "innerbrowraiser": "browInnerUp",
    "browraiseinner": "browInnerUp",
    "browraiseouter#": "browOuterUp#",
    "browouterraise#": "browOuterUp#",
    "outerbrowraiser#": "browOuterUp#",
    "browdrop#": "browDown#",
    "browlower#": "browDown#",
    "browlowerer#": "browDown#",
    "browsdown#": "browDown#",
    "cheekpuff#": "cheekPuff",
    "cheekspuff": "cheekPuff",
    "cheekraise#": "cheekSquint#",
    "eyeclose#": "eyeBlink#",
    "eyeclosed#": "eyeBlink#",
    "eyesclose#": "eyeBlink#",
    "eyesclosed#": "eyeBlink#",
    "eyelidclose#": "eyeBlink#",
    "blink#": "eyeBlink#",
    "eyewiden#": "eyeWide#",
    "eyesquinch#": "eyeSquint#",
    "jawdrop": "jawOpen",
    "jawforwards": "jawForward",
    "jawfwd": "jawForward",
    "mouthclosed": "mouthClose",
    "lipstogether": "mouthClose",
    "mouthlowerlipdown#": "mouthLowerDown#",
    "mouthdownlower#": "mouthLowerDown#",
    "mouthlowerdown#": "mouthLowerDown#",
    "mouthupperlipup#": "mouthUpperUp#",
    "mouthupupper#": "mouthUpperUp#",
    "mouthrollinupper": "mouthRollUpper",
    "mouthrollinlower": "mouthRollLower",
    "mouthrollupperlip": "mouthRollUpper",
    "mouthrolllowerlip": "mouthRollLower",
    "liprollupper": "mouthRollUpper",
    "liprolllower": "mouthRollLower",
    "mouthshrugup": "mouthShrugUpper",
    "mouthshrugdown": "mouthShrugLower",
    "nosewrinkle#": "noseSneer#",
    "sneer#": "noseSneer#",
    "nosewrinkler#": "noseSneer#",
    "tongueoutward": "tongueOut",
    # Character Creator's: the side of the eye, then where it looks; the quarters of the mouth.
    "eyeleftlookleft": "eyeLookOutLeft",
    "eyeleftlookright": "eyeLookInLeft",
    "eyerightlookleft": "eyeLookInRight",
    "eyerightlookright": "eyeLookOutRight",
    "mouthpuckerup#": "mouthPucker",
    "mouthpuckerdown#": "mouthPucker",
    "mouthfunnelup#": "mouthFunnel",
    "mouthfunneldown#": "mouthFunnel",
    "mouthrollinupper#": "mouthRollUpper",
    "mouthrollinlower#": "mouthRollLower",
}


def _synonyms() -> dict[str, tuple[str, bool]]:
    """By key: the channel, and whether the shape is one side of it."""
    table: dict[str, tuple[str, bool]] = {}
    for key, channel in _SYNONYMS.items():
        for side in ("Left", "Right") if "#" in key else ("",):
            whole = channel.replace("#", side)
            table[key.replace("#", side.lower())] = whole, "#" in key and "#" not in channel
    return table


OTHER_NAMES = _synonyms()
