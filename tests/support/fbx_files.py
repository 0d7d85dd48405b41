"""Small FBX files of a head, written by hand."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from support.character_files import Names, same, targets_of
from support.heads import small_head


def fbx_value(value: Any) -> bytes:
    """One value of a record."""
    if isinstance(value, bool):
        return b"C" + struct.pack("<B", value)
    if isinstance(value, np.ndarray):
        kind, dtype = {"f": (b"d", "<f8"), "i": (b"i", "<i4")}[value.dtype.kind]
        raw = np.ascontiguousarray(value.ravel(), dtype).tobytes()
        packed = zlib.compress(raw)
        return kind + struct.pack("<III", value.size, 1, len(packed)) + packed
    if isinstance(value, int):
        return b"L" + struct.pack("<q", value)
    if isinstance(value, float):
        return b"D" + struct.pack("<d", value)
    if isinstance(value, bytes):
        return b"R" + struct.pack("<I", len(value)) + value
    text = str(value).encode()
    return b"S" + struct.pack("<I", len(text)) + text


FbxRecord = tuple[str, list[Any], list[Any]]


def fbx_record(name: str, *values: Any, inside: Iterable[FbxRecord] = ()) -> FbxRecord:
    """A record for `fbx_bytes`."""
    return name, list(values), list(inside)


def _encoded(record: FbxRecord, place: int, wide: bool) -> bytes:
    name, values, inside = record
    content = b"".join(map(fbx_value, values))
    size = 25 if wide else 13
    start = place + size + len(name)
    body, at = b"", start + len(content)
    for child in inside:
        body += _encoded(child, at + 0, wide)
        at = start + len(content) + len(body)
    if inside:
        body += b"\0" * size
    end = start + len(content) + len(body)
    head = struct.pack("<QQQB" if wide else "<IIIB", end, len(values), len(content), len(name))
    return head + name.encode() + content + body


def fbx_bytes(records: Iterable[FbxRecord], version: int = 7400) -> bytes:
    """A binary FBX file."""
    wide = version >= 7500
    out = b"Kaydara FBX Binary  \x00\x1a\x00" + struct.pack("<I", version)
    for record in records:
        out += _encoded(record, len(out), wide)
    return out + b"\0" * (25 if wide else 13) + b"\0" * 160


def fbx_of_head(names: Names = same, texture: bytes = b"") -> list[FbxRecord]:
    """The records of the small head in centimetres, in quads, turned and moved by its model."""
    head = small_head()
    half = len(head.faces) // 2
    quads = np.column_stack((head.faces[:half], head.faces[half:, 2])).astype(np.int32)
    quads[:, 3] = ~quads[:, 3]
    places = head.vertices / 10
    uv = np.stack((head.uv[:, 0], 1 - head.uv[:, 1]), axis=1)
    corners = np.column_stack((head.faces[:half], head.faces[half:, 2])).astype(np.int32)
    layer = fbx_record(
        "LayerElementUV",
        0,
        inside=[
            fbx_record("MappingInformationType", "ByPolygonVertex"),
            fbx_record("ReferenceInformationType", "IndexToDirect"),
            fbx_record("UV", uv),
            fbx_record("UVIndex", corners),
        ],
    )
    objects = [
        fbx_record(
            "Geometry",
            1,
            "Head\0\1Geometry",
            "Mesh",
            inside=[
                fbx_record("Vertices", places),
                fbx_record("PolygonVertexIndex", quads),
                layer,
            ],
        ),
        fbx_record(
            "Model",
            2,
            "Head\0\1Model",
            "Mesh",
            inside=[
                fbx_record(
                    "Properties70",
                    inside=[
                        fbx_record("P", "Lcl Rotation", "Lcl Rotation", "", "A", 0.0, 90.0, 0.0),
                        fbx_record("P", "Lcl Translation", "", "", "A", 0.0, 160.0, 5.0),
                        fbx_record("P", "Lcl Scaling", "", "", "A", 2.0, 2.0, 2.0),
                    ],
                )
            ],
        ),
        fbx_record("Deformer", 3, "Head\0\1Deformer", "BlendShape"),
    ]
    links = [(1, 2), (2, 0), (3, 1)]
    if texture:
        inside = [fbx_record("Content", texture)]
        objects += [
            fbx_record("Material", 4, "Skin\0\1Material", ""),
            fbx_record("Texture", 5, "t\0\1Texture", "", inside=[fbx_record("FileName", "t.png")]),
            fbx_record("Video", 6, "v\0\1Video", "Clip", inside=inside),
        ]
        links += [(4, 2), (6, 5)]
    for number, (name, moves) in enumerate(targets_of(head, names).items()):
        channel, shape = 100 + 2 * number, 101 + 2 * number
        rows = np.flatnonzero(np.abs(moves).max(axis=1) > 1e-9).astype(np.int32)
        objects += [
            fbx_record("Deformer", channel, f"{name}\0\1SubDeformer", "BlendShapeChannel"),
            fbx_record(
                "Geometry",
                shape,
                f"{name}\0\1Geometry",
                "Shape",
                inside=[fbx_record("Indexes", rows), fbx_record("Vertices", moves[rows] / 10)],
            ),
        ]
        links += [(channel, 3), (shape, channel)]
    connections = [fbx_record("C", "OO", a, b) for a, b in links]
    if texture:
        connections.append(fbx_record("C", "OP", 5, 4, "DiffuseColor"))
    return [fbx_record("Objects", inside=objects), fbx_record("Connections", inside=connections)]


def write_fbx(path: Path, names: Names = same, version: int = 7400, texture: bytes = b"") -> Path:
    """The small head as binary FBX."""
    path.write_bytes(fbx_bytes(fbx_of_head(names, texture), version))
    return path
