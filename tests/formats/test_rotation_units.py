"""Rotations are in the unit that the file says; if it says none, in the only one that can be."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from faceedit_app.core.arkit import ROTATION_INDEX
from faceedit_app.formats.opening import open_take, write_take

NAMES = ("headYaw", "headPitch", "headRoll")
FRAMES = 60
CALM = np.sin(np.arange(FRAMES) / 9)[:, None] * [1.1, 0.6, 0.4]  # degrees, or many radians


def table(
    path: Path,
    names: tuple[str, ...] = NAMES,
    turns: np.ndarray = CALM,
    units: str = "",
    before: str = "",
    encoding: str = "utf-8",
) -> Path:
    lines = [",".join(["time", "jawOpen", *names]), *([units] if units else [])]
    for n, row in enumerate(turns.tolist()):
        lines.append(",".join([f"{n / 30:.3f}", f"{0.01 * n:.2f}", *(f"{v:.3f}" for v in row)]))
    path.write_text(before + "\n".join(lines) + "\n", encoding=encoding)
    return path


def head(path: Path) -> np.ndarray:
    rotations = open_take(path).clip.rotations
    assert rotations is not None
    return rotations[:, :3]


@pytest.mark.parametrize(
    "name",
    ["{} [°]", "{} (deg)", "{}_deg", "{}Degrees", "{} (º)", "{}_angle_degrees", "{}_rad", "{}"],
)
def test_a_unit_in_the_names_decides_and_stays(tmp_path: Path, name: str) -> None:
    path = table(tmp_path / "take.csv", tuple(name.format(one) for one in NAMES))
    take, out = open_take(path), tmp_path / "out.csv"
    assert not [note for note in take.notes if "read as" in note]
    unit = 1.0 if name in ("{}_rad", "{}") else np.degrees(1)
    np.testing.assert_allclose(head(path), CALM / unit, atol=1e-3)
    edited = take.clip.rotations
    assert edited is not None
    edited = edited.copy()
    edited[7, ROTATION_INDEX["headPitch"]] = 0.25 / unit
    write_take(out, take, take.clip.weights, edited)
    before, after = path.read_bytes().split(b","), out.read_bytes().split(b",")
    changed = [b for a, b in zip(before, after, strict=True) if a != b]
    assert [float(cell) for cell in changed] == [0.25]


def test_a_sign_that_was_saved_in_an_older_encoding_is_still_one(tmp_path: Path) -> None:
    names = tuple(f"{name} [°]" for name in NAMES)
    path = table(tmp_path / "take.csv", names, encoding="latin-1")
    np.testing.assert_allclose(head(path), np.radians(CALM), atol=1e-4)


@pytest.mark.parametrize(
    ("units", "before"),
    [
        ("s,,°,°,°", ""),
        ("s,1,deg,deg,deg", ""),
        ("[s],[0-1],[deg],[deg],[deg]", ""),
        (",,degrees,degrees,degrees", ""),
        ("", "# head rotation in degrees\n"),
    ],
)
def test_a_row_of_units_or_a_comment_says_degrees(tmp_path: Path, units: str, before: str) -> None:
    path = table(tmp_path / "take.csv", units=units, before=before)
    np.testing.assert_allclose(head(path), np.radians(CALM), atol=1e-4)
    assert "read as" not in " ".join(open_take(path).notes)


def test_degrees_by_which_a_film_is_turned_are_no_unit(tmp_path: Path) -> None:
    path = table(tmp_path / "take.csv", before="# video rotation: 90 degrees\n")
    np.testing.assert_allclose(head(path), CALM, atol=1e-3)


def test_radians_that_the_file_says_stay_and_what_no_head_does_is_named(tmp_path: Path) -> None:
    path = table(tmp_path / "take.csv", turns=12 * CALM, units="s,,rad,rad,rad")
    np.testing.assert_allclose(head(path), 12 * CALM, atol=1e-3)
    (note,) = [note for note in open_take(path).notes if "farther than any head turns" in note]
    assert "in radians" in note
    assert "as the file says" in note


def test_the_same_rotation_in_both_units_is_read_in_radians(tmp_path: Path) -> None:
    names = (*NAMES, *(f"{name}_deg" for name in NAMES))
    turns = np.concatenate([np.radians(CALM), CALM], axis=1)
    take = open_take(table(tmp_path / "take.csv", names, turns))
    assert take.clip.rotations is not None
    np.testing.assert_allclose(take.clip.rotations[:, :3], np.radians(CALM), atol=1e-3)
    assert {*names} <= {*take.carried}


@pytest.mark.parametrize("most", [1.8, 3.0, 5.0])
def test_a_calm_head_that_would_turn_round_in_radians_is_in_degrees(
    tmp_path: Path, most: float
) -> None:
    turns = CALM * (most / 1.1)
    path = table(tmp_path / "take.csv", turns=turns)
    np.testing.assert_allclose(head(path), np.radians(turns), atol=1e-4)
    assert any("headYaw and 2 more go as far as" in note for note in open_take(path).notes)


@pytest.mark.parametrize(
    ("name", "middle", "swing"),
    [("headRoll", np.pi / 2, 0.4), ("headRoll", 0.0, 2.0), ("headPitch", np.pi, 0.3)],
)
def test_a_camera_that_is_turned_leaves_radians_and_a_remark_asks(
    tmp_path: Path, name: str, middle: float, swing: float
) -> None:
    turns = middle + swing * CALM[:, :1] / 1.1
    turns = (turns + np.pi) % (2 * np.pi) - np.pi
    path = table(tmp_path / "take.csv", (name,), turns)
    rotations = open_take(path).clip.rotations
    assert rotations is not None
    np.testing.assert_allclose(rotations[:, ROTATION_INDEX[name]], turns[:, 0], atol=1e-3)
    (note,) = [note for note in open_take(path).notes if "farther than any head turns" in note]
    assert "in radians, farther than any head turns" in note
    assert f'if it is in degrees, name it "{name}_deg"' in note


def test_an_eye_that_looks_too_far_in_radians_is_named(tmp_path: Path) -> None:
    path = table(tmp_path / "take.csv", ("leftEyeYaw",), CALM[:, :1])
    assert any("farther than any eye turns" in note for note in open_take(path).notes)


@pytest.mark.parametrize("scale", [np.degrees(1), 1.0])
def test_eyes_in_another_unit_than_the_head_are_named(tmp_path: Path, scale: float) -> None:
    names = ("headYaw_deg", "leftEyeYaw", "leftEyePitch")
    path = table(tmp_path / "take.csv", names, 0.4 * CALM * [scale, 1, 1])
    notes = " ".join(open_take(path).notes)
    assert "leftEyeYaw and 1 more go only as far as 0.24: read as radians" in notes
