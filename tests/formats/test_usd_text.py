"""Animations in USD text open with their own times, and an export changes one number alone."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from support import recordings

from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.errors import FileError
from faceedit_app.formats.opening import open_take, write_take
from faceedit_app.formats.registry import find_format

FACE = recordings.face()


def usda(codes: float | None = 30, first: float = 1, step: float = 1, lost: int = -1) -> str:
    head = "" if codes is None else f"(\n    timeCodesPerSecond = {codes:g}\n)\n"
    names = ", ".join(f'"{name}"' for name in (*ARKIT_CHANNELS, "headYaw"))
    rows = [
        f"            {first + n * step:g}: [{', '.join(map(str, row))}, 0.5],"
        for n, row in enumerate(FACE.tolist())
    ]
    if lost >= 0:
        rows[lost] = f"            {first + lost * step:g}: None,"
    samples = "\n".join(rows)
    return f"""#usda 1.0
{head}def SkelRoot "Face"
{{
    def Mesh "Head"
    {{
        uniform token[] skel:blendShapes = [{names}]
    }}
    def SkelAnimation "Body"
    {{
        quatf[] rotations.timeSamples = {{ 1: [(1, 0, 0, 0)], }}
    }}
    def SkelAnimation "Animation"
    {{
        uniform token[] blendShapes = [{names}]
        float[] blendShapeWeights.timeSamples = {{
{samples}
        }}
    }}
}}
"""


@pytest.mark.parametrize(
    ("text", "rate"),
    [
        (usda(30), 30),
        (usda(24, first=0), 24),
        (usda(120, step=2), 60),
        (usda(1, first=0.5, step=0.04), 25),
        (usda(None), 24),
    ],
)
def test_an_animation_opens_and_an_edit_changes_its_number_alone(
    tmp_path: Path, text: str, rate: float
) -> None:
    path, out = tmp_path / "take.usda", tmp_path / "out.usda"
    path.write_text(text)
    take = open_take(path)
    assert take.clip.rate == rate
    assert take.clip.gaps == ()
    assert np.allclose(take.clip.arkit_weights(), FACE, atol=1e-7)
    assert take.carried == ("headYaw",)
    assert any("24 are assumed" in note for note in take.notes) == ("timeCodes" not in text)
    write_take(out, take, take.clip.weights)
    assert out.read_text() == text
    edited = take.clip.weights.copy()
    edited[17, 5] = 0.7654
    write_take(out, take, edited)
    assert np.allclose(open_take(out).clip.weights, edited, atol=1e-7)
    before, after = text.split(","), out.read_text().split(",")
    assert sum(a != b for a, b in zip(before, after, strict=True)) == 1


def test_blocked_samples_are_gaps(tmp_path: Path) -> None:
    path = tmp_path / "take.usda"
    path.write_text(usda(lost=9))
    assert [(gap.frame, gap.missing) for gap in open_take(path).clip.gaps] == [(8, 1)]


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        (", 0.5],", "],", "line 19: has 52 weights where 53 shapes are named"),
        ("0.5, ", "x, ", 'line 19: holds "x", not a number'),
        ("3: [", "2: [", "the time code 2 does not come after 2"),
        ("3: [", "-: [", 'line 21: holds "-", not a number'),
        ('"eyeBlinkLeft", "eyeLookDownLeft"', '"jawOpen", "eyeLookDownLeft"', "twice"),
    ],
)
def test_damage_is_refused_with_its_line(tmp_path: Path, old: str, new: str, says: str) -> None:
    path = tmp_path / "take.usda"
    text = usda()
    place = text.index('SkelAnimation "Animation"')
    path.write_text(text[:place] + text[place:].replace(old, new, 1))
    with pytest.raises(FileError) as refused:
        open_take(path)
    assert says in str(refused.value)


def test_usd_without_weights_is_no_take() -> None:
    assert find_format(usda().replace("blendShapeWeights", "weights").encode()) is None
