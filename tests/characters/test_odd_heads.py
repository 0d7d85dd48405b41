"""Heads as programs really write them: copies, levels of detail, in-betweens, damaged shapes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import fast_simplification
import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from support.character_files import (
    FLOAT,
    SHORT,
    UNSIGNED,
    Glb,
    parts_of,
    small_glb,
    write_glb,
    write_objs,
)
from support.fbx_files import fbx_bytes, fbx_of_head, fbx_record, write_fbx
from support.heads import JAW, MOUTH, small_head

from faceedit_app.characters.fitted import FittedCharacter, open_character
from faceedit_app.characters.map_file import map_path, write_map
from faceedit_app.characters.points import MAIN_POINTS
from faceedit_app.characters.registry import read_character
from faceedit_app.characters.scene import shape_weights
from faceedit_app.characters.scenes import SCENES, scene_content
from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.clip import Clip
from faceedit_app.core.errors import FileError

_OBJECTS = ("SubDeformer", "Geometry")  # of a shape in an FBX


def saved(out: Glb, folder: Path) -> FittedCharacter:
    (folder / "head.glb").write_bytes(out.content())
    return open_character(folder / "head.glb")


def assert_whole(fitted: FittedCharacter) -> None:
    """It is the small head, with all its shapes, seen from the front."""
    assert tuple(fitted.checklist.matched) == ARKIT_CHANNELS
    assert fitted.checklist.dead == fitted.checklist.doubts == ()
    rig = fitted.rig
    assert len(rig.neutral) == len(small_head().vertices)
    jaw = 1000 * rig.deltas[rig.channels.index("jawOpen")][:, 1]
    assert jaw.min() == pytest.approx(-JAW, abs=0.1)
    smile = np.abs(rig.deltas[rig.channels.index("mouthSmileLeft")]).max(axis=1)
    assert rig.neutral[smile.argmax(), 0] > 0


@pytest.mark.parametrize(
    "node",
    [
        {"name": "Head.001", "translation": [3.0, 0.0, 0.0]},  # a second one to the side
        {"name": "Copy"},
        {"name": "Copy", "scale": [2.0, 2.0, 2.0], "rotation": [0.0, 0.6, 0.0, 0.8]},
    ],
)
def test_of_a_head_that_a_scene_shows_twice_one_is_opened(
    tmp_path: Path, node: dict[str, Any]
) -> None:
    out = small_glb()
    out.node(mesh=0, **node)
    fitted = saved(out, tmp_path)
    assert_whole(fitted)
    assert fitted.checklist.remarks == (f"copies of the head were left out: {node['name']}",)


def test_of_several_levels_of_detail_the_finest_is_opened(tmp_path: Path) -> None:
    out = small_glb()
    mesh = out.json["meshes"][0]
    (primitive,) = mesh["primitives"]
    coarse = np.asarray(small_head().faces[::2], np.uint32).ravel()
    fewer = primitive | {"indices": out.accessor(coarse, 5125)}
    out.json["nodes"][0]["name"] = "Head_LOD0"
    out.mesh([fewer], mesh["extras"]["targetNames"], name="Head_LOD1")
    fitted = saved(out, tmp_path)
    assert_whole(fitted)
    assert "Head_LOD1" in fitted.checklist.remarks[0]


def test_teeth_on_both_sides_are_not_copies_of_each_other(tmp_path: Path) -> None:
    """Meshes without shapes may well be the same mesh twice, as eyes are."""
    out = small_glb()
    eye = {"attributes": {"POSITION": out.accessor(0.01 * np.eye(3), FLOAT)}}
    out.mesh([eye], [], name="Eye")
    out.node(mesh=len(out.json["meshes"]) - 1, name="Eye", translation=[0.06, 0.0, 0.0])
    fitted = saved(out, tmp_path)
    assert len(fitted.character.parts) == 3


@pytest.mark.parametrize("heads", [1, 2])
def test_each_head_has_both_eyes_though_they_are_one_mesh(tmp_path: Path, heads: int) -> None:
    """Eyes with shapes, as in an FBX that FaceEdit wrote, are not copies of each other."""
    out = small_glb()
    reach = 0.1  # m, about as long as the head
    points = out.accessor(reach * 0.1 * np.eye(3), FLOAT)
    moves = out.accessor(reach * 0.01 * np.eye(3), FLOAT)
    eye = {"attributes": {"POSITION": points}, "targets": [{"POSITION": moves}]}
    out.mesh([eye], ["eyeLookUpLeft"], name="Eye")
    number = len(out.json["meshes"]) - 1
    out.node(mesh=number, name="Eye.R", translation=[0.3 * reach, 0.0, 0.0])
    if heads == 2:
        out.node(mesh=0, name="Copy", translation=[3 * reach, 0.0, 0.0])
        out.node(mesh=number, name="Eye.L2", translation=[3 * reach, 0.0, 0.0])
        out.node(mesh=number, name="Eye.R2", translation=[3.3 * reach, 0.0, 0.0])
    (tmp_path / "head.glb").write_bytes(out.content())
    character = read_character(tmp_path / "head.glb")
    assert len(character.parts) == 3
    middles = [part.neutral.mean(axis=0)[0] for part in character.parts]
    assert np.ptp(middles) < reach
    assert ("Copy" in "".join(character.remarks)) == (heads == 2)


def test_names_of_some_targets_are_used_though_others_lack_theirs(tmp_path: Path) -> None:
    out = small_glb()
    names = out.json["meshes"][0]["extras"]["targetNames"]
    out.json["meshes"][0]["extras"]["targetNames"] = names[:45]
    fitted = saved(out, tmp_path)
    assert len(fitted.checklist.matched) == 45
    assert "target_45" in fitted.checklist.unknown


def test_vertices_that_no_joint_carries_stay_in_place(tmp_path: Path) -> None:
    out = small_glb(kind="skinned")
    attributes = out.json["meshes"][0]["primitives"][0]["attributes"]
    count = len(small_head().vertices)
    attributes["WEIGHTS_0"] = out.accessor(np.zeros((count, 4)), FLOAT)
    assert_whole(saved(out, tmp_path))


@pytest.mark.parametrize("is_last", [True, False])
def test_the_full_shape_of_an_fbx_is_known_by_its_weight(tmp_path: Path, is_last: bool) -> None:
    records = fbx_of_head()
    objects, links = (next(r for r in records if r[0] == n)[2] for n in ("Objects", "Connections"))
    channel = next(
        o for o in objects if o[1][1:] == ["jawOpen\0\1SubDeformer", "BlendShapeChannel"]
    )
    shape = next(o for o in objects if o[1][1:] == ["jawOpen\0\1Geometry", "Shape"])
    rows, moves = shape[2]
    half = fbx_record("Vertices", 0.5 * moves[1][0])
    objects.append(fbx_record("Geometry", 9001, "half\0\1Geometry", "Shape", inside=[rows, half]))
    link = fbx_record("C", "OO", 9001, channel[1][0])
    full = next(i for i, each in enumerate(links) if each[1][1] == shape[1][0])
    links.insert(full if is_last else full + 1, link)
    weights = [50.0, 100.0] if is_last else [100.0, 50.0]
    channel[2].append(fbx_record("FullWeights", np.array(weights)))
    (tmp_path / "head.fbx").write_bytes(fbx_bytes(records))
    assert_whole(open_character(tmp_path / "head.fbx"))


@pytest.mark.parametrize("content", [b"v 1 2\n", b"v nan 0 0\n", b"\0\5\x16\7"])
def test_a_damaged_shape_is_left_out_and_said(tmp_path: Path, content: bytes) -> None:
    folder = write_objs(tmp_path / "head")
    (folder / "tongueOut.obj").write_bytes(content)
    (folder / "._jawOpen.obj").write_bytes(b"what macOS keeps beside a file")
    fitted = open_character(folder)
    assert fitted.checklist.missing == ("tongueOut",)
    assert len(fitted.checklist.remarks) == 1
    assert "tongueOut.obj" in fitted.checklist.remarks[0]


def test_the_only_obj_that_is_no_shape_is_the_neutral_head(tmp_path: Path) -> None:
    folder = write_objs(tmp_path / "head")
    (folder / "neutral.obj").rename(folder / "Bob.obj")
    fitted = open_character(folder)
    assert_whole(fitted)
    assert fitted.checklist.remarks[0].startswith("Bob.obj is used as the neutral head")


def test_a_version_at_the_end_of_a_name_does_not_hide_it(tmp_path: Path) -> None:
    assert_whole(open_character(write_glb(tmp_path / "head.glb", lambda n: f"ARKit.{n}.v2")))


@pytest.mark.parametrize("nods", [-40.0, -30.0, 0.0, 30.0, 45.0])
@pytest.mark.parametrize("turned", ["xy", "xyz"])
def test_a_head_that_nods_in_its_file_is_shown_upright(
    tmp_path: Path, nods: float, turned: str
) -> None:
    turn = Rotation.from_euler(turned, [nods, 25.0, -15.0][: len(turned)], degrees=True)
    out = small_glb()
    out.json["nodes"][0]["rotation"] = turn.as_quat().tolist()
    fitted = saved(out, tmp_path)
    assert fitted.checklist.doubts == ()
    up = turn.apply([0.0, 1.0, 0.0])
    assert np.degrees(np.arccos(fitted.frame.axes[1] @ up)) < 12
    assert fitted.frame.axes[2] @ turn.apply([0.0, 0.0, 1.0]) > 0


@pytest.mark.parametrize(("nods", "is_said"), [(0.0, False), (-16.0, True), (18.0, True)])
def test_a_head_that_may_nod_a_little_is_shown_as_it_is_and_said(
    nods: float, is_said: bool, tmp_path: Path
) -> None:
    out = small_glb()
    turn = Rotation.from_euler("x", nods, degrees=True)
    out.json["nodes"][0]["rotation"] = turn.as_quat().tolist()
    fitted = saved(out, tmp_path)
    np.testing.assert_allclose(fitted.frame.axes, np.eye(3), atol=1e-6)
    assert ("nod by about" in "".join(fitted.checklist.remarks)) == is_said


def test_shapes_for_weights_up_to_a_hundred_are_shown_and_exported_so(tmp_path: Path) -> None:
    out = small_glb()
    primitive = out.json["meshes"][0]["primitives"][0]
    moves = small_head().targets.values()
    primitive["targets"] = [{"POSITION": out.accessor(m / 1e5, FLOAT)} for m in moves]
    fitted = saved(out, tmp_path)
    assert_moves(fitted)
    assert "weight of 100" in fitted.checklist.remarks[0]
    clip = Clip(np.array([[0.0], [0.5]], np.float32), ("jawOpen",), np.arange(2) / 25, 25.0)
    assert shape_weights(clip, fitted.shares, fitted.rig.levels)["jawOpen"].max() == 50
    write_map(map_path(tmp_path / "head.glb"), fitted.whole_map)
    assert_moves(open_character(tmp_path / "head.glb"))


def assert_moves(fitted: FittedCharacter) -> None:
    assert fitted.checklist.dead == fitted.checklist.doubts == ()
    jaw = fitted.rig.deltas[fitted.rig.channels.index("jawOpen")][:, 1]
    assert 1000 * jaw.min() == pytest.approx(-JAW, abs=0.1)


@pytest.mark.parametrize("bits", [12, 14])
def test_parts_that_are_rounded_to_grids_of_their_own_are_still_one_skin(
    tmp_path: Path, bits: int
) -> None:
    """The lips are a part of their own, as those of many heads are."""
    head, out = small_head(), Glb()
    middles = head.vertices[head.faces].mean(axis=1)
    is_mouth = np.hypot(middles[:, 0], middles[:, 1] - MOUTH) < 30
    for name, faces in (("Face", head.faces[~is_mouth]), ("Lips", head.faces[is_mouth])):
        rows = np.unique(faces)
        places = head.vertices[rows] / 1000
        middle = (places.min(axis=0) + places.max(axis=0)) / 2
        step = max(np.abs(places - middle).max(), JAW / 1000) / 2 ** (bits - 1)

        def rounded(array: np.ndarray, step: float = step) -> int:
            return out.accessor(np.round(array / step), SHORT)

        targets = [{"POSITION": rounded(m[rows] / 1000)} for m in head.targets.values()]
        corners = out.accessor(np.searchsorted(rows, faces).ravel(), UNSIGNED)
        position = {"POSITION": rounded(places - middle)}
        primitive = {"attributes": position, "targets": targets, "indices": corners}
        node = {"translation": middle.tolist(), "scale": [step] * 3}
        out.mesh([primitive], list(head.targets), name=name, **node)
    fitted, whole = saved(out, tmp_path), saved(small_glb(), tmp_path)
    assert fitted.checklist.doubts == ()
    for point in ("inner_upper_lip", "inner_lower_lip", "left_mouth_corner", "right_mouth_corner"):
        place = whole.rig.neutral[whole.points[point]]
        assert np.allclose(fitted.rig.neutral[fitted.points[point]], place, atol=5e-4), point


FEW = ("jawOpen", "eyeBlinkLeft", "eyeBlinkRight")


@pytest.mark.parametrize(
    "more",
    [
        (),
        ("mouthSmileLeft", "mouthSmileRight"),
        ("mouthUpperUpLeft", "mouthUpperUpRight", "mouthRollUpper"),
        ("mouthUpperUpLeft", "mouthRollUpper", "mouthLowerDownRight", "mouthLowerDownLeft"),
        ("mouthPucker", "mouthRollLower", "mouthLowerDownLeft"),
    ],
)
def test_jaw_and_blinks_are_enough_to_find_the_mouth(tmp_path: Path, more: tuple[str, ...]) -> None:
    """No shape moves the middle of the lips: it is where the skin goes down with the jaw."""
    few = open_character(write_glb(tmp_path / "few.glb", lambda n: n if n in FEW + more else None))
    whole = open_character(write_glb(tmp_path / "head.glb"))
    assert few.checklist.doubts == few.checklist.dead == ()
    for point in ("inner_upper_lip", "inner_lower_lip", "left_mouth_corner", "right_mouth_corner"):
        place = whole.rig.neutral[whole.points[point]]
        assert np.linalg.norm(few.rig.neutral[few.points[point]] - place) < 0.0035, point


@pytest.mark.parametrize("degrees", [-25.0, 25.0])
def test_a_crooked_mouth_has_its_lips_and_corners(tmp_path: Path, degrees: float) -> None:
    head, out = small_head(), small_glb()
    middle = np.array([6.0, MOUTH, 0.0])
    near = np.exp(-np.square((head.vertices - [0.0, MOUTH, 0.0]) / [45, 30, 1e9]).sum(axis=1))
    turn = Rotation.from_euler("z", degrees, degrees=True)
    turned = turn.apply(head.vertices - [0.0, MOUTH, 0.0]) + middle
    places = head.vertices + near[:, None] * (turned - head.vertices)
    attributes = out.json["meshes"][0]["primitives"][0]["attributes"]
    attributes["POSITION"] = out.accessor(places / 1000, FLOAT)
    fitted = saved(out, tmp_path)
    assert fitted.checklist.doubts == ()
    corners = [fitted.points[f"{side}_mouth_corner"] for side in ("left", "right")]
    across = np.subtract(*fitted.rig.neutral[corners])
    assert 0.035 < np.linalg.norm(across) < 0.06
    assert np.sign(across[1]) == np.sign(degrees)
    lips = [fitted.points[f"inner_{lip}_lip"] for lip in ("upper", "lower")]
    assert np.linalg.norm(np.subtract(*fitted.rig.neutral[lips])) < 0.002


def test_shapes_that_are_too_few_are_named(tmp_path: Path) -> None:
    path = write_glb(tmp_path / "head.glb", lambda n: n if n in FEW[:2] else f"x {n[::-1]}")
    with pytest.raises(
        FileError, match=r"for eyeBlinkLeft and jawOpen only.*unknown: x .*; rename"
    ):
        open_character(path)


def test_what_needs_the_jaw_is_not_doubted_without_it(tmp_path: Path) -> None:
    path = write_glb(tmp_path / "head.glb", lambda n: None if n == "jawOpen" else n)
    assert "jaw" not in " ".join(open_character(path).checklist.doubts)


@pytest.mark.parametrize("is_of_node", [True, False])
def test_shapes_that_make_a_face_someones_stay_as_they_are_in_the_file(
    tmp_path: Path, is_of_node: bool
) -> None:
    """Those of channels rest at 0, whatever the file shows; an export keeps the others."""
    out = small_glb(lambda name: "longer chin" if name == "jawForward" else name)
    names = out.json["meshes"][0]["extras"]["targetNames"]
    weights = [0.5 if name in ("longer chin", "jawOpen") else 0.0 for name in names]
    holder = out.json["nodes" if is_of_node else "meshes"][0]
    holder["weights"] = weights
    fitted, plain = saved(out, tmp_path), open_character(write_glb(tmp_path / "plain.glb"))
    moves = plain.rig.deltas[plain.rig.channels.index("jawForward")]
    places = fitted.rig.neutral - plain.rig.neutral
    np.testing.assert_allclose(
        places - places.mean(axis=0), 0.5 * (moves - moves.mean(axis=0)), atol=2e-5
    )
    clip = Clip(np.array([[0.0], [0.2]], np.float32), ("jawOpen",), np.arange(2) / 25, 25.0)
    document, binary = parts_of(scene_content(SCENES[0], clip, fitted, "take"))
    accessor = document["accessors"][document["animations"][0]["samplers"][0]["output"]]
    start = document["bufferViews"][accessor["bufferView"]]["byteOffset"]
    played = np.frombuffer(binary, "<f4", accessor["count"], start).reshape(2, -1)
    assert played[:, names.index("longer chin")] == pytest.approx([0.5, 0.5])
    assert played[:, names.index("jawOpen")] == pytest.approx([0.0, 0.2])


def test_an_fbx_keeps_such_shapes_too(tmp_path: Path) -> None:
    records = fbx_of_head(lambda name: "longer chin" if name == "jawForward" else name)
    objects = next(r for r in records if r[0] == "Objects")[2]
    channel = next(
        o for o in objects if o[1][1:] == ["longer chin\0\1SubDeformer", "BlendShapeChannel"]
    )
    percent = fbx_record("P", "DeformPercent", "Number", "", "A", 50.0)
    channel[2].append(fbx_record("Properties70", inside=[percent]))
    (tmp_path / "head.fbx").write_bytes(fbx_bytes(records))
    (part,) = open_character(tmp_path / "head.fbx").character.parts
    (plain,) = read_character(write_fbx(tmp_path / "plain.fbx")).parts
    moved = part.neutral - plain.neutral
    np.testing.assert_allclose(moved, 0.5 * plain.targets["jawForward"], atol=1e-4)


def test_of_two_different_heads_one_is_opened(tmp_path: Path) -> None:
    """Each with an eye of its own, which has no shapes."""
    out, fewer = small_glb(), list(ARKIT_CHANNELS[:48])
    reach = 0.1  # m, about as long as the head
    eye = {"attributes": {"POSITION": out.accessor(0.1 * reach * np.eye(3), FLOAT)}}
    (primitive,) = out.json["meshes"][0]["primitives"]
    second = primitive | {"targets": primitive["targets"][:48]}
    there = {"translation": [5 * reach, reach, 0.0], "scale": [1.2] * 3}
    out.mesh([second], [f"Bob.{name}" for name in fewer], name="Bob", **there)
    out.mesh([eye], [], name="Eye")
    out.mesh([eye], [], name="Bob's eye", translation=[5 * reach, reach, 0.0])
    fitted = saved(out, tmp_path)
    assert tuple(fitted.checklist.matched) == ARKIT_CHANNELS
    assert fitted.checklist.unknown == fitted.checklist.doubts == ()
    assert [part.name for part in fitted.character.parts] == ["Head", "Eye"]
    assert "another head was left out: Bob" in fitted.checklist.remarks[0]


@pytest.mark.parametrize("triangles", [1000, 300])
def test_coarse_heads_have_all_main_points(tmp_path: Path, triangles: int) -> None:
    (part,) = read_character(write_glb(tmp_path / "head.glb")).parts
    places, faces, collapses = fast_simplification.simplify(
        part.neutral, part.faces, target_count=triangles, return_collapses=True
    )
    _, faces, kept = fast_simplification.replay_simplification(part.neutral, part.faces, collapses)
    first = np.unique(kept, return_index=True)[1]
    out = small_glb()
    (primitive,) = out.json["meshes"][0]["primitives"]
    primitive["attributes"] = {"POSITION": out.accessor(places, FLOAT)}
    primitive["indices"] = out.accessor(faces.ravel(), UNSIGNED)
    primitive["targets"] = [
        {"POSITION": out.accessor(moves[first], FLOAT)} for moves in part.targets.values()
    ]
    assert set(MAIN_POINTS) <= set(saved(out, tmp_path).points)
