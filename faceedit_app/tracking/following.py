"""Follows one face from picture to picture, and looks for it when it was lost."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from PIL import Image

from faceedit_app.core.arrays import Doubles
from faceedit_app.tracking.landmarker import FaceLandmarker, FaceLandmarks, Square

CERTAIN = 0.9  # probability of a face that is upside down or small, where more looks like one
_NEAR = 0.75  # of a face's size; where it is looked for after it was lost
_ON_IT = 0.5  # of a found square; how far from its middle a place is still on the face
_CLOSER = 3.0  # times the last square, where a face that was lost is looked for
_PARTS = 2, 4  # of a picture's longer side that are looked at by themselves
_OFTEN = 5  # one of that many pictures without a face is looked at in parts


class Follower:
    """Follows one face.

    Args:
        landmarker: finds faces.
        place: a place on the face, pixels of the first pictures; None = the largest face.
    """

    def __init__(
        self, landmarker: FaceLandmarker, place: tuple[float, float] | None = None
    ) -> None:
        self._landmarker, self._place = landmarker, place
        self._square: Square | None = None  # where the face is in the next picture
        self._last: Square | None = None  # where it was before it was lost
        self._missed = 0  # pictures in a row without a face

    def step(self, image: Image.Image) -> FaceLandmarks | None:
        """The face in the next picture, or None."""
        face = None
        if self._square is not None:
            face = self._landmarker.landmarks(image, self._square)
        if face is None:
            face = self._look(image)
        self._missed = 0 if face is not None else self._missed + 1
        self._square = None if face is None else Square.around(face.points)
        self._last = self._square or self._last
        return face

    def go_on_from(self, points: Doubles) -> None:
        """The next picture is beside one with the face at landmarks (478, 2 or 3)."""
        self._square = self._last = Square.around(points)

    def _look(self, image: Image.Image) -> FaceLandmarks | None:
        face = self._face_in(image, self._landmarker.faces(image))
        if face is None and (self._last is None or math.cos(self._last.angle) < 0):
            face = self._upside_down(image)
        if face is None:
            face = self._closer(image)
        if face is None:
            return None
        # Once more in the square around the landmarks, which is more exact.
        return self._landmarker.landmarks(image, Square.around(face.points)) or face

    def _face_in(self, image: Image.Image, squares: list[Square]) -> FaceLandmarks | None:
        """The face that is followed, in one of the squares, the largest first; or None."""
        last = self._last
        if last is not None:  # the same face again, not another one
            squares = [s for s in squares if s.distance_to(last.x, last.y) < _NEAR * last.size]
        elif self._place is not None:
            x, y = self._place
            squares = [s for s in squares if s.distance_to(x, y) < _ON_IT * s.size]
            squares.sort(key=lambda square: square.distance_to(x, y))
        face = self._landmarker.landmarks(image, squares[0]) if squares else None
        return face if face is not None and math.isfinite(face.probability) else None

    def _upside_down(self, image: Image.Image) -> FaceLandmarks | None:
        """A face that is upside down, which the networks do not find, or not where it is."""
        width, height = image.size
        squares = [
            Square(width - found.x, height - found.y, found.size, found.angle + math.pi)
            for found in self._landmarker.faces(image.transpose(Image.Transpose.ROTATE_180))
        ]
        return _if_certain(self._face_in(image, squares))

    def _closer(self, image: Image.Image) -> FaceLandmarks | None:
        """A face that is too small for the detector, which sees little of a whole picture."""
        for views in self._views(*image.size):
            squares = [found for view in views for found in self._landmarker.faces(image, view)]
            squares.sort(key=lambda square: -square.size)
            face = _if_certain(self._face_in(image, squares))
            if face is not None:
                return face
        return None

    def _views(self, width: int, height: int) -> Iterator[list[Square]]:
        """The parts of a picture to look at, the largest first."""
        whole = max(width, height)
        if self._last is not None:
            yield [Square(self._last.x, self._last.y, _CLOSER * self._last.size, 0.0)]
            return
        for parts in _PARTS:
            side = whole / parts
            if self._place is not None:
                yield [Square(*self._place, side, 0.0)]
            elif self._missed % _OFTEN == 0:  # they take as long as ten pictures of a face
                across, down = (_spread(length, side) for length in (width, height))
                yield [Square(x, y, side, 0.0) for y in down for x in across]


def _spread(length: float, side: float) -> list[float]:
    """The middles of parts that overlap by half of them, or more, along a length; pixels."""
    if length <= side:
        return [length / 2.0]
    count = math.ceil(2.0 * (length - side) / side) + 1
    middles: list[float] = np.linspace(side / 2.0, length - side / 2.0, count).tolist()
    return middles


def _if_certain(face: FaceLandmarks | None) -> FaceLandmarks | None:
    return face if face is not None and face.probability > CERTAIN else None
