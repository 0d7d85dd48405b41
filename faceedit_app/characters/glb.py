"""FaceEdit's own character file: a standard GLB with morph targets, which Blender can open.

All primitives share one set of vertex accessors and differ only in their indices, so that the rig
stays one vertex array. The control points are in the mesh's `extras`.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pygltflib as gltf
from numpy.typing import NDArray

from faceedit_app.characters.bounded import read_file
from faceedit_app.core.atomic import write_atomically
from faceedit_app.core.controls import CONTROL_IDS
from faceedit_app.core.errors import FileError
from faceedit_app.core.rig import Material, Rig

_REMEDY = "choose a GLB with morph targets and FaceEdit control definitions"
_MISSING = (-1, -1)  # a control that the file does not define
_FLOAT, _UINT = gltf.FLOAT, gltf.UNSIGNED_INT
_WIDTH = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
_DTYPE: dict[int, Any] = {
    gltf.FLOAT: np.float32,
    gltf.UNSIGNED_INT: np.uint32,
    gltf.UNSIGNED_SHORT: np.uint16,
    gltf.UNSIGNED_BYTE: np.uint8,
}


class _Writer:
    """Collects accessors into one binary buffer."""

    def __init__(self) -> None:
        self.blob = bytearray()
        self.document = gltf.GLTF2(asset=gltf.Asset(version="2.0", generator="FaceEdit"))

    def _view(self, data: bytes, target: int | None) -> int:
        self.blob += b"\0" * (-len(self.blob) % 4)
        self.document.bufferViews.append(
            gltf.BufferView(
                buffer=0, byteOffset=len(self.blob), byteLength=len(data), target=target
            )
        )
        self.blob += data
        return len(self.document.bufferViews) - 1

    def add(self, array: NDArray[Any], kind: str, component: int, target: int | None) -> int:
        """Add a dense accessor; returns its index."""
        accessor = gltf.Accessor(
            bufferView=self._view(array.tobytes(), target),
            componentType=component,
            count=len(array),
            type=kind,
        )
        if kind == "VEC3":
            accessor.min, accessor.max = array.min(0).tolist(), array.max(0).tolist()
        self.document.accessors.append(accessor)
        return len(self.document.accessors) - 1

    def add_sparse(self, array: NDArray[np.float32]) -> int:
        """Add an accessor of (V, 3) displacements, most of which are zero; returns its index."""
        moved = np.flatnonzero(array.any(1)).astype(np.uint32)
        if not len(moved):  # a sparse accessor must name at least one vertex
            moved = np.zeros(1, np.uint32)
        self.document.accessors.append(
            gltf.Accessor(
                byteOffset=None,  # pygltflib writes 0, which is an error without a buffer view
                componentType=_FLOAT,
                count=len(array),
                type="VEC3",
                min=array.min(0).tolist(),
                max=array.max(0).tolist(),
                sparse=gltf.Sparse(
                    count=len(moved),
                    indices=gltf.AccessorSparseIndices(
                        bufferView=self._view(moved.tobytes(), None), componentType=_UINT
                    ),
                    values=gltf.AccessorSparseValues(
                        bufferView=self._view(array[moved].tobytes(), None)
                    ),
                ),
            )
        )
        return len(self.document.accessors) - 1


def write_rig(path: Path | str, rig: Rig) -> None:
    """Write a rig as GLB; the same rig always gives the same bytes.

    glTF cannot hold everything: materials without faces are left out, and colours are clipped to
    0..1.

    Raises:
        FileError: the file cannot be written.
    """
    out = _Writer()
    attributes = gltf.Attributes(
        POSITION=out.add(rig.neutral.astype("<f4"), "VEC3", _FLOAT, gltf.ARRAY_BUFFER),
        COLOR_0=out.add(rig.colors.clip(0, 1).astype("<f4"), "VEC4", _FLOAT, gltf.ARRAY_BUFFER),
    )
    targets = [{"POSITION": out.add_sparse(d.astype("<f4"))} for d in rig.deltas]
    primitives = []
    for i, material in enumerate(m for m in rig.materials if m.stop > m.start):
        indices = rig.faces[material.start : material.stop].ravel().astype("<u4")
        primitives.append(
            gltf.Primitive(
                attributes=attributes,
                indices=out.add(indices, "SCALAR", _UINT, gltf.ELEMENT_ARRAY_BUFFER),
                material=i,
                targets=targets,
            )
        )
        out.document.materials.append(
            gltf.Material(
                name=material.name,
                doubleSided=True,
                pbrMetallicRoughness=gltf.PbrMetallicRoughness(
                    roughnessFactor=material.roughness, metallicFactor=material.metallic
                ),
            )
        )
    pairs = zip(CONTROL_IDS, rig.control_pairs.tolist(), rig.has_control, strict=True)
    controls = {name: pair for name, pair, has in pairs if has}
    mesh = gltf.Mesh(
        name=rig.name,
        primitives=primitives,
        weights=[0.0] * len(rig.channels),
        extras={
            "targetNames": list(rig.channels),
            "controls": controls,
            "attribution": rig.attribution,
        },
    )
    document = out.document
    document.meshes = [mesh]
    document.nodes = [gltf.Node(name=rig.name, mesh=0)]
    document.scenes = [gltf.Scene(nodes=[0])]
    document.scene = 0
    document.buffers = [gltf.Buffer(byteLength=len(out.blob))]
    document.set_binary_blob(bytes(out.blob))
    write_atomically(path, b"".join(document.save_to_bytes()))


def _accessor(document: gltf.GLTF2, index: int) -> NDArray[Any]:
    accessor = document.accessors[index]
    width, dtype = _WIDTH[accessor.type], np.dtype(_DTYPE[accessor.componentType])
    blob = document.binary_blob()

    def read(view_index: int, offset: int, count: int, kind: np.dtype[Any], columns: int) -> Any:
        start = (document.bufferViews[view_index].byteOffset or 0) + (offset or 0)
        flat = np.frombuffer(blob, kind, count * columns, start)
        return flat.reshape(count, columns) if columns > 1 else flat

    if accessor.bufferView is None:
        array = np.zeros((accessor.count, width) if width > 1 else accessor.count, dtype)
    else:
        array = read(accessor.bufferView, accessor.byteOffset, accessor.count, dtype, width)
    if accessor.sparse is not None:
        sparse = accessor.sparse
        array = array.copy()
        kind = np.dtype(_DTYPE[sparse.indices.componentType])
        where = read(sparse.indices.bufferView, sparse.indices.byteOffset, sparse.count, kind, 1)
        array[where] = read(
            sparse.values.bufferView, sparse.values.byteOffset, sparse.count, dtype, width
        )
    return array


def read_rig(path: Path | str) -> Rig:
    """Read a character written by `write_rig`.

    Raises:
        FileError: it is not a GLB, or has no morph targets or control definitions.
    """
    path = Path(path)
    content = read_file(path)
    if content[:4] != b"glTF":
        raise FileError(path, "is not a binary glTF file", _REMEDY)
    try:
        document = gltf.GLTF2.load_from_bytes(content)
    except Exception as error:  # the library raises all kinds for a damaged file
        raise FileError(path, "is damaged", _REMEDY) from error
    if document is None or not document.meshes:
        raise FileError(path, "holds no mesh", _REMEDY)
    try:
        rig = _rig(document, path.stem)
    except (KeyError, TypeError, IndexError, ValueError, AttributeError) as error:
        raise FileError(path, "lacks a part of the character", _REMEDY) from error
    if problem := _problem(rig):
        raise FileError(path, problem, _REMEDY)
    return rig


def _rig(document: gltf.GLTF2, fallback_name: str) -> Rig:
    mesh = document.meshes[0]
    extras = mesh.extras or {}
    first = mesh.primitives[0]
    controls = extras["controls"]
    faces, materials, start = [], [], 0
    for primitive in mesh.primitives:
        triangles = _accessor(document, primitive.indices).reshape(-1, 3).astype(np.int32)
        look = document.materials[primitive.material]
        surface = look.pbrMetallicRoughness
        stop = start + len(triangles)
        materials.append(
            Material(look.name, start, stop, surface.roughnessFactor, surface.metallicFactor)
        )
        faces.append(triangles)
        start = stop
    return Rig(
        neutral=_accessor(document, first.attributes.POSITION).astype(np.float32),
        faces=np.concatenate(faces),
        channels=tuple(extras["targetNames"]),
        deltas=np.stack([_accessor(document, t["POSITION"]) for t in first.targets]),
        colors=_accessor(document, first.attributes.COLOR_0).astype(np.float32),
        materials=tuple(materials),
        control_pairs=np.array([controls.get(name, _MISSING) for name in CONTROL_IDS], np.int32),
        name=mesh.name or fallback_name,
        attribution=extras.get("attribution", ""),
    )


def _problem(rig: Rig) -> str | None:
    """What is inconsistent in a rig from a file, as a phrase; None if nothing."""
    count = len(rig.neutral)
    shapes = (rig.neutral.shape, rig.deltas.shape, rig.colors.shape, rig.control_pairs.shape)
    if shapes != ((count, 3), (len(rig.channels), count, 3), (count, 4), (len(CONTROL_IDS), 2)):
        return "has parts of the character that do not fit together"
    if not all(isinstance(name, str) for name in rig.channels):
        return "has morph targets without names"
    if not rig.has_control.any():
        return "has no control definitions"
    pairs = rig.control_pairs[(rig.control_pairs != _MISSING).any(axis=1)]
    for indices, what in ((rig.faces, "triangle"), (pairs, "control")):
        if indices.min() < 0 or indices.max() >= count:
            return f"has a {what} that names a vertex that does not exist"
    if not (np.isfinite(rig.neutral).all() and np.isfinite(rig.deltas).all()):
        return "has vertices that are not numbers"
    return None
