"""Make a character from a scan in steps that can be looked at and done again with moved points."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import trimesh

from faceedit_app.characters.leaving_out import without_parts
from faceedit_app.characters.making import Made, Template, make
from faceedit_app.characters.registration import Landmarks
from faceedit_app.characters.scans import Scan, read_scan
from faceedit_app.core.arrays import Doubles, Floats, Pixels
from faceedit_app.core.rig import Rig
from faceedit_app.render.camera import Camera, default_camera
from faceedit_app.render.snapshot import snapshot
from faceedit_app.scans.landmarks import drawable, find_landmarks

_NEAR = 0.12  # of the head's width; landmarks this near to a moved point are left out
# Faces on which the result is judged, by the weights that differ from 0.
EXPRESSIONS: Mapping[str, Mapping[str, float]] = {
    "At rest": {},
    "Mouth open": {"jawOpen": 0.8},
    "Lips closed over an open jaw": {"jawOpen": 0.5, "mouthClose": 0.5},
    "Eyes closed": {"eyeBlinkLeft": 1.0, "eyeBlinkRight": 1.0},
    "Smile": {"mouthSmileLeft": 0.9, "mouthSmileRight": 0.9},
    "Pucker": {"mouthPucker": 0.9},
}


@dataclass(frozen=True)
class Attempt:
    """A character made of a scan, and the scan as seen from the same camera.

    Attributes:
        made: the character.
        scan: the scan as a rig to draw, in the character's place and size.
        points: the vertex of `scan` at each control point.
        landmarks: how many were used.
        distance: median and 95th percentile of the distance from the face to the scan, mm.
    """

    made: Made
    scan: Rig
    points: Mapping[str, int]
    landmarks: int
    distance: tuple[float, float]

    @property
    def camera(self) -> Camera:
        """Sees the character from the front."""
        return default_camera(self.made.rig)

    def without(self, parts: Collection[str]) -> Attempt:
        """The same without hair, brows or lashes; see `leaving_out.PARTS`."""
        rig = without_parts(self.made.rig, parts)
        return replace(self, made=replace(self.made, rig=rig))

    def picture(self, size: int, expression: str | None) -> Pixels:
        """(size, size, 3) RGB of the character with an expression, or of the scan for None."""
        if expression is None:
            return snapshot(self.scan, np.zeros(1, np.float32), size, size, self.camera)
        rig = self.made.rig
        weights: Floats = np.zeros(len(rig.channels), np.float32)
        for channel, value in EXPRESSIONS[expression].items():
            weights[rig.channel_index[channel]] = value
        return snapshot(rig, weights, size, size, self.camera)


class ScanSteps:
    """Makes a character of one scan.

    Args:
        path: the scan's file.
        rig: FaceEdit's own character, which is the template.
        landmarker: other networks than those that ship with FaceEdit.

    Raises:
        FileError: the scan cannot be read, or is not a head.
    """

    def __init__(self, path: Path, rig: Rig, landmarker: Path | None = None) -> None:
        self.path, self._landmarker = path, landmarker
        self.scan: Scan = read_scan(path)
        self._template = Template.of(rig)
        self._found: Landmarks | None = None

    def attempt(self, moved: Mapping[str, Doubles] | None = None) -> Attempt:
        """Fit the template and transfer its shapes; takes some seconds.

        Args:
            moved: control points that the user has put elsewhere, in the scan's coordinates.

        Raises:
            Unavailable, FileError: the networks cannot be loaded, or find no face.
        """
        if self._found is None:
            self._found = find_landmarks(self._template, self.scan, self.path, self._landmarker)
        landmarks = self._with(self._found, moved or {})
        made = make(self._template, self.scan, landmarks, self.path.stem)
        back = np.linalg.inv(made.to_scan)
        here = trimesh.transform_points(self.scan.vertices, back) / 1000.0
        places = {name: made.skin[v] / 1000.0 for name, v in self._template.points.items()}
        for name, place in (moved or {}).items():
            places[name] = trimesh.transform_points(place[None], back)[0] / 1000.0
        points = {
            name: int(((here - place) ** 2).sum(axis=1).argmin()) for name, place in places.items()
        }
        return Attempt(
            made,
            drawable(here.astype(np.float32), self.scan),
            points,
            len(landmarks.positions),
            made.distance_to(self.scan),
        )

    def _with(self, found: Landmarks, moved: Mapping[str, Doubles]) -> Landmarks:
        """The landmarks, with moved points in place of those around them."""
        if not moved:
            return found
        own = self._template.landmarks(moved)
        source = found.on(self._template.vertices, self._template.faces)
        mine = own.on(self._template.vertices, self._template.faces)
        width = float(np.ptp(source[:, 0]))
        away = np.linalg.norm(source[:, None] - mine[None], axis=2).min(axis=1)
        kept = away > _NEAR * width
        return Landmarks(
            np.concatenate((found.triangles[kept], own.triangles)),
            np.concatenate((found.weights[kept], own.weights)),
            np.concatenate((found.positions[kept], own.positions)),
        )
