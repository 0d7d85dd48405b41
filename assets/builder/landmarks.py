"""Finds the tracker's landmarks on the character: `python -m assets.builder.landmarks`.

Writes `assets/character.landmarks.json`: for each landmark three vertices and their weights.
Lips and lids are put on the character's own control points, which a picture shows less exactly.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import trimesh

from faceedit_app.core.atomic import write_atomically
from faceedit_app.core.resources import LANDMARKS_OF_CHARACTER
from faceedit_app.core.rig import Rig
from faceedit_app.editing.opening import shipped_rig
from faceedit_app.scans.landmarks import seen_landmarks
from faceedit_app.tracking.face_points import CONTROL_LANDMARKS, IRISES
from faceedit_app.tracking.landmarker import LANDMARKS, FaceLandmarker

OUTPUT = Path(LANDMARKS_OF_CHARACTER)
_SKIN = ("skin", "lips")
_FACING = 0.2  # cosine of the angle to the viewer; landmarks at the outline slide


def main() -> None:
    """Write the file."""
    rig = shipped_rig()
    seen = seen_landmarks(rig, FaceLandmarker())
    if seen is None:
        raise SystemExit("the landmarker does not recognise the character")
    numbers, triangles, places = seen
    mesh = trimesh.Trimesh(rig.neutral.astype(np.float64), rig.faces, process=False)
    weights = trimesh.triangles.points_to_barycentric(mesh.triangles[triangles], places)
    facing = mesh.face_normals[triangles, 2] > _FACING
    skin = np.zeros(len(rig.faces), bool)
    for material in rig.materials:
        skin[material.start : material.stop] = material.name in _SKIN
    entries: dict[int, tuple[list[int], list[float]]] = {
        int(number): (rig.faces[triangle].tolist(), np.round(weight, 4).tolist())
        for number, triangle, weight, fits in zip(
            numbers, triangles, weights, facing & skin[triangles], strict=True
        )
        if fits
    }
    for landmark, (control, end) in CONTROL_LANDMARKS.items():
        vertex = int(rig.control_pairs[control, end])
        entries[landmark] = ([vertex, vertex, vertex], [1.0, 0.0, 0.0])
    for landmark, is_left in zip(IRISES, (False, True), strict=True):
        entries[landmark] = _pupil(rig, is_left)
    rows = [
        f'  "{number}": {json.dumps(entries[number])}'
        for number in sorted(entries)
        if number < LANDMARKS
    ]
    write_atomically(OUTPUT, ("{\n" + ",\n".join(rows) + "\n}\n").encode())
    print(f"{OUTPUT}: {len(rows)} landmarks")


def _pupil(rig: Rig, is_left: bool) -> tuple[list[int], list[float]]:
    """Three vertices around the middle of a pupil."""
    material = next(m for m in rig.materials if m.name == "pupil")
    vertices = np.unique(rig.faces[material.start : material.stop])
    vertices = vertices[(rig.neutral[vertices, 0] > 0) == is_left]
    middle = rig.neutral[vertices].mean(axis=0)
    nearest = vertices[np.linalg.norm(rig.neutral[vertices] - middle, axis=1).argmin()]
    return [int(nearest)] * 3, [1.0, 0.0, 0.0]


if __name__ == "__main__":
    main()
