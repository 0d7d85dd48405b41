"""Other names of ARKit's shapes, as they are spelt by character makers."""

from __future__ import annotations

# Other names of the same shape. `#` stands for the side, `^` for the upper or lower half; a shape
# that has more of them than its channel is a part of it, to be added to the others.
_SYNONYMS = {
    # Brows.
    "browraiseinner#": "browInnerUp",
    "browraisein#": "browInnerUp",
    "browinnerraise#": "browInnerUp",
    "innerbrowraise#": "browInnerUp",
    "browinnerup#": "browInnerUp",
    "browsinnerup": "browInnerUp",
    "browinnerupdown": "browInnerUp",
    "innerbrowraiser#": "browInnerUp",
    "innerbrowraiser": "browInnerUp",
    "browraiseinner": "browInnerUp",
    "browraiseouter#": "browOuterUp#",
    "browouterraise#": "browOuterUp#",
    "browouterupdown#": "browOuterUp#",
    "outerbrowraiser#": "browOuterUp#",
    "browdrop#": "browDown#",
    "browlower#": "browDown#",
    "browlowerer#": "browDown#",
    "browsdown#": "browDown#",
    # Cheeks and nose.
    "cheekpuff#": "cheekPuff",
    "cheekspuff": "cheekPuff",
    "cheekpuffer": "cheekPuff",
    "cheeksballoon": "cheekPuff",
    "cheekblow#": "cheekPuff",
    "mouthcheekblow#": "cheekPuff",
    "cheekraise#": "cheekSquint#",
    "cheekraiser#": "cheekSquint#",
    "eyecheekraise#": "cheekSquint#",
    "nosewrinkle#": "noseSneer#",
    "sneer#": "noseSneer#",
    "nosewrinkler#": "noseSneer#",
    "nosescrunch#": "noseSneer#",
    # Lids and eyes.
    "eyeclose#": "eyeBlink#",
    "eyeclosed#": "eyeBlink#",
    "eyesclose#": "eyeBlink#",
    "eyesclosed#": "eyeBlink#",
    "eyelidclose#": "eyeBlink#",
    "blink#": "eyeBlink#",
    "eyewiden#": "eyeWide#",
    "eyeswide#": "eyeWide#",
    "upperlidraiser#": "eyeWide#",
    "eyesquinch#": "eyeSquint#",
    "eyesquintinner#": "eyeSquint#",
    "eyesqueeze#": "eyeSquint#",
    "lidtightener#": "eyeSquint#",
    "squint#": "eyeSquint#",
    "eyeslookup#": "eyeLookUp#",
    "eyeslookdown#": "eyeLookDown#",
    "eyeup#": "eyeLookUp#",
    "eyedown#": "eyeLookDown#",
    # The side of the eye, and to which side it looks.
    "eyeleftlookleft": "eyeLookOutLeft",
    "eyeleftlookright": "eyeLookInLeft",
    "eyerightlookleft": "eyeLookInRight",
    "eyerightlookright": "eyeLookOutRight",
    "eyeleftleft": "eyeLookOutLeft",
    "eyeleftright": "eyeLookInLeft",
    "eyerightleft": "eyeLookInRight",
    "eyerightright": "eyeLookOutRight",
    # To which side it looks, and the side of the eye.
    "eyelookleftleft": "eyeLookOutLeft",
    "eyelookrightleft": "eyeLookInLeft",
    "eyelookleftright": "eyeLookInRight",
    "eyelookrightright": "eyeLookOutRight",
    "eyeslookleftleft": "eyeLookOutLeft",
    "eyeslookrightleft": "eyeLookInLeft",
    "eyeslookleftright": "eyeLookInRight",
    "eyeslookrightright": "eyeLookOutRight",
    # Jaw and tongue.
    "jawdrop": "jawOpen",
    "jawforwards": "jawForward",
    "jawforeward": "jawForward",
    "jawfwd": "jawForward",
    "jawthrust": "jawForward",
    "jawsideways#": "jaw#",
    "tongueoutward": "tongueOut",
    # Lips.
    "mouthape": "mouthClose",
    "mouthclosed": "mouthClose",
    "mouthclose^": "mouthClose",
    "lipstogether": "mouthClose",
    "lipstoward": "mouthClose",
    "lipstowards": "mouthClose",
    "mouthlipstogether^#": "mouthClose",
    "mouthlowerlipdown#": "mouthLowerDown#",
    "mouthdownlower#": "mouthLowerDown#",
    "mouthlowerdown#": "mouthLowerDown#",
    "mouthlowerlipdepress#": "mouthLowerDown#",
    "lowerlipdepressor#": "mouthLowerDown#",
    "lowerlipdown#": "mouthLowerDown#",
    "mouthupperlipup#": "mouthUpperUp#",
    "mouthupupper#": "mouthUpperUp#",
    "mouthupperlipraise#": "mouthUpperUp#",
    "upperlipraiser#": "mouthUpperUp#",
    "upperlipup#": "mouthUpperUp#",
    "mouthrollinupper": "mouthRollUpper",
    "mouthrollinlower": "mouthRollLower",
    "mouthrollinupper#": "mouthRollUpper",
    "mouthrollinlower#": "mouthRollLower",
    "mouthrollupperlip": "mouthRollUpper",
    "mouthrolllowerlip": "mouthRollLower",
    "mouthupperliprollin#": "mouthRollUpper",
    "mouthlowerliprollin#": "mouthRollLower",
    "liprollupper": "mouthRollUpper",
    "liprolllower": "mouthRollLower",
    "lipsuckupper#": "mouthRollUpper",
    "lipsucklower#": "mouthRollLower",
    "lipsuck#": "mouthRollUpper",
    "upperlipin": "mouthRollUpper",
    "lowerlipin": "mouthRollLower",
    "mouthupperinside": "mouthRollUpper",
    "mouthlowerinside": "mouthRollLower",
    "mouthshrugup": "mouthShrugUpper",
    "mouthshrugdown": "mouthShrugLower",
    "mouthraiserupper": "mouthShrugUpper",
    "mouthraiserlower": "mouthShrugLower",
    "jawchinraiseupper#": "mouthShrugUpper",
    "jawchinraiselower#": "mouthShrugLower",
    "chinraisert": "mouthShrugUpper",
    "chinraiserb": "mouthShrugLower",
    "chinraiser": "mouthShrugLower",
    "mouthpucker^#": "mouthPucker",
    "mouthlipspurse^#": "mouthPucker",
    "mouthpurse^#": "mouthPucker",
    "mouthnarrow#": "mouthPucker",
    "mouthpout": "mouthPucker",
    "lippucker^#": "mouthPucker",
    "lippucker#": "mouthPucker",
    "lippuckerer": "mouthPucker",
    "lippucker": "mouthPucker",
    "lipspucker": "mouthPucker",
    "mouthfunnel^#": "mouthFunnel",
    "lipfunnel^#": "mouthFunnel",
    "lipfunneler^#": "mouthFunnel",
    "lipfunneler#": "mouthFunnel",
    "lipfunneler": "mouthFunnel",
    "lipsfunnel": "mouthFunnel",
    "mouthoshape": "mouthFunnel",
    # Corners of the mouth.
    "mouthcornerpull#": "mouthSmile#",
    "mouthcornerup#": "mouthSmile#",
    "mouthsmilesimple#": "mouthSmile#",
    "lipcornerpuller#": "mouthSmile#",
    "smile#": "mouthSmile#",
    "mouthcornerdepress#": "mouthFrown#",
    "mouthcornerdown#": "mouthFrown#",
    "mouthsad#": "mouthFrown#",
    "lipcornerdepressor#": "mouthFrown#",
    "frown#": "mouthFrown#",
    "dimpler#": "mouthDimple#",
    "lipstretcher#": "mouthStretch#",
    "mouthpress^#": "mouthPress#",
    "lippressor#": "mouthPress#",
    "midmouth#": "mouth#",
}
_HEIGHTS = (("up", "down"), ("upper", "lower"), ("top", "bottom"))

# The action units of FACS that are channels, as words of the names above. Unit 27, which FACS calls
# mouth stretch, opens the jaw far.
ACTION_UNITS: dict[int, tuple[str, ...]] = {
    1: ("inner", "brow", "raiser"),
    2: ("outer", "brow", "raiser"),
    4: ("brow", "lowerer"),
    5: ("upper", "lid", "raiser"),
    6: ("cheek", "raiser"),
    7: ("lid", "tightener"),
    9: ("nose", "wrinkler"),
    10: ("upper", "lip", "raiser"),
    12: ("lip", "corner", "puller"),
    14: ("dimpler",),
    15: ("lip", "corner", "depressor"),
    16: ("lower", "lip", "depressor"),
    17: ("chin", "raiser"),
    18: ("lip", "puckerer"),
    19: ("tongue", "out"),
    20: ("lip", "stretcher"),
    22: ("lip", "funneler"),
    24: ("lip", "pressor"),
    26: ("jaw", "drop"),
    27: ("mouth", "open"),
    29: ("jaw", "thrust"),
    30: ("jaw", "sideways"),
    34: ("cheek", "puff"),
    43: ("eye", "close"),
    45: ("blink",),
}


def _synonyms() -> tuple[dict[str, tuple[str, str]], dict[str, str]]:
    """By key: the channel and which part of it; and by key without a side: a channel's stem."""
    table: dict[str, tuple[str, str]] = {}
    stems: dict[str, str] = {}
    for key, channel in _SYNONYMS.items():
        heights = [h for pair in _HEIGHTS for h in zip(pair, ("up", "down"), strict=True)]
        for spelling, height in heights if "^" in key else [("", "")]:
            for side in ("left", "right") if "#" in key else ("",):
                whole = channel.replace("#", side.capitalize())
                part = height + (side if "#" not in channel else "")
                table[key.replace("^", spelling).replace("#", side)] = whole, part
        if channel.endswith("#") and "^" not in key:
            stems[key.removesuffix("#")] = channel.removesuffix("#")
    return table, stems


# OTHER_NAMES: by key, the channel and the part of it that the shape is ("" for all of it).
# OTHER_STEMS: by the key of a shape that moves both sides, the channels' common name.
OTHER_NAMES, OTHER_STEMS = _synonyms()
