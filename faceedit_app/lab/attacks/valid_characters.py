"""Valid characters of every format, small enough to be read thousands of times."""

from __future__ import annotations

import base64
import io
import json
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import DracoPy
import meshopt
import numpy as np
import trimesh
from numpy.typing import NDArray
from PIL import Image

from faceedit_app.characters.fbx_animated import scene_fbx
from faceedit_app.characters.glb import read_rig
from faceedit_app.characters.glb_writing import write_rig
from faceedit_app.characters.map_file import read_map
from faceedit_app.characters.points import MAIN_POINTS
from faceedit_app.characters.registry import read_character
from faceedit_app.characters.scans import read_scan
from faceedit_app.characters.scene import Scene
from faceedit_app.core.controls import CONTROLS
from faceedit_app.core.glb import join_glb, split_glb
from faceedit_app.core.rig import Material, Rig
from faceedit_app.editing.opening import shipped_rig
from faceedit_app.lab.attacks.reader import Reader
from faceedit_app.scans.landmarks import read_points

_VERTICES = 60  # of the characters
_FRAMES = 3  # of an animated one
_MAP = b"""{"faceedit_character_map": 1,
 "channels": {"jawOpen": ["Jaw_Open"], "mouthClose": [{"shape": "close", "weight": 0.5}]},
 "points": {"left_mouth_corner": {"part": "head", "vertex": 7}},
 "strength": {"jawOpen": {"multiplier": 1.5, "offset": 0.1, "limit": 0.9}}}"""


def character_readers(folder: Path) -> Iterator[Reader]:
    """The readers of characters, scans and what belongs to them.

    Args:
        folder: where files are made.
    """
    rig = small_rig()
    write_rig(folder / "head.glb", rig)
    head = (folder / "head.glb").read_bytes()
    yield Reader("rigs", ".glb", head, read_rig)
    for ending, content in ((".glb", head), *_gltf(head), (".fbx", _fbx(rig)), (".obj", _obj(rig))):
        yield Reader("characters", ending, content, read_character)
    yield Reader("maps", ".json", _MAP, read_map)
    sphere = trimesh.creation.icosphere(2)
    for kind in ("ply", "stl", "obj", "glb"):
        content = sphere.export(file_type=kind)
        content = content.encode() if isinstance(content, str) else content
        yield Reader("scans", f".{kind}", content, read_scan)
    yield Reader("scans", ".ply", sphere.export(file_type="ply", encoding="ascii"), read_scan)
    points = {name: [0.1 * n, 1.0, 2.0] for n, name in enumerate(MAIN_POINTS)}
    yield Reader("points", ".json", json.dumps(points).encode(), read_points)


@cache
def small_rig() -> Rig:
    """A corner of the shipped character."""
    rig = shipped_rig()
    faces = rig.faces[(rig.faces < _VERTICES).all(axis=1)]
    return Rig(
        neutral=rig.neutral[:_VERTICES],
        faces=faces,
        channels=rig.channels,
        deltas=rig.deltas[:, :_VERTICES],
        colors=rig.colors[:_VERTICES],
        materials=(Material("skin", 0, len(faces)),),
        control_pairs=np.arange(2 * len(CONTROLS), dtype=np.int32).reshape(-1, 2),
    )


def _fbx(rig: Rig) -> bytes:
    weights = np.zeros((_FRAMES, len(rig.channels)), np.float32)
    times = np.arange(_FRAMES) / 30.0
    return scene_fbx(Scene(rig, rig.channels, weights, times, 30.0), "still")


def _obj(rig: Rig) -> bytes:
    points = [f"v {x:.6f} {y:.6f} {z:.6f}" for x, y, z in rig.neutral]
    faces = [f"f {a} {b} {c}" for a, b, c in rig.faces + 1]
    return "\n".join(["mtllib input.mtl", "o head", *points, "usemtl skin", *faces, ""]).encode()


def _gltf(head: bytes) -> Iterator[tuple[str, bytes]]:
    """A GLB in other forms: as text, as VRM, compressed, with pictures."""
    text = _Glb(head)
    packed = base64.b64encode(text.binary).decode()
    text.document["buffers"][0]["uri"] = f"data:application/octet-stream;base64,{packed}"
    yield ".gltf", json.dumps(text.document).encode()
    for extension, content in (("VRM", _vrm_0()), ("VRMC_vrm", _vrm_1())):
        vrm = _Glb(head)
        vrm.extend(extension, content)
        yield ".vrm", vrm.content()
    yield ".glb", _with_meshopt(head)
    yield ".glb", _with_draco(head)
    for kind in ("PNG", "JPEG", "WEBP"):
        yield ".glb", _with_picture(head, kind)


class _Glb:
    """A GLB that is taken apart.

    Attributes:
        document: its JSON.
        binary: its buffer.
    """

    def __init__(self, content: bytes) -> None:
        self.document, (start, stop) = split_glb(content)
        self.binary = bytearray(content[start:stop])

    @property
    def primitive(self) -> dict[str, Any]:
        """Its mesh."""
        primitive: dict[str, Any] = self.document["meshes"][0]["primitives"][0]
        return primitive

    def view(self, content: bytes, **more: Any) -> int:
        """Add a part of the buffer; returns its number."""
        self.binary += b"\0" * (-len(self.binary) % 4)
        place = {"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(content)}
        self.document["bufferViews"].append({**place, **more})
        self.binary += content
        return len(self.document["bufferViews"]) - 1

    def extend(self, name: str, content: object = None) -> None:
        """Use an extension."""
        self.document.setdefault("extensionsUsed", []).append(name)
        if content is not None:
            self.document.setdefault("extensions", {})[name] = content

    def numbers(self, accessor: int, dtype: str, width: int) -> NDArray[Any]:
        """(N, width) what a dense accessor holds."""
        entry = self.document["accessors"][accessor]
        start = self.document["bufferViews"][entry["bufferView"]].get("byteOffset", 0)
        found = np.frombuffer(self.binary, dtype, entry["count"] * width, start)
        return found.reshape(-1, width).copy()

    def content(self) -> bytes:
        """The file."""
        self.document["buffers"][0]["byteLength"] = len(self.binary)
        return join_glb(self.document, bytes(self.binary))


def _vrm_0() -> dict[str, Any]:
    groups = [
        {"name": name, "presetName": name, "binds": [{"mesh": 0, "index": n, "weight": 100}]}
        for n, name in enumerate(("a", "i", "u", "e", "o", "blink"))
    ]
    return {"blendShapeMaster": {"blendShapeGroups": groups}, "meta": {"title": "Small"}}


def _vrm_1() -> dict[str, Any]:
    preset = {
        name: {"morphTargetBinds": [{"node": 0, "index": n, "weight": 1.0}]}
        for n, name in enumerate(("aa", "ih", "ou", "ee", "oh", "blink"))
    }
    return {"specVersion": "1.0", "expressions": {"preset": preset}, "meta": {"name": "Small"}}


def _with_meshopt(head: bytes) -> bytes:
    """Its positions compressed by meshoptimizer."""
    glb = _Glb(head)
    positions = glb.primitive["attributes"]["POSITION"]
    places = glb.numbers(positions, "<f4", 3)
    view = glb.view(meshopt.encode_gltf_buffer(places, "ATTRIBUTES"))
    place = glb.document["bufferViews"][view]
    packed = {**place, "byteStride": 12, "count": len(places), "mode": "ATTRIBUTES"}
    place["extensions"] = {"EXT_meshopt_compression": packed}
    glb.document["accessors"][positions]["bufferView"] = view
    glb.extend("EXT_meshopt_compression")
    return glb.content()


def _with_draco(head: bytes) -> bytes:
    """Its mesh compressed by Draco."""
    glb = _Glb(head)
    primitive = glb.primitive
    places = glb.numbers(primitive["attributes"]["POSITION"], "<f4", 3)
    faces = glb.numbers(primitive["indices"], "<u4", 1).reshape(-1, 3)
    content = DracoPy.encode(places, faces, quantization_bits=16, preserve_order=True)
    (number,) = (part["unique_id"] for part in DracoPy.decode(content).attributes)
    packed = {"bufferView": glb.view(content), "attributes": {"POSITION": number}}
    primitive["extensions"] = {"KHR_draco_mesh_compression": packed}
    glb.extend("KHR_draco_mesh_compression")
    return glb.content()


def _with_picture(head: bytes, kind: str) -> bytes:
    """A picture on its skin."""
    glb, picture = _Glb(head), io.BytesIO()
    Image.new("RGB", (8, 8), (200, 150, 120)).save(picture, kind)
    view = glb.view(picture.getvalue())
    places = np.zeros((_VERTICES, 2), "<f4")
    entry = {"bufferView": glb.view(places.tobytes()), "componentType": 5126, "type": "VEC2"}
    glb.document["accessors"].append({**entry, "count": _VERTICES})
    glb.primitive["attributes"]["TEXCOORD_0"] = len(glb.document["accessors"]) - 1
    glb.document["images"] = [{"bufferView": view, "mimeType": f"image/{kind.lower()}"}]
    glb.document["textures"] = [{"source": 0}]
    base = {"baseColorTexture": {"index": 0}}
    glb.document["materials"] = [{"name": "skin", "pbrMetallicRoughness": base}]
    glb.primitive["material"] = 0
    return glb.content()
