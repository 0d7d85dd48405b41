"""A character that cannot be used is one line that says what to do, and never much memory."""

from __future__ import annotations

import json
import os
import random
import struct
import tracemalloc
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.character_files import (
    FLOAT,
    glb_of,
    parts_of,
    small_glb,
    write_glb,
    write_objs,
    write_vrm,
)
from support.fbx_files import fbx_bytes, fbx_of_head, fbx_record, write_fbx

from faceedit_app.characters.fitted import open_character
from faceedit_app.core.controls import OPTIONAL_CONTROLS
from faceedit_app.core.errors import FileError

Json = dict[str, Any]


def complaint(path: Path) -> str:
    """The one line that opening a bad file gives."""
    with pytest.raises(FileError) as caught:
        open_character(path)
    text = str(caught.value)
    assert "\n" not in text
    assert "; " in text, "no remedy"
    assert len(text) - len(str(path)) < 300
    return text


def changed(path: Path, change: Callable[[Json], Any], kind: str = "plain") -> Path:
    """The small head with another JSON part."""
    document, binary = parts_of(small_glb(kind=kind).content())
    change(document)
    path.write_bytes(glb_of(document, binary))
    return path


# --- faces that are none -------------------------------------------------------------------------


def test_no_blendshapes(tmp_path: Path) -> None:
    says = complaint(write_glb(tmp_path / "a.glb", lambda n: None))
    assert "has no blendshapes" in says
    assert "Make from a scan" in says


def test_a_scan_beside_other_heads_can_be_made_a_character(tmp_path: Path) -> None:
    scan = write_objs(tmp_path / "scans", lambda n: None) / "neutral.obj"
    for name in ("ann.obj", "bob.obj"):
        scan.with_name(name).write_bytes(scan.read_bytes())
    with pytest.raises(FileError, match="none of its 2 shapes has a name") as caught:
        open_character(scan)
    assert "if it has no blendshapes, make some: File > Character" in str(caught.value)
    assert "make some with faceedit character make" in caught.value.for_command


def test_one_eye_only(tmp_path: Path) -> None:
    path = write_glb(tmp_path / "a.glb", lambda n: None if n == "eyeBlinkRight" else n)
    assert "closes the right eye (eyeBlinkRight)" in complaint(path)


def test_no_eyes(tmp_path: Path) -> None:
    path = write_glb(tmp_path / "a.glb", lambda n: None if n.startswith("eye") else n)
    assert "eyeBlinkLeft, eyeBlinkRight" in complaint(path)


def test_names_that_mean_nothing(tmp_path: Path) -> None:
    path = write_glb(tmp_path / "a.glb", lambda n: f"Форма {hash(n) % 10**9}")
    assert "Форма" in complaint(path)


def test_eyes_that_do_not_move(tmp_path: Path) -> None:
    out = small_glb()
    for target in out.json["meshes"][0]["primitives"][0]["targets"][:14]:
        target["POSITION"] = out.accessor(np.zeros((len_of(out), 3)), FLOAT)
    (tmp_path / "a.glb").write_bytes(out.content())
    assert "move nothing" in complaint(tmp_path / "a.glb")


def len_of(out: Any) -> int:
    position = out.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"]
    return int(out.json["accessors"][position]["count"])


def test_a_mouth_that_does_not_open_lacks_its_curves(tmp_path: Path) -> None:
    """What can be edited is edited; the rest is said."""
    path = write_glb(
        tmp_path / "a.glb", lambda n: n if n.startswith(("eye", "brow", "mouthS")) else None
    )
    fitted = open_character(path)
    assert set(fitted.rig.missing_controls) - {*OPTIONAL_CONTROLS} == {
        *("mouth_opening", "mouth_width", "left_corner", "right_corner", "upper_lip", "lower_lip")
    }
    assert "no shape opens the mouth" in fitted.checklist.doubts[0]


def test_numbers_that_are_none(tmp_path: Path) -> None:
    out = small_glb()
    view = out.json["accessors"][out.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"]]
    start = out.json["bufferViews"][view["bufferView"]]["byteOffset"]
    out.binary[start : start + 4] = struct.pack("<f", float("nan"))
    (tmp_path / "a.glb").write_bytes(out.content())
    assert "not numbers" in complaint(tmp_path / "a.glb")


def test_no_triangles(tmp_path: Path) -> None:
    def points(document: Json) -> None:
        document["meshes"][0]["primitives"][0]["mode"] = 0

    assert "no triangles" in complaint(changed(tmp_path / "a.glb", points))


# --- files of another kind, age or place ---------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "content", "says"),
    [
        ("a.glb", b"", "not a character file"),
        ("a.glb", b"glTF", "cut short"),
        ("a.glb", b"solid cube", "not a character file"),
        ("a.gltf", b"{}", "which glTF"),
        ("a.gltf", b'{"asset": {"version": "3.0"}}', "is glTF 3.0"),
        ("a.gltf", b'{"asset": {"version": "1.0"}}', "is glTF 1.0"),
        ("a.gltf", b"[" * 100_000, "JSON"),
        ("a.gltf", b'{"asset": {"version": NaN}}', "JSON"),
        ("a.fbx", b"; FBX 7.7.0 project file", "is a text FBX"),
        ("a.fbx", b"Kaydara FBX Binary  \x00\x1a\x00" + struct.pack("<I", 6100), "older"),
        ("a.fbx", b"Kaydara FBX Binary  \x00\x1a\x00" + struct.pack("<I", 9000), "newer"),
        ("a.fbx", b"nothing", "is not an FBX"),
        ("a.obj", b"# empty", "no triangles"),
        ("a.obj", b"v 0 0 0\nf 1 2 3\n", "does not exist"),
        ("a.obj", b"v 0 0\nf 1 1 1\n", "three numbers"),
        ("a.obj", b"v a b c\nf 1 1 1\n", "three numbers"),
        ("a.obj", b"v 0 0 inf\nf 1 1 1\n", "not numbers"),
        ("a.obj", b"v 0 0 -1e12\nf 1 1 1\n", "are too large, up to 1e+12"),
        ("a.blend", b"BLENDER-v300", "Blender"),
        ("a.usdz", b"PK", "USD"),
        ("a.png", b"\x89PNG", "not a character file"),
    ],
)
def test_other_files_say_what_to_do(tmp_path: Path, name: str, content: bytes, says: str) -> None:
    (tmp_path / name).write_bytes(content)
    assert says in complaint(tmp_path / name)


def test_a_required_extension_that_nobody_knows(tmp_path: Path) -> None:
    path = changed(tmp_path / "a.glb", lambda d: d.update(extensionsRequired=["ACME_secret"]))
    assert "ACME_secret" in complaint(path)


def test_missing_files_and_folders_without_heads(tmp_path: Path) -> None:
    complaint(tmp_path / "none.glb")
    assert "no OBJ" in complaint(tmp_path)
    write_objs(tmp_path / "head")
    (tmp_path / "head" / "neutral.obj").unlink()
    assert "named neutral" in complaint(tmp_path / "head")


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="pipes have no names here")
def test_a_pipe_does_not_freeze(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "a.glb")
    complaint(tmp_path / "a.glb")
    write_objs(tmp_path / "head")
    os.mkfifo(tmp_path / "head" / "jawOpen2.obj")
    assert "jawOpen2.obj" in open_character(tmp_path / "head").checklist.remarks[0]


def test_buffers_outside_are_files_beside_it(tmp_path: Path) -> None:
    document, binary = parts_of(small_glb().content())
    document["buffers"][0]["uri"] = "head%20data.bin"
    (tmp_path / "head data.bin").write_bytes(binary)
    path = tmp_path / "a.gltf"
    path.write_text(json.dumps(document))
    assert len(open_character(path).checklist.matched) == 52
    uris = ("https://example.org/a.bin", "none.bin", "data:text/plain,a", "QUFB" * 9999)
    for uri in uris:  # the last is data whose beginning was lost
        document["buffers"][0]["uri"] = uri
        path.write_text(json.dumps(document))
        assert complaint(path).startswith(str(path))


# --- files that lie ------------------------------------------------------------------------------


def _accessor(**more: Any) -> Callable[[Json], None]:
    def change(document: Json) -> None:
        position = document["meshes"][0]["primitives"][0]["attributes"]["POSITION"]
        document["accessors"][position].update(more)

    return change


def _without_view(document: Json) -> None:
    """Zeros that are nowhere: so many that they take terabytes."""
    _accessor(count=10**12)(document)
    for accessor in document["accessors"]:
        accessor.pop("bufferView", None)


def _many_zeros(document: Json) -> None:
    for accessor in document["accessors"]:
        accessor.pop("bufferView", None)
        accessor["count"] = 5_000_000


LIES: dict[str, Callable[[Json], Any]] = {
    "a count of terabytes": _accessor(count=10**12),
    "a count that overflows": _accessor(count=2**63),
    "a count below nothing": _accessor(count=-1),
    "a count that is a text": _accessor(count="many"),
    "an offset beyond the end": _accessor(byteOffset=2**40),
    "an offset below nothing": _accessor(byteOffset=-4),
    "terabytes of zeros": _without_view,
    "gigabytes of zeros": _many_zeros,
    "an unknown type": _accessor(type="VEC9"),
    "an unknown number type": _accessor(componentType=1),
    "a view that is not there": _accessor(bufferView=999),
    "a view beyond the end": lambda d: d["bufferViews"][1].update(byteOffset=2**40),
    "a view of more than there is": lambda d: d["bufferViews"][1].update(byteLength=2**62),
    "a stride of nothing": lambda d: d["bufferViews"][1].update(byteStride=0),
    "nodes in a circle": lambda d: d["nodes"][0].update(children=[0]),
    "a child that is not there": lambda d: d["nodes"][0].update(children=[7]),
    "a mesh that is not there": lambda d: d["nodes"][0].update(mesh=3),
    "no meshes": lambda d: d.pop("meshes"),
    "meshes that are a text": lambda d: d.update(meshes="none"),
    "a scene that is not there": lambda d: d.update(scene=5),
    "an enormous matrix": lambda d: d["nodes"][0].update(matrix=[1e300] * 16),
    "targets of another size": lambda d: d["meshes"][0]["primitives"][0]["targets"][0].update(
        POSITION=d["meshes"][0]["primitives"][0]["indices"]
    ),
    "more targets than any face has": lambda d: d["meshes"][0]["primitives"][0].update(
        targets=d["meshes"][0]["primitives"][0]["targets"] * 100
    ),
}


@pytest.mark.parametrize("lie", LIES)
def test_a_file_that_lies_takes_no_memory(tmp_path: Path, lie: str) -> None:
    path = changed(tmp_path / "a.glb", LIES[lie])
    tracemalloc.start()
    complaint(path)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 200e6


def _sparse(**more: Any) -> Callable[[Json], None]:
    def change(document: Json) -> None:
        sparse = next(a for a in document["accessors"] if "sparse" in a)["sparse"]
        sparse.update(more)

    return change


@pytest.mark.parametrize(
    "change", [_sparse(count=10**9), _sparse(count=-1), _sparse(indices={}), _sparse(values=[])]
)
def test_a_sparse_target_that_lies(tmp_path: Path, change: Callable[[Json], None]) -> None:
    complaint(changed(tmp_path / "a.glb", change, "sparse"))


@pytest.mark.parametrize("key", ["count", "byteStride", "byteLength"])
def test_a_packed_buffer_that_lies(tmp_path: Path, key: str) -> None:
    def change(document: Json) -> None:
        view = next(v for v in document["bufferViews"] if "extensions" in v)
        view["extensions"]["EXT_meshopt_compression"][key] = 2_000_000_000

    complaint(changed(tmp_path / "a.glb", change, "meshopt"))


def test_an_fbx_array_that_claims_more_than_it_holds(tmp_path: Path) -> None:
    content = bytearray(fbx_bytes(fbx_of_head()))
    place = content.index(b"Vertices") + 8 + 1
    content[place : place + 4] = struct.pack("<I", 2**31)
    (tmp_path / "a.fbx").write_bytes(content)
    assert "more than it can hold" in complaint(tmp_path / "a.fbx")


def test_fbx_records_without_end(tmp_path: Path) -> None:
    nested = fbx_record("A", 1)
    for _ in range(100):
        nested = fbx_record("A", 1, inside=[nested])
    (tmp_path / "a.fbx").write_bytes(fbx_bytes([nested]))
    assert "nested too deep" in complaint(tmp_path / "a.fbx")


# --- damage at random ----------------------------------------------------------------------------

WRITERS: dict[str, Callable[[Path], Path]] = {
    "GLB": lambda folder: write_glb(folder / "a.glb", kind="sparse"),
    "skinned": lambda folder: write_glb(folder / "a.glb", kind="quantized"),
    "meshopt": lambda folder: write_glb(folder / "a.glb", kind="meshopt"),
    "Draco": lambda folder: write_glb(folder / "a.glb", kind="draco"),
    "VRM": lambda folder: write_vrm(folder / "a.vrm"),
    "FBX": lambda folder: write_fbx(folder / "a.fbx"),
}


@pytest.mark.parametrize("kind", WRITERS)
def test_a_damaged_file_opens_or_is_one_line(tmp_path: Path, kind: str) -> None:
    whole = WRITERS[kind](tmp_path)
    content, chance = whole.read_bytes(), random.Random(kind)
    damaged = tmp_path / f"damaged{whole.suffix}"
    for _ in range(25):
        damaged.write_bytes(_damage(content, chance))
        said = _said(damaged)
        assert "\n" not in said
        assert len(said) - len(str(damaged)) < 300


def _said(path: Path) -> str:
    """What opening a file complains of; nothing else may be raised."""
    try:
        open_character(path)
    except FileError as error:
        return str(error)
    return ""


def _damage(content: bytes, chance: random.Random) -> bytes:
    """Bytes changed, cut, or a number in the JSON replaced by another one."""
    out = bytearray(content)
    match chance.randrange(4):
        case 0:
            return bytes(out[: chance.randrange(len(out))])
        case 1:
            start = chance.randrange(len(out))
            out[start : start + chance.randrange(1, 200)] = chance.randbytes(chance.randrange(60))
        case 2:
            for _ in range(chance.randrange(1, 30)):
                out[chance.randrange(min(len(out), 30_000))] = chance.randrange(256)
        case _:
            digits = [i for i in range(20, min(len(out), 30_000)) if 48 <= out[i] <= 57]
            for place in chance.sample(digits, min(len(digits), 4)):
                out[place] = 48 + chance.randrange(10)
    return bytes(out)
