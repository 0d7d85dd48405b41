"""Eyes without eyeLook shapes are turned: eyeballs, or what the joints of eyes carry."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import trimesh
from support.character_files import (
    FLOAT,
    UNSIGNED,
    UNSIGNED_BYTE,
    Glb,
    glb_of,
    parts_of,
    small_glb,
)
from support.fbx_files import fbx_bytes, fbx_of_head, fbx_record
from support.heads import EYE

from faceedit_app.characters.fitted import FittedCharacter, open_character
from faceedit_app.characters.gaze import LOOKS
from faceedit_app.characters.registry import read_character
from faceedit_app.characters.scenes import SCENES, scene_content
from faceedit_app.core.arrays import Doubles
from faceedit_app.core.clip import Clip

RADIUS = 0.012  # metres
ASKEW = [0.0, 0.6, 0.0, 0.8]


def without_looks() -> Glb:
    return small_glb(lambda name: None if name.startswith("eyeLook") else name)


def add_eyeballs(out: Glb) -> None:
    """Two balls behind the lids, and a flat iris in front of each."""
    ball = trimesh.creation.icosphere(2, RADIUS)
    iris = np.array([[x, y, 0.98 * RADIUS] for x, y in ((0, 0), (2, 0), (0, 2), (-2, 0), (0, -2))])
    iris[:, :2] /= 1000
    fan = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1]])
    places = np.concatenate((ball.vertices, iris))
    faces = np.concatenate((ball.faces, fan + len(ball.vertices)))
    for name, x in (("Eye_L", EYE), ("Eye_R", -EYE)):
        moved = places + np.array([x / 1000, 0.0, -RADIUS - 0.006])
        primitive = {
            "attributes": {"POSITION": out.accessor(moved, FLOAT)},
            "indices": out.accessor(faces.ravel(), UNSIGNED),
        }
        out.mesh([primitive], [], name=name)


def flat_eye() -> tuple[Doubles, np.ndarray]:
    """(16, 3) metres, and (18, 3): a small square that faces Z."""
    across = np.linspace(-0.006, 0.006, 4)
    square = np.array([[x, y, 0.0] for x in across for y in across])
    quads = [(i, i + 4, i + 5, i + 1) for i in range(11) if i % 4 < 3]
    return square, np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])


def add_eye_joints(out: Glb) -> None:
    """Flat eyes on a skin, as anime heads have them; each joint lies 3 cm behind its eye."""
    disc, faces = flat_eye()
    places = np.concatenate([disc + np.array([x / 1000, 0, -0.004]) for x in (EYE, -EYE)])
    joints = [
        out.node(name=name, translation=[x / 1000, 0.0, -0.034])
        for name, x in (("J_Bip_Head", 0.0), ("J_Adj_L_FaceEye", EYE), ("J_Adj_R_FaceEye", -EYE))
    ]
    binds = np.tile(np.eye(4), (3, 1, 1))
    binds[:, 3, :3] = -np.array([[0, 0, -0.034], [EYE / 1000, 0, -0.034], [-EYE / 1000, 0, -0.034]])
    matrices = out.accessor(binds.reshape(3, 16), FLOAT)
    out.json["skins"] = [{"joints": joints, "inverseBindMatrices": matrices}]
    which = np.zeros((32, 4))
    which[:16, 0], which[16:, 0] = 1, 2
    attributes = {
        "POSITION": out.accessor(places, FLOAT),
        "JOINTS_0": out.accessor(which, UNSIGNED_BYTE),
        "WEIGHTS_0": out.accessor(np.tile([1.0, 0, 0, 0], (32, 1)), FLOAT),
    }
    indices = out.accessor(np.concatenate((faces, faces + 16)).ravel(), UNSIGNED)
    out.mesh([{"attributes": attributes, "indices": indices}], [], name="Face_eyes", skin=0)


def fbx_with_eye_joints() -> bytes:
    """The small head with flat eyes on a skin, whose joints lie 3 cm behind them."""
    objects, links = fbx_of_head(lambda n: None if n.startswith("eyeLook") else n)
    square, faces = flat_eye()
    places = np.concatenate([square * 100 + [x / 10, 0, -0.4] for x in (EYE, -EYE)])
    corners = np.concatenate((faces, faces + 16)).astype(np.int32)
    corners[:, 2] = ~corners[:, 2]
    inside = [fbx_record("Vertices", places), fbx_record("PolygonVertexIndex", corners)]
    objects[2].extend(
        [
            fbx_record("Geometry", 9000, "eyes\0\1Geometry", "Mesh", inside=inside),
            fbx_record("Model", 9001, "eyes\0\1Model", "Mesh"),
            fbx_record("Deformer", 9002, "skin\0\1Deformer", "Skin"),
        ]
    )
    pairs = [(9000, 9001), (9001, 2), (9002, 9000)]
    for number, (name, x) in enumerate((("CC_Base_L_Eye", EYE), ("CC_Base_R_Eye", -EYE))):
        bone, cluster = 9100 + number, 9200 + number
        place = fbx_record("P", "Lcl Translation", "", "", "A", x / 10, 0.0, -3.4)
        follow = np.arange(16 * number, 16 * number + 16, dtype=np.int32)
        carried = [fbx_record("Indexes", follow), fbx_record("Weights", np.ones(16))]
        table = [fbx_record("Properties70", inside=[place])]
        objects[2].extend(
            [
                fbx_record("Model", bone, f"{name}\0\1Model", "LimbNode", inside=table),
                fbx_record("Deformer", cluster, "\0\1SubDeformer", "Cluster", inside=carried),
            ]
        )
        pairs += [(bone, 2), (cluster, 9002), (bone, cluster)]
    links[2].extend(fbx_record("C", "OO", a, b) for a, b in pairs)
    return fbx_bytes([objects, links])


def opened(out: Glb, folder: Path) -> FittedCharacter:
    (folder / "head.glb").write_bytes(out.content())
    return open_character(folder / "head.glb")


def moves(fitted: FittedCharacter, channel: str, part: str) -> Doubles:
    """(V, 3) mm of the vertices of one part."""
    number = [p.name for p in fitted.character.parts].index(part)
    deltas = fitted.rig.deltas[fitted.rig.channels.index(channel)]
    found: Doubles = 1000.0 * deltas[fitted.part_of == number].astype(np.float64)
    return found


@pytest.mark.parametrize("kind", [add_eyeballs, add_eye_joints])
def test_eyes_look_where_their_channels_say(tmp_path: Path, kind: object) -> None:
    out = without_looks()
    assert callable(kind)
    kind(out)
    fitted = opened(out, tmp_path)
    assert set(LOOKS) <= set(fitted.rig.channels)
    assert "the eyes have no shapes; they are turned instead" in fitted.checklist.remarks
    assert set(LOOKS) <= set(fitted.checklist.missing)  # the file has no shapes for them
    rig, eyes = fitted.rig, [fitted.part_of == n for n in range(1, len(fitted.character.parts))]
    of_eyes = np.any(eyes, axis=0)
    for side, sign in (("Left", 1.0), ("Right", -1.0)):
        front = (
            of_eyes
            & (sign * rig.neutral[:, 0] > 0)
            & (rig.neutral[:, 2] > rig.neutral[of_eyes, 2].max() - 0.001)
        )
        for way, axis, direction in (
            ("Up", 1, 1),
            ("Down", 1, -1),
            ("Out", 0, sign),
            ("In", 0, -sign),
        ):
            moved = rig.deltas[rig.channels.index(f"eyeLook{way}{side}")]
            assert direction * moved[front, axis].mean() > 0.003
            assert np.abs(moved[of_eyes & (sign * rig.neutral[:, 0] < 0)]).max() == 0
            assert np.abs(moved[~of_eyes]).max() == 0


def test_joints_of_an_fbx_turn_its_eyes(tmp_path: Path) -> None:
    (tmp_path / "head.fbx").write_bytes(fbx_with_eye_joints())
    fitted = open_character(tmp_path / "head.fbx")
    assert "the eyes have no shapes; they are turned instead" in fitted.checklist.remarks
    moved = moves(fitted, "eyeLookUpLeft", "eyes")
    assert np.abs(moved[16:]).max() == 0
    assert moved[:16, 1].min() > 10.0  # they lie 30 mm before their joint


def test_an_iris_turns_with_its_eyeball(tmp_path: Path) -> None:
    out = without_looks()
    add_eyeballs(out)
    moved = moves(opened(out, tmp_path), "eyeLookUpLeft", "Eye_L")
    assert moved[-5:, 1].min() > 3.0  # the iris


def test_eyes_that_shapes_turn_are_not_turned_again(tmp_path: Path) -> None:
    out = small_glb()
    add_eyeballs(out)
    for mesh in out.json["meshes"][1:]:
        (primitive,) = mesh["primitives"]
        count = out.json["accessors"][primitive["attributes"]["POSITION"]]["count"]
        primitive["targets"] = [{"POSITION": out.accessor(np.full((count, 3), 0.002), FLOAT)}]
        mesh["extras"]["targetNames"] = ["eyeLookUpLeft"]
    fitted = opened(out, tmp_path)
    assert moves(fitted, "eyeLookUpLeft", "Eye_L") == pytest.approx(2.0, rel=0.1)
    assert np.abs(moves(fitted, "eyeLookDownLeft", "Eye_L")).max() == 0
    assert fitted.checklist.remarks == ()


def test_eyes_are_turned_if_looks_move_only_the_lids(tmp_path: Path) -> None:
    out = small_glb()
    add_eyeballs(out)
    fitted = opened(out, tmp_path)
    assert fitted.checklist.remarks == (
        "the shapes of looks do not move the eyes; they are turned as well",
    )
    assert fitted.checklist.missing == ()
    assert moves(fitted, "eyeLookUpLeft", "Eye_L")[-5:, 1].min() > 3.0
    assert np.abs(moves(fitted, "eyeLookUpLeft", "Head")).max() > 0.1


def test_a_character_without_eyes_gets_none(tmp_path: Path) -> None:
    fitted = opened(without_looks(), tmp_path)
    assert not set(LOOKS) & set(fitted.rig.channels)
    assert fitted.checklist.remarks == ()


def test_eyes_are_turned_whatever_the_orientation_of_the_file(tmp_path: Path) -> None:
    out = without_looks()
    add_eyeballs(out)
    out.node(name="Root", rotation=ASKEW, scale=[100.0, 100.0, 100.0], children=[0, 1, 2])
    out.json["scenes"][0]["nodes"] = [3]
    moved = moves(opened(out, tmp_path), "eyeLookUpLeft", "Eye_L")
    assert moved[-5:, 1].min() > 3.0


@pytest.mark.parametrize("kind", [add_eyeballs, add_eye_joints])
@pytest.mark.parametrize("look", ["eyeLookUpLeft", "eyeLookInLeft", "eyeLookOutRight"])
@pytest.mark.parametrize("askew", [False, True])
def test_the_eyes_of_an_exported_glb_look_as_in_the_view(
    tmp_path: Path, kind: Callable[[Glb], None], look: str, askew: bool
) -> None:
    out = without_looks()
    kind(out)
    count = len(out.json["nodes"])
    if askew:
        out.node(name="Root", rotation=ASKEW, scale=[9.0] * 3, children=list(range(count)))
        out.json["scenes"][0]["nodes"] = [count]
    fitted = opened(out, tmp_path)
    clip = Clip(np.array([[0.0], [1.0]], np.float32), (look,), np.arange(2) / 25, 25.0)
    content = scene_content(SCENES[0], clip, fitted, "looks")
    last = poses(content)
    for number, part in enumerate(fitted.character.parts[1:], 1):
        mine = fitted.part_of == number
        shown = fitted.rig.neutral[mine] + fitted.rig.deltas[fitted.rig.channels.index(look)][mine]
        (tmp_path / "posed.glb").write_bytes(last)
        posed = {p.name: p for p in read_character(tmp_path / "posed.glb").parts}[part.name]
        np.testing.assert_allclose(fitted.frame.places(posed.neutral), shown, atol=1e-5)


def poses(content: bytes) -> bytes:
    """An animated GLB whose nodes stand as at the end of its animation."""
    document, binary = parts_of(content)
    (animation,) = document.pop("animations")
    for channel in animation["channels"]:
        if channel["target"]["path"] != "weights":
            sampler = animation["samplers"][channel["sampler"]]
            accessor = document["accessors"][sampler["output"]]
            place = document["bufferViews"][accessor["bufferView"]]
            start, width = place["byteOffset"], place["byteLength"] // 4
            values = np.frombuffer(binary, "<f4", width, start).reshape(2, -1)[1]
            node = document["nodes"][channel["target"]["node"]]
            node[channel["target"]["path"]] = values.tolist()
    return glb_of(document, binary)


def test_eyes_in_one_mesh_are_said_to_stay_still_in_an_exported_glb(tmp_path: Path) -> None:
    out = without_looks()
    add_eyeballs(out)
    meshes = out.json["meshes"]
    meshes[1]["primitives"] += meshes[2]["primitives"]
    del out.json["nodes"][2], out.json["scenes"][0]["nodes"][2]
    fitted = opened(out, tmp_path)
    assert "but not in a GLB" in fitted.checklist.remarks[0]
    clip = Clip(np.ones((2, 1), np.float32), ("eyeLookUpLeft",), np.arange(2) / 25, 25.0)
    document, _ = parts_of(scene_content(SCENES[0], clip, fitted, "looks"))
    paths = [c["target"]["path"] for c in document["animations"][0]["channels"]]
    assert paths == ["weights"]
