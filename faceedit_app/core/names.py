"""Map the channel names that files use to ARKit's, by rules.

Tools spell one shape `eyeBlinkLeft`, `EyeBlinkLeft`, `eyeBlink_L`, `EYE_BLINK_LEFT`,
`left_eye_blink`, `A14_Eye_Blink_Left`, `blendShape1.eyeBlink_L`, `eyeBlink.L`,
`head_ARKit_eyeBlinkLeft`, `weights[eyeBlinkLeft]`, `key_blocks["eyeBlinkLeft"].value` or
`eyeBlinkLeft.value`.
A name is split into words, namespaces and the usual prefixes are dropped, and a word for a side
at either end becomes the side. Names are never read by similarity: if the rules do not lead to
an ARKit name, there is none. `characters.names` builds on this: a character's shapes may be halves
or both sides of a channel, and have names that no take has.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterable, Iterator
from functools import lru_cache, partial
from itertools import islice

from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.texts import ONE_LETTER, near_names

# A point may also stand before a side (`eyeBlink.L`) or a word for the number (`jawOpen.weight`).
# ARKit's own constants begin as one word.
_NAMESPACE = re.compile(
    r"^(?:.*[.:|/](?!(?:l|r|left|right|values?|weights?|scores?|val)$)|k?ARBlendShapeLocation)",
    re.IGNORECASE,
)
_BRACKETS = re.compile(
    r"(?P<before>[^\[\](){}]*)[\[({]['\"]?(?P<inside>[^\[\](){}'\"]*)['\"]?[\])}]"
    r"(?:\.(?:value|weight))?"
)
_PREFIX = re.compile(
    r"^(?:(?:blendshapes?|bs|shapes?|key|face|head|morph|arkit|ctrl|expressions?|[A-Z]?\d{1,3})"
    r"[ _-]+)+(?=.)",
    re.IGNORECASE,
)
_BETWEEN_WORDS = re.compile(r"(?<=[a-z])(?=[A-Z])")
_POINTS = re.compile(r"[.:|/]+")
_BETWEEN_PARTS = re.compile(r"[\W_]+")
_SHARED = 4  # names that make a beginning or an end one of the file's
_MOST_NAMES = 500  # that are searched for such a beginning or end
_MOST_MARKS = 8  # between the words of a name
_BETWEEN = re.compile(rf"{_BETWEEN_PARTS.pattern}|{_BETWEEN_WORDS.pattern}")
_LONGEST = 200  # characters; a longer text is not a name
_LETTER = re.compile("[A-Za-z]")  # each name has one; most cells of a take have none
_REMEMBERED = 2_000  # names, what each means
_NUMBER_WORDS = {
    *("value", "values", "weight", "weights", "score", "scores", "val", "raw", "percent", "pct"),
}
# What names of the numbers of a tracker say, and those of the same numbers after a filter.
_RAW = frozenset(("raw", "unfiltered", "unsmoothed", "original", "orig"))
_SMOOTHED = frozenset(("filtered", "filt", "smoothed", "smooth", "denoised", "stabilized"))
_SIDES = {"l": "left", "left": "left", "r": "right", "right": "right"}


def canonical_channel(name: str) -> str | None:
    """The ARKit name that `name` means, or None."""
    if len(name) > _LONGEST or _LETTER.search(name) is None:
        return None
    return _canonical(name)


@lru_cache(_REMEMBERED)  # to recognise a file, each format looks at the same names
def _canonical(name: str) -> str | None:
    """As `canonical_channel`, of a name that is not too long."""
    found = _BY_KEY.get(_key(name))
    if found is not None:
        return found
    brackets = _BRACKETS.fullmatch(name.strip())
    if brackets is None:
        return _joined(name)
    return _BY_KEY.get(_key(brackets["inside"])) or _BY_KEY.get(_key(brackets["before"]))


def _joined(name: str) -> str | None:
    """The ARKit name of words that points join, such as `face.jaw.open`, or None."""
    words = _POINTS.split(name.strip())[-_MOST_MARKS:]
    for start in range(len(words) - 2, -1, -1):
        found = _BY_KEY.get(_key("_".join(words[start:])))
        if found is not None:
            return found
    return None


def similar_channel(name: str, channels: Collection[str]) -> str | None:
    """The one of some ARKit names that was probably meant by a name with a typing error, or None.

    Only for messages: no take is read by it. A file's names are often its own, so that only one
    letter may be wrong; where a name must be a channel's, `did_you_mean` goes further.
    """
    if len(name) > _LONGEST:
        return None
    key = _key(name)
    near = (k for k, one in _BY_KEY.items() if one in channels and abs(len(k) - len(key)) <= 2)
    close = near_names(key, {k: _BY_KEY[k] for k in near}, ONE_LETTER)
    return close[0] if close else None


def _key(name: str) -> str:
    """What all spellings of a shape share: its words in lower case, the side last."""
    name = _PREFIX.sub("", _NAMESPACE.sub("", name.strip()))
    words = [w.lower() for w in _BETWEEN_PARTS.split(_BETWEEN_WORDS.sub(" ", name)) if w]
    if len(words) > 1 and words[-1] in _NUMBER_WORDS:
        words.pop()
    if len(words) > 1:
        if words[-1] in _SIDES:
            words[-1] = _SIDES[words[-1]]
        elif words[0] in _SIDES:
            words = [*words[1:], _SIDES[words[0]]]
    return "".join(words)


def naming_of(names: Iterable[str]) -> Callable[[str], str | None]:
    """What finds the channels among the names of a file.

    It is `canonical_channel`; if that finds none, it drops a beginning or an end that several names
    share (`newton jawOpen`, `facs_bs_JawOpen`, `jawOpen_h`). Beside plain or smoothed names, such
    as `jawOpen` or `jawOpen_filtered`, raw ones (`jawOpen_raw`) are none. If a channel would have
    two names otherwise, such as `Anna_jawOpen` and `Bob_jawOpen`, it finds none.
    """
    names = list(dict.fromkeys(names))
    known = {name: channel for name in names if (channel := canonical_channel(name))}
    plain = {name: channel for name, channel in known.items() if not _is_one_of(_RAW, name)}
    if plain:
        again = {name for name in known.keys() - plain.keys() if known[name] in plain.values()}
        return partial(_canonical_unless, again) if again else canonical_channel
    found = versions_of(names)
    owners = {name: channel for by in found.values() for name, channel in by.items()}
    several = len(set(owners.values())) < len(owners)
    if owners and not several and not known:
        return owners.get
    smoothed = [by for affixes, by in found.items() if _is_one_of(_SMOOTHED, *affixes)]
    raw = [by for affixes, by in found.items() if _is_one_of(_RAW, *affixes) or not any(affixes)]
    if len(smoothed) == len(raw) == 1 and set(raw[0].values()) <= set(smoothed[0].values()):
        return smoothed[0].get
    return canonical_channel


def _canonical_unless(others: Collection[str], name: str) -> str | None:
    """As `canonical_channel`; None for some other names."""
    return None if name in others else canonical_channel(name)


def versions_of(names: Iterable[str]) -> dict[tuple[str, str], dict[str, str]]:
    """The channels that names mean without the beginning and the end that several of them share.

    Returns:
        By beginning and end, the channel of each name that has them; without either, those of
        `canonical_channel`.
    """
    found: dict[tuple[str, str], dict[str, str]] = {}
    for name in islice(dict.fromkeys(names), _MOST_NAMES):
        for affixes, channel in _without_affixes(name):
            found.setdefault(affixes, {})[name] = channel
    return {affixes: by for affixes, by in found.items() if len(set(by.values())) >= _SHARED}


def _is_one_of(words: frozenset[str], *texts: str) -> bool:
    """Whether a word of some texts is one of these."""
    return any(not words.isdisjoint(map(str.lower, _BETWEEN.split(text))) for text in texts)


def _without_affixes(name: str) -> Iterator[tuple[tuple[str, str], str]]:
    """The channels that a name means without its first words or its last, and those words."""
    if len(name) > _LONGEST or _LETTER.search(name) is None:
        return
    marks = [(m.start(), m.end()) for m in _BETWEEN.finditer(name)][:_MOST_MARKS]
    starts = [0, *(end for _, end in marks)]
    ends = [*(start for start, _ in marks), len(name)]
    for start in starts:
        for end in ends:
            channel = canonical_channel(name[start:end]) if start < end else None
            if channel is not None:
                yield (name[:start], name[end:]), channel
                return


_BY_KEY = {_key(name): name for name in ARKIT_CHANNELS}
