"""Heads turn in exported characters as they do in the viewport."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation, Slerp
from support.blender import head_in_blender
from support.character_files import parts_of, small_glb, write_glb
from support.faces import shipped_rig, talking_clip
from support.gltf import has_validator, validator_errors

from faceedit_app.characters.fitted import FittedCharacter, open_character
from faceedit_app.characters.gltf_nodes import node_places, own_place
from faceedit_app.characters.scenes import SCENES, scene_content
from faceedit_app.core.arrays import Doubles, Floats
from faceedit_app.core.clip import Clip
from faceedit_app.core.head import Head
from faceedit_app.core.head import turn as head_turn
from faceedit_app.core.rig import Rig

FORMS = {form.ending: form for form in SCENES}
FRAME = 12


def turning_clip() -> Clip:
    clip = talking_clip()
    rotations = np.zeros((len(clip), 9), np.float32)
    rotations[:, 0] = np.linspace(-0.6, 0.6, len(clip))
    rotations[:, 1] = 0.3 * np.sin(clip.times)
    rotations[:, 2] = np.linspace(0.2, -0.1, len(clip))
    return replace(clip, rotations=rotations)


def shown(rig: Rig, clip: Clip, frame: int) -> Floats:
    """What the viewport shows."""
    assert clip.rotations is not None
    weights = rig.from_arkit(clip.arkit_weights()[frame])
    return Head(rig).turned(rig.vertices(weights), clip.rotations[frame])


def write(path: Path, character: Rig | FittedCharacter, clip: Clip) -> Path:
    form = FORMS[path.suffix]
    path.write_bytes(scene_content(form, clip, character, "talk", follows_head=True))
    return path


def array(document: dict[str, Any], binary: bytes, number: int, width: int) -> Doubles:
    accessor = document["accessors"][number]
    view = document["bufferViews"][accessor["bufferView"]]
    kind = {5126: "<f4", 5121: "u1"}[accessor["componentType"]]
    start = view.get("byteOffset", 0)
    count = accessor["count"] * width
    return np.frombuffer(binary, kind, count, start).reshape(-1, width).astype(np.float64)


def turns_of(path: Path, second: float) -> tuple[dict[str, Any], bytes, int, Doubles]:
    """The document, its binary, the node that turns, and its rotation at a time (3, 3)."""
    document, binary = parts_of(path.read_bytes())
    animation = document["animations"][0]
    (channel,) = (c for c in animation["channels"] if c["target"]["path"] == "rotation")
    sampler = animation["samplers"][channel["sampler"]]
    times = array(document, binary, sampler["input"], 1).ravel()
    keys = Rotation.from_quat(array(document, binary, sampler["output"], 4))
    return document, binary, channel["target"]["node"], Slerp(times, keys)(second).as_matrix()


def test_a_skin_in_a_glb_turns_each_vertex_as_the_viewport_does(tmp_path: Path) -> None:
    rig, clip = shipped_rig(), turning_clip()
    path = write(tmp_path / "talk.glb", rig, clip)
    document, binary, node, turn = turns_of(path, clip.times[FRAME])
    attributes = document["meshes"][0]["primitives"][0]["attributes"]
    weights = array(document, binary, attributes["WEIGHTS_0"], 4)
    skin = document["skins"][0]
    binds = array(document, binary, skin["inverseBindMatrices"], 16).reshape(-1, 4, 4)
    head = own_place(document["nodes"][node])
    head[:3, :3] = turn
    assert skin["joints"][1] == node
    still = rig.vertices(rig.from_arkit(clip.arkit_weights()[FRAME]))
    vertices = np.c_[still, np.ones(len(still))]
    moved = [
        vertices @ (place @ bind.T).T for place, bind in ((head, binds[1]), (np.eye(4), binds[0]))
    ]
    found = weights[:, :1] * moved[0] + weights[:, 1:2] * moved[1]
    np.testing.assert_allclose(found[:, :3], shown(rig, clip, FRAME), atol=1e-6)
    if has_validator():
        assert validator_errors(path) == []


def test_without_following_the_head_nothing_turns(tmp_path: Path) -> None:
    clip = turning_clip()
    for form in SCENES:
        straight = scene_content(form, clip, shipped_rig(), "talk")
        plain = scene_content(form, replace(clip, rotations=None), shipped_rig(), "talk")
        assert straight == plain
        plain = scene_content(
            form, replace(clip, rotations=None), shipped_rig(), "talk", follows_head=True
        )
        assert straight == plain


def test_a_head_of_another_maker_without_joints_turns_as_a_whole(tmp_path: Path) -> None:
    fitted = open_character(write_glb(tmp_path / "head.glb"))
    clip = turning_clip()
    path = write(tmp_path / "talk.glb", fitted, clip)
    document, _, node, turn = turns_of(path, clip.times[FRAME])
    assert document["scenes"][0]["nodes"] == [node]
    (inner,) = document["nodes"][node]["children"]
    outer = own_place(document["nodes"][node])
    outer[:3, :3] = turn
    place = outer @ own_place(document["nodes"][inner])
    part = fitted.character.parts[0]
    moved = trimesh.transform_points(part.neutral, place)
    still = replace(clip, weights=np.zeros_like(clip.weights))
    wanted = shown(fitted.rig, still, FRAME)
    above = Head(fitted.rig).share[: len(moved)] == 1
    assert above.sum() > 100
    np.testing.assert_allclose(fitted.frame.places(moved)[above], wanted[above], atol=2e-5)
    again = open_character(path)  # the file is a character as before
    assert again.checklist.matched == fitted.checklist.matched


@pytest.mark.parametrize("as_matrix", [False, True])
def test_the_joint_of_a_skinned_head_turns(as_matrix: bool, tmp_path: Path) -> None:
    out = small_glb(kind="skinned")
    skin = out.json["skins"][0]
    joint = skin["joints"][0]
    out.json["nodes"][joint]["name"] = "mixamorig:Head"
    if as_matrix:
        node = out.json["nodes"][joint]
        place = own_place(node)
        for key in ("translation", "rotation", "scale"):
            node.pop(key, None)
        node["matrix"] = place.T.ravel().tolist()
    rest = own_place(out.json["nodes"][joint])
    head = tmp_path / "head.glb"
    head.write_bytes(out.content())
    fitted, clip = open_character(head), turning_clip()
    path = write(tmp_path / "talk.glb", fitted, clip)
    document, _, node, turn = turns_of(path, clip.times[FRAME])
    assert node == joint
    assert "matrix" not in document["nodes"][node]
    assert clip.rotations is not None
    world = fitted.frame.axes.T @ head_turn(*clip.rotations[FRAME, :3]) @ fitted.frame.axes
    turned, straight = turn, rest[:3, :3] / np.linalg.norm(rest[:3, :3], axis=0)
    above = node_places(document["nodes"])[node][:3, :3] @ np.linalg.inv(rest[:3, :3])
    above /= np.linalg.norm(above, axis=0)
    np.testing.assert_allclose(above @ turned, world @ above @ straight, atol=1e-5)
    after = own_place(document["nodes"][node])
    np.testing.assert_allclose(after, rest, atol=1e-6)  # at rest nothing has moved


BLENDER = """
scene.frame_set(int(arguments[0]))
bpy.context.view_layer.update()
mesh = head.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
rows = [list(head.matrix_world @ v.co) for v in mesh.vertices]
print("FACTS " + json.dumps({"rows": rows}))
"""


@pytest.mark.parametrize("ending", FORMS)
def test_blender_turns_the_head_as_the_viewport_does(ending: str, tmp_path: Path) -> None:
    rig, clip = shipped_rig(), turning_clip()
    path = write(tmp_path / f"talk{ending}", rig, clip)
    first = 1 if ending == ".fbx" else 0  # Blender's number of the first frame
    facts = head_in_blender(BLENDER, path, clip.rate, FRAME + first)
    found = np.array(facts["rows"])[:, [0, 2, 1]] * [1, 1, -1]  # Blender has Z up
    away, _ = cKDTree(found).query(shown(rig, clip, FRAME))  # it splits some vertices of a GLB
    assert away.max() < 2e-5
