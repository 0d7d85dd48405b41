"""From the names that files use to ARKit's: by rules, for takes and characters alike.

Tools spell one shape `eyeBlinkLeft`, `EyeBlinkLeft`, `eyeBlink_L`, `EYE_BLINK_LEFT`,
`left_eye_blink`, `A14_Eye_Blink_Left`, `blendShape1.eyeBlink_L` or `head_ARKit_eyeBlinkLeft`.
A name is split into words, namespaces and the usual prefixes are dropped, and a word for a side
at either end becomes the side. Nothing is compared by likeness: a name that the rules do not
bring to an ARKit name has none.
"""

from __future__ import annotations

import re
from collections.abc import Iterable

from faceedit_app.core.arkit import ARKIT_CHANNELS

_NAMESPACE = re.compile(r"^.*[.:|/]")
_PREFIX = re.compile(
    r"^(?:(?:blendshapes?|bs|shapes?|key|face|head|morph|arkit|ctrl|expressions?|[A-Z]?\d{1,3})"
    r"[ _-]+)+(?=.)",
    re.IGNORECASE,
)
_BETWEEN_WORDS = re.compile(r"(?<=[a-z])(?=[A-Z])")
_BETWEEN_PARTS = re.compile(r"[\W_]+")
_SIDES = {"l": "left", "left": "left", "r": "right", "right": "right"}


def canonical_channel(name: str) -> str | None:
    """The ARKit name that `name` means, or None."""
    return _BY_KEY.get(_key(name))


def match_channels(names: Iterable[str]) -> dict[str, list[str]]:
    """Which of some names mean each ARKit channel.

    Some characters have two halves of a shape that ARKit has whole, such as `browInnerUp_L` and
    `browInnerUp_R`: both are listed under it.

    Returns:
        {ARKit name: the names that mean it, in their order}; channels without one are absent.
    """
    found: dict[str, list[str]] = {}
    for name in names:
        key = _key(name)
        channel = _BY_KEY.get(key) or _HALVES.get(key)
        if channel is not None:
            found.setdefault(channel, []).append(name)
    return found


def _key(name: str) -> str:
    """What all spellings of a shape have in common: its words in lower case, its side last."""
    name = _PREFIX.sub("", _NAMESPACE.sub("", name.strip()))
    words = [w.lower() for w in _BETWEEN_PARTS.split(_BETWEEN_WORDS.sub(" ", name)) if w]
    if len(words) > 1:
        if words[-1] in _SIDES:
            words[-1] = _SIDES[words[-1]]
        elif words[0] in _SIDES:
            words = [*words[1:], _SIDES[words[0]]]
    return "".join(words)


_BY_KEY = {_key(name): name for name in ARKIT_CHANNELS}
_HALVES = {
    f"{_key(name)}{side}": name
    for name in ARKIT_CHANNELS
    if not name.endswith(("Left", "Right"))
    for side in ("left", "right")
    if f"{_key(name)}{side}" not in _BY_KEY
}
