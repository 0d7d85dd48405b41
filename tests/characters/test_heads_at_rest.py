"""Heads whose lips or eyes are not in the file as a take at rest expects them, or blink weakly."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from support.character_files import FLOAT, Glb, small_glb
from support.faces import shipped_rig
from support.heads import small_head

from faceedit_app.characters.closure import Openings
from faceedit_app.characters.fitted import FittedCharacter, open_character
from faceedit_app.characters.map_file import map_path, write_map
from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.editing.solving.closing import Closing

BLINKS = ("eyeBlinkLeft", "eyeBlinkRight")


def saved(out: Glb, folder: Path) -> FittedCharacter:
    (folder / "head.glb").write_bytes(out.content())
    return open_character(folder / "head.glb")


def changed(out: Glb, rest: dict[str, float], factors: dict[str, float]) -> Glb:
    """A head whose file is written with shapes at `rest`, and others scaled by `factors`."""
    head = small_head()
    places = head.vertices + sum(weight * head.targets[name] for name, weight in rest.items())
    (primitive,) = out.json["meshes"][0]["primitives"]
    primitive["attributes"]["POSITION"] = out.accessor(places / 1000, FLOAT)
    names = out.json["meshes"][0]["extras"]["targetNames"]
    for channel, factor in factors.items():
        moves = out.accessor(factor * head.targets[channel] / 1000, FLOAT)
        primitive["targets"][names.index(channel)] = {"POSITION": moves}
    return out


def test_lips_that_rest_apart_count_as_shut_there(tmp_path: Path) -> None:
    """Weights bring them nearer only by grimaces."""
    fitted = saved(changed(small_glb(), {"jawOpen": 0.12}, {}), tmp_path)
    (doubt,) = fitted.checklist.doubts
    assert doubt.startswith("the inner lips rest 3.")
    still = np.zeros((1, len(ARKIT_CHANNELS)), np.float32)
    assert Openings.of(fitted.rig).measure(still)[0, 0] == pytest.approx(0.0, abs=1e-3)
    assert np.array_equal(Closing(shipped_rig(), fitted.rig)(still), still)


def test_a_blink_that_is_too_weak_says_what_closes_the_eye(tmp_path: Path) -> None:
    without = small_glb(lambda name: None if "Squint" in name else name)
    fitted = saved(changed(without, {}, dict.fromkeys(BLINKS, 0.45)), tmp_path)
    first, second = fitted.checklist.doubts
    assert first.startswith("eyeBlinkLeft leaves the left eye ")
    assert "there is no eyeSquintLeft; a multiplier of 1." in first
    times = float(first.split("multiplier of ")[1].split()[0])
    assert f"multiplier of {times:.2f}" in second
    left = fitted.with_level(BLINKS[0], (times, 0.0, 1.0))
    assert left.checklist.doubts == (second,)
    assert left.with_level(BLINKS[0], (0.9, 0.0, 1.0)).checklist.doubts[0].startswith(BLINKS[0])
    write_map(map_path(fitted.character.path), left.mapping)
    assert open_character(fitted.character.path).checklist.doubts == (second,)
    for channel in BLINKS:
        fitted = fitted.with_level(channel, (times, 0.0, 1.0))
    assert fitted.checklist.doubts == ()
    shut = np.zeros((1, len(ARKIT_CHANNELS)), np.float32)
    shut[0, [ARKIT_CHANNELS.index(channel) for channel in BLINKS]] = 1.0
    assert Openings.of(fitted.rig).measure(shut)[0, 1:].max() < 0.5


def test_eyes_that_are_shut_in_the_file_are_said(tmp_path: Path) -> None:
    fitted = saved(
        changed(small_glb(), dict.fromkeys(BLINKS, 0.9), dict.fromkeys(BLINKS, 0.1)), tmp_path
    )
    assert "left_upper_lid" not in fitted.points
    assert fitted.checklist.doubts[0].startswith("eyeBlinkLeft moves the lid by only 0.9 mm")


def test_skin_beside_the_eyes_that_blinks_pull_along_does_not_change_the_size(
    tmp_path: Path,
) -> None:
    """The eyes, which show the size of a head, are where the lids are."""
    head, out = small_head(), small_glb()
    (primitive,) = out.json["meshes"][0]["primitives"]
    names = out.json["meshes"][0]["extras"]["targetNames"]
    near = np.exp(-np.square((head.vertices - [0.0, 5.0, 0.0]) / [14, 16, 1e9]).sum(axis=1))
    for channel in BLINKS:
        moves = head.targets[channel] - 3.0 * near[:, None] * [0.0, 1.0, 0.0]
        moves *= np.abs(head.targets[channel]).max() / np.abs(moves).max()
        primitive["targets"][names.index(channel)] = {"POSITION": out.accessor(moves / 1000, FLOAT)}
    assert saved(out, tmp_path).frame.scale == pytest.approx(1.0, rel=0.05)
