"""Characters in GLB files: what is written is read again, and bad files end in one line."""

from __future__ import annotations

import json
import struct
from collections.abc import Callable
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.faces import random_rig

from faceedit_app.characters.glb import read_rig
from faceedit_app.characters.glb_writing import write_rig
from faceedit_app.core.controls import CONTROL_IDS, CONTROL_INDEX
from faceedit_app.core.errors import FileError

PNG = b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR" + bytes(60)


def complaint(path: Path) -> str:
    """The one line that opening a bad file gives."""
    with pytest.raises(FileError) as caught:
        read_rig(path)
    text = str(caught.value)
    assert text.startswith(str(path))
    assert "\n" not in text
    assert "; " in text, "no remedy"
    return text


def edit_json(content: bytes, change: Callable[[dict[str, Any]], None]) -> bytes:
    """A GLB with another JSON part."""
    length = struct.unpack("<I", content[12:16])[0]
    document = json.loads(content[20 : 20 + length])
    change(document)
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    rest = content[20 + length :]
    total = 20 + len(text) + len(rest)
    head = struct.pack("<4sIIII", b"glTF", 2, total, len(text), 0x4E4F534A)
    return head + text + rest


def test_rig_comes_back_as_it_was(tmp_path: Path) -> None:
    rig = random_rig(4)
    rig.deltas[3] = 0.0  # a shape that moves nothing is kept all the same
    write_rig(tmp_path / "a.glb", rig)
    back = read_rig(tmp_path / "a.glb")
    for field in fields(rig):
        ours, theirs = getattr(rig, field.name), getattr(back, field.name)
        if isinstance(ours, np.ndarray):
            assert ours.dtype == theirs.dtype, field.name
            np.testing.assert_array_equal(ours, theirs, err_msg=field.name)
        else:
            assert ours == theirs, field.name


def test_shade_comes_back_as_it_was(tmp_path: Path) -> None:
    rig = random_rig(2)
    shade = np.linspace(0.0, 1.0, len(rig.neutral), dtype=np.float32)
    write_rig(tmp_path / "a.glb", replace(rig, shade=shade))
    back = read_rig(tmp_path / "a.glb").shade
    assert back is not None
    assert back.dtype == np.float32
    np.testing.assert_array_equal(back, shade)


def test_same_rig_gives_the_same_bytes(tmp_path: Path) -> None:
    for name in ("a.glb", "b.glb"):
        write_rig(tmp_path / name, random_rig(4))
    assert (tmp_path / "a.glb").read_bytes() == (tmp_path / "b.glb").read_bytes()


def test_names_in_other_scripts_survive(tmp_path: Path) -> None:
    write_rig(tmp_path / "a.glb", replace(random_rig(1), name="Zoë 顔", attribution="© Ł"))
    back = read_rig(tmp_path / "a.glb")
    assert (back.name, back.attribution) == ("Zoë 顔", "© Ł")


@pytest.mark.parametrize("content", [b"", b"glTF", PNG, b"solid cube", bytes(400)])
def test_what_is_no_glb_is_reported(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "face.glb"
    path.write_bytes(content)
    complaint(path)


def test_missing_file_and_folder_are_reported(tmp_path: Path) -> None:
    complaint(tmp_path / "none.glb")
    complaint(tmp_path)


def test_truncated_file_is_reported_wherever_it_ends(tmp_path: Path) -> None:
    write_rig(tmp_path / "whole.glb", random_rig(4, ("jawOpen", "eyeBlinkLeft")))
    content = (tmp_path / "whole.glb").read_bytes()
    cut = tmp_path / "cut.glb"
    for length in [*range(4, 40), *range(40, len(content), 97), len(content) - 1]:
        cut.write_bytes(content[:length])
        complaint(cut)


def _drop_targets(document: dict[str, Any]) -> None:
    for primitive in document["meshes"][0]["primitives"]:
        del primitive["targets"]


def _drop_a_target(document: dict[str, Any]) -> None:
    for primitive in document["meshes"][0]["primitives"]:
        primitive["targets"].pop()


def _set_extras(**extras: Any) -> Callable[[dict[str, Any]], None]:
    return lambda document: document["meshes"][0]["extras"].update(extras)


DAMAGES: dict[str, Callable[[dict[str, Any]], Any]] = {
    "no mesh": lambda d: d.pop("meshes"),
    "no extras": lambda d: d["meshes"][0].pop("extras"),
    "no controls": lambda d: d["meshes"][0]["extras"].pop("controls"),
    "no targets": _drop_targets,
    "a target too few": _drop_a_target,
    "controls that FaceEdit does not know": _set_extras(controls={"nose": [0, 1]}),
    "half a control": _set_extras(controls={"upper_lip": [0, -1]}),
    "names that are numbers": _set_extras(targetNames=[1] * 52),
    "names that are a text": _set_extras(targetNames="jawOpen" * 8),
    "controls that are a list": _set_extras(controls=[1, 2]),
    "a vertex that is not there": lambda d: d["meshes"][0]["extras"]["controls"].update(
        upper_lip=[0, 9999]
    ),
    "a vertex beyond 32 bits": _set_extras(controls={"upper_lip": [0, 2**31]}),
    "a vertex beyond 64 bits": _set_extras(controls={"upper_lip": [0, 10**20]}),
    "half a vertex": _set_extras(controls={"upper_lip": [0, 0.5]}),
    "a name that is a list": lambda d: d["meshes"][0].update(name=["face"]),
    "metal that is a text": lambda d: d["materials"][0].update(
        pbrMetallicRoughness={"metallicFactor": "much"}
    ),
    "three vertices": lambda d: d["meshes"][0]["extras"]["controls"].update(upper_lip=[0, 1, 2]),
    "no colours": lambda d: d["meshes"][0]["primitives"][0]["attributes"].pop("COLOR_0"),
    "a shade of numbers in threes": lambda d: d["meshes"][0]["primitives"][0]["attributes"].update(
        _SHADE=d["meshes"][0]["primitives"][0]["indices"]
    ),
    "an accessor that is not there": lambda d: d["meshes"][0]["primitives"][0].update(indices=999),
    "a view beyond the end": lambda d: d["bufferViews"][0].update(byteOffset=10**9),
    "too many vertices": lambda d: d["accessors"][0].update(count=10**7),
    "an unknown number type": lambda d: d["accessors"][0].update(componentType=1),
    "an extras list": lambda d: d["meshes"][0].update(extras=[1]),
}


@pytest.mark.parametrize("damage", DAMAGES)
def test_glb_without_a_part_of_the_character_is_reported(tmp_path: Path, damage: str) -> None:
    write_rig(tmp_path / "face.glb", random_rig(4))
    content = (tmp_path / "face.glb").read_bytes()
    (tmp_path / "face.glb").write_bytes(edit_json(content, DAMAGES[damage]))
    complaint(tmp_path / "face.glb")


def test_character_without_a_control_opens_and_says_which_curve_it_lacks(tmp_path: Path) -> None:
    path = tmp_path / "face.glb"
    rig = random_rig(4)
    write_rig(path, rig)
    assert read_rig(path).missing_note == ""
    path.write_bytes(
        edit_json(
            path.read_bytes(), lambda d: d["meshes"][0]["extras"]["controls"].pop("upper_lip")
        )
    )
    back = read_rig(path)
    assert back.missing_controls == ("upper_lip",)
    assert back.missing_note == (
        "Cloud lacks the control points of the curve “Upper lip drop”, which cannot be edited"
    )
    weights = np.ones((3, len(rig.channels)), np.float32)
    assert (back.controls(weights)[:, CONTROL_INDEX["upper_lip"]] == 0).all()
    others = np.array(CONTROL_IDS) != "upper_lip"
    np.testing.assert_array_equal(
        back.controls(weights)[:, others], rig.controls(weights)[:, others]
    )
    write_rig(tmp_path / "again.glb", back)
    assert read_rig(tmp_path / "again.glb").missing_controls == ("upper_lip",)


def test_triangle_that_names_no_vertex_is_reported(tmp_path: Path) -> None:
    rig = random_rig(4)
    write_rig(tmp_path / "face.glb", replace(rig, faces=np.full_like(rig.faces, 24)))
    complaint(tmp_path / "face.glb")


def test_failed_write_leaves_nothing(tmp_path: Path) -> None:
    with pytest.raises(FileError, match="cannot be written"):
        write_rig(tmp_path / "none" / "face.glb", random_rig(4))
    assert not list(tmp_path.iterdir())
