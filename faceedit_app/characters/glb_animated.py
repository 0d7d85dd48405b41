"""GLB with the animation of a take: on FaceEdit's kind of character, or in a file of another maker.

The weights are one animation channel a mesh. `compact` stores them as 16-bit integers, and leaves
out zeros if that is smaller (a sparse accessor); a step is then 1/65535.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from faceedit_app.characters.glb_gaze import EyeTurns, turned_node
from faceedit_app.characters.glb_turning import HeadTurns, turning_node
from faceedit_app.characters.glb_writing import rig_content
from faceedit_app.characters.scene import Scene
from faceedit_app.core.arrays import Floats, Times
from faceedit_app.core.errors import FileError, reason_of
from faceedit_app.core.glb import MAGIC, join_glb, split_glb

_FLOAT, _SHORT, _UINT = 5126, 5123, 5125
_FULL = 65535
_SPARSE_BELOW = 0.3  # share of weights that are not 0: an index takes twice the room of a weight
_DAMAGE = (KeyError, IndexError, TypeError, ValueError, AttributeError, struct.error)


def scene_glb(scene: Scene, name: str, compact: bool = False) -> bytes:
    """A scene as GLB.

    Args:
        name: of the animation.
        compact: store the weights as 16-bit integers.
    """
    weights = dict(zip(scene.shapes, scene.weights.T, strict=True))
    rig, turning = replace(scene.rig, shade=None), scene.turning  # the shade is FaceEdit's alone
    content = rig_content(rig, scene.shapes, turning)
    turns = None if turning is None else HeadTurns(turning.pivot, turning.matrices)
    return _animated(content, weights, scene.times, name, compact, turns=turns)


def animate_glb(
    path: Path,
    weights: Mapping[str, Floats],
    alike: Mapping[str, Sequence[str]],
    times: Times,
    name: str,
    compact: bool = False,
    turns: HeadTurns | None = None,
    eyes: Sequence[EyeTurns] = (),
) -> bytes:
    """A character's GLB with an animation added, and nothing else changed.

    Args:
        path: the character.
        weights: (T,) by shape; shapes without weights keep theirs.
        alike: other spellings of a shape, which some meshes have.
        times: (T,) seconds.
        name: of the animation.
        compact: store the weights as 16-bit integers.
        turns: how the head turns; without a joint of the head, the scene is put below a new node.
        eyes: how eyes without shapes turn.

    Raises:
        FileError: it cannot be read, or none of its meshes has these shapes.
    """
    try:
        content = path.read_bytes()
    except OSError as error:
        reason = reason_of(error)
        raise FileError(path, f"cannot be read ({reason})", "check the path") from error
    try:
        return _animated(content, weights, times, name, compact, alike, turns, eyes)
    except _DAMAGE:
        raise FileError(path, "is damaged", "export it again") from None


def is_glb(path: Path) -> bool:
    """Whether a file is a GLB (a VRM is one)."""
    try:
        with path.open("rb") as file:
            return file.read(4) == MAGIC
    except OSError:
        return False


def _animated(
    content: bytes,
    weights: Mapping[str, Floats],
    times: Times,
    name: str,
    compact: bool,
    alike: Mapping[str, Sequence[str]] | None = None,
    turns: HeadTurns | None = None,
    eyes: Sequence[EyeTurns] = (),
) -> bytes:
    document, (start, stop) = split_glb(content)
    out = _Writer(document, content[start:stop])
    clock = out.add_times(times)
    samplers: list[dict[str, Any]] = []
    channels: list[dict[str, Any]] = []
    for node, mesh, rest in _animatable(document):
        names = _target_names(mesh)
        played = {
            spelling: values
            for shape, values in weights.items()
            for spelling in [*(s for s in (shape, *(alike or {}).get(shape, ())) if s in names)][:1]
        }
        if not played:
            continue
        columns = [
            played.get(shape, np.full(len(times), rest[k] if k < len(rest) else 0.0, np.float32))
            for k, shape in enumerate(names)
        ]
        output = out.add_weights(np.stack(columns, axis=1), compact)
        channels.append({"sampler": len(samplers), "target": {"node": node, "path": "weights"}})
        samplers.append({"input": clock, "output": output, "interpolation": "LINEAR"})
    if not channels:
        raise ValueError("no mesh has these shapes")

    def play(node: int, path: str, values: Floats) -> None:
        channels.append({"sampler": len(samplers), "target": {"node": node, "path": path}})
        output = out.add_vectors(values)
        samplers.append({"input": clock, "output": output, "interpolation": "LINEAR"})

    for eye in eyes:
        turned = turned_node(document, eye, eyes)
        if turned is not None:
            play(eye.node, "rotation", turned[0])
            if np.ptp(turned[1], axis=0).max() > 0:
                play(eye.node, "translation", turned[1])
    if turns is not None:
        node, rotations = turning_node(document, turns)
        play(node, "rotation", rotations)
    animation = {"name": name, "samplers": samplers, "channels": channels}
    # In front of others, because programs play the first.
    document["animations"] = [animation, *document.get("animations", [])]
    return out.content()


def _animatable(
    document: Mapping[str, Any],
) -> list[tuple[int, dict[str, Any], Sequence[float]]]:
    """The nodes with meshes: number, mesh, and the weights at rest."""
    found = []
    for number, node in enumerate(document.get("nodes", [])):
        if "mesh" in node:
            mesh = document["meshes"][node["mesh"]]
            found.append((number, mesh, node.get("weights") or mesh.get("weights") or ()))
    return found


def _target_names(mesh: Mapping[str, Any]) -> Sequence[str]:
    count = len(mesh["primitives"][0].get("targets", []))
    for place in (mesh, *mesh["primitives"]):
        names = (place.get("extras") or {}).get("targetNames")
        if isinstance(names, list) and len(names) == count:
            return [str(name) for name in names]
    return [""] * count


class _Writer:
    """Adds accessors to a document and its binary chunk."""

    def __init__(self, document: dict[str, Any], binary: bytes) -> None:
        self._document, self._binary = document, bytearray(binary)
        if "uri" in document["buffers"][0]:
            raise ValueError("the binary chunk is not its first buffer")

    def add_times(self, times: Times) -> int:
        """Add the key times (T,); returns the accessor's index."""
        seconds = times.astype("<f4")
        return self._accessor(
            bufferView=self._view(seconds),
            componentType=_FLOAT,
            count=len(seconds),
            type="SCALAR",
            min=[float(seconds.min())],
            max=[float(seconds.max())],
        )

    def add_weights(self, weights: Floats, compact: bool) -> int:
        """Add weights (T, N); returns the accessor's index.

        Weights beyond 0..1 have no 16-bit form and stay floats.
        """
        flat = weights.ravel()
        if not compact or flat.min() < 0 or flat.max() > 1:
            view = self._view(flat.astype("<f4"))
            return self._accessor(
                bufferView=view, componentType=_FLOAT, count=flat.size, type="SCALAR"
            )
        numbers = np.round(flat * _FULL).astype("<u2")
        common: dict[str, Any] = {
            "componentType": _SHORT,
            "normalized": True,
            "count": flat.size,
            "type": "SCALAR",
        }
        moved = np.flatnonzero(numbers).astype("<u4")
        if not 0 < len(moved) < _SPARSE_BELOW * flat.size:
            return self._accessor(bufferView=self._view(numbers), **common)
        sparse = {
            "count": len(moved),
            "indices": {"bufferView": self._view(moved), "componentType": _UINT},
            "values": {"bufferView": self._view(numbers[moved])},
        }
        return self._accessor(**common, sparse=sparse)

    def add_vectors(self, vectors: Floats) -> int:
        """Add rotations (T, 4) x, y, z, w or translations (T, 3); returns the accessor's index."""
        view, kind = self._view(vectors.astype("<f4")), f"VEC{vectors.shape[1]}"
        return self._accessor(bufferView=view, componentType=_FLOAT, count=len(vectors), type=kind)

    def content(self) -> bytes:
        """The whole file."""
        self._document["buffers"][0]["byteLength"] = len(self._binary)
        return join_glb(self._document, bytes(self._binary))

    def _view(self, array: NDArray[Any]) -> int:
        self._binary += b"\0" * (-len(self._binary) % 4)
        views = self._document.setdefault("bufferViews", [])
        views.append({"buffer": 0, "byteOffset": len(self._binary), "byteLength": array.nbytes})
        self._binary += array.tobytes()
        return len(views) - 1

    def _accessor(self, **fields: Any) -> int:
        accessors = self._document.setdefault("accessors", [])
        accessors.append(fields)
        return len(accessors) - 1
