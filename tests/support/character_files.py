"""Character files of every kind, written by the tests themselves."""

from __future__ import annotations

import io
import json
import struct
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from faceedit_app.core.arrays import Doubles
from support.heads import Head, small_head

Json = dict[str, Any]
Names = Callable[[str], str | None]

FLOAT, BYTE, SHORT, UNSIGNED, UNSIGNED_SHORT, UNSIGNED_BYTE = 5126, 5120, 5122, 5125, 5123, 5121
_TYPES = {
    FLOAT: "<f4",
    BYTE: "i1",
    SHORT: "<i2",
    UNSIGNED: "<u4",
    UNSIGNED_SHORT: "<u2",
    UNSIGNED_BYTE: "u1",
}
_KINDS = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}


class Glb:
    """Collects what a GLB consists of."""

    def __init__(self) -> None:
        self.binary = bytearray()
        self.json: Json = {
            "asset": {"version": "2.0"},
            "buffers": [{}],
            "bufferViews": [],
            "accessors": [],
            "meshes": [],
            "nodes": [],
            "scenes": [{"nodes": []}],
            "scene": 0,
        }

    def view(self, content: bytes, **more: Any) -> int:
        """A buffer view."""
        self.binary += b"\0" * (-len(self.binary) % 4)
        place = {"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(content)}
        self.json["bufferViews"].append({**place, **more})
        self.binary += content
        return len(self.json["bufferViews"]) - 1

    def packed(self, array: np.ndarray, mode: str) -> int:
        """A buffer view that meshoptimizer has compressed."""
        import meshopt

        array = np.ascontiguousarray(array)
        content = meshopt.encode_gltf_buffer(array, mode)
        stride = array.itemsize if mode == "TRIANGLES" else array.strides[0]
        count = array.size if mode == "TRIANGLES" else len(array)
        view = self.view(content)
        place = self.json["bufferViews"][view]
        extension = {**place, "byteStride": stride, "count": count, "mode": mode}
        place["extensions"] = {"EXT_meshopt_compression": extension}
        self.json["extensionsRequired"] = ["EXT_meshopt_compression"]
        return view

    def accessor(self, array: np.ndarray, component: int, **more: Any) -> int:
        """A dense accessor; `view` names another buffer view to read it from."""
        array = np.asarray(array, _TYPES[component])
        width = 1 if array.ndim == 1 else array.shape[1]
        if "bufferView" not in more:
            more["bufferView"] = self.view(array.tobytes())
        head = {"componentType": component, "count": len(array), "type": _KINDS[width]}
        self.json["accessors"].append({**head, **more})
        return len(self.json["accessors"]) - 1

    def sparse(self, array: np.ndarray) -> int:
        """A sparse accessor of (V, 3) that has no buffer view of its own."""
        rows = np.flatnonzero(np.abs(array).max(axis=1) > 1e-7)
        rows = rows if len(rows) else np.zeros(1, int)
        values = {"bufferView": self.view(np.asarray(array[rows], "<f4").tobytes())}
        indices = {
            "bufferView": self.view(rows.astype("<u2").tobytes()),
            "componentType": UNSIGNED_SHORT,
        }
        sparse = {"count": len(rows), "indices": indices, "values": values}
        entry = {"componentType": FLOAT, "count": len(array), "type": "VEC3", "sparse": sparse}
        self.json["accessors"].append(entry)
        return len(self.json["accessors"]) - 1

    def mesh(self, primitives: list[Json], names: list[str], **node: Any) -> int:
        """A mesh and its node; returns the node."""
        self.json["meshes"].append({"primitives": primitives, "extras": {"targetNames": names}})
        return self.node(mesh=len(self.json["meshes"]) - 1, **node)

    def node(self, **node: Any) -> int:
        """A node of the scene."""
        self.json["nodes"].append(node)
        self.json["scenes"][0]["nodes"].append(len(self.json["nodes"]) - 1)
        return len(self.json["nodes"]) - 1

    def content(self) -> bytes:
        """The file."""
        self.json["buffers"][0]["byteLength"] = len(self.binary)
        return glb_of(self.json, bytes(self.binary))


def glb_of(document: Json, binary: bytes) -> bytes:
    """A GLB of its two parts."""
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    binary += b"\0" * (-len(binary) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
    chunks += struct.pack("<II", len(binary), 0x004E4942) + binary
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def parts_of(content: bytes) -> tuple[Json, bytes]:
    """The two parts of a GLB."""
    length = struct.unpack_from("<I", content, 12)[0]
    return json.loads(content[20 : 20 + length]), content[28 + length :]


def same(name: str) -> str:
    """ARKit's own name."""
    return name


def targets_of(head: Head, names: Names) -> dict[str, Doubles]:
    return {new: moves for name, moves in head.targets.items() if (new := names(name))}


def write_glb(path: Path, names: Names = same, kind: str = "plain", picture: bytes = b"") -> Path:
    """The small head as GLB.

    Args:
        names: what each channel's target is called; None leaves it out.
        kind: plain, sparse, skinned (with the scale in the bind matrices), quantized (skinned and
            in whole numbers), meshopt, draco, or strips.
        picture: its texture.
    """
    path.write_bytes(small_glb(names, kind, picture).content())
    return path


def small_glb(names: Names = same, kind: str = "plain", picture: bytes = b"") -> Glb:
    """See `write_glb`."""
    head, out = small_head(), Glb()
    targets = targets_of(head, names)
    places, faces = head.vertices / 1000, head.faces
    attributes: Json = {"TEXCOORD_0": out.accessor(head.uv, FLOAT)}
    node: Json = {"name": "Head"}
    if kind in ("skinned", "quantized"):
        node |= _skin(out, attributes, len(places), scale=0.01)
        places, shrunk = places * 100, 100.0
    else:
        shrunk = 1.0
    moves = {name: moves / 1000 * shrunk for name, moves in targets.items()}
    if kind == "quantized":
        step = 0.001
        attributes["POSITION"] = out.accessor(np.round(places / step), SHORT)
        made = [{"POSITION": out.accessor(np.round(m / step), SHORT)} for m in moves.values()]
        bind = out.json["accessors"][out.json["skins"][0]["inverseBindMatrices"]]
        start = out.json["bufferViews"][bind["bufferView"]]["byteOffset"]
        matrix = np.diag([0.01 * step] * 3 + [1.0]).astype("<f4")
        out.binary[start : start + 64] = matrix.tobytes()
        out.json["extensionsUsed"] = ["KHR_mesh_quantization"]
    elif kind == "meshopt":
        view = out.packed(places.astype("<f4"), "ATTRIBUTES")
        attributes["POSITION"] = out.accessor(places, FLOAT, bufferView=view)
        made = [
            {
                "POSITION": out.accessor(
                    m, FLOAT, bufferView=out.packed(m.astype("<f4"), "ATTRIBUTES")
                )
            }
            for m in moves.values()
        ]
    else:
        attributes["POSITION"] = out.accessor(places, FLOAT)
        write = out.sparse if kind == "sparse" else lambda m: out.accessor(m, FLOAT)
        made = [{"POSITION": write(m)} for m in moves.values()]
    primitive: Json = {"attributes": attributes, "targets": made}
    if kind == "meshopt":
        triangles = faces.astype("<u4").ravel()
        view = out.packed(triangles, "TRIANGLES")
        primitive["indices"] = out.accessor(triangles, UNSIGNED, bufferView=view)
    elif kind == "draco":
        _draco(out, primitive, places, faces)
    else:
        primitive["indices"] = out.accessor(faces.ravel(), UNSIGNED)
    if picture:
        out.json["images"] = [{"bufferView": out.view(picture), "name": "skin.png"}]
        out.json["textures"] = [{"source": 0}]
        base = {"baseColorTexture": {"index": 0}}
        out.json["materials"] = [{"name": "Skin", "pbrMetallicRoughness": base}]
        primitive["material"] = 0
    out.mesh([primitive], list(targets), **node)
    return out


def _skin(out: Glb, attributes: Json, count: int, scale: float) -> Json:
    """One joint that carries everything; the inverse bind matrix holds the scale."""
    joint = out.node(name="Neck", translation=[0.0, 1.6, 0.0])
    matrix = np.diag([scale, scale, scale, 1.0]).astype("<f4")
    bind = out.accessor(matrix.reshape(1, 16), FLOAT)
    out.json["skins"] = [{"joints": [joint], "inverseBindMatrices": bind}]
    attributes["JOINTS_0"] = out.accessor(np.zeros((count, 4)), UNSIGNED_BYTE)
    weights = np.tile([255, 0, 0, 0], (count, 1))
    attributes["WEIGHTS_0"] = out.accessor(weights, UNSIGNED_BYTE, normalized=True)
    return {"skin": 0}


def _draco(out: Glb, primitive: Json, places: Doubles, faces: np.ndarray) -> None:
    """Compress a primitive without changing the order of its vertices."""
    import DracoPy

    content = DracoPy.encode(
        places.astype(np.float32),
        faces.astype(np.uint32),
        quantization_bits=16,
        preserve_order=True,
    )
    (number,) = (a["unique_id"] for a in DracoPy.decode(content).attributes)
    extension = {"bufferView": out.view(content), "attributes": {"POSITION": number}}
    primitive["extensions"] = {"KHR_draco_mesh_compression": extension}
    for index in (primitive["attributes"]["POSITION"],):
        del out.json["accessors"][index]["bufferView"]
    count = {"componentType": UNSIGNED, "count": faces.size, "type": "SCALAR"}
    out.json["accessors"].append(count)
    primitive["indices"] = len(out.json["accessors"]) - 1
    out.json["extensionsRequired"] = ["KHR_draco_mesh_compression"]


def picture_of(color: tuple[int, int, int], kind: str = "PNG") -> bytes:
    """A picture of one colour."""
    out = io.BytesIO()
    Image.new("RGB", (16, 16), color).save(out, kind)
    return out.getvalue()


# --- VRM -----------------------------------------------------------------------------------------

VISEMES = {
    "a": {"jawOpen": 1.0},
    "i": {"mouthStretchLeft": 1.0, "mouthStretchRight": 1.0},
    "u": {"mouthPucker": 1.0},
    "e": {"mouthLowerDownLeft": 1.0, "mouthLowerDownRight": 1.0},
    "o": {"mouthFunnel": 1.0},
    "blink": {"eyeBlinkLeft": 1.0, "eyeBlinkRight": 1.0},
    "joy": {"mouthSmileLeft": 1.0, "mouthSmileRight": 1.0, "eyeBlinkLeft": 0.5},
    "angry": {"browDownLeft": 1.0, "browDownRight": 1.0, "mouthFrownLeft": 1.0},
}


def write_vrm(
    path: Path, version: int = 0, presets: Mapping[str, Mapping[str, float]] = VISEMES
) -> Path:
    """The small head as VRM whose meshes call their targets by numbers; VRM 0 looks backwards."""
    order = list(small_head().targets)
    out = small_glb(lambda name: f"shape{order.index(name)}", "plain")
    if version == 0:
        out.json["nodes"][0]["rotation"] = [0.0, 1.0, 0.0, 0.0]
        groups = [
            {
                "name": name.upper(),
                "presetName": name,
                "binds": [
                    {"mesh": 0, "index": order.index(c), "weight": 100 * w} for c, w in made.items()
                ],
            }
            for name, made in presets.items()
        ]
        meta = {"title": "Small", "author": "A test"}
        vrm = {"blendShapeMaster": {"blendShapeGroups": groups}, "meta": meta}
        out.json["extensions"] = {"VRM": vrm}
        out.json["extensionsUsed"] = ["VRM"]
    else:
        made = {
            name: {
                "morphTargetBinds": [
                    {"node": 0, "index": order.index(c), "weight": w} for c, w in made.items()
                ]
            }
            for name, made in presets.items()
        }
        vrm = {"specVersion": "1.0", "expressions": {"preset": made}, "meta": {"name": "Small"}}
        out.json["extensions"] = {"VRMC_vrm": vrm}
        out.json["extensionsUsed"] = ["VRMC_vrm"]
    path.write_bytes(out.content())
    return path


# --- OBJ -----------------------------------------------------------------------------------------


def places_of_obj(vertices: NDArray[np.floating]) -> str:
    """(V, 3) as lines of an OBJ file: formatted in one go, that takes a quarter of the time."""
    return "v %.6f %.6f %.6f\n" * len(vertices) % tuple(vertices.ravel().tolist())


def write_objs(folder: Path, names: Names = same, scale: float = 0.1) -> Path:
    """A folder of OBJ files in centimetres, Z up and looking along -Y, as some programs write."""
    head = small_head()
    folder.mkdir(exist_ok=True)
    faces = "\n".join("f " + " ".join(f"{i + 1}/{i + 1}" for i in face) for face in head.faces)
    coordinates = "\n".join(f"vt {u:.5f} {1 - v:.5f}" for u, v in head.uv)
    shapes = {"neutral": np.zeros_like(head.vertices)} | targets_of(head, names)
    for name, moves in shapes.items():
        x, y, z = ((head.vertices + moves) * scale).T
        rows = places_of_obj(np.stack((x, -z, y), axis=1))
        text = f"# a head\n{rows}{coordinates}\nusemtl skin\n{faces}\n"
        (folder / f"{name}.obj").write_text(text)
    return folder
