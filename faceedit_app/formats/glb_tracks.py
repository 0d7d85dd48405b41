"""The tracks of shapes in a GLB: where their weights are, and what they are.

A track is one animation channel of `weights`. Its numbers may be floats, whole numbers, compressed
(meshopt) or sparse.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from faceedit_app.core.arrays import Floats, Times
from faceedit_app.core.glb import split_glb
from faceedit_app.core.names import canonical_channel

FLOAT = 5126
_TYPES: dict[int, Any] = {5120: "i1", 5121: "u1", 5122: "<i2", 5123: "<u2", FLOAT: "<f4"}
_INDEX_TYPES = {5121: "u1", 5123: "<u2", 5125: "<u4"}
_COMPRESSED = ("EXT_meshopt_compression", "KHR_meshopt_compression")
# The best compression of meshoptimizer: one control byte for 256 rows.
_MOST_EXPANSION = 2048


class UnusualStorage(Exception):
    """A GLB is stored in a way that cannot be read; the text says how, as a phrase."""


@dataclass(frozen=True)
class Track:
    """The weights of one mesh over time.

    Attributes:
        names: the N shapes; "" for one without a name.
        times: (T,) seconds.
        output: (T, 1, N) weights, or (T, 3, N) tangents before, weights, tangents after (cubic).
        sampler: (animation, sampler) indices.
        offset: where the output begins in the file; None if it is not plain floats.
        rounding: the step between two weights that the file can tell apart; 0 for floats.
        mesh: the name of what is animated, "" if it has none.
    """

    names: tuple[str, ...]
    times: Times
    output: Floats
    sampler: tuple[int, int]
    offset: int | None
    rounding: float = 0.0
    mesh: str = ""

    @property
    def values(self) -> Floats:
        """(T, N) the weights."""
        return self.output[:, self.output.shape[1] // 2]

    @property
    def is_cubic(self) -> bool:
        """Whether each key has tangents around its weights."""
        return bool(self.output.shape[1] > 1)

    @cached_property
    def columns(self) -> dict[str, int]:
        """The column of each channel."""
        found: dict[str, int] = {}
        for column, name in enumerate(self.names):
            channel = canonical_channel(name)
            if channel is not None:
                found.setdefault(channel, column)
        return found


@dataclass(frozen=True)
class Glb:
    """A GLB in memory: its bytes, its JSON chunk, and its binary chunk as (start, stop)."""

    content: bytes
    document: Mapping[str, Any]
    binary: tuple[int, int]


def parse(content: bytes) -> Glb:
    """The parts of a GLB, without a look at what is in them."""
    return Glb(content, *split_glb(content))


def shape_channels(document: Mapping[str, Any]) -> Iterator[tuple[int, int, int, tuple[str, ...]]]:
    """Animation, sampler, node and shape names of each animation of weights."""
    for number, animation in enumerate(document.get("animations", [])):
        for channel in animation["channels"]:
            target = channel["target"]
            if target["path"] == "weights" and "node" in target:
                mesh = document["meshes"][document["nodes"][target["node"]]["mesh"]]
                yield number, channel["sampler"], target["node"], _target_names(mesh)


def _target_names(mesh: Mapping[str, Any]) -> tuple[str, ...]:
    primitives = mesh["primitives"]
    count = len(primitives[0].get("targets", []))
    for place in (mesh, *primitives):
        names = (place.get("extras") or {}).get("targetNames")
        if isinstance(names, list) and len(names) == count:
            return tuple(name if isinstance(name, str) else "" for name in names)
    return ("",) * count


def tracks_of(glb: Glb) -> Iterator[Track]:
    """The tracks with channels of ARKit, in the order of the file."""
    seen: set[tuple[int, int]] = set()
    for animation, number, node, names in shape_channels(glb.document):
        if (animation, number) in seen or not any(map(canonical_channel, names)):
            continue
        seen.add((animation, number))
        sampler = glb.document["animations"][animation]["samplers"][number]
        times, _ = _accessor(glb, sampler["input"])
        output, offset = _accessor(glb, sampler["output"])
        parts = 3 if sampler.get("interpolation") == "CUBICSPLINE" else 1
        yield Track(
            names=names,
            times=times.astype(np.float64),
            output=output.reshape(len(times), parts, len(names)),
            sampler=(animation, number),
            offset=offset,
            rounding=_rounding(glb, sampler["output"]),
            mesh=_mesh_name(glb, node),
        )


def _rounding(glb: Glb, index: int) -> float:
    dtype = np.dtype(_TYPES[glb.document["accessors"][index]["componentType"]])
    return 0.0 if dtype.kind == "f" else 1 / float(np.iinfo(dtype).max)


def _mesh_name(glb: Glb, number: int) -> str:
    node = glb.document["nodes"][number]
    names = (node.get("name"), glb.document["meshes"][node["mesh"]].get("name"))
    return next((name for name in names if isinstance(name, str) and name), "")


def _accessor(glb: Glb, index: int) -> tuple[Floats, int | None]:
    """The numbers of an accessor (N,), and their place in the file if they are plain floats."""
    accessor = glb.document["accessors"][index]
    dtype = np.dtype(_TYPES[accessor["componentType"]])
    count = accessor["count"]
    if accessor["type"] != "SCALAR":
        raise UnusualStorage("stores its weights in an unusual way")
    if "sparse" in accessor:
        return _sparse(glb, accessor, dtype), None
    view = glb.document["bufferViews"][accessor["bufferView"]]
    start = accessor.get("byteOffset", 0)
    extensions = view.get("extensions", {})
    packed = next((extensions[name] for name in _COMPRESSED if name in extensions), None)
    if packed is not None:
        data, stride = _unpack(glb, packed)
        # Rows of a compressed view are padded to four bytes: take the numbers from the start.
        rows = np.frombuffer(data, np.uint8)[start : start + count * stride].reshape(count, stride)
        numbers = rows[:, : dtype.itemsize].copy().view(dtype)[:, 0]
        return _as_parts(numbers), None
    numbers, start = _plain(glb, accessor, dtype, count)
    plain = accessor["componentType"] == FLOAT
    return _as_parts(numbers), glb.binary[0] + start if plain else None


def _sparse(glb: Glb, accessor: Mapping[str, Any], dtype: np.dtype[Any]) -> Floats:
    """The numbers (N,) of an accessor that replaces some of another's, or of zeros."""
    sparse = accessor["sparse"]
    dense = {key: value for key, value in accessor.items() if key != "sparse"}
    if "bufferView" in accessor:
        numbers, _ = _plain(glb, dense, dtype, accessor["count"])
        numbers = numbers.copy()
    else:
        if accessor["count"] > _MOST_EXPANSION * len(glb.content):
            raise ValueError("it claims more than it can hold")
        numbers = np.zeros(accessor["count"], dtype)
    kind = np.dtype(_INDEX_TYPES[sparse["indices"]["componentType"]])
    where, _ = _plain(glb, sparse["indices"], kind, sparse["count"])
    numbers[where], _ = _plain(glb, sparse["values"], dtype, sparse["count"])
    return _as_parts(numbers)


def _plain(
    glb: Glb, reader: Mapping[str, Any], dtype: np.dtype[Any], count: int
) -> tuple[NDArray[Any], int]:
    """Uncompressed numbers (N,) and their place in the binary chunk.

    Args:
        reader: what names the buffer view and the offset in it.
    """
    view = glb.document["bufferViews"][reader["bufferView"]]
    if view.get("byteStride", dtype.itemsize) != dtype.itemsize:
        raise UnusualStorage("stores its weights in an unusual way")
    start = view.get("byteOffset", 0) + reader.get("byteOffset", 0)
    return np.frombuffer(_buffer(glb, view), dtype, count, start), start


def _buffer(glb: Glb, view: Mapping[str, Any]) -> bytes:
    """The binary chunk, which must contain every plain view."""
    if view["buffer"] != 0 or "uri" in glb.document["buffers"][0]:
        raise UnusualStorage("keeps its data in other files")
    return glb.content[slice(*glb.binary)]


def _unpack(glb: Glb, packed: Mapping[str, Any]) -> tuple[bytes, int]:
    """The bytes of a compressed buffer view, and the bytes per row."""
    start, count, stride = packed.get("byteOffset", 0), packed["count"], packed["byteStride"]
    data = _buffer(glb, packed)[start : start + packed["byteLength"]]
    if count * stride > _MOST_EXPANSION * len(data):
        raise ValueError("it claims more than it can hold")
    import meshopt  # few files are compressed; the window does not wait for this

    rows = meshopt.decode_gltf_buffer(
        data, count, stride, packed["mode"], packed.get("filter", "NONE")
    )
    return np.ascontiguousarray(rows).tobytes(), stride


def _as_parts(numbers: NDArray[Any]) -> Floats:
    """Numbers as floats; integers are normalised to 1."""
    floats: Floats = numbers.astype(np.float32)
    if numbers.dtype.kind != "f":
        floats = np.maximum(floats / np.float32(np.iinfo(numbers.dtype).max), np.float32(-1))
    return floats
