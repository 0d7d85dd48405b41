"""Characters are read from every kind of file, and the same head comes out of each."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from support.character_files import (
    FLOAT,
    UNSIGNED,
    picture_of,
    small_glb,
    write_glb,
    write_objs,
    write_vrm,
)
from support.faces import shipped_rig
from support.fbx_files import write_fbx
from support.heads import Head, small_head
from support.places import ROOT

from faceedit_app.characters.fitted import FittedCharacter, open_character
from faceedit_app.characters.points import POINTS
from faceedit_app.characters.registry import read_character
from faceedit_app.core.arkit import ARKIT_CHANNELS

KINDS: dict[str, Callable[[Path], Path]] = {
    "GLB": lambda folder: write_glb(folder / "head.glb"),
    "GLB with sparse targets": lambda folder: write_glb(folder / "head.glb", kind="sparse"),
    "GLB with a skin": lambda folder: write_glb(folder / "head.glb", kind="skinned"),
    "GLB in whole numbers": lambda folder: write_glb(folder / "head.glb", kind="quantized"),
    "GLB packed by meshoptimizer": lambda folder: write_glb(folder / "head.glb", kind="meshopt"),
    "GLB packed by Draco": lambda folder: write_glb(folder / "head.glb", kind="draco"),
    "OBJ": lambda folder: write_objs(folder / "head"),
    "FBX 7.4": lambda folder: write_fbx(folder / "head.fbx"),
    "FBX 7.5": lambda folder: write_fbx(folder / "head.fbx", version=7500),
}


@pytest.fixture(scope="module", params=KINDS)
def opened(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> FittedCharacter:
    return open_character(KINDS[request.param](tmp_path_factory.mktemp("kinds")))


@pytest.fixture(scope="module")
def head() -> Head:
    return small_head()


def test_every_shape_is_matched_and_alive(opened: FittedCharacter) -> None:
    assert tuple(opened.checklist.matched) == ARKIT_CHANNELS
    assert opened.checklist.missing == opened.checklist.dead == ()
    assert opened.checklist.doubts == opened.checklist.remarks == ()


def test_it_is_upright_and_as_large_as_a_face(opened: FittedCharacter, head: Head) -> None:
    """Metres, Y up, facing +Z, whatever unit and axes the file has."""
    rig = opened.rig
    extent = 1000 * np.ptp(rig.neutral, axis=0)
    np.testing.assert_allclose(extent, np.ptp(head.vertices, axis=0), atol=0.3)
    nose = rig.neutral[rig.neutral[:, 2].argmax()]
    assert abs(nose[0]) < 0.004
    assert nose[1] < 0
    left = rig.deltas[rig.channels.index("mouthSmileLeft")]
    assert rig.neutral[np.abs(left).max(axis=1).argmax(), 0] > 0.01


def test_shapes_move_it_as_they_should(opened: FittedCharacter, head: Head) -> None:
    rig = opened.rig
    for channel in ("jawOpen", "eyeBlinkRight", "mouthSmileLeft", "browInnerUp"):
        moves = 1000 * rig.deltas[rig.channels.index(channel)]
        known = head.targets[channel]
        np.testing.assert_allclose(moves.min(0), known.min(0), atol=0.03)
        np.testing.assert_allclose(moves.max(0), known.max(0), atol=0.03)


def test_the_points_are_found(opened: FittedCharacter, head: Head) -> None:
    origin = head.points["inner_upper_lip"]
    start = 1000 * opened.rig.neutral[opened.points["inner_upper_lip"]]
    for name, place in head.points.items():
        found = 1000 * opened.rig.neutral[opened.points[name]] - start
        allowed = 4.5 if "lid" in name or "eye" in name else 3.5 if name[-4:] != "chin" else 1.2
        assert np.linalg.norm(found - (place - origin)) < allowed, name
    assert {*opened.points} == {*POINTS}
    assert opened.rig.missing_controls == ()


def test_faces_look_outwards(opened: FittedCharacter) -> None:
    corners = opened.rig.neutral[opened.rig.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert (normals[:, 2] > 0).mean() > 0.95


def test_the_unit_of_the_file_is_found(tmp_path: Path) -> None:
    assert open_character(write_glb(tmp_path / "a.glb")).frame.scale == pytest.approx(1.0, rel=1e-4)
    assert open_character(write_objs(tmp_path / "b")).frame.scale == pytest.approx(0.01, rel=1e-4)


def test_one_obj_takes_those_beside_it_for_its_shapes(tmp_path: Path) -> None:
    folder = write_objs(tmp_path / "head")
    assert len(read_character(folder / "neutral.obj").targets) == 52


def test_the_obj_of_a_shape_opens_the_head_that_it_belongs_to(tmp_path: Path) -> None:
    folder = write_objs(tmp_path / "head")
    character = read_character(folder / "jawOpen.obj")
    assert set(character.targets) == set(read_character(folder).targets)


def test_an_obj_with_other_vertices_is_left_out_and_said(tmp_path: Path) -> None:
    folder = write_objs(tmp_path / "head")
    (folder / "glasses.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    character = read_character(folder)
    assert len(character.targets) == 52
    assert "glasses.obj" in character.remarks[0]


# --- VRM -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("version", [0, 1])
def test_expressions_of_a_vrm_become_shapes(tmp_path: Path, version: int) -> None:
    fitted = open_character(write_vrm(tmp_path / "head.vrm", version))
    assert fitted.character.format == f"VRM {version}"
    assert fitted.checklist.matched["jawOpen"] == ("a",)
    assert "blink stands for eyeBlinkLeft and eyeBlinkRight" in fitted.checklist.lost
    assert "mouthClose" in fitted.checklist.missing
    assert "Small" in fitted.character.attribution


@pytest.mark.parametrize("version", [0, 1])
def test_a_vrm_faces_us_and_blinks_on_one_side(tmp_path: Path, version: int) -> None:
    """VRM 0 looks backwards, and has but one shape for both eyes."""
    rig = open_character(write_vrm(tmp_path / "head.vrm", version)).rig
    blink = np.abs(rig.deltas[rig.channels.index("eyeBlinkLeft")]).max(axis=1)
    assert (rig.neutral[blink > 1e-5, 0] > 0).all()
    assert rig.neutral[rig.neutral[:, 2].argmax(), 1] < 0  # the nose, below the eyes


def test_joy_smiles_and_does_not_close_the_eyes(tmp_path: Path) -> None:
    rig = open_character(write_vrm(tmp_path / "head.vrm")).rig
    smile = np.abs(rig.deltas[rig.channels.index("mouthSmileLeft")]).max(axis=1)
    assert smile.max() > 0.004
    assert rig.neutral[smile > 1e-5, 1].max() < -0.02


def test_a_vrm_by_another_name_is_recognised(tmp_path: Path) -> None:
    path = write_vrm(tmp_path / "head.vrm").rename(tmp_path / "head.glb")
    assert read_character(path).format == "VRM 0"


# --- parts, colours and textures -----------------------------------------------------------------


@pytest.mark.parametrize("kind", ["PNG", "JPEG", "WEBP"])
def test_a_texture_is_read(tmp_path: Path, kind: str) -> None:
    path = write_glb(tmp_path / "a.glb", picture=picture_of((200, 40, 40), kind))
    rig = open_character(path).rig
    assert rig.materials[0].texture == 0
    assert rig.uv is not None
    assert np.abs(rig.textures[0][8, 8, :3].astype(int) - (200, 40, 40)).max() < 8


def test_a_texture_inside_an_fbx_is_read(tmp_path: Path) -> None:
    path = write_fbx(tmp_path / "a.fbx", texture=picture_of((20, 140, 40)))
    rig = open_character(path).rig
    assert rig.textures[0][8, 8].tolist() == [20, 140, 40, 255]
    assert rig.materials[0].name == "Skin"


@pytest.mark.parametrize(
    "picture", [b"no picture", b"\x89PNG\r\n\x1a\n", b"\xabKTX 20\xbb\r\n\x1a\n"]
)
def test_a_texture_that_cannot_be_read_is_said_and_left_out(tmp_path: Path, picture: bytes) -> None:
    fitted = open_character(write_glb(tmp_path / "a.glb", picture=picture))
    assert fitted.rig.textures == ()
    assert "skin.png cannot be read" in fitted.checklist.remarks[0]


def test_several_meshes_move_together(tmp_path: Path) -> None:
    """Teeth that are a mesh of their own, with a jawOpen of their own."""
    out = small_glb()
    places = np.array([[0, -0.07, -0.01], [0.01, -0.07, -0.01], [0, -0.075, -0.01]])
    target = {"POSITION": out.accessor(np.tile([0, -0.02, 0], (3, 1)), FLOAT)}
    primitive = {
        "attributes": {"POSITION": out.accessor(places, FLOAT)},
        "indices": out.accessor(np.array([0, 1, 2]), UNSIGNED),
        "targets": [target],
    }
    out.mesh([primitive], ["teeth.jawOpen"], name="Teeth")
    (tmp_path / "a.glb").write_bytes(out.content())
    fitted = open_character(tmp_path / "a.glb")
    rig = fitted.rig
    assert [material.surface for material in rig.materials] == ["skin", "teeth"]
    jaw = rig.deltas[rig.channels.index("jawOpen")]
    np.testing.assert_allclose(jaw[-3:, 1], -0.02, atol=1e-5)
    assert fitted.match.alike == {"jawOpen": ("teeth.jawOpen",)}


def test_a_body_is_cut_away_and_said(tmp_path: Path) -> None:
    out = small_glb()
    body = np.array([[-0.2, -0.5, 0], [0.2, -0.5, 0], [0, -1.5, 0], [0.9, -0.05, 0]])
    primitive = {
        "attributes": {"POSITION": out.accessor(body, FLOAT)},
        "indices": out.accessor(np.array([0, 2, 1, 0, 1, 3]), UNSIGNED),
    }
    out.mesh([primitive], [], name="Body")
    (tmp_path / "a.glb").write_bytes(out.content())
    fitted = open_character(tmp_path / "a.glb")
    assert len(fitted.rig.neutral) == len(small_head().vertices)
    assert fitted.checklist.remarks == ("the body below the neck was cut away",)


def test_names_that_say_the_wrong_side_are_put_right(tmp_path: Path) -> None:
    def wrong(name: str) -> str:
        if name.endswith("Left"):
            return name.removesuffix("Left") + "Right"
        return name.removesuffix("Right") + "Left" if name.endswith("Right") else name

    fitted = open_character(write_glb(tmp_path / "a.glb", wrong))
    rig = fitted.rig
    smile = np.abs(rig.deltas[rig.channels.index("mouthSmileLeft")]).max(axis=1)
    assert rig.neutral[smile.argmax(), 0] > 0
    assert "reversed" in fitted.checklist.remarks[0]
    assert rig.neutral[fitted.points["left_upper_lid"], 0] > 0


def test_a_scan_of_many_triangles_is_decimated_and_still_closes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from faceedit_app.characters import assembly

    monkeypatch.setattr(assembly, "MOST_TRIANGLES", 4000)
    monkeypatch.setattr(assembly, "DECIMATED_TO", 3000)
    fitted = open_character(write_glb(tmp_path / "a.glb", picture=picture_of((9, 9, 9))))
    assert len(fitted.rig.faces) < 3300
    assert "were decimated" in fitted.checklist.remarks[0]
    assert {*fitted.points} == {*POINTS}
    rest, opened = (fitted.rig.controls(w)[0, 0] for w in _weights(fitted, {}, {"jawOpen": 1.0}))
    assert opened > rest + 15


def _weights(fitted: FittedCharacter, *frames: dict[str, float]) -> list[np.ndarray]:
    channels = fitted.rig.channels
    return [np.array([[f.get(c, 0.0) for c in channels]], np.float32) for f in frames]


def test_a_file_of_our_own_says_where_its_points_are() -> None:
    fitted = open_character(ROOT / "assets" / "character.glb")
    known = shipped_rig()
    for pair, ours in zip(fitted.rig.control_pairs, known.control_pairs, strict=True):
        for vertex, one in zip(pair, ours, strict=True):
            place = fitted.frame.places(known.neutral[one].astype(np.float64))
            np.testing.assert_allclose(fitted.rig.neutral[vertex], place, atol=1e-6)
