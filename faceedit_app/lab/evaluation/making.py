"""How well shapes are made for a head: measured on heads whose own shapes are known.

The head is fitted and given our shapes as if it had none; then both are compared on its skin.
"""

from __future__ import annotations

import time
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np
import trimesh

from faceedit_app.characters.character import Character, MeshPart
from faceedit_app.characters.closure import Openings
from faceedit_app.characters.fitted import FittedCharacter, fit
from faceedit_app.characters.making import Made, Template, make
from faceedit_app.characters.registry import read_character
from faceedit_app.characters.scans import Scan
from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Doubles
from faceedit_app.core.errors import FileError
from faceedit_app.core.rig import Rig
from faceedit_app.editing.opening import shipped_rig

_NEAR = 4.0  # mm from the head within which its own shapes are read
_SEEN = 1.0  # mm; a shape that moves nothing farther is not compared


@dataclass(frozen=True)
class MakingFigures:
    """What `faceedit evaluate-character` prints of a head.

    Attributes:
        head: its file.
        seconds: to fit it and to transfer all shapes.
        distance_median, distance_p95: mm from the fitted skin of the face to the head.
        shape_rms: mm, how far the head's own shapes move it; the median over shapes.
        transferred_rms, copied_rms: mm from the head's own shapes to those that were transferred,
            and to ours as they are, rotated and scaled.
        transferred_cosine, copied_cosine: how alike their directions are, -1..1.
        lips_shut, lids_shut: mm between them where the shapes close them.
        copied_lids_shut: mm, the same with ours as they are.
    """

    head: str
    seconds: float
    distance_median: float
    distance_p95: float
    shape_rms: float
    transferred_rms: float
    copied_rms: float
    transferred_cosine: float
    copied_cosine: float
    lips_shut: float
    lids_shut: float
    copied_lids_shut: float

    def text(self) -> str:
        """For people, one line a figure."""
        rows = asdict(self)
        return "\n".join(
            f"{name.replace('_', ' '):20}{value if isinstance(value, str) else round(value, 3)}"
            for name, value in rows.items()
        )


def evaluate_making(path: Path) -> MakingFigures:
    """Make shapes for a head that has its own, and compare.

    Raises:
        FileError: it cannot be read, or is no face.
    """
    fitted = fit(_read_stored(path) if path.suffix == ".npz" else read_character(path))
    template = Template.of(shipped_rig())
    scan = _scan(fitted)
    points = {
        name: 1000.0 * fitted.rig.neutral[vertex].astype(np.float64)
        for name, vertex in fitted.points.items()
    }
    started = time.perf_counter()
    made = make(template, scan, template.landmarks(points), path.stem)
    seconds = time.perf_counter() - started
    middle, most = made.distance_to(scan)
    shapes = _compare(template, made, fitted, scan)
    copied = _shut(_copied(template, made))
    lips, lids = _shut(made.rig)
    return MakingFigures(str(path), seconds, middle, most, *shapes, lips, lids, copied[1])


def _read_stored(path: Path) -> Character:
    """A head as arrays: vertices_cm, faces, names and deltas_cm (ICT-FaceKit's)."""
    try:
        with np.load(path) as stored:
            vertices, faces = stored["vertices_cm"], stored["faces"]
            names = [str(name) for name in stored["names"]]
            moves = stored["deltas_cm"].astype(np.float32)
    except (OSError, KeyError, ValueError) as error:
        raise FileError(path, "is no stored head", "use a GLB, VRM, FBX or OBJ") from error
    targets = dict(zip(names, moves, strict=True))
    part = MeshPart("head", vertices.astype(np.float32), faces.astype(np.int32), targets)
    return Character(path, "arrays", (part,))


def _scan(fitted: FittedCharacter) -> Scan:
    """The head's skin without its shapes, in millimetres."""
    rig = fitted.rig
    skin = [rig.faces[m.start : m.stop] for m in rig.materials if m.surface == "skin"]
    faces = np.concatenate(skin)
    return Scan(1000.0 * rig.neutral.astype(np.float64), faces, None)


def _compare(
    template: Template, made: Made, fitted: FittedCharacter, scan: Scan
) -> tuple[float, float, float, float, float]:
    """Medians over shapes: rms, error and cosine of transferred and of copied ones."""
    mesh = trimesh.Trimesh(scan.vertices, scan.faces, process=False)
    there = trimesh.transform_points(made.skin, made.to_scan)
    places, far, triangles = mesh.nearest.on_surface(there)
    weights = trimesh.triangles.points_to_barycentric(mesh.triangles[triangles], places)
    near = made.face & (np.asarray(far) < _NEAR)
    linear = made.to_scan[:3, :3]
    rows = []
    for channel, moves in zip(fitted.rig.channels, fitted.rig.deltas, strict=True):
        own = np.einsum("vk,vkx->vx", weights, 1000.0 * moves[scan.faces[triangles]])[near]
        if np.abs(own).max(initial=0.0) < _SEEN or channel not in template.rig.channel_index:
            continue
        index = template.rig.channel_index[channel]
        ours = made.moves[index][near] @ linear.T
        copied = template.moves[index][near] @ linear.T
        rows.append(
            (
                _rms(own),
                _rms(own - ours),
                _rms(own - copied),
                _cosine(own, ours),
                _cosine(own, copied),
            )
        )
    rms, transferred, plain, cosine, plain_cosine = np.median(rows, axis=0).tolist()
    return rms, transferred, plain, cosine, plain_cosine


def _copied(template: Template, made: Made) -> Rig:
    """The made head with the template's own displacements."""
    return replace(made.rig, deltas=template.rig.deltas)


def _shut(rig: Rig) -> tuple[float, float]:
    """Mm beyond touching with the jaw open and the mouth closed, and with both eyes shut."""
    weights = np.zeros((2, 52), np.float32)
    weights[0, [ARKIT_INDEX["jawOpen"], ARKIT_INDEX["mouthClose"]]] = 1.0
    weights[1, [ARKIT_INDEX["eyeBlinkLeft"], ARKIT_INDEX["eyeBlinkRight"]]] = 1.0
    gaps = Openings.of(rig).measure(weights)
    return float(gaps[0, 0]), float(gaps[1, 1:].max())


def _rms(moves: Doubles) -> float:
    return float(np.sqrt((moves**2).sum(axis=1).mean()))


def _cosine(one: Doubles, other: Doubles) -> float:
    return float((one * other).sum() / max(np.sqrt((one**2).sum() * (other**2).sum()), 1e-9))
