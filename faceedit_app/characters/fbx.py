"""Characters from binary FBX files."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path, PurePosixPath, PureWindowsPath

import numpy as np
from numpy.typing import NDArray

from faceedit_app.characters.bounded import (
    MOST_TARGETS,
    MOST_VERTICES,
    Damaged,
    check_targets,
    finite,
    read_file,
)
from faceedit_app.characters.character import (
    Character,
    EyeJoint,
    MeshPart,
    Surface,
    Texture,
    unique_names,
)
from faceedit_app.characters.eye_joints import eye_joint, is_eye
from faceedit_app.characters.fbx_places import (
    geometric_place,
    local_place,
    properties_of,
    vector,
)
from faceedit_app.characters.fbx_tree import Record, read_tree
from faceedit_app.core.arrays import Doubles, Floats
from faceedit_app.core.errors import FileError

_MOST_PERCENT = 1000.0


def read_fbx(path: Path) -> Character:
    """Read a binary FBX file.

    Raises:
        FileError: it cannot be read, or holds no mesh.
        Damaged: it contradicts itself.
    """
    scene = _Scene(path, read_tree(path))
    parts = scene.parts()
    if not parts:
        raise FileError(path, "holds no triangles", "export the mesh of the head")
    return Character(path, "FBX", tuple(parts))


class _Scene:
    """The objects of a file and their connections."""

    def __init__(self, path: Path, tree: Record) -> None:
        self._path = path
        self._objects: dict[int, Record] = {}
        objects = tree.first("Objects")
        for record in objects.children if objects else ():
            if record.values and isinstance(record.values[0], int):
                self._objects[record.values[0]] = record
        self._children: dict[int, list[tuple[int, str]]] = defaultdict(list)
        self._parents: dict[int, list[int]] = defaultdict(list)
        connections = tree.first("Connections")
        for record in connections.all("C") if connections else ():
            if len(record.values) < 3 or not all(isinstance(v, int) for v in record.values[1:3]):
                continue
            child, parent = record.values[1:3]
            use = record.values[3] if len(record.values) > 3 else ""
            self._children[parent].append((child, str(use)))
            self._parents[child].append(parent)
        self._textures: dict[int, Texture | None] = {}

    def parts(self) -> list[MeshPart]:
        """Every mesh, one part for each of its materials."""
        meshes = [
            (number, record)
            for number, record in self._objects.items()
            if record.name == "Geometry" and _kind(record) == "Mesh"
        ]
        sizes = [len(self._vertices(record)) for _, record in meshes]
        counts = [sum(1 for _ in self._channels(number)) for number, _ in meshes]
        if max(counts, default=0) > MOST_TARGETS:
            raise Damaged(f"{max(counts)} morph targets are more than {MOST_TARGETS}")
        check_targets(sizes, counts)
        parts = [part for number, record in meshes for part in self._mesh(number, record)]
        names = unique_names([part.name for part in parts])
        return [replace(part, name=name) for part, name in zip(parts, names, strict=True)]

    def _mesh(self, number: int, geometry: Record) -> Iterator[MeshPart]:
        vertices = self._vertices(geometry)
        model = next((p for p in self._parents[number] if self._is(p, "Model")), None)
        place = self._place(model)
        corners, owners, triangles = _triangles(geometry, len(vertices))
        if not len(triangles):
            return
        uv = _uv(geometry, len(corners))
        # A vertex has one texture coordinate: if corners disagree, it becomes several vertices.
        keys = corners[:, None] if uv is None else np.column_stack((corners, _ranks(uv)))
        _, first, vertex_of = np.unique(keys, axis=0, return_index=True, return_inverse=True)
        points, vertex_of = corners[first], vertex_of.ravel()
        linear = place[:3, :3]
        flipped = np.linalg.det(linear) < 0
        faces = vertex_of[triangles].astype(np.int32)
        targets = {
            name: (moves[points] @ linear.T).astype(np.float32)
            for name, moves in self._targets(number, len(vertices))
        }
        whole = MeshPart(
            name=_label(self._objects[model]) if model is not None else "mesh",
            neutral=(vertices[points] @ linear.T + place[:3, 3]).astype(np.float32),
            faces=np.ascontiguousarray(faces[:, ::-1]) if flipped else faces,
            targets=targets,
            uv=None if uv is None else uv[first].astype(np.float32),
            eyes=tuple(self._eyes(number, len(vertices), points)),
            rest=dict(self._rest(number)),
        )
        surfaces = self._surfaces(model)
        chosen = _materials(geometry, int(owners.max()) + 1)[owners]
        for material in np.unique(chosen):
            mine = whole.faces[chosen == material]
            surface = surfaces[material] if 0 <= material < len(surfaces) else Surface()
            part = replace(whole, faces=mine, surface=surface)
            yield part.only(np.unique(mine).astype(np.intp))

    def _eyes(self, geometry: int, count: int, points: NDArray[np.int64]) -> Iterator[EyeJoint]:
        """The joints of eyes that carry a mesh.

        Args:
            count: of the mesh's vertices.
            points: (V,) the vertex of the mesh that each vertex of the part is.
        """
        for deformer in self._under(geometry, "Deformer", "Skin"):
            for cluster in self._under(deformer, "Deformer", "Cluster"):
                bone = next((c for c, _ in self._children[cluster] if self._is(c, "Model")), None)
                if bone is None or not is_eye(_label(self._objects[bone])):
                    continue
                rows, weights = (self._objects[cluster].array(n) for n in ("Indexes", "Weights"))
                if rows is None or weights is None or len(rows) != len(weights) or not len(rows):
                    continue
                if rows.min() < 0 or rows.max() >= count:
                    raise Damaged("a joint carries a vertex that does not exist")
                share = np.zeros(count)
                share[rows] = finite(weights, "a joint's weights")
                joint = eye_joint(self._node_place(bone)[:3, 3], share[points])
                if joint is not None:
                    yield joint

    def _vertices(self, geometry: Record) -> Doubles:
        vertices = geometry.array("Vertices")
        if vertices is None or len(vertices) % 3 or len(vertices) > 3 * MOST_VERTICES:
            raise (
                Damaged("a mesh has no vertices")
                if vertices is None
                else Damaged("a mesh has too many vertices, or part of one")
            )
        return finite(vertices.astype(np.float64).reshape(-1, 3), "vertices")

    def _channels(self, geometry: int) -> Iterator[tuple[str, Record]]:
        """The name and the full shape of each blendshape channel of a mesh."""
        for deformer in self._under(geometry, "Deformer", "BlendShape"):
            for channel in self._under(deformer, "Deformer", "BlendShapeChannel"):
                shapes = list(self._under(channel, "Geometry", "Shape"))
                if shapes:
                    full = shapes[_full(self._objects[channel], len(shapes))]
                    yield _label(self._objects[channel]), self._objects[full]

    def _targets(self, geometry: int, count: int) -> Iterator[tuple[str, Doubles]]:
        seen = set()
        for name, shape in self._channels(geometry):
            if name in seen:
                continue
            seen.add(name)
            moves = np.zeros((count, 3))
            rows, values = shape.array("Indexes"), shape.array("Vertices")
            if rows is not None and values is not None and len(rows):
                if rows.min() < 0 or rows.max() >= count or len(values) != 3 * len(rows):
                    raise Damaged("a morph target names a vertex that does not exist")
                moves[rows] = finite(values.reshape(-1, 3), "a morph target's vertices")
            yield name, moves

    def _rest(self, geometry: int) -> Iterator[tuple[str, float]]:
        """The weights, 0 to 1, that blendshapes have in the file."""
        for deformer in self._under(geometry, "Deformer", "BlendShape"):
            for number in self._under(deformer, "Deformer", "BlendShapeChannel"):
                channel = self._objects[number]
                (percent,) = properties_of(channel).get("DeformPercent", (0.0,))[:1] or (0.0,)
                if isinstance(percent, (int, float)) and 0 < abs(percent) <= _MOST_PERCENT:
                    yield _label(channel), percent / 100

    def _under(self, number: int, name: str, kind: str) -> Iterator[int]:
        """The objects of one kind that are connected to an object."""
        for child, _ in self._children[number]:
            record = self._objects.get(child)
            if record is not None and record.name == name and _kind(record) == kind:
                yield child

    def _is(self, number: int, name: str) -> bool:
        return number in self._objects and self._objects[number].name == name

    def _place(self, model: int | None) -> Doubles:
        """(4, 4) local to world of a model at rest, with its geometric transform."""
        if model is None:
            return np.eye(4)
        properties = properties_of(self._objects[model])
        place = self._node_place(model) @ geometric_place(properties)
        return finite(place, "a model's place")

    def _node_place(self, model: int) -> Doubles:
        place = np.eye(4)
        seen: set[int] = set()
        at: int | None = model
        while at is not None and at not in seen:
            seen.add(at)
            place = local_place(properties_of(self._objects[at])) @ place
            at = next((p for p in self._parents[at] if self._is(p, "Model")), None)
        return place

    def _surfaces(self, model: int | None) -> list[Surface]:
        if model is None:
            return []
        return [
            self._surface(child)
            for child, _ in self._children[model]
            if self._is(child, "Material")
        ]

    def _surface(self, number: int) -> Surface:
        record = self._objects[number]
        properties = properties_of(record)
        red, green, blue = np.clip(vector(properties, "DiffuseColor", (0.8, 0.8, 0.8)), 0, 1)
        uses = ("DiffuseColor", "Diffuse", "Maya|baseColor", "3dsMax|Parameters|base_color_map")
        texture = next(
            (
                self._texture(child)
                for child, use in self._children[number]
                if use in uses and self._is(child, "Texture")
            ),
            None,
        )
        color = (1.0, 1.0, 1.0, 1.0) if texture else (float(red), float(green), float(blue), 1.0)
        return Surface(_label(record), color, texture)

    def _texture(self, number: int) -> Texture:
        """A texture in the file or next to it."""
        if number in self._textures:
            return self._textures[number] or Texture("picture", b"")
        record = self._objects[number]
        names = [record.text("RelativeFilename"), record.text("FileName")]
        content = b""
        for child, _ in self._children[number]:
            if self._is(child, "Video"):
                video = self._objects[child].first("Content")
                if video and video.values and isinstance(video.values[0], bytes):
                    content = video.values[0]
        for name in names:
            if not content and name:
                content = self._beside(name)
        shown = PureWindowsPath(names[0] or names[1] or "picture").name
        self._textures[number] = Texture(shown[:60], content)
        return self._textures[number] or Texture(shown[:60], b"")

    def _beside(self, name: str) -> bytes:
        """A picture by its path relative to the file, or by its bare name in the same folder."""
        relative = PurePosixPath(*PureWindowsPath(name).parts)
        places = [] if relative.is_absolute() or PureWindowsPath(name).drive else [relative]
        for place in (*places, PurePosixPath(relative.name)):
            try:
                return read_file(self._path.parent / place)
            except FileError:
                continue
        return b""


def _kind(record: Record) -> str:
    return str(record.values[2]) if len(record.values) > 2 else ""


def _full(channel: Record, shapes: int) -> int:
    """Which of a channel's shapes is the full one; the others are in-betweens."""
    weights = channel.array("FullWeights")
    return shapes - 1 if weights is None or len(weights) != shapes else int(weights.argmax())


def _label(record: Record) -> str:
    """The name of an object, without the kind that follows it in the file."""
    name = str(record.values[1]) if len(record.values) > 1 else ""
    return name.split("\x00")[0][:200] or "mesh"


def _triangles(
    geometry: Record, count: int
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """Triangulate the polygons of a mesh.

    Returns:
        corners: (C,) vertex of each polygon corner.
        owners: (F,) polygon of each triangle.
        triangles: (F, 3) which corners.
    """
    stored = geometry.array("PolygonVertexIndex")
    if stored is None or not len(stored):
        nothing = np.zeros(0, np.int64)
        return nothing, nothing, np.zeros((0, 3), np.int64)
    stored = stored.astype(np.int64)
    ends = np.flatnonzero(stored < 0)
    corners = np.where(stored < 0, -1 - stored, stored)
    if not len(ends) or ends[-1] != len(stored) - 1 or corners.max() >= count:
        raise Damaged("a polygon names a vertex that does not exist")
    starts = np.r_[0, ends[:-1] + 1]
    sizes = np.maximum(ends - starts - 1, 0)  # triangles of each polygon
    owners = np.repeat(np.arange(len(sizes)), sizes)
    within = np.arange(sizes.sum()) - np.repeat(np.cumsum(sizes) - sizes, sizes)
    first = starts[owners]
    return corners, owners, np.stack((first, first + within + 1, first + within + 2), axis=1)


def _uv(geometry: Record, corners: int) -> Floats | None:
    """(C, 2) texture coordinates of the corners, (0, 0) at the upper left of the picture."""
    layer = geometry.first("LayerElementUV")
    values = layer.array("UV") if layer else None
    if layer is None or values is None or len(values) % 2 or not len(values):
        return None
    values = finite(values.reshape(-1, 2), "texture coordinates")
    if layer.text("MappingInformationType") != "ByPolygonVertex":
        return None
    index = layer.array("UVIndex")
    rows = np.arange(corners) if index is None else index
    if len(rows) != corners or rows.max() >= len(values):
        return None
    placed: Floats = values[np.maximum(rows, 0)].astype(np.float32)
    placed[:, 1] = 1.0 - placed[:, 1]
    return placed


def _ranks(uv: Floats) -> NDArray[np.int64]:
    """A number for each row, equal for equal coordinates."""
    rounded = np.round(uv * 65536).astype(np.int64)
    return np.unique(rounded, axis=0, return_inverse=True)[1].ravel()


def _materials(geometry: Record, polygons: int) -> NDArray[np.int64]:
    """(P,) the number of each polygon's material in its model."""
    layer = geometry.first("LayerElementMaterial")
    values = layer.array("Materials") if layer else None
    if layer is None or values is None or len(values) != polygons:
        first = int(values[0]) if values is not None and len(values) else 0
        return np.full(polygons, first, np.int64)
    return values.astype(np.int64)
