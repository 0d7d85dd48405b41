"""Read a head without shapes, such as a scan or a sculpture, as one mesh."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import fast_simplification
import numpy as np
import trimesh
from numpy.typing import NDArray

from faceedit_app.characters.bounded import MOST_TRIANGLES, MOST_VERTICES, finite, read_file
from faceedit_app.characters.character import Character, Part
from faceedit_app.characters.pictures import Unreadable, decode
from faceedit_app.characters.registry import read_character
from faceedit_app.core.arrays import Doubles, Floats
from faceedit_app.core.errors import FileError

_PLAIN = (".ply", ".stl")
_ENOUGH = 120_000  # triangles; more would only slow the fit
_FEWEST = 200
_REMEDY = "use an OBJ, PLY, STL or GLB of a neutral face"


@dataclass(frozen=True)
class Scan:
    """One mesh.

    Attributes:
        vertices: (V, 3), in the file's unit and axes.
        faces: (F, 3).
        colors: (V, 4) float32, linear RGBA, if the file has colours or a texture.
        remarks: sentences about what was left out or decimated.
    """

    vertices: Doubles
    faces: NDArray[np.int32]
    colors: Floats | None
    remarks: tuple[str, ...] = ()


def read_scan(path: Path | str) -> Scan:
    """Read a head without shapes; any shapes it has are ignored.

    Raises:
        FileError: it cannot be read, or is not a head.
    """
    path = Path(path)
    scan = _plain(path) if path.suffix.lower() in _PLAIN else _joined(read_character(path))
    if len(scan.faces) < _FEWEST:
        raise FileError(path, f"has only {len(scan.faces)} triangles", _REMEDY)
    return _smaller(scan)


def _plain(path: Path) -> Scan:
    """PLY and STL, by trimesh."""
    content = read_file(path)
    try:
        mesh = trimesh.load_mesh(
            trimesh.util.wrap_as_stream(content), file_type=path.suffix[1:].lower(), process=False
        )
        vertices = finite(np.asarray(mesh.vertices, np.float64), "vertices")
        faces = np.asarray(mesh.faces, np.int32)
    except Exception as error:  # trimesh raises all kinds
        raise FileError(path, "cannot be read as a mesh", _REMEDY) from error
    if len(vertices) > MOST_VERTICES or len(faces) > MOST_TRIANGLES:
        raise FileError(path, f"has {len(faces)} triangles", "export a smaller one")
    if faces.size and (faces.min() < 0 or faces.max() >= len(vertices)):
        raise FileError(path, "has a triangle without its vertices", "export it again")
    colors = None
    if isinstance(mesh.visual, trimesh.visual.ColorVisuals) and mesh.visual.kind == "vertex":
        colors = np.asarray(mesh.visual.vertex_colors, np.float32) / 255.0
        colors[:, :3] = _linear(colors[:, :3])
    return Scan(vertices, faces, colors)


def _joined(character: Character) -> Scan:
    """All parts of a character as one mesh, in its own colours."""
    starts = np.cumsum([0, *(len(part.neutral) for part in character.parts)])
    faces = [p.faces + np.int32(s) for p, s in zip(character.parts, starts[:-1], strict=True)]
    remarks = list(character.remarks)
    colors = [_colors(part, remarks) for part in character.parts]
    known = any(color is not None for color in colors)
    grey = [
        np.full((len(part.neutral), 4), 0.5, np.float32) if color is None else color
        for part, color in zip(character.parts, colors, strict=True)
    ]
    return Scan(
        np.concatenate([part.neutral for part in character.parts]).astype(np.float64),
        np.concatenate(faces),
        np.concatenate(grey) if known else None,
        tuple(remarks),
    )


def _colors(part: Part, remarks: list[str]) -> Floats | None:
    """(V, 4) the colours of a part, from its texture if it has one."""
    tint = np.array(part.surface.color, np.float32)
    if part.surface.texture is not None and part.uv is not None:
        try:
            picture = decode(part.surface.texture)
        except Unreadable as error:
            remarks.append(str(error))
        else:
            height, width = picture.shape[:2]
            column = (part.uv[:, 0] % 1.0 * width).astype(int).clip(0, width - 1)
            row = (part.uv[:, 1] % 1.0 * height).astype(int).clip(0, height - 1)
            seen = picture[row, column].astype(np.float32) / 255.0
            seen[:, :3] = _linear(seen[:, :3])
            tinted: Floats = seen * tint
            return tinted
    if part.colors is None:
        return None
    own: Floats = part.colors * tint
    return own


def _linear(srgb: Floats) -> Floats:
    linear: Floats = np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
    return linear.astype(np.float32)


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
    return Scan(places.astype(np.float64), faces.astype(np.int32), colors, (*scan.remarks, said))
