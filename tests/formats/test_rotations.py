"""Rotations of head and eyes go from format to format by their names, however many there are."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest
from support import recordings

from faceedit_app.cli import main
from faceedit_app.core.arkit import ROTATION_INDEX
from faceedit_app.editing.solving.channel_edits import channels_of
from faceedit_app.formats.azure_speech import NAMES
from faceedit_app.formats.opening import open_take, write_take

TURNS = np.linspace(-0.4, 0.5, 90).reshape(30, 3)
FACE = recordings.face(30, channels=52)


def table(path: Path, names: tuple[str, ...]) -> Path:
    rows = [
        ",".join([f"{k / 30:.6f}", f"{0.01 * k:.2f}", *(f"{value:.6f}" for value in row)])
        for k, row in enumerate(TURNS)
    ]
    path.write_text("\n".join([",".join(["time_s", "jawOpen", *names]), *rows]) + "\n")
    return path


def azure(path: Path) -> Path:
    rows = np.concatenate([FACE, TURNS], axis=1).tolist()
    path.write_text(json.dumps([{"FrameIndex": 0, "BlendShapes": rows}]))
    return path


def found(path: Path, names: tuple[str, ...]) -> np.ndarray:
    with path.open(newline="") as file:
        rows = [{key.lower(): cell for key, cell in row.items()} for row in csv.DictReader(file)]
    return np.array([[float(row[name.lower()]) for name in names] for row in rows])


@pytest.mark.parametrize("form", ["livelink", "csv"])
@pytest.mark.parametrize(
    ("written", "names"),
    [
        (("HeadYaw", "HeadPitch", "HeadRoll"), ("headYaw", "headPitch", "headRoll")),
        (("right_eye_roll", "head_pitch", "head_yaw"), ("rightEyeRoll", "headPitch", "headYaw")),
        ((), NAMES[52:]),
    ],
)
def test_rotations_go_into_every_format_that_has_them(
    tmp_path: Path,
    capfd: pytest.CaptureFixture[str],
    form: str,
    written: tuple[str, ...],
    names: tuple[str, ...],
) -> None:
    take = table(tmp_path / "take.csv", written) if written else azure(tmp_path / "take.json")
    out, plain = tmp_path / "out.csv", tmp_path / "plain.csv"
    assert main(["convert", str(take), str(out), "--format", form, "--fps", "60"]) == 0
    assert "left out" not in capfd.readouterr().out
    np.testing.assert_allclose(found(out, names)[:: 2 if written else 1], TURNS, atol=2e-5)
    if form == "livelink":
        assert main(["convert", str(out), str(plain), "--format", "csv"]) == 0
        np.testing.assert_allclose(found(plain, names)[:: 2 if written else 1], TURNS, atol=2e-5)


@pytest.mark.parametrize("is_json", [False, True])
def test_an_edit_changes_the_rotations_that_the_file_has_and_offers_no_others(
    tmp_path: Path, is_json: bool
) -> None:
    names = NAMES[52:] if is_json else ("headYaw", "leftEyeYaw", "leftEyePitch")
    path = azure(tmp_path / "take.json") if is_json else table(tmp_path / "take.csv", names)
    take, out = open_take(path), tmp_path / "out"
    assert take.clip.rotations is not None
    assert {name for name in channels_of(take.clip) if name in ROTATION_INDEX} == set(names)
    turned = take.clip.rotations.copy()
    turned[7, ROTATION_INDEX[names[1]]] = 0.123
    write_take(out, take, take.clip.weights, turned)
    again = open_take(out).clip.rotations
    assert again is not None
    np.testing.assert_allclose(again, turned, atol=1e-6)
    before, after = path.read_bytes().split(b","), out.read_bytes().split(b",")
    changed = [b.strip() for a, b in zip(before, after, strict=True) if a != b]
    assert [float(cell) for cell in changed] == [0.123]


def turned(path: Path, unit: float, turns: np.ndarray = TURNS, is_json: bool = False) -> Path:
    """A take with the head's yaw and both eyes' pitch, written in radians (1) or degrees."""
    names = ("HeadYaw", "LeftEyePitch", "RightEyePitch")
    cells = [[f"{v * unit:.4f}" for v in row] for row in turns]
    if is_json:
        faces = [dict(zip(names, map(float, row), strict=True)) for row in cells]
        rows = [
            {"time": k / 30, "blendshapes": {"jawOpen": 0.01 * k, **face}}
            for k, face in enumerate(faces)
        ]
        path.write_text(json.dumps(rows))
        return path
    lines = [",".join(["time_s", "jawOpen", *names])]
    lines += [",".join([f"{k / 30:.6f}", f"{0.01 * k:.4f}", *row]) for k, row in enumerate(cells)]
    path.write_text("\n".join(lines) + "\n")
    return path


@pytest.mark.parametrize("is_json", [False, True])
def test_degrees_are_recognised_and_written_back_as_degrees(tmp_path: Path, is_json: bool) -> None:
    path = turned(tmp_path / "take", np.degrees(1), is_json=is_json)
    take, out = open_take(path), tmp_path / "out"
    rotations = take.clip.rotations
    assert rotations is not None
    places = [ROTATION_INDEX[name] for name in ("headYaw", "leftEyePitch", "rightEyePitch")]
    np.testing.assert_allclose(rotations[:, places], TURNS, atol=1e-5)
    assert sum("read as degrees, and written as degrees" in note for note in take.notes) == 2
    edited = rotations.copy()
    edited[7, ROTATION_INDEX["leftEyePitch"]] = np.radians(10)
    write_take(out, take, take.clip.weights, edited)
    before, after = path.read_bytes().split(b","), out.read_bytes().split(b",")
    changed = [b for a, b in zip(before, after, strict=True) if a != b]
    assert [float(cell.split(b":")[-1]) for cell in changed] == [10]
    again = open_take(out).clip.rotations
    assert again is not None
    np.testing.assert_allclose(again, edited, atol=1e-6)


@pytest.mark.parametrize(("form", "unit"), [("livelink", 1.0), ("csv", 1.0), ("", np.degrees(1))])
def test_degrees_go_into_other_programs_as_radians(tmp_path: Path, form: str, unit: float) -> None:
    take, out = turned(tmp_path / "take.csv", np.degrees(1)), tmp_path / "out.csv"
    options = ["--format", form] if form else ["--fps", "60"]
    assert main(["convert", str(take), str(out), *options]) == 0
    names = ("HeadYaw", "LeftEyePitch", "RightEyePitch")
    rows = found(out, names)[:: 1 if form else 2]
    np.testing.assert_allclose(rows, TURNS * unit, atol=1e-4 * unit)


@pytest.mark.parametrize(
    ("units", "says"),
    [
        ((1, 1, 1), []),
        ((np.degrees(1), 1, 1), ["HeadYaw"]),
        ((1, np.degrees(1), np.degrees(1)), ["LeftEyePitch"]),
    ],
)
def test_only_what_turns_too_far_for_radians_is_degrees(
    tmp_path: Path, units: tuple[float, ...], says: list[str]
) -> None:
    take = open_take(turned(tmp_path / "take.csv", 1.0, TURNS * units))
    assert [note.split()[0] for note in take.notes if "read as degrees" in note] == says
    assert take.clip.rotations is not None
    assert np.abs(take.clip.rotations).max() == pytest.approx(np.abs(TURNS).max(), abs=1e-3)


@pytest.mark.parametrize(
    ("column", "value", "says"),
    [(0, 40.0, "HeadYaw is 40 in line 6"), (0, 4.0, "HeadYaw is 4"), (1, -2.5, "Pitch is -2.5")],
)
def test_a_rotation_that_no_head_or_eye_makes_is_named_and_stays(
    tmp_path: Path, column: int, value: float, says: str
) -> None:
    turns = TURNS.copy()
    turns[4, column] = value
    take = open_take(turned(tmp_path / "take.csv", 1.0, turns))
    assert [note for note in take.notes if says in note and "in radians, farther than any" in note]
    assert take.clip.rotations is not None
    assert np.abs(take.clip.rotations).max() == pytest.approx(abs(value))


def test_a_full_turn_in_radians_is_not_taken_for_degrees(tmp_path: Path) -> None:
    take = open_take(turned(tmp_path / "take.csv", 1.0, TURNS % (2 * np.pi)))
    assert not any("read as degrees" in note for note in take.notes)
