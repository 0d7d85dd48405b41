"""Characters from OBJ files: one file is the neutral head, each other the head with a shape.

trimesh's reader is not used because it reorders vertices, and morph targets are the differences
between files with vertices in the same order.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from faceedit_app.characters.base_colors import linear
from faceedit_app.characters.bounded import Damaged, check_targets, finite, read_file
from faceedit_app.characters.character import Character, MeshPart, Surface, unique_names
from faceedit_app.characters.names import match_channels
from faceedit_app.characters.obj_materials import read_materials
from faceedit_app.core import on_disk
from faceedit_app.core.arrays import Floats
from faceedit_app.core.errors import FileError, reason_of

NEUTRAL_WORDS = ("neutral", "basis", "base", "rest", "default", "mean", "generic_neutral")
_MOST_FILES = 1_000
_REMEDY = "put the neutral head as neutral.obj and one OBJ per shape into a folder"


@dataclass(frozen=True)
class _Mesh:
    """The content of an OBJ file.

    Attributes:
        places: (V, 3).
        colors: (V, 4) linear, if they follow the places.
        corners, uv_corners: (F, 3).
        materials: (F,).
    """

    places: Floats
    colors: Floats | None
    corners: NDArray[np.int64]
    uv_corners: NDArray[np.int64] | None
    uv: Floats | None
    materials: NDArray[np.int64]
    material_names: tuple[str, ...]
    library: str


def read_obj(path: Path) -> Character:
    """Read an OBJ file and the files next to it with the same vertices, or a folder of them.

    The neutral head is the one whose name says so, or the only one whose name is not a shape's; of
    a file, it is the file itself if its name is not a shape's.

    Raises:
        FileError: there is no OBJ file, or no neutral one.
        Damaged: a file contradicts itself.
    """
    folder = path if on_disk.is_folder(path) else path.parent
    try:
        shown = (p for p in folder.iterdir() if not p.name.startswith("."))
        files = sorted(p for p in shown if p.suffix.lower() == ".obj")
    except OSError as error:
        reason = reason_of(error)
        raise FileError(path, f"cannot be read ({reason})", "check the path") from error
    if on_disk.is_folder(path):
        neutral = _neutral(path, files)
    else:
        is_shape = bool(match_channels([path.stem]).matched)
        neutral = _neutral_beside(path, files) if is_shape else path
    others = [p for p in files if p != neutral]
    if len(others) > _MOST_FILES:
        raise FileError(path, f"has more than {_MOST_FILES} OBJ files", _REMEDY)
    mesh = _read_mesh(neutral)
    check_targets([len(mesh.places)], [len(others)])
    targets, strangers, unread = {}, [], []
    for other in others:
        try:
            places = _places(_read(other))
        except (Damaged, FileError):
            unread.append(other.name)
            continue
        if places.shape == mesh.places.shape:
            targets[other.stem] = places - mesh.places
        else:
            strangers.append(other.name)
    remarks = []
    if on_disk.is_folder(path) and not _says_neutral(neutral):
        name = neutral.name[:60]
        remarks.append(f"{name} is used as the neutral head, because its name is no shape's")
    for names, why in ((strangers, "other vertices"), (unread, "damaged")):
        if names and on_disk.is_folder(path):
            first = ", ".join(names[:3]) + (" …" if len(names) > 3 else "")
            remarks.append(f"left out ({why}): {first}")
    parts, missing = _parts(neutral, mesh, targets)
    return Character(path, "OBJ", tuple(parts), (*remarks, *missing))


def read_one_obj(path: Path) -> Character:
    """Read an OBJ file without those beside it.

    Raises:
        FileError: it cannot be read, or holds no mesh.
        Damaged: it contradicts itself.
    """
    parts, missing = _parts(path, _read_mesh(path), {})
    return Character(path, "OBJ", tuple(parts), missing)


def _neutral(folder: Path, files: list[Path]) -> Path:
    if not files:
        raise FileError(folder, "holds no OBJ file", _REMEDY)
    for word in NEUTRAL_WORDS:
        found = [p for p in files if word in p.stem.lower()]
        if found:
            return min(found, key=lambda p: len(p.stem))
    match = match_channels([p.stem for p in files])
    unknown = [p for p in files if p.stem in match.unknown]
    if match.matched and len(unknown) == 1:
        return unknown[0]
    raise FileError(folder, "has no OBJ file named neutral", _REMEDY)


def _says_neutral(file: Path) -> bool:
    return any(word in file.stem.lower() for word in NEUTRAL_WORDS)


def _neutral_beside(shape: Path, files: list[Path]) -> Path:
    """The neutral head of a file that is one of its shapes; the file itself if there is none."""
    try:
        neutral = _neutral(shape.parent, files)
        same = _places(_read(neutral)).shape == _places(_read(shape)).shape
    except (Damaged, FileError):
        return shape
    return neutral if same else shape


def _read(path: Path) -> bytes:
    """The content of an OBJ file, with plain spaces and line ends, and long lines joined."""
    content = read_file(path).replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    return content.replace(b"\\\n", b" ").replace(b"\t", b" ")


def _places(content: bytes) -> Floats:
    """(V, 3) float32 of the lines that begin with v."""
    rows = [line.split()[1:4] for line in content.split(b"\n") if line.startswith(b"v ")]
    try:
        places = np.array(rows, np.float64).reshape(-1, 3)
    except ValueError as error:
        raise Damaged("a vertex does not have three numbers") from error
    return finite(places, "vertices").astype(np.float32)


def _colors(content: bytes) -> Floats | None:
    """(V, 4) linear colours, if red, green and blue follow the places of all vertices."""
    rows = [line.split()[4:7] for line in content.split(b"\n") if line.startswith(b"v ")]
    if not rows or any(len(row) != 3 for row in rows):
        return None
    try:
        stored = finite(np.array(rows, np.float64), "colours")
    except ValueError as error:
        raise Damaged("a colour does not have three numbers") from error
    colors = np.ones((len(stored), 4), np.float32)
    colors[:, :3] = linear((stored / (255.0 if stored.max() > 1.0 else 1.0)).clip(0, 1))
    return colors


def _read_mesh(path: Path) -> _Mesh:
    content = _read(path)
    places = _places(content)
    uv_rows: list[list[bytes]] = []
    corners: list[tuple[int, int, int]] = []
    uv_corners: list[tuple[int, int, int]] = []
    materials: list[int] = []
    names: dict[str, int] = {}
    library, material, seen = "", 0, 0
    for line in content.split(b"\n"):
        if line.startswith(b"v "):
            seen += 1
        elif line.startswith(b"vt "):
            uv_rows.append(line.split()[1:3])
        elif line.startswith(b"f "):
            for three in _fan(line.split()[1:], seen, len(uv_rows)):
                corners.append(three[0])
                uv_corners.append(three[1])
                materials.append(material)
        elif line.startswith(b"usemtl "):
            name = line[7:].strip().decode("utf-8", "replace")[:60]
            material = names.setdefault(name, len(names))
        elif line.startswith(b"mtllib "):
            library = line[7:].strip().decode("utf-8", "replace")
    triangles = np.array(corners, np.int64).reshape(-1, 3)
    if not len(triangles):
        raise FileError(path, "holds no triangles", "export the mesh of the head")
    if not (triangles.min() >= 0 and triangles.max() < len(places)):
        raise Damaged(f"a triangle of {path.name} names a vertex that does not exist")
    uv, uv_triangles = None, np.array(uv_corners, np.int64).reshape(-1, 3)
    if uv_rows and uv_triangles.size and uv_triangles.min() >= 0:
        if uv_triangles.max() >= len(uv_rows):
            raise Damaged("a triangle names a texture coordinate that does not exist")
        uv = finite(np.array(uv_rows, np.float64), "texture coordinates").astype(np.float32)
        uv[:, 1] = 1 - uv[:, 1]
    return _Mesh(
        places,
        _colors(content),
        triangles,
        uv_triangles if uv is not None else None,
        uv,
        np.array(materials, np.int64),
        tuple(names),
        library,
    )


_Three = tuple[int, int, int]


def _fan(corners: list[bytes], vertices: int, coordinates: int) -> Iterator[tuple[_Three, _Three]]:
    """The triangles of a polygon: vertices and texture coordinates from 0; -1 means none."""
    points, places = [], []
    for corner in corners:
        numbers = corner.split(b"/")
        points.append(_index(numbers[0], vertices))
        has_uv = len(numbers) > 1 and numbers[1]
        places.append(_index(numbers[1], coordinates) if has_uv else -1)
    for k in range(1, len(points) - 1):
        yield (points[0], points[k], points[k + 1]), (places[0], places[k], places[k + 1])


def _index(text: bytes, count: int) -> int:
    try:
        number = int(text)
    except ValueError as error:
        raise Damaged("a polygon names no vertex") from error
    if not -count <= number <= 1 << 30 or number == 0:
        raise Damaged("a polygon names a vertex that does not exist")
    return number - 1 if number > 0 else count + number


def _parts(
    path: Path, mesh: _Mesh, targets: dict[str, Floats]
) -> tuple[list[MeshPart], tuple[str, ...]]:
    """One part for each material, and sentences about what is missing."""
    corners, uv = mesh.corners.ravel(), None
    if mesh.uv is not None and mesh.uv_corners is not None:
        keys = np.column_stack((corners, mesh.uv_corners.ravel()))
        _, first, vertex_of = np.unique(keys, axis=0, return_index=True, return_inverse=True)
        points = corners[first]
        uv = mesh.uv[mesh.uv_corners.ravel()[first]]
    else:
        points, vertex_of = np.unique(corners, return_inverse=True)
    whole = MeshPart(
        name=path.stem,
        neutral=mesh.places[points],
        faces=vertex_of.reshape(-1, 3).astype(np.int32),
        targets={name: moves[points] for name, moves in targets.items()},
        uv=uv,
        colors=None if mesh.colors is None else mesh.colors[points],
    )
    surfaces, missing = read_materials(path, mesh.library)
    parts = []
    for number in np.unique(mesh.materials):
        faces = whole.faces[mesh.materials == number]
        name = mesh.material_names[number] if number < len(mesh.material_names) else ""
        part = replace(whole, faces=faces, surface=surfaces.get(name, Surface(name)))
        parts.append(part.only(np.unique(faces).astype(np.intp)))
    labels = unique_names([part.name for part in parts])
    return [replace(part, name=name) for part, name in zip(parts, labels, strict=True)], missing
