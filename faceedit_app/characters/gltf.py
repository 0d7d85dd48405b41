"""Characters from GLB and glTF files: every mesh at its place in the scene at rest."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from faceedit_app.characters.bounded import (
    MOST_TARGETS,
    Damaged,
    check_targets,
    finite,
    indices_within,
    whole,
)
from faceedit_app.characters.character import (
    Character,
    EyeJoint,
    MeshPart,
    PartVertex,
    Surface,
    unique_names,
)
from faceedit_app.characters.eye_joints import eye_joint, is_eye
from faceedit_app.characters.gltf_buffers import GltfFile, Json
from faceedit_app.characters.gltf_nodes import node_places
from faceedit_app.characters.gltf_surfaces import colors_of, placed_uv, surface_of
from faceedit_app.characters.points import PAIRS
from faceedit_app.core.arrays import Doubles, Floats, Indices
from faceedit_app.core.errors import FileError

_TRIANGLES, _STRIP, _FAN = 4, 5, 6


@dataclass(frozen=True)
class PlacedPrimitive:
    """A primitive in the scene, not read yet.

    Attributes:
        name: unique in the file.
    node, mesh: their numbers in the file.
        place: local to world, (4, 4).
        primitive: its JSON.
        names: of its morph targets.
    """

    name: str
    node: int
    mesh: int
    place: Doubles
    primitive: Json
    names: tuple[str, ...]


def read_gltf(path: Path) -> Character:
    """Read a GLB or glTF file.

    Raises:
        FileError: it cannot be read, or holds no mesh.
        Damaged: it contradicts itself.
    """
    document = GltfFile(path)
    placed = read_parts(document)
    parts = tuple(part for _, part, _ in placed)
    points = _own_points(document, placed)
    return Character(path, "glTF", parts, attribution=_attribution(document), points=points)


def read_parts(document: GltfFile) -> list[tuple[PlacedPrimitive, MeshPart, Indices]]:
    """All meshes of the scene, with their place in the file and the vertices they keep.

    Raises:
        FileError: there is no mesh.
        Damaged: the file contradicts itself.
    """
    nodes = Nodes(document)
    placed = nodes.primitives()
    # Primitives may share one set of vertices; each keeps only those that it uses.
    shared = {p.primitive["attributes"]["POSITION"]: p for p in placed}
    counts = [document.count(position) for position in shared]
    check_targets(counts, [len(p.names) for p in shared.values()])
    parts = [(p, *read) for p in placed if (read := nodes.part(p)) is not None]
    if not parts:
        raise FileError(document.path, "holds no triangles", "export the mesh of the head")
    return parts


class Nodes:
    """The nodes of a document, with their transforms."""

    def __init__(self, document: GltfFile) -> None:
        self.document = document
        self.nodes = document.all("nodes")
        self.places = node_places(self.nodes)
        self._surfaces: dict[int, Surface] = {}

    def primitives(self) -> list[PlacedPrimitive]:
        """The primitives that are drawn, in the order of the nodes."""
        found: list[PlacedPrimitive] = []
        for number in self._drawn():
            node = self.nodes[number]
            if node.get("mesh") is None:
                continue
            mesh = self.document.entry("meshes", node["mesh"])
            label = str(node.get("name") or mesh.get("name") or "mesh")[:60]
            for primitive in mesh["primitives"]:
                if primitive.get("mode", _TRIANGLES) not in (_TRIANGLES, _STRIP, _FAN):
                    continue
                names = target_names(self.document, mesh, primitive)
                place = self.places[number]
                found.append(PlacedPrimitive(label, number, node["mesh"], place, primitive, names))
        labels = unique_names([placed.name for placed in found])
        return [replace(p, name=name) for p, name in zip(found, labels, strict=True)]

    def _drawn(self) -> list[int]:
        """The nodes of the default scene; all nodes if there is none."""
        scenes = self.document.all("scenes")
        if not scenes:
            return list(range(len(self.nodes)))
        scene = self.document.entry("scenes", self.document.json.get("scene", 0))
        seen: set[int] = set()
        waiting = list(scene.get("nodes", []))
        while waiting:
            number = whole(waiting.pop(), "the number of a node", len(self.nodes) - 1)
            if number not in seen:
                seen.add(number)
                waiting += self.nodes[number].get("children") or []
        return sorted(seen)

    def part(self, placed: PlacedPrimitive) -> tuple[MeshPart, Indices] | None:
        """Read a primitive and the vertices that it uses; None if it has no triangles."""
        document, primitive = self.document, placed.primitive
        attributes = primitive["attributes"]
        if not document.is_backed(attributes["POSITION"]) and not _is_draco(primitive):
            raise Damaged("a mesh has no positions")
        arrays, triangles = self._arrays(primitive)
        neutral = arrays["POSITION"].astype(np.float64)
        if triangles is None:
            triangles = _triangles(np.arange(len(neutral)), primitive.get("mode", _TRIANGLES))
        faces = indices_within(triangles, len(neutral))
        if not len(faces):
            return None
        linear, offset = self._skinned(placed, arrays, len(neutral))
        if np.linalg.det(np.atleast_3d(linear).reshape(-1, 3, 3)[0]) < 0:  # mirrored
            faces = np.ascontiguousarray(faces[:, ::-1])
        part = MeshPart(
            name=placed.name,
            neutral=(_turned(linear, neutral) + offset).astype(np.float32),
            faces=faces,
            uv=placed_uv(self._material(primitive.get("material")), arrays),
            colors=colors_of(arrays.get("COLOR_0")),
            surface=self._surface(primitive.get("material")),
        )
        is_skinned = self.nodes[placed.node].get("skin") is not None
        node = None if is_skinned else placed.node
        part = replace(part, eyes=self._eyes(placed, arrays), rest=self._rest(placed), node=node)
        kept = np.unique(faces).astype(np.intp)
        targets = self._targets(placed, linear, len(neutral), kept)
        return replace(part.only(kept), targets=targets), kept

    def _arrays(self, primitive: Json) -> tuple[dict[str, NDArray[Any]], NDArray[np.int64] | None]:
        """Attributes by name, and triangles (F, 3) or None if vertices are simply in order."""
        document, attributes = self.document, primitive["attributes"]
        if _is_draco(primitive):
            return _draco(document, primitive)
        arrays = {}
        for name, index in attributes.items():
            if name in ("POSITION", "WEIGHTS_0", "COLOR_0") or name.startswith("TEXCOORD_"):
                arrays[name] = document.array(index)
            elif name == "JOINTS_0":
                arrays[name] = document.array(index, normalize=False)
        count = len(arrays["POSITION"])
        if any(len(array) != count for array in arrays.values()):
            raise Damaged("a mesh has more of one attribute than of another")
        if primitive.get("indices") is None:
            return arrays, None
        indices = document.array(primitive["indices"], normalize=False)
        if indices.dtype.kind != "u":
            raise Damaged("a triangle names a vertex that does not exist")
        return arrays, _triangles(indices[:, 0], primitive.get("mode", _TRIANGLES))

    def _skinned(
        self, placed: PlacedPrimitive, arrays: Mapping[str, NDArray[Any]], count: int
    ) -> tuple[Doubles, Doubles]:
        """The transform of the vertices: (3, 3) or (V, 3, 3), and (3,) or (V, 3).

        Needed even for an unposed mesh: quantised meshes keep their scale in the inverse bind
        matrices.
        """
        skin_index = self.nodes[placed.node].get("skin")
        if skin_index is None or "JOINTS_0" not in arrays or "WEIGHTS_0" not in arrays:
            return placed.place[:3, :3], placed.place[:3, 3]
        skin = self.document.entry("skins", skin_index)
        joints = [whole(j, "a joint", len(self.nodes) - 1) for j in skin["joints"]]
        inverse = np.tile(np.eye(4), (len(joints), 1, 1))
        if skin.get("inverseBindMatrices") is not None:
            stored = self.document.array(skin["inverseBindMatrices"]).astype(np.float64)
            if stored.shape[1] != 16 or len(stored) < len(joints):
                raise Damaged("a skin has too few matrices")
            inverse = stored[: len(joints)].reshape(-1, 4, 4).transpose(0, 2, 1)
        moves = np.stack([self.places[j] for j in joints]) @ inverse
        which = arrays["JOINTS_0"].astype(np.intp)
        if which.size and which.max() >= len(joints):
            raise Damaged("a vertex names a joint that does not exist")
        weights = arrays["WEIGHTS_0"].astype(np.float64)
        total = weights.sum(axis=1, keepdims=True)
        weights = weights / np.maximum(total, 1e-9)
        place = np.zeros((count, 3, 4))
        for column in range(which.shape[1]):
            place += weights[:, column, None, None] * moves[which[:, column], :3]
        place[total[:, 0] <= 0] = placed.place[:3]  # no joint carries them
        return place[:, :, :3], place[:, :, 3]

    def _eyes(
        self, placed: PlacedPrimitive, arrays: Mapping[str, NDArray[Any]]
    ) -> tuple[EyeJoint, ...]:
        """The joints of eyes among those of a skin."""
        index = self.nodes[placed.node].get("skin")
        if index is None or "JOINTS_0" not in arrays or "WEIGHTS_0" not in arrays:
            return ()
        joints = self.document.entry("skins", index)["joints"]
        which, weights = arrays["JOINTS_0"], arrays["WEIGHTS_0"].astype(np.float64)
        found = [
            eye_joint(
                self.places[joint][:3, 3],
                np.where(which == number, weights, 0.0).sum(axis=1),
                joint,
            )
            for number, joint in enumerate(joints)
            if is_eye(str(self.nodes[joint].get("name") or ""))
        ]
        return tuple(joint for joint in found if joint is not None)

    def _rest(self, placed: PlacedPrimitive) -> dict[str, float]:
        """The weights that morph targets have in the file; those of the node go first."""
        mesh = self.document.entry("meshes", placed.mesh)
        weights = self.nodes[placed.node].get("weights") or mesh.get("weights") or []
        given = finite(np.array(weights, np.float64).ravel(), "the weights of a mesh").tolist()
        return {n: w for n, w in zip(placed.names, given, strict=False) if w}

    def _targets(
        self, placed: PlacedPrimitive, linear: Doubles, count: int, kept: Indices
    ) -> dict[str, Floats]:
        """The displacements of the kept vertices, of `count` in all."""
        linear = linear if linear.ndim == 2 else linear[kept]
        targets: dict[str, Floats] = {}
        for name, target in zip(placed.names, placed.primitive.get("targets") or [], strict=True):
            if target.get("POSITION") is None or name in targets:
                continue
            moves = self.document.array(target["POSITION"])
            if moves.shape != (count, 3):
                raise Damaged("a morph target has another number of vertices than its mesh")
            moved = moves if len(kept) == count else moves[kept]
            targets[name] = _turned(linear, moved).astype(np.float32, copy=False)
        return targets

    def _material(self, index: Any) -> Json:
        if index is None:
            return {}
        return self.document.entry("materials", index)

    def _surface(self, index: Any) -> Surface:
        if index not in self._surfaces:
            self._surfaces[index] = surface_of(self.document, self._material(index))
        return self._surfaces[index]


def target_names(document: GltfFile, mesh: Json, primitive: Json) -> tuple[str, ...]:
    """The names of a primitive's morph targets.

    They are in the extras of the mesh or the primitive, or are the accessors' own.
    """
    targets = primitive.get("targets") or []
    if len(targets) > MOST_TARGETS:
        raise Damaged(f"{len(targets)} morph targets are more than {MOST_TARGETS}")
    for extras in (mesh.get("extras"), primitive.get("extras")):
        names = extras.get("targetNames") if isinstance(extras, dict) else None
        if isinstance(names, list) and names:
            given = [str(name)[:200] for name in names[: len(targets)]]
            break
    else:
        given = []
    found = given
    for number, target in enumerate(targets[len(given) :], len(given)):
        accessors, index = document.all("accessors"), target.get("POSITION")
        inside = isinstance(index, int) and 0 <= index < len(accessors)
        name = accessors[index].get("name") if inside else None
        found.append(str(name or f"target_{number}")[:200])
    return tuple(found)


def _turned(linear: Doubles, vectors: Doubles) -> Doubles:
    """Transform vectors (V, 3) by one matrix, or by one matrix each."""
    if linear.ndim == 2:
        # Most meshes need no transform, and products with small matrices are slow.
        return vectors if np.array_equal(linear, np.eye(3)) else vectors @ linear.T
    turned: Doubles = np.einsum("vij,vj->vi", linear, vectors)
    return turned


def _triangles(indices: NDArray[Any], mode: int) -> NDArray[np.int64]:
    indices = indices.astype(np.int64)
    if mode == _STRIP:
        triples = np.stack((indices[:-2], indices[1:-1], indices[2:]), axis=1)
        triples[1::2] = triples[1::2][:, ::-1]
        return triples
    if mode == _FAN:
        first = np.full(max(len(indices) - 2, 0), indices[0] if len(indices) else 0)
        return np.stack((first, indices[1:-1], indices[2:]), axis=1)
    return indices[: len(indices) // 3 * 3].reshape(-1, 3)


def _is_draco(primitive: Json) -> bool:
    return "KHR_draco_mesh_compression" in (primitive.get("extensions") or {})


def _draco(
    document: GltfFile, primitive: Json
) -> tuple[dict[str, NDArray[Any]], NDArray[np.int64]]:
    """Decode a primitive compressed by Draco."""
    packed = primitive["extensions"]["KHR_draco_mesh_compression"]
    data = document.bytes_of(packed["bufferView"])
    try:
        import DracoPy
    except ImportError as error:
        raise FileError(
            document.path, "is compressed (Draco)", "pip install DracoPy, or export without it"
        ) from error
    try:
        mesh = DracoPy.decode(data)
    except Exception as error:  # the library raises several kinds
        raise Damaged("a mesh that Draco compressed cannot be decoded") from error
    count = document.count(primitive["attributes"]["POSITION"])
    if len(mesh.points) != count:
        raise Damaged("a mesh that Draco compressed has another number of vertices")
    arrays: dict[str, NDArray[Any]] = {}
    by_id = {attribute["unique_id"]: attribute["data"] for attribute in mesh.attributes}
    for name, number in packed["attributes"].items():
        if number in by_id:
            arrays[name] = np.asarray(by_id[number])
    arrays["POSITION"] = finite(np.asarray(mesh.points, np.float32), "positions")
    return arrays, np.asarray(mesh.faces, np.int64).reshape(-1, 3)


def _own_points(
    document: GltfFile, placed: Sequence[tuple[PlacedPrimitive, MeshPart, Indices]]
) -> dict[str, PartVertex]:
    """The control points of a file that FaceEdit wrote, from the extras of its mesh."""
    found: dict[str, PartVertex] = {}
    for one, part, kept in placed:
        extras = document.entry("meshes", one.mesh).get("extras")
        controls = extras.get("controls") if isinstance(extras, dict) else None
        if not isinstance(controls, dict):
            continue
        for control, first, second in PAIRS:
            pair = controls.get(control)
            if not isinstance(pair, list) or len(pair) != 2:
                continue
            for name, vertex in zip((first, second), pair, strict=True):
                rows = np.flatnonzero(kept == (vertex if isinstance(vertex, int) else -1))
                if len(rows):
                    found.setdefault(name, PartVertex(part.name, int(rows[0])))
    return found


def _attribution(document: GltfFile) -> str:
    asset = document.json.get("asset") or {}
    return str(asset.get("copyright") or "")[:300]
