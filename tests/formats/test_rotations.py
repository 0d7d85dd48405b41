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
