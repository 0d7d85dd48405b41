"""GLBs with several meshes and animations, and their numbers as they are in the file."""

from __future__ import annotations

import json
import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Numbers = NDArray[np.float64]


@dataclass(frozen=True)
class Played:
    """What a mesh does in an animation.

    Attributes:
        mesh: its name.
        weights: (T, N), or (T, 3, N) with tangents.
        times: (T,) seconds; None = 30 fps.
    """

    mesh: str
    weights: Numbers
    times: Numbers | None = None


def write_animations(
    path: Path,
    meshes: Mapping[str, Sequence[str]],
    animations: Sequence[tuple[str, Sequence[Played]]],
    number: str = "<f4",
) -> Path:
    """Write a GLB of triangles.

    Args:
        meshes: the names of the shapes of each.
        animations: the name of each, "" for none, and what is played.
        number: how weights are stored: `<f4`, `u1` or `<u2`.
    """
    file = _File()
    triangle = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], "<f4")
    corners = file.add(triangle, "VEC3", min=[0, 0, 0], max=[1, 1, 0])
    shape = {"POSITION": file.add(triangle, "VEC3", min=[0, 0, 0], max=[1, 1, 0])}
    written: list[dict[str, Any]] = []
    for name, played in animations:
        samplers: list[dict[str, Any]] = []
        channels: list[dict[str, Any]] = []
        for one in played:
            times = np.arange(len(one.weights)) / 30 if one.times is None else one.times
            sampler: dict[str, Any] = {"input": file.add(times.astype("<f4"), "SCALAR")}
            sampler["output"] = file.add_weights(one.weights, number)
            if one.weights.ndim == 3:
                sampler["interpolation"] = "CUBICSPLINE"
            target = {"node": list(meshes).index(one.mesh), "path": "weights"}
            channels.append({"sampler": len(samplers), "target": target})
            samplers.append(sampler)
        named = {"name": name} if name else {}
        written.append({**named, "samplers": samplers, "channels": channels})
    document = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": list(range(len(meshes)))}],
        "nodes": [{"mesh": n, "name": name} for n, name in enumerate(meshes)],
        "meshes": [
            {
                "primitives": [
                    {"attributes": {"POSITION": corners}, "targets": [shape] * len(shapes)}
                ],
                "extras": {"targetNames": list(shapes)},
            }
            for shapes in meshes.values()
        ],
        "animations": written,
    }
    path.write_bytes(file.content(document))
    return path


def outputs(path: Path) -> list[list[Numbers]]:
    """The numbers of each sampler of each animation."""
    content = path.read_bytes()
    length = struct.unpack_from("<I", content, 12)[0]
    document, binary = json.loads(content[20 : 20 + length]), content[28 + length :]

    def numbers(index: int) -> Numbers:
        accessor = document["accessors"][index]
        kind = np.dtype({5121: "u1", 5123: "<u2", 5126: "<f4"}[accessor["componentType"]])
        start = document["bufferViews"][accessor["bufferView"]]["byteOffset"]
        return np.frombuffer(binary, kind, accessor["count"], start).astype(np.float64)

    animations = document["animations"]
    return [[numbers(s["output"]) for s in one["samplers"]] for one in animations]


class _File:
    def __init__(self) -> None:
        self._binary = bytearray()
        self._accessors: list[dict[str, Any]] = []
        self._views: list[dict[str, Any]] = []

    def add(self, array: NDArray[Any], type_: str, **more: Any) -> int:
        self._binary.extend(b"\0" * (-len(self._binary) % 4))
        place = {"byteOffset": len(self._binary), "byteLength": array.nbytes}
        self._views.append({"buffer": 0, **place})
        self._binary.extend(array.tobytes())
        component = {"|u1": 5121, "<u2": 5123, "<f4": 5126}[array.dtype.str]
        count = array.size if type_ == "SCALAR" else len(array)
        view = {"bufferView": len(self._views) - 1, "componentType": component}
        self._accessors.append({**view, "count": count, "type": type_, **more})
        return len(self._accessors) - 1

    def add_weights(self, weights: Numbers, number: str) -> int:
        kind = np.dtype(number)
        if kind.kind == "f":
            return self.add(weights.astype(kind), "SCALAR")
        whole = np.round(weights * np.iinfo(kind).max).astype(kind)
        return self.add(whole, "SCALAR", normalized=True)

    def content(self, document: dict[str, Any]) -> bytes:
        self._binary.extend(b"\0" * (-len(self._binary) % 4))
        rest = {"accessors": self._accessors, "bufferViews": self._views}
        text = json.dumps(document | rest | {"buffers": [{"byteLength": len(self._binary)}]})
        text += " " * (-len(text) % 4)
        chunks = struct.pack("<I4s", len(text), b"JSON") + text.encode()
        chunks += struct.pack("<I4s", len(self._binary), b"BIN\0") + bytes(self._binary)
        return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks
