"""Writes FaceEdit's own character file; see `glb`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pygltflib as gltf
from numpy.typing import NDArray

from faceedit_app.characters.base_colors import png_of
from faceedit_app.characters.glb import SHADE
from faceedit_app.characters.turning import HEAD_JOINT, Turning
from faceedit_app.core.arrays import Pixels
from faceedit_app.core.atomic import GLB, begins_with, write_keeping
from faceedit_app.core.controls import CONTROL_IDS
from faceedit_app.core.rig import Material, Rig

_FLOAT, _UINT, _UBYTE = gltf.FLOAT, gltf.UNSIGNED_INT, gltf.UNSIGNED_BYTE


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

    def add_texture(self, picture: Pixels) -> int:
        """Add a picture (H, W, 4) as a texture; returns its index."""
        view = self._view(png_of(picture), None)
        self.document.images.append(gltf.Image(bufferView=view, mimeType="image/png"))
        self.document.textures.append(gltf.Texture(source=len(self.document.images) - 1))
        return len(self.document.textures) - 1


def write_rig(path: Path | str, rig: Rig) -> Path | None:
    """Write a rig as GLB; see `rig_content`.

    Returns:
        The copy that was kept of a file that was no GLB; None if there was none.

    Raises:
        FileError: the file cannot be written.
    """
    content = rig_content(rig)
    return write_keeping(path, content, begins_with(GLB))


def rig_content(
    rig: Rig, shapes: Sequence[str] | None = None, turning: Turning | None = None
) -> bytes:
    """A rig as GLB; the same rig always gives the same bytes.

    glTF cannot hold everything: materials without faces are left out, and colours are clipped to
    0..1.

    Args:
        shapes: the names of its blendshapes in the file; None = those of its channels.
        turning: adds the joint `HEAD_JOINT`, about which the head can turn.
    """
    out = _Writer()
    document = out.document
    document.meshes = [_mesh(out, rig, shapes or rig.channels, turning)]
    document.nodes = [gltf.Node(name=rig.name, mesh=0)]
    document.scenes = [gltf.Scene(nodes=[0])]
    if turning is not None:
        document.nodes[0].skin = 0
        document.nodes += [
            gltf.Node(name="body", children=[2]),
            gltf.Node(name=HEAD_JOINT, translation=turning.pivot.tolist()),
        ]
        document.scenes[0].nodes = [0, 1]
    document.scene = 0
    document.buffers = [gltf.Buffer(byteLength=len(out.blob))]
    document.set_binary_blob(bytes(out.blob))
    return b"".join(document.save_to_bytes())


def _mesh(out: _Writer, rig: Rig, shapes: Sequence[str], turning: Turning | None) -> gltf.Mesh:
    """Add a rig's vertices, faces and materials; returns its mesh."""
    attributes = _attributes(out, rig, turning)
    for picture in rig.textures:
        out.add_texture(picture)
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
        out.document.materials.append(_material(material))
    pairs = zip(CONTROL_IDS, rig.control_pairs.tolist(), rig.has_control, strict=True)
    return gltf.Mesh(
        name=rig.name,
        primitives=primitives,
        weights=[0.0] * len(rig.channels),
        extras={
            "targetNames": list(shapes),
            "controls": {name: pair for name, pair, has in pairs if has},
            "attribution": rig.attribution,
        },
    )


def _attributes(out: _Writer, rig: Rig, turning: Turning | None) -> gltf.Attributes:
    """Add what each vertex has."""
    attributes = gltf.Attributes(
        POSITION=out.add(rig.neutral.astype("<f4"), "VEC3", _FLOAT, gltf.ARRAY_BUFFER),
        COLOR_0=out.add(rig.colors.clip(0, 1).astype("<f4"), "VEC4", _FLOAT, gltf.ARRAY_BUFFER),
    )
    if rig.uv is not None:
        attributes.TEXCOORD_0 = out.add(rig.uv.astype("<f4"), "VEC2", _FLOAT, gltf.ARRAY_BUFFER)
    if rig.shade is not None:
        shade = out.add(rig.shade.astype("<f4"), "SCALAR", _FLOAT, gltf.ARRAY_BUFFER)
        setattr(attributes, SHADE, shade)
    if turning is not None:
        _add_skin(out, attributes, turning)
    return attributes


def _material(material: Material) -> gltf.Material:
    texture = None if material.texture is None else gltf.TextureInfo(index=material.texture)
    return gltf.Material(
        name=material.name,
        doubleSided=True,
        alphaMode="MASK" if material.cutoff > 0 else "OPAQUE",
        alphaCutoff=material.cutoff if material.cutoff > 0 else None,
        pbrMetallicRoughness=gltf.PbrMetallicRoughness(
            roughnessFactor=material.roughness,
            metallicFactor=material.metallic,
            baseColorTexture=texture,
        ),
    )


def _add_skin(out: _Writer, attributes: gltf.Attributes, turning: Turning) -> None:
    """Add a skin of two joints, nodes 1 (body) and 2 (head)."""
    count = len(turning.share)
    joints = np.tile(np.array([1, 0, 0, 0], np.uint8), (count, 1))
    weights = np.zeros((count, 4), "<f4")
    weights[:, 0], weights[:, 1] = turning.share, 1.0 - turning.share
    attributes.JOINTS_0 = out.add(joints, "VEC4", _UBYTE, gltf.ARRAY_BUFFER)
    attributes.WEIGHTS_0 = out.add(weights, "VEC4", _FLOAT, gltf.ARRAY_BUFFER)
    binds = np.tile(np.eye(4, dtype="<f4"), (2, 1, 1))
    binds[1, 3, :3] = -turning.pivot  # column by column
    matrices = out.add(binds.reshape(2, 16), "MAT4", _FLOAT, None)
    out.document.skins = [gltf.Skin(joints=[1, 2], skeleton=1, inverseBindMatrices=matrices)]
