"""Read a head without shapes, such as a scan or a sculpture, as one mesh."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path, PureWindowsPath

import fast_simplification
import numpy as np
import trimesh
from numpy.typing import NDArray

from faceedit_app.characters.base_colors import linear, png_of
from faceedit_app.characters.bounded import MOST_TRIANGLES, MOST_VERTICES, finite, read_file
from faceedit_app.characters.character import Character, MeshPart, Surface, Texture
from faceedit_app.characters.paint import Paint
from faceedit_app.characters.pictures import read_textures
from faceedit_app.characters.registry import SCAN_REMEDY, read_character
from faceedit_app.core.arrays import Doubles, Floats
from faceedit_app.core.errors import FileError

_PLAIN = (".ply", ".stl")
_ENOUGH = 120_000  # triangles; more would only slow the fit
_FEWEST = 200
_FINE = 20_000  # vertices; the colours of more are finer than those of our vertices
_GREY = np.array([0.5, 0.5, 0.5, 1.0], np.float32)


@dataclass(frozen=True)
class Scan:
    """One mesh.

    Attributes:
        vertices: (V, 3), in the file's unit and axes.
        faces: (F, 3).
        colors: (V, 4) float32, linear RGBA, if the file has colours or a texture.
        remarks: sentences about what was left out or decimated.
        paint: the colours of its surface, if they show more than `colors`.
    """

    vertices: Doubles
    faces: NDArray[np.int32]
    colors: Floats | None
    remarks: tuple[str, ...] = ()
    paint: Paint | None = None


def read_scan(path: Path | str) -> Scan:
    """Read a head without shapes; any shapes it has are ignored.

    Raises:
        FileError: it cannot be read, or is not a head.
    """
    path = Path(path)
    is_plain = path.suffix.lower() in _PLAIN
    scan = _joined(_plain(path) if is_plain else read_character(path, with_shapes=False))
    if len(scan.faces) < _FEWEST:
        raise FileError(path, f"has only {len(scan.faces)} triangles", SCAN_REMEDY)
    return _smaller(scan)


def _plain(path: Path) -> Character:
    """PLY and STL, by trimesh."""
    kind = path.suffix[1:].lower()
    stream, beside = trimesh.util.wrap_as_stream(read_file(path)), _Beside(path.parent)
    try:
        mesh = trimesh.load_mesh(stream, file_type=kind, process=False, resolver=beside)
        vertices = finite(np.asarray(mesh.vertices, np.float64), "vertices")
        faces = np.asarray(mesh.faces, np.int32)
    except Exception as error:  # trimesh raises all kinds
        raise FileError(path, "cannot be read as a mesh", SCAN_REMEDY) from error
    if len(vertices) > MOST_VERTICES or len(faces) > MOST_TRIANGLES:
        raise FileError(path, f"has {len(faces)} triangles", "export a smaller one")
    if faces.size and (faces.min() < 0 or faces.max() >= len(vertices)):
        raise FileError(path, "has a triangle without its vertices", "export it again")
    part = MeshPart(path.stem, vertices.astype(np.float32), faces)
    visual = mesh.visual
    if isinstance(visual, trimesh.visual.TextureVisuals) and visual.uv is not None:
        uv = np.asarray(visual.uv, np.float64) * (1, -1) + (0, 1)
        placed = finite(uv, "texture coordinates").astype(np.float32)
        part = replace(part, uv=placed, surface=Surface("scan", texture=beside.texture))
        return Character(path, kind.upper(), (part,))
    if isinstance(visual, trimesh.visual.ColorVisuals) and visual.kind == "vertex":
        colors = np.asarray(visual.vertex_colors, np.float32) / 255.0
        colors[:, :3] = linear(colors[:, :3])
        part = replace(part, colors=colors)
    return Character(path, kind.upper(), (part,))


class _Beside:
    """Gives trimesh the pictures that lie beside a mesh, and no other files.

    Attributes:
        texture: the last one; without content if it is missing.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self.texture = Texture("picture", b"")

    def get(self, name: str) -> bytes:
        """The content of a picture; a blank one if it is missing."""
        name = PureWindowsPath(name).name
        try:
            content = read_file(self._folder / name)
        except FileError:
            content = b""
        self.texture = Texture(name[:60], content)
        return content or png_of(np.zeros((1, 1, 4), np.uint8))


def _joined(character: Character) -> Scan:
    """All parts of a character as one mesh, in its own colours."""
    parts = character.parts
    starts = np.cumsum([0, *(len(part.neutral) for part in parts)])
    faces = np.concatenate(
        [part.faces + np.int32(start) for part, start in zip(parts, starts[:-1], strict=True)]
    )
    vertices = np.concatenate([part.neutral for part in parts]).astype(np.float64)
    pictures, numbers, faults = read_textures(parts)
    remarks = (*character.remarks, *dict.fromkeys(faults))
    known = [n is not None or p.colors is not None for p, n in zip(parts, numbers, strict=True)]
    if not any(known):
        return Scan(vertices, faces, None, remarks)
    paint = Paint(
        vertices,
        faces,
        np.concatenate([_tints(part, has) for part, has in zip(parts, known, strict=True)]),
        np.concatenate([_coordinates(part) for part in parts]),
        np.repeat([-1 if n is None else n for n in numbers], [len(p.faces) for p in parts]),
        tuple(pictures),
    )
    is_finer = bool(pictures) or len(vertices) > _FINE
    return Scan(vertices, faces, paint.of_vertices, remarks, paint if is_finer else None)


def _tints(part: MeshPart, is_colored: bool) -> Floats:
    """(V, 4) what multiplies the texture of a part; grey if it has no colours."""
    count = len(part.neutral)
    if not is_colored:
        return np.tile(_GREY, (count, 1))
    own = np.ones((count, 4), np.float32) if part.colors is None else part.colors
    tints: Floats = own * np.array(part.surface.color, np.float32)
    return tints


def _coordinates(part: MeshPart) -> Floats:
    return np.zeros((len(part.neutral), 2), np.float32) if part.uv is None else part.uv


def _smaller(scan: Scan) -> Scan:
    if len(scan.faces) <= _ENOUGH:
        return scan
    share = 1.0 - _ENOUGH / len(scan.faces)
    _, _, collapses = fast_simplification.simplify(
        scan.vertices.astype(np.float32), scan.faces, share, return_collapses=True
    )
    places, faces, mapping = fast_simplification.replay_simplification(
        scan.vertices.astype(np.float32), scan.faces, collapses
    )
    colors = None
    if scan.colors is not None:
        colors = np.zeros((len(places), 4), np.float32)
        colors[mapping] = scan.colors
    said = f"{len(scan.faces):,} triangles were decimated to about {_ENOUGH:,}".replace(",", " ")
    remarks = (*scan.remarks, said)
    return Scan(places.astype(np.float64), faces.astype(np.int32), colors, remarks, scan.paint)
