"""GLB: the animation of a character's shape keys (glTF 2.0, animation channels of `weights`).

A track is one such channel: key times in seconds, and for each key the weights of all shapes of
the mesh, named by `extras.targetNames`. Meshes that share a take, such as head and teeth, have one
track each; tracks with the same times are edited together. Everything else is carried.

An export overwrites the changed weights in place. Weights stored as integers or compressed are
written to the end of the file, as floats.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from faceedit_app.core.arrays import Floats, Times
from faceedit_app.core.errors import FileError
from faceedit_app.core.glb import MAGIC, join_glb, split_glb
from faceedit_app.core.names import canonical_channel
from faceedit_app.formats.take import Recording, Take, finish_take
from faceedit_app.formats.timing import time_keys

FORMAT = "GLB animation"
_FLOAT = 5126
_TYPES: dict[int, Any] = {5120: "i1", 5121: "u1", 5122: "<i2", 5123: "<u2", _FLOAT: "<f4"}
_INDEX_TYPES = {5121: "u1", 5123: "<u2", 5125: "<u4"}
_COMPRESSED = ("EXT_meshopt_compression", "KHR_meshopt_compression")
_DAMAGE = (KeyError, IndexError, TypeError, ValueError, AttributeError, struct.error)
# The best compression of meshoptimizer: one control byte for 256 rows.
_MOST_EXPANSION = 2048
_EXPORT_AGAIN = "export it again"


@dataclass(frozen=True)
class Track:
    """The weights of one mesh over time.

    Attributes:
        names: the N shapes; "" for one without a name.
        times: (T,) seconds.
        values: (T, N) float32.
        cubic: whether each key has tangents around its weights.
        sampler: (animation, sampler) indices.
        offset: where the weights begin in the file; None if they are not plain floats.
    """

    names: tuple[str, ...]
    times: Times
    values: Floats
    cubic: bool
    sampler: tuple[int, int]
    offset: int | None


@dataclass(frozen=True)
class Glb:
    """A GLB in memory: its bytes, its JSON chunk, and its binary chunk as (start, stop)."""

    content: bytes
    document: Mapping[str, Any]
    binary: tuple[int, int]


def sniff(content: bytes) -> float:
    """How likely, 0..1, this is a GLB with an animation of shapes with ARKit names."""
    if not content.startswith(MAGIC):
        return 0.0
    try:
        names = {name for _, _, found in _channels(_parse(content).document) for name in found}
    except _DAMAGE:
        return 0.0
    return 0.9 if any(map(canonical_channel, names)) else 0.0


def read(path: Path, content: bytes, fps: float | None) -> Take:
    """Open the animation in a GLB.

    Raises:
        RateNeeded: its times are unusable, and `fps` is None.
        FileError: it is damaged, or stored in a way that cannot be read.
    """
    try:
        glb = _parse(content)
        tracks = list(_tracks(glb))
    except _Unreadable as error:
        raise FileError(path, str(error), "save it without compression") from None
    except _DAMAGE:
        raise FileError(path, "is damaged", _EXPORT_AGAIN) from None
    # Of several, the first, as other programs play it: an export puts its take before what the
    # character came with. A single key is a pose.
    main = max(tracks, key=lambda track: (len(_columns(track)), len(track.times) > 1))
    together = [main, *(t for t in tracks if t is not main and _goes_with(t, main))]
    columns: dict[str, list[tuple[int, int]]] = {}
    for place, track in enumerate(together):
        for channel, column in _columns(track).items():
            columns.setdefault(channel, []).append((place, column))
    first = [places[0] for places in columns.values()]
    values = np.stack([together[place].values[:, column] for place, column in first], axis=1)
    if not np.isfinite(values).all():
        raise FileError(path, "holds weights that are not numbers", _EXPORT_AGAIN)
    others = len(tracks) - len(together)
    unread = (f"one of {others + 1} animations is read",) if others else ()
    used = {name for track in together for name in track.names if canonical_channel(name)}
    recording = Recording(
        path=path,
        format=FORMAT,
        channels=tuple(columns),
        values=values.astype(np.float64),
        timing=time_keys(path, main.times, _EXPORT_AGAIN),
        lost=np.zeros(len(values), bool),
        carried=tuple(n for track in together for n in track.names if n and n not in used),
        unread=unread,
    )
    places = tuple(tuple(found) for found in columns.values())
    return finish_take(recording, fps, lambda scale: GlbSource(glb, tuple(together), places, scale))


class _Unreadable(Exception):
    """A GLB is stored in a way that cannot be read; the text says how, as a phrase."""


def _columns(track: Track) -> dict[str, int]:
    found: dict[str, int] = {}
    for column, name in enumerate(track.names):
        channel = canonical_channel(name)
        if channel is not None:
            found.setdefault(channel, column)
    return found


def _goes_with(track: Track, main: Track) -> bool:
    return np.array_equal(track.times, main.times) and bool(_columns(track))


# --- reading -------------------------------------------------------------------------------------


def _parse(content: bytes) -> Glb:
    return Glb(content, *split_glb(content))


def _channels(document: Mapping[str, Any]) -> Iterator[tuple[int, int, tuple[str, ...]]]:
    """Animation, sampler and shape names of each animation of weights."""
    for number, animation in enumerate(document.get("animations", [])):
        for channel in animation["channels"]:
            target = channel["target"]
            if target["path"] == "weights" and "node" in target:
                mesh = document["meshes"][document["nodes"][target["node"]]["mesh"]]
                yield number, channel["sampler"], _target_names(mesh)


def _target_names(mesh: Mapping[str, Any]) -> tuple[str, ...]:
    primitives = mesh["primitives"]
    count = len(primitives[0].get("targets", []))
    for place in (mesh, *primitives):
        names = (place.get("extras") or {}).get("targetNames")
        if isinstance(names, list) and len(names) == count:
            return tuple(name if isinstance(name, str) else "" for name in names)
    return ("",) * count


def _tracks(glb: Glb) -> Iterator[Track]:
    seen: set[tuple[int, int]] = set()
    for animation, number, names in _channels(glb.document):
        if (animation, number) in seen or not any(map(canonical_channel, names)):
            continue
        seen.add((animation, number))
        sampler = glb.document["animations"][animation]["samplers"][number]
        times, _ = _accessor(glb, sampler["input"])
        values, offset = _accessor(glb, sampler["output"])
        cubic = sampler.get("interpolation") == "CUBICSPLINE"
        shape = (len(times), 3, len(names)) if cubic else (len(times), 1, len(names))
        values = values.reshape(shape)[:, 1 if cubic else 0]
        yield Track(names, times.astype(np.float64), values, cubic, (animation, number), offset)


def _accessor(glb: Glb, index: int) -> tuple[Floats, int | None]:
    """The numbers of an accessor (N,), and their place in the file if they are plain floats."""
    accessor = glb.document["accessors"][index]
    dtype = np.dtype(_TYPES[accessor["componentType"]])
    count = accessor["count"]
    if accessor["type"] != "SCALAR":
        raise _Unreadable("stores its weights in an unusual way")
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
    plain = accessor["componentType"] == _FLOAT
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
        raise _Unreadable("stores its weights in an unusual way")
    start = view.get("byteOffset", 0) + reader.get("byteOffset", 0)
    return np.frombuffer(_buffer(glb, view), dtype, count, start), start


def _buffer(glb: Glb, view: Mapping[str, Any]) -> bytes:
    """The binary chunk, which must contain every plain view."""
    if view["buffer"] != 0 or "uri" in glb.document["buffers"][0]:
        raise _Unreadable("keeps its data in other files")
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


# --- writing -------------------------------------------------------------------------------------


@dataclass(frozen=True)
class GlbSource:
    """A GLB, and where a clip's weights are in it (`take.Source`).

    Attributes:
        glb: the file.
        tracks: the edited tracks.
        places: (K) the places of each channel, each a track and a column.
        scale: the value of a full blendshape in the file.
    """

    glb: Glb
    tracks: tuple[Track, ...]
    places: tuple[tuple[tuple[int, int], ...], ...]
    scale: float = 1.0

    def encode(self, tracked: Floats, edited: Floats) -> bytes:
        """The whole file; see `take.Source.encode`."""
        changed = tracked != edited
        if not changed.any():
            return self.glb.content
        values = [track.values.copy() for track in self.tracks]
        touched = [np.zeros(track.values.shape, bool) for track in self.tracks]
        for k, found in enumerate(self.places):
            rows = changed[:, k]
            for place, column in found:
                values[place][rows, column] = edited[rows, k] * np.float32(self.scale)
                touched[place][rows, column] = True
        content = bytearray(self.glb.content)
        moved: list[tuple[Track, Floats]] = []
        for track, new, where in zip(self.tracks, values, touched, strict=True):
            if not where.any():
                continue
            if track.offset is None or track.cubic:
                moved.append((track, new))
            else:
                flat = np.frombuffer(content, "<f4", new.size, track.offset)
                flat[where.ravel()] = new[where]
        return _with_new_outputs(bytes(content), moved) if moved else bytes(content)


def _with_new_outputs(content: bytes, moved: list[tuple[Track, Floats]]) -> bytes:
    """A GLB with the weights of some tracks at the end, as plain floats."""
    glb = _parse(content)
    document: Any = glb.document
    binary = bytearray(content[slice(*glb.binary)])
    for track, values in moved:
        animation, number = track.sampler
        output = _with_tangents(track.times, values) if track.cubic else values
        binary += b"\0" * (-len(binary) % 4)
        data = output.astype("<f4").tobytes()
        view = {"buffer": 0, "byteOffset": len(binary), "byteLength": len(data)}
        document["bufferViews"].append(view)
        document["accessors"].append(
            {
                "bufferView": len(document["bufferViews"]) - 1,
                "componentType": _FLOAT,
                "count": output.size,
                "type": "SCALAR",
            }
        )
        sampler = document["animations"][animation]["samplers"][number]
        sampler["output"] = len(document["accessors"]) - 1
        binary += data
    document["buffers"][0]["byteLength"] = len(binary)
    return join_glb(document, bytes(binary))


def _with_tangents(times: Times, values: Floats) -> Floats:
    """(T, 3, N): in-tangents, weights, out-tangents of a curve through the weights (T, N)."""
    slopes = np.gradient(values, times, axis=0) if len(times) > 1 else np.zeros_like(values)
    return np.stack([slopes, values, slopes], axis=1).astype(np.float32)
