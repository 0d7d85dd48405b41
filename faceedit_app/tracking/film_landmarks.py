"""Landmarks in every picture of a film."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from PIL import Image

from faceedit_app.core.arrays import Doubles, Pixels, Times
from faceedit_app.core.errors import FileError
from faceedit_app.media.container import check, film_stream, opened
from faceedit_app.media.film import Film
from faceedit_app.tracking.hidden import colors_at
from faceedit_app.tracking.landmarker import (
    LANDMARKS,
    OUTER_EYES,
    Face,
    FaceLandmarker,
    Square,
)
from faceedit_app.tracking.lips import SAMPLES, colors_across

_SLOWEST = 8.0  # pictures per second; speech has closures of a tenth of a second
_FEWEST = 8
_LARGEST = 4096  # pixels of the longest side
_PICTURES = ("image2", "gif", "apng", "webp_pipe", "_pipe")
_PAUSE = 8.0  # times the usual step between pictures
_CERTAIN = 0.9  # probability of a face that is upside down, which is rare
_NEAR = 0.75  # of a face's size; where it is looked for after it was lost


@dataclass(frozen=True)
class Progress:
    """How far tracking is, for the user.

    Attributes:
        pass_: what is being done.
        done, of: pictures.
        picture: (H, W, 4) BGRA, the one just seen, if any.
        points: (478, 2) its landmarks in pixels, if it shows a face.
    """

    pass_: str
    done: int
    of: int
    picture: Pixels | None = None
    points: Doubles | None = None


Report = Callable[[Progress], None]


@dataclass(frozen=True)
class FilmLandmarks:
    """The landmarks of one face in a film.

    Attributes:
        path: the film.
        times: (F,) seconds from the first picture.
        rate: pictures per second.
        timecode: of the first picture, as the film writes it, if it has one.
        size: width and height of the pictures that were looked at, pixels.
        points: (F, 478, 3) as `Face.points`; NaN where the face was not found.
        probabilities: (F,) as `Face.probability`; 0 where it was not found.
        colors: (F, 478, 3) uint8, see `colors_at`; 0 where it was not found.
        lips: (F, SAMPLES, 3) uint8, see `colors_across`; 0 where it was not found; None = unknown.
    """

    path: Path
    times: Times
    rate: float
    timecode: str | None
    size: tuple[int, int]
    points: Doubles
    probabilities: Doubles
    colors: Pixels
    lips: Pixels | None = None

    @property
    def quarter_turns(self) -> int:
        """0..3: by how many the face is turned clockwise in the film, by most of its pictures."""
        right, left = (self.points[self.probabilities > 0, number, :2] for number in OUTER_EYES)
        across, down = np.median((left - right) / np.linalg.norm(left - right, axis=1)[:, None], 0)
        return round(math.atan2(down, across) / (math.pi / 2.0)) % 4

    @property
    def upright(self) -> Doubles:
        """(F, 478, 3) `points`, turned around the picture's middle until the face is upright."""
        turns = self.quarter_turns
        if not turns:
            return self.points
        cosine, sine = ((1, 0), (0, 1), (-1, 0), (0, -1))[turns]
        middle = 0.5 * np.array(self.size)
        points = self.points.copy()
        points[..., :2] = middle + (points[..., :2] - middle) @ np.array(
            [[cosine, -sine], [sine, cosine]]
        )
        return points


def read_landmarks(
    path: Path,
    landmarker: FaceLandmarker,
    report: Report = lambda progress: None,
    stopped: Callable[[], bool] | None = None,
    face: tuple[float, float] | None = None,
) -> FilmLandmarks:
    """Find one face in every picture of a film and follow it.

    Args:
        path: the film.
        landmarker: finds faces.
        report: is called after each picture.
        stopped: asked after each picture; True gives up.
        face: a place on the face to follow, as shares of the picture's width and height; None =
            the largest.

    Raises:
        FileError: it is not a film, is too slow or too large, or shows no face.
        Unavailable: PyAV is not installed.
        Abandoned: `stopped` returned True.
    """
    _check_kind(path)
    film = Film(path, stopped)
    rate = usual_rate(film.times)
    if len(film) < _FEWEST or rate < _SLOWEST:
        film.close()
        count = "1 picture" if len(film) == 1 else f"{len(film)} pictures"
        what = f"has {count}" if len(film) < _FEWEST else f"has {rate:.2g} pictures a second"
        raise FileError(
            path, f"{what}, too few for a take", f"use a film with {_SLOWEST:g} or more a second"
        )
    points = np.full((len(film), LANDMARKS, 3), np.nan)
    probabilities = np.zeros(len(film))
    colors = np.zeros((len(film), LANDMARKS, 3), np.uint8)
    lips = np.zeros((len(film), SAMPLES, 3), np.uint8)
    follower: _Follower | None = None
    try:
        for index in range(len(film)):
            check(stopped)
            picture = film.picture(index)
            if index < film.first:  # damaged: what is shown instead was not there yet
                continue
            image = Image.fromarray(np.ascontiguousarray(picture[..., 2::-1]))
            if follower is None:
                width, height = image.size
                place = None if face is None else (face[0] * width, face[1] * height)
                follower = _Follower(landmarker, place)
            found = follower.step(image)
            if found is not None:
                points[index], probabilities[index] = found.points, found.probability
                colors[index] = colors_at(image, found.points)
                lips[index] = colors_across(image, found.points)
            seen = None if found is None else found.points[:, :2]
            report(Progress("Finding the face", index + 1, len(film), picture, seen))
    finally:
        film.close()
    if not probabilities.any():
        raise FileError(path, "shows no face", "use a film in which a face looks at the camera")
    return FilmLandmarks(
        path,
        film.times,
        rate,
        film.timecode,
        image.size,
        points,
        probabilities,
        colors,
        lips,
    )


def usual_rate(times: Times) -> float:
    """Pictures per second, from their times (F,) in seconds; pauses of the camera do not count."""
    steps = np.diff(times)
    if not len(steps):
        return 0.0
    pauses = steps[steps > _PAUSE * float(np.median(steps))]
    shown = float(times[-1] - times[0]) - float(pauses.sum())
    return (len(steps) - len(pauses)) / shown


def _check_kind(path: Path) -> None:
    """Refuse photos, animated pictures and films that are too large."""
    with opened(path) as container:
        names = container.format.name.split(",")
        stream = film_stream(container)
        if any(name.endswith(_PICTURES) for name in names):
            raise FileError(path, "is a picture, not a film", "use a film, such as an MP4")
        side = max(stream.width, stream.height)
        if side > _LARGEST:
            raise FileError(
                path,
                f"has pictures of {stream.width} x {stream.height} pixels",
                f"make it smaller, {_LARGEST} pixels at most",
            )


class _Follower:
    """Follows one face from picture to picture, and looks for it when it was lost."""

    def __init__(self, landmarker: FaceLandmarker, place: tuple[float, float] | None) -> None:
        self._landmarker, self._place = landmarker, place
        self._square: Square | None = None  # where the face is in the next picture
        self._last: Square | None = None  # where it was before it was lost

    def step(self, image: Image.Image) -> Face | None:
        """The face in the next picture, or None."""
        face = None
        if self._square is not None:
            face = self._landmarker.landmarks(image, self._square)
        if face is None:
            face = self._look(image)
        self._square = None if face is None else Square.around(face.points)
        self._last = self._square or self._last
        return face

    def _look(self, image: Image.Image) -> Face | None:
        face = self._face_in(image, self._landmarker.faces(image))
        if face is None and (self._last is None or math.cos(self._last.angle) < 0):
            face = self._upside_down(image)
        if face is None:
            return None
        # Once more in the square around the landmarks, which is more exact.
        return self._landmarker.landmarks(image, Square.around(face.points)) or face

    def _face_in(self, image: Image.Image, squares: list[Square]) -> Face | None:
        """The face that is followed, in one of the squares, the largest first; or None."""
        last = self._last
        if last is not None:  # the same face again, not another one
            squares = [s for s in squares if s.distance_to(last.x, last.y) < _NEAR * last.size]
        elif self._place is not None:
            x, y = self._place
            squares.sort(key=lambda square: square.distance_to(x, y))
        face = self._landmarker.landmarks(image, squares[0]) if squares else None
        return face if face is not None and math.isfinite(face.probability) else None

    def _upside_down(self, image: Image.Image) -> Face | None:
        """A face that is upside down, which the networks do not find, or not where it is."""
        width, height = image.size
        squares = [
            Square(width - found.x, height - found.y, found.size, found.angle + math.pi)
            for found in self._landmarker.faces(image.transpose(Image.Transpose.ROTATE_180))
        ]
        face = self._face_in(image, squares)
        return face if face is not None and face.probability > _CERTAIN else None
