"""FaceEdit's own character file: a standard GLB with morph targets, which Blender can open.

All primitives share one set of vertex accessors and differ only in their indices, so that the rig
stays one vertex array. The control points are in the mesh's `extras`; the baked shade is an
attribute that other programs ignore. `glb_writing` writes it: the library that it uses would take
longer to read the file than everything else.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from faceedit_app.characters.bounded import MOST_VERTICES, Damaged, whole
from faceedit_app.characters.gltf_buffers import GltfFile, Json
from faceedit_app.core.controls import CONTROL_IDS
from faceedit_app.core.errors import FileError
from faceedit_app.core.rig import Material, Rig

_REMEDY = "choose a GLB with morph targets and FaceEdit control definitions"
SHADE = "_SHADE"  # glTF wants names of one's own to begin so
_MISSING = (-1, -1)  # a control that the file does not define


def read_rig(path: Path | str) -> Rig:
    """Read a character written by `glb_writing.write_rig`.

    Raises:
        FileError: it is not a GLB, or has no morph targets or control definitions.
    """
    path = Path(path)
    try:
        document = GltfFile(path)
        if not document.all("meshes"):
            raise FileError(path, "holds no mesh", _REMEDY)
        rig = _rig(document, path.stem)
    except Damaged as error:
        raise FileError(path, f"is damaged: {error}", _REMEDY) from error
    except (KeyError, TypeError, IndexError, ValueError, AttributeError) as error:
        raise FileError(path, "lacks a part of the character", _REMEDY) from error
    if problem := _problem(rig):
        raise FileError(path, problem, _REMEDY)
    return rig


def _rig(document: GltfFile, fallback_name: str) -> Rig:
    mesh = document.entry("meshes", 0)
    extras, primitives = mesh["extras"], mesh["primitives"]
    attributes, targets = primitives[0]["attributes"], primitives[0]["targets"]
    faces, materials, start = [], [], 0
    for primitive in primitives:
        triangles = document.array(primitive["indices"]).reshape(-1, 3).astype(np.int32)
        stop = start + len(triangles)
        materials.append(_material(document.entry("materials", primitive["material"]), start, stop))
        faces.append(triangles)
        start = stop
    controls, shade = extras["controls"], attributes.get(SHADE)
    neutral = document.array(attributes["POSITION"]).astype(np.float32)
    deltas = np.empty((len(targets), *neutral.shape), np.float32)
    for delta, target in zip(deltas, targets, strict=True):
        moved = document.array(target["POSITION"])
        if moved.shape != neutral.shape:
            raise Damaged("a morph target has another number of vertices than its mesh")
        delta[:] = moved
    return Rig(
        neutral=neutral,
        faces=np.concatenate(faces),
        channels=tuple(extras["targetNames"]),
        deltas=deltas,
        colors=document.array(attributes["COLOR_0"]).astype(np.float32),
        materials=tuple(materials),
        control_pairs=np.array([_pair(controls, name) for name in CONTROL_IDS], np.int32),
        name=mesh.get("name") or fallback_name,
        attribution=extras.get("attribution", ""),
        shade=None if shade is None else document.array(shade)[:, 0].astype(np.float32),
    )


def _pair(controls: Json, name: str) -> list[int]:
    """The two vertices between which a control is measured."""
    pair = controls.get(name, _MISSING)
    return [whole(vertex, f"a vertex of {name}", MOST_VERTICES, -1) for vertex in pair]


def _material(look: Json, start: int, stop: int) -> Material:
    """The material of the triangles from `start` to before `stop`; glTF's defaults are 1."""
    surface = look["pbrMetallicRoughness"]
    roughness, metallic = (surface.get(f"{name}Factor", 1.0) for name in ("roughness", "metallic"))
    return Material(look["name"], start, stop, roughness, metallic)


def _is_material(material: Material) -> bool:
    numbers = (material.roughness, material.metallic)
    are_numbers = all(isinstance(number, int | float) and 0 <= number <= 1 for number in numbers)
    return isinstance(material.name, str) and are_numbers


def _problem(rig: Rig) -> str | None:
    """What is inconsistent in a rig from a file, as a phrase; None if nothing."""
    count = len(rig.neutral)
    shapes = (rig.neutral.shape, rig.deltas.shape, rig.colors.shape, rig.control_pairs.shape)
    if shapes != ((count, 3), (len(rig.channels), count, 3), (count, 4), (len(CONTROL_IDS), 2)):
        return "has parts of the character that do not fit together"
    if rig.shade is not None and rig.shade.shape != (count,):
        return "has a shade that does not fit the character"
    if not all(isinstance(name, str) for name in rig.channels):
        return "has morph targets without names"
    if not all(isinstance(text, str) for text in (rig.name, rig.attribution)):
        return "has a name or an attribution that is not a text"
    if not all(map(_is_material, rig.materials)):
        return "has a material without a name, or with numbers beyond 0 to 1"
    if not rig.has_control.any():
        return "has no control definitions"
    pairs = rig.control_pairs[(rig.control_pairs != _MISSING).any(axis=1)]
    for indices, what in ((rig.faces, "triangle"), (pairs, "control")):
        if indices.min() < 0 or indices.max() >= count:
            return f"has a {what} that names a vertex that does not exist"
    if not (np.isfinite(rig.neutral).all() and np.isfinite(rig.deltas).all()):
        return "has vertices that are not numbers"
    return None
