"""A channel is found under every spelling in use, and no other name is taken for one."""

from __future__ import annotations

import re
from collections.abc import Callable

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.chance import CHARACTERS

from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.names import canonical_channel


def words(name: str) -> list[str]:
    return re.sub(r"(?=[A-Z])", " ", name).lower().split()


def short_side(name: str) -> str:
    """`eyeBlink_L`; as tools do it, `jawLeft` and `mouthRight` stay whole."""
    if name in ("jawLeft", "jawRight", "mouthLeft", "mouthRight"):
        return name
    return re.sub(r"(Left|Right)$", lambda match: f"_{match[0][0]}", name)


def side_first(name: str) -> str:
    parts = words(name)
    if parts[-1] in ("left", "right"):
        parts = [parts[-1], *parts[:-1]]
    return "_".join(parts)


SPELLINGS: dict[str, Callable[[str], str]] = {
    "ARKit": str,
    "Live Link Face": lambda name: name[0].upper() + name[1:],
    "capitals": str.upper,
    "small letters": str.lower,
    "snake case": lambda name: "_".join(words(name)),
    "capital snake case": lambda name: "_".join(words(name)).upper(),
    "side first": side_first,
    "short side": short_side,
    "Audio2Face": lambda name: f"blendShapes.{name[0].upper()}{name[1:]}",
    "Maya": lambda name: f"head:blendShape1.{short_side(name)}",
    "numbered": lambda name: "A14_" + "_".join(words(name)).title(),
    "prefixed": lambda name: f"ARKit_{name}",
    "twice prefixed": lambda name: f"head_ARKit_{short_side(name)}",
    "spaces": lambda name: " " + " ".join(words(name)) + " ",
    "Blender's paths": lambda name: f'key_blocks["{name}"].value',
    "constants of ARKit": lambda name: f"ARBlendShapeLocation{name[0].upper()}{name[1:]}",
    "constants in Objective-C": lambda name: f"kARBlendShapeLocation{name[0].upper()}{name[1:]}",
    "val": lambda name: f"{name}_val",
}


@pytest.mark.parametrize("spelling", SPELLINGS)
def test_every_spelling_in_use_is_understood(spelling: str) -> None:
    spell = SPELLINGS[spelling]
    assert [canonical_channel(spell(name)) for name in ARKIT_CHANNELS] == list(ARKIT_CHANNELS)


@pytest.mark.parametrize(
    "name",
    [
        *("", "_", "L", "Timecode", "BlendShapeCount", "HeadYaw", "LeftEyeYaw", "Head_Left"),
        *("_neutral", "mouth", "jaw", "eyeBlink", "browInnerUp_L", "jawOpen2", "jawOpen_1"),
        *("eyeBlinkLeft.001", "jawOpenSpeed", "notJawOpen", "blendShapes.HeadRoll"),
    ],
)
def test_other_names_mean_no_channel(name: str) -> None:
    assert canonical_channel(name) is None


@settings(deadline=None, derandomize=True)
@given(st.text(CHARACTERS, max_size=40))
def test_any_text_is_a_name(text: str) -> None:
    channel = canonical_channel(text)
    assert channel is None or channel in ARKIT_CHANNELS
