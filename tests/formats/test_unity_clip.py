"""Animation clips of Unity open if their keys are frames, and both copies of a curve are edited."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from faceedit_app.core.errors import FileError
from faceedit_app.formats.opening import open_take, write_take

NAMES = ("jawOpen", "eyeBlink_L", "eyeBlink_R")
FRAMES = 40
HEAD = """%YAML 1.1
%TAG !u! tag:unity3d.com,2011:
--- !u!74 &7400000
AnimationClip:
  m_Name: face
  serializedVersion: 6
  m_RotationCurves: []
"""
TAIL = """  m_PPtrCurves: []
  m_SampleRate: 60
  m_AnimationClipSettings:
    m_StartTime: 0
    m_StopTime: 0.65
"""


def weight(n: int, k: int) -> float:
    return round(50 + 30 * float(np.sin(n / 5 + k)), 4)


def key(time: float, value: float) -> str:
    return f"""      - serializedVersion: 3
        time: {np.float32(time)}
        value: {value:g}
        inSlope: 0
        outSlope: Infinity
        tangentMode: 136
        weightedMode: 0
        inWeight: 0.33333334
        outWeight: 0.33333334
"""


def curve(attribute: str, keys: list[tuple[float, float]], path: str = "Head") -> str:
    inner = "".join(key(time, value) for time, value in keys)
    return f"""  - serializedVersion: 2
    curve:
      serializedVersion: 2
      m_Curve:
{inner}      m_PreInfinity: 2
      m_PostInfinity: 2
      m_RotationOrder: 4
    attribute: {attribute}
    path: {path}
    classID: 137
    script: {{fileID: 0}}
"""


def shape(
    k: int, step: int = 1, path: str = "Head", shift: int = 0, share: float = 1, still: bool = False
) -> str:
    frames = range(0, FRAMES, step)
    keys = [(n / 60, 0 if still else share * weight(n + shift, k)) for n in frames]
    return curve(f"blendShape.{NAMES[k]}", keys, path)


def clip(*curves: str) -> str:
    body = "".join(curves)
    return f"{HEAD}  m_FloatCurves:\n{body}{TAIL}  m_EditorCurves:\n{body}  m_Events: []\n"


OTHERS = curve("blendShape.tongueOut", [(0.0, 0.0)]) + curve("m_LocalScale.x", [(0.0, 1.0)])


def test_a_clip_opens_as_percent_at_the_rate_of_its_keys(tmp_path: Path) -> None:
    path = tmp_path / "face.anim"
    path.write_text(clip(*map(shape, range(3)), OTHERS))
    take = open_take(path)
    assert (take.format, take.clip.rate, take.clip.gaps) == ("Unity animation clip", 60, ())
    assert take.clip.channels == ("jawOpen", "eyeBlinkLeft", "eyeBlinkRight")
    expected = [[weight(n, k) / 100 for k in range(3)] for n in range(FRAMES)]
    np.testing.assert_allclose(take.clip.weights, expected, atol=1e-6)
    assert "1 channel with one or two keys: carried" in take.notes


def test_an_edit_changes_one_key_in_both_copies(tmp_path: Path) -> None:
    path, out = tmp_path / "face.anim", tmp_path / "out.anim"
    path.write_text(clip(*map(shape, range(3)), OTHERS))
    take = open_take(path)
    write_take(out, take, take.clip.weights)
    assert out.read_bytes() == path.read_bytes()
    edited = take.clip.weights.copy()
    edited[7, 1] = 0.255
    write_take(out, take, edited)
    before, after = path.read_text().splitlines(), out.read_text().splitlines()
    changed = [new for old, new in zip(before, after, strict=True) if old != new]
    assert changed == ["        value: 25.5"] * 2
    np.testing.assert_allclose(open_take(out).clip.weights, edited, atol=1e-6)


OTHERS_OF_THEIR_OWN = {
    "another person": [shape(k, path="Bob/Face", shift=9 * (k < 2)) for k in range(3)],
    "with other keys": [shape(k, path="Bob/Face", shift=9, step=2) for k in range(3)],
    "who is still": [shape(k, path="Bob/Face", still=True) for k in range(3)],
    "teeth with a share": [shape(k, path="Teeth", share=0.8) for k in range(2)],
}


@pytest.mark.parametrize("other", OTHERS_OF_THEIR_OWN.values(), ids=OTHERS_OF_THEIR_OWN)
@pytest.mark.parametrize("channel", [0, 2])
def test_the_mesh_of_another_person_is_kept_and_said(
    tmp_path: Path, other: list[str], channel: int
) -> None:
    path, out = tmp_path / "face.anim", tmp_path / "out.anim"
    path.write_text(clip(*(shape(k, path="Anna/Face") for k in range(3)), *other))
    take = open_take(path)
    assert take.unread == ('2 meshes have weights of their own: those of "Anna/Face" are read',)
    edited = take.clip.weights.copy()
    edited[8, channel] = 0.255
    write_take(out, take, edited)
    before, after = path.read_text().splitlines(), out.read_text().splitlines()
    changed = [new for old, new in zip(before, after, strict=True) if old != new]
    assert changed == ["        value: 25.5"] * 2
    assert "\n".join(after).count("".join(other).strip("\n")) == 2


def test_teeth_with_the_weights_of_the_head_are_edited_along(tmp_path: Path) -> None:
    path, out = tmp_path / "face.anim", tmp_path / "out.anim"
    teeth = [shape(0, path="Teeth"), shape(1, path="Teeth", still=True)]
    path.write_text(clip(*teeth, *map(shape, range(3))))
    take = open_take(path)
    assert take.unread == ()
    expected = [[weight(n, k) / 100 for k in range(3)] for n in range(FRAMES)]
    np.testing.assert_allclose(take.clip.weights, expected, atol=1e-6)
    edited = take.clip.weights.copy()
    edited[7, :2] = 0.255
    write_take(out, take, edited)
    before, after = path.read_text().splitlines(), out.read_text().splitlines()
    changed = [new for old, new in zip(before, after, strict=True) if old != new]
    assert changed == ["        value: 25.5"] * 6  # jawOpen of both meshes, and a blink


def test_keys_that_are_not_frames_are_refused_in_one_line(tmp_path: Path) -> None:
    path = tmp_path / "face.anim"
    path.write_text(clip(shape(0), shape(1, step=3)))
    with pytest.raises(FileError, match="keys at other times for eyeBlink_L than for jawOpen"):
        open_take(path)


def test_a_damaged_key_is_named_by_its_line(tmp_path: Path) -> None:
    path = tmp_path / "face.anim"
    path.write_text(clip(shape(0)).replace("value: 50", "value: fifty", 1))
    with pytest.raises(FileError, match='line 15: holds "fifty", not a finite number'):
        open_take(path)


def test_a_clip_of_something_else_is_named(tmp_path: Path) -> None:
    path = tmp_path / "walk.anim"
    path.write_text(clip(curve("m_LocalScale.x", [(0.0, 1.0), (1.0, 2.0)])))
    with pytest.raises(FileError, match="is a file of Unity without curves of ARKit's shapes"):
        open_take(path)
