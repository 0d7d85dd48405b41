"""Match a character's shapes to the ARKit channels, by rules.

`core.names` has the rules that takes and characters share. Characters have more spellings:
`eyeBlinkLeft`, `EyeBlink_L`, `blendShape1.eyeBlink.L`, `A14_Eye_Blink_Left`,
`head_ARKit_eyeBlinkLeft`. A name is split into words; words about the file rather than the face are
dropped; the side goes to the end; and the rest is looked up.

Some characters have fewer shapes than ARKit, and some have more. `browInnerUp_L` and
`browInnerUp_R` together make one channel; one `Blink` is split in two. Shapes that fit a channel
less well (the visemes of a VRM) are used only if there is nothing better, and `ShapeMatch.lost`
says so.
"""

from __future__ import annotations

import re
import unicodedata
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence

from faceedit_app.characters.matches import Half, ShapeMatch, Share
from faceedit_app.characters.other_names import ACTION_UNITS, OTHER_NAMES, OTHER_STEMS
from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.names import canonical_channel

# --- words ------------------------------------------------------------------------------------

_WORDS = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|[^\W\d_A-Za-z]+|\d+")
_NUMBERED = re.compile(r"^[A-Za-z]?\d{1,3}[ _-]+(?=[A-Za-z])")  # A14_Eye_Blink_Left
_DAZ = re.compile(r"(?<![A-Za-z])(?:[ep]CTRL|PHM)(?=[A-Z])")  # eCTRLMouthOpen
# What follows the last dot of some names: head.eyeBlinkLeft.v2, eyeBlinkLeft.shape.
_IS_NO_NAME = re.compile(r"v\d+|(blend)?shapes?|(shape)?keys?|targets?|morphs?", re.IGNORECASE)
_COPY = re.compile(r"\.\d{3}$")  # Blender's second jawOpen is jawOpen.001
_SIDES = dict.fromkeys(("l", "lt", "lf", "lft", "left"), "left") | dict.fromkeys(
    ("r", "rt", "rg", "rgt", "right"), "right"
)
_QUARTERS = {  # beside `lb` and `rb`, `lt` and `rt` mean the upper quarters; they are read as sides
    **{"ul": ("upper", "left"), "ur": ("upper", "right")},
    **{"dl": ("lower", "left"), "dr": ("lower", "right")},
    **{"lb": ("lower", "left"), "rb": ("lower", "right")},
}
# Words about the file, not the face.
_NOISE = re.compile(
    r"blendshapes?|blend|shapes?|bsh?|key|morph(er)?|targets?|face|facial|facs?|jnt|head|arkit|ark?|"
    r"kit|apple|ctrls?|controls?|exp(ressions?)?|mesh|geo|body|avatar|skin|char(acter)?|genesis|"
    r"(fe)?male|lod|div"
)
# An action unit of FACS, and the side of the face: AU12_L, AU_12_LipCornerPuller_Left.
_ACTION_UNIT = re.compile(
    r"(?:^|.*[^A-Za-z])AU[ _-]?0*(?P<number>\d{1,2})(?:[ _.-]?[A-Za-z]{4,})*?[ _.-]?"
    r"(?P<side>L|R|Left|Right)?",
    re.IGNORECASE,
)
_FACE = re.compile(r"brows?|cheeks?|eyes?|eyelids?|jaw|mouth|lips?|nose|tongue")


def words_of(name: str) -> list[str]:
    """The words of a name in lower case, without the namespace and words about the file."""
    # Half-width kana and full-width letters are other forms of the same.
    text = _COPY.sub("", unicodedata.normalize("NFKC", name).strip())
    text = re.split(r"[:|/\\]", text)[-1]
    unit = _ACTION_UNIT.fullmatch(text)
    if unit and int(unit["number"]) in ACTION_UNITS:
        return [*ACTION_UNITS[int(unit["number"])], *filter(None, [(unit["side"] or "").lower()])]
    pieces = [piece for piece in text.split(".") if piece.strip()]
    while len(pieces) > 1 and _IS_NO_NAME.fullmatch(pieces[-1].strip()):
        pieces.pop()
    if len(pieces) > 1 and pieces[-1].strip().lower() in _SIDES:  # Blender's eyeBlink.L
        text = " ".join(pieces[-2:])
    elif pieces:
        text = pieces[-1]
    words = [word.lower() for word in _WORDS.findall(_DAZ.sub("", _NUMBERED.sub("", text)))]
    words = [word for word in words if not word.isdigit()] or words
    while len(words) > 1 and _NOISE.fullmatch(words[0]):
        words = words[1:]
    while len(words) > 1 and _NOISE.fullmatch(words[-1]):
        words = words[:-1]
    return words


def _keys(words: Sequence[str]) -> tuple[str, ...]:
    """The keys to look up: words with `l` and `r` spelt out, as they are and with the side last."""
    spelt = [each for word in words for each in _QUARTERS.get(word, (_SIDES.get(word, word),))]
    sides = [i for i, word in enumerate(spelt) if word in ("left", "right")]
    keys = ["".join(spelt)]
    if len(sides) == 1 and len(spelt) > 1:
        rest = spelt[: sides[0]] + spelt[sides[0] + 1 :]
        keys.append("".join(rest) + spelt[sides[0]])
    return tuple(dict.fromkeys(keys))


# --- what the words mean ----------------------------------------------------------------------

_CHANNELS = {channel.lower(): channel for channel in ARKIT_CHANNELS}
_TWO_SIDED = sorted(
    {c.removesuffix("Left") for c in ARKIT_CHANNELS if c.endswith("Left")} - {"jaw", "mouth"}
)

# Substitutes for channels without a shape of their own: the presets of VRM 0 and 1, the visemes of
# Oculus, VRoid's and MikuMikuDance's names. Keys are as `_keys` makes them.
_Rough = tuple[tuple[str, Half], ...]


def _both(stem: str, left: Half = Half.LEFT, right: Half = Half.RIGHT) -> _Rough:
    return (stem + "Left", left), (stem + "Right", right)


def _one(channel: str, half: Half = Half.WHOLE) -> _Rough:
    return ((channel, half),)


_BLINK = _both("eyeBlink")
_SMILE = _both("mouthSmile", Half.LOWER_LEFT, Half.LOWER_RIGHT)
_LOWER_DOWN = _both("mouthLowerDown")
_UPPER = (Half.UPPER_LEFT, Half.UPPER_RIGHT)
_ROUGH: tuple[tuple[tuple[str, ...], _Rough], ...] = (
    (
        (
            *("blink", "eyeclose", "eyesclosed", "eyesclose", "eyeclosed", "eyesblink"),
            *("fcleyeclose", "まばたき", "眨眼", "笑い"),
        ),
        _BLINK,
    ),
    (("fcleyecloseleft", "ウィンク左", "ウィンク"), _one("eyeBlinkLeft")),
    (("fcleyecloseright", "ウィンク右"), _one("eyeBlinkRight")),
    (("mouthopen", "openmouth", "张嘴", "張嘴"), _one("jawOpen")),
    (("smile", "mouthhappy", "口角上げ", "にっこり"), _SMILE),
    (
        (
            *("a", "aa", "ah", "visemeaa", "vrcvaa", "vaa", "fclmtha", "mtha", "moutha", "あ"),
            *("vopen", "open"),
        ),
        _one("jawOpen"),
    ),
    (
        ("o", "oh", "visemeo", "vrcvoh", "voh", "vow", "fclmtho", "mtho", "moutho", "お"),
        _one("mouthFunnel"),
    ),
    (
        ("u", "ou", "visemeu", "vrcvou", "vou", "vuw", "fclmthu", "mthu", "mouthu", "う"),
        _one("mouthPucker"),
    ),
    (
        ("i", "ih", "visemei", "vrcvih", "vih", "fclmthi", "mthi", "mouthi", "い"),
        _both("mouthStretch"),
    ),
    (("e", "ee", "visemee", "vrcve", "vee", "ve", "fclmthe", "mthe", "mouthe", "え"), _LOWER_DOWN),
    (("口横広げ", "mouthwiden"), _both("mouthStretch")),
    (("mouthbottomlipdown",), _LOWER_DOWN),
    (
        ("mouthdepressionretraction",),  # of MakeHuman; it raises the upper lip, too
        _both("mouthLowerDown", Half.LOWER_LEFT, Half.LOWER_RIGHT),
    ),
    (("mouthtoplipup", "liptopupdown"), _both("mouthUpperUp")),
    (("visemepp", "vrcvpp", "vpp", "pp"), _both("mouthPress")),
    (("fun", "relaxed", "fclmthfun", "mthfun", "にやり", "微笑"), _SMILE),
    (("joy", "happy", "fclmthjoy", "mthjoy"), _SMILE),
    (("口角下げ", "∧", "fclmthangry"), _both("mouthFrown", Half.LOWER_LEFT, Half.LOWER_RIGHT)),
    (("angry", "fclbrwangry", "brwangry", "怒り", "下"), _both("browDown", *_UPPER)),
    (("sorrow", "sad", "fclbrwsorrow", "brwsorrow", "困る"), _one("browInnerUp", Half.UPPER)),
    (
        ("browupleft", "browsupleft", "browraiseleft", "browupdownleft"),
        _one("browOuterUpLeft"),
    ),
    (
        ("browupright", "browsupright", "browraiseright", "browupdownright"),
        _one("browOuterUpRight"),
    ),
    (
        ("surprised", "fclbrwsurprised", "brwsurprised", "上", "browup", "browsup", "browraise"),
        _both("browOuterUp", *_UPPER),
    ),
    (("びっくり", "fcleyespread", "fcleyesurprised"), _both("eyeWide", *_UPPER)),
    (("じと目",), _both("eyeSquint", *_UPPER)),
    (("ぺろっ",), _one("tongueOut")),
    (("lookup", "eyeslookup"), _both("eyeLookUp")),
    (("lookdown", "eyeslookdown"), _both("eyeLookDown")),
    (("lookleft",), (("eyeLookOutLeft", Half.LEFT), ("eyeLookInRight", Half.RIGHT))),
    (("lookright",), (("eyeLookInLeft", Half.LEFT), ("eyeLookOutRight", Half.RIGHT))),
)
# Shapes that move both sides, by key: the common name of the two channels. Those that are also in
# the table above are used last, and are reported there.
_BOTH_SIDES = {s.lower(): s for s in _TWO_SIDED} | {
    key: stem
    for key, stem in OTHER_STEMS.items()
    if not any(key in synonyms for synonyms, _ in _ROUGH)
}
# Presets without a channel, which are not reported as unused.
_WITHOUT_CHANNEL = frozenset(("neutral", "basis", "default", "visemesil", "vrcvsil"))


def match_channels(names: Iterable[str], meshes: Mapping[str, str] | None = None) -> ShapeMatch:
    """Match names to the ARKit channels.

    Args:
        names: the names of shapes; repeats count once.
        meshes: the name of the mesh that has each shape, which some names begin or end with.

    Returns:
        The match; every name is in exactly one of `matched`, `alike` and `unknown`.
    """
    given = list(dict.fromkeys(names))
    words: dict[str, Sequence[str]] = {name: words_of(name) for name in given}
    tail = _common_words([each[::-1] for each in words.values()])
    words = {name: _without(each[::-1], tail)[::-1] for name, each in words.items()}
    common = _common_words(list(words.values()))
    keys = {name: _keys(_without(each, common)) for name, each in words.items()}
    for name, mesh in (meshes or {}).items():
        bare = _without_mesh(words_of(name), words_of(mesh))
        if bare and canonical_channel(name) is None and _exact(keys[name]) is None:
            keys[name] = _keys(bare)
    shares: dict[str, list[Share]] = {}
    alike: dict[str, list[str]] = {}
    first: dict[tuple[str, str], str] = {}  # the name used for a channel and key
    rest: list[str] = []
    for name in sorted(
        given, key=lambda n: n.lower() not in _CHANNELS
    ):  # ARKit's own spelling first
        plain = canonical_channel(name)
        found = (plain, "") if plain else _exact(keys[name])
        if found is None:
            rest.append(name)
            continue
        channel, side = found
        if found in first:
            alike.setdefault(first[found], []).append(name)
        elif side and (channel, "") in first:  # a half although there is a whole
            rest.append(name)
        else:
            shares.setdefault(channel, []).append(Share(name))
            first[found] = name
    for channel, whole in [(c, name) for (c, part), name in first.items() if not part]:
        if len(shares[channel]) > 1:  # its parts would double it
            rest += [share.name for share in shares[channel] if share.name != whole]
            shares[channel] = [Share(whole)]
    once: dict[Sequence[str], list[str]] = {}  # shapes of several meshes, by their keys
    for name in rest:
        once.setdefault(keys[name], []).append(name)
    singles = [same[0] for same in once.values()]
    left, lost = _rough(_two_sided(singles, keys, shares), keys, shares)
    rest = [name for same in once.values() if same[0] in left for name in same]
    alike |= {same[0]: same[1:] for same in once.values() if same[0] not in left and same[1:]}
    order = {name: i for i, name in enumerate(given)}
    return ShapeMatch(
        {channel: tuple(shares[channel]) for channel in ARKIT_CHANNELS if channel in shares},
        tuple(sorted(rest, key=order.__getitem__)),
        {name: tuple(others) for name, others in alike.items()},
        tuple(lost),
    )


def _exact(keys: Sequence[str]) -> tuple[str, str] | None:
    """The channel that a key names, and which part of it the shape is; "" is all of it."""
    for key in keys:
        if key in _CHANNELS:
            return _CHANNELS[key], ""
        if key in OTHER_NAMES:
            return OTHER_NAMES[key]
    return None


def _two_sided(
    names: Sequence[str], keys: Mapping[str, Sequence[str]], shares: dict[str, list[Share]]
) -> list[str]:
    """Split shapes that move both sides, such as `eyeBlink`; returns the remaining names."""
    rest = []
    for name in names:
        stem = next((_BOTH_SIDES[key] for key in keys[name] if key in _BOTH_SIDES), None)
        free = [c for c in (f"{stem}Left", f"{stem}Right") if stem and c not in shares]
        for channel in free:
            half = Half.LEFT if channel.endswith("Left") else Half.RIGHT
            shares[channel] = [Share(name, half=half)]
        if not free:
            rest.append(name)
    return rest


def _rough(
    names: Sequence[str], keys: Mapping[str, Sequence[str]], shares: dict[str, list[Share]]
) -> tuple[list[str], list[str]]:
    """Use substitutes for missing channels; returns the remaining names, and sentences."""
    by_key: dict[str, str] = {}
    for name in names:
        for key in keys[name]:
            by_key.setdefault(key, name)
    used: dict[str, list[str]] = {}
    for synonyms, parts in _ROUGH:
        for name in (by_key[key] for key in synonyms if key in by_key):
            for channel, half in parts:
                if channel not in shares:
                    shares[channel] = [Share(name, half=half)]
                    used.setdefault(name, []).append(channel)
    lost = [f"{name} stands for {' and '.join(channels)}" for name, channels in used.items()]
    return [name for name in names if name not in used], lost


def is_without_channel(name: str) -> bool:
    """Whether a name is of a pose that needs no channel, such as VRM's `Neutral`."""
    return "".join(words_of(name)) in _WITHOUT_CHANNEL


def _common_words(all_words: Sequence[Sequence[str]]) -> tuple[str, ...]:
    """The words that most names begin with: the character's own name."""
    common: list[str] = []
    rest = [list(words) for words in all_words if len(words) > 1]
    least = max(0.6 * len(rest), 5)
    while rest:
        word, count = Counter(words[0] for words in rest).most_common(1)[0]
        if (
            count < least
            or _FACE.fullmatch(word)
            or word in _SIDES
            or word in ("viseme", "fcl", "vrc")
        ):
            break
        common.append(word)
        rest = [words[1:] for words in rest if words[0] == word and len(words) > 2]
    return tuple(common)


def _without_mesh(words: Sequence[str], mesh: Sequence[str]) -> Sequence[str]:
    """Words without those of the mesh at either end; () if it has none of them there."""
    count = len(mesh)
    if not 0 < count < len(words):
        return ()
    if list(words[:count]) == list(mesh):
        return words[count:]
    return words[:-count] if list(words[-count:]) == list(mesh) else ()


def _without(words: Sequence[str], common: Sequence[str]) -> Sequence[str]:
    """Words without those common to all names, and without noise after these."""
    for word in common:
        if len(words) > 1 and words[0] == word:
            words = words[1:]
    while len(words) > 1 and _NOISE.fullmatch(words[0]):
        words = words[1:]
    return words
