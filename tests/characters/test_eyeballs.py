"""Characters without a shape that closes the eyes: the eyes are found by their eyeballs."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh
from support.heads import EYE, small_head

from faceedit_app.characters.character import Character, MeshPart
from faceedit_app.characters.fitted import fit
from faceedit_app.core.errors import FileError

VISEMES = {"jawOpen": "viseme_aa", "mouthFunnel": "viseme_O", "mouthPucker": "viseme_U"}


def skin() -> MeshPart:
    head = small_head()
    targets = {name: head.targets[channel].astype(np.float32) for channel, name in VISEMES.items()}
    return MeshPart("Skin", head.vertices.astype(np.float32), head.faces.astype(np.int32), targets)


def eyeball(x: float, half: bool = False, name: str = "Ball") -> MeshPart:
    ball = trimesh.creation.icosphere(subdivisions=3, radius=12.0)
    faces = ball.faces
    if half:
        faces = faces[(ball.vertices[faces][:, :, 2] > -1).all(axis=1)]
    used, faces = np.unique(faces, return_inverse=True)
    places = ball.vertices[used] + (x, 0.0, -18.0)
    return MeshPart(name, places.astype(np.float32), faces.reshape(-1, 3).astype(np.int32))


def character(*parts: MeshPart) -> Character:
    return Character(Path("head.glb"), "glTF", parts)


@pytest.mark.parametrize("half", [False, True])
def test_a_head_with_visemes_only_is_found_by_its_eyeballs(half: bool) -> None:
    fitted = fit(character(skin(), eyeball(EYE, half), eyeball(-EYE, half)))
    assert fitted.frame.scale == pytest.approx(0.001, rel=0.02)
    assert fitted.frame.axes == pytest.approx(np.eye(3), abs=0.02)
    assert set(fitted.checklist.matched) >= {"jawOpen", "mouthFunnel", "mouthPucker"}
    assert {"inner_upper_lip", "chin", "nose_bridge"} <= set(fitted.points)
    assert "no shape closes the left eye (eyeBlinkLeft)" in fitted.checklist.doubts


def test_eyeballs_may_be_pieces_of_the_same_mesh() -> None:
    parts = (skin(), eyeball(EYE), eyeball(-EYE))
    starts = np.cumsum([0, *(len(part.neutral) for part in parts)])
    places = np.concatenate([part.neutral for part in parts])
    faces = np.concatenate([p.faces + s for p, s in zip(parts, starts[:-1], strict=True)])
    targets = {
        name: np.concatenate((moves, np.zeros((len(places) - len(moves), 3), np.float32)))
        for name, moves in parts[0].targets.items()
    }
    fitted = fit(character(MeshPart("All", places, faces.astype(np.int32), targets)))
    assert fitted.frame.scale == pytest.approx(0.001, rel=0.02)


def test_meshes_named_as_eyes_come_before_larger_balls() -> None:
    earrings = [
        replace(eyeball(x), neutral=eyeball(x).neutral * np.float32(1.6)) for x in (-45.0, 45.0)
    ]
    eyes = [eyeball(-EYE, name="EyeRight"), eyeball(EYE, name="EyeLeft")]
    fitted = fit(character(skin(), *earrings, *eyes))
    assert fitted.frame.scale == pytest.approx(0.001, rel=0.02)


def test_without_eyeballs_it_says_which_shapes_are_missing() -> None:
    with pytest.raises(FileError, match="no shapes that close the eyes"):
        fit(character(skin(), eyeball(EYE)))
