"""Landmarks in every picture of a film."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from PIL import Image

from faceedit_app.core.arrays import Doubles, Pixels, Times
from faceedit_app.core.errors import FileError
from faceedit_app.formats.timing import counted
from faceedit_app.media.container import check, film_stream, opened
from faceedit_app.media.film import BEHIND, Film
from faceedit_app.tracking.following import CERTAIN, Follower
from faceedit_app.tracking.hidden import colors_at
from faceedit_app.tracking.landmarker import LANDMARKS, OUTER_EYES, FaceLandmarker, FaceLandmarks
from faceedit_app.tracking.lips import SAMPLES, colors_across

_SLOWEST = 8.0  # pictures per second; speech has closures of a tenth of a second
_FEWEST = 8
_LARGEST = 4096  # pixels of the longest side
_PICTURES = ("image2", "gif", "apng", "webp_pipe", "_pipe")
_RIVAL = 1 / 3  # of the largest face's height; who is smaller is in the background
_PAUSE = 8.0  # times the usual step between pictures


@dataclass(frozen=True)
class Progress:
    """How far tracking is, for the user.

    Attributes:
        pass_: what is being done.
        done, of: pictures.
        picture: (H, W, 4) BGRA, the one just seen, if any.
        points: (478, 2) its landmarks in pixels, if it shows a face.
        seconds: its time in the film.
    """

    pass_: str
    done: int
    of: int
    picture: Pixels | None = None
    points: Doubles | None = None
    seconds: float = 0.0


Report = Callable[[Progress], None]


@dataclass(frozen=True)
class Faces:
    """Several faces in the first picture with one, for the user to choose from.

    Attributes:
        picture: (H, W, 4) BGRA.
        boxes: (n, 4) shares of its width and height: left, top, right and bottom of each face, the
            largest first.
    """

    picture: Pixels
    boxes: Doubles


Choose = Callable[[Faces], int]  # says which of the faces to follow


@dataclass(frozen=True)
class FilmLandmarks:
    """The landmarks of one face in a film.

    Attributes:
        path: the film.
        times: (F,) seconds from the first picture.
        rate: pictures per second.
        timecode: of the first picture, as the film writes it, if it has one.
        size: width and height of the pictures that were looked at, pixels.
        points: (F, 478, 3) as `FaceLandmarks.points`; NaN where the face was not found.
        probabilities: (F,) as `FaceLandmarks.probability`; 0 where it was not found.
        colors: (F, 478, 3) uint8, see `colors_at`; 0 where it was not found.
        lips: (F, SAMPLES, 3) uint8, see `colors_across`; 0 where it was not found; None = unknown.
        damaged: the number of pictures that could not be read, and show no face therefore.
        remarks: as `Film.remarks`.
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
    remarks: tuple[str, ...] = ()
    damaged: int = 0

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


@dataclass(frozen=True)
class Chosen:
    """A place on the face to follow.

    Attributes:
        x, y: shares of the picture's width and height.
        seconds: when the face is there; None = in the first picture with a face there.
    """

    x: float
    y: float
    seconds: float | None = None


class NoFaceThere(FileError):
    """The picture shows no face at the chosen place."""

    def __init__(self, path: Path, face: Chosen) -> None:
        when = "" if face.seconds is None else f" after {face.seconds:.2f} s"
        where = f"shows no face at {face.x:.2f},{face.y:.2f}{when}"
        super().__init__(path, where, "choose a place on a face, or none")


def read_landmarks(
    path: Path,
    landmarker: FaceLandmarker,
    report: Report = lambda progress: None,
    stopped: Callable[[], bool] | None = None,
    face: Chosen | None = None,
    choose: Choose | None = None,
) -> FilmLandmarks:
    """Find one face in every picture of a film and follow it.

    Args:
        path: the film.
        landmarker: finds faces.
        report: is called after each picture.
        stopped: asked after each picture; True gives up.
        face: the face to follow; None = the largest in the first picture with one.
        choose: is asked instead if that picture has several, unless `face` says it.

    Raises:
        NoFaceThere: there is no face at the chosen place.
        FileError: it is not a film, is too slow or too large, or shows no face.
        Unavailable: PyAV is not installed.
        Abandoned: `stopped` returned True.
    """
    check_kind(path)
    film = Film(path, stopped)
    rate = usual_rate(film.times)
    if len(film) < _FEWEST or rate < _SLOWEST:
        film.close()
        what, least = f"has {rate:.2g} pictures a second", f"{_SLOWEST:g} or more a second"
        if len(film) < _FEWEST:
            what, least = f"has {counted(len(film), 'picture')}", f"{_FEWEST} pictures or more"
        raise FileError(path, f"{what}, too few for a take", f"use a film with {least}")
    seeing = _Seeing(film, landmarker, face, choose, rate)
    try:
        for done, index in enumerate(seeing.order, 1):
            check(stopped)
            picture = seeing.look(index)
            if picture is not None:
                points = seeing.seen.points[index, :, :2] if seeing.has_face(index) else None
                seconds = float(film.times[index])
                report(Progress("Finding the face", done, len(film), picture, points, seconds))
    finally:
        film.close()
    if not seeing.seen.probabilities.any():
        if face is not None:
            raise NoFaceThere(path, face)
        why = f" ({film.remarks[0]})" if film.remarks else ""
        raise FileError(
            path, f"shows no face{why}", "use a film in which a face looks at the camera"
        )
    return replace(seeing.seen, damaged=len(film.damaged))


class _Seeing:
    """What was seen so far in the pictures of a film.

    Attributes:
        seen: all of it, up to the picture that was looked at last.
        order: (F,) in which order the pictures are looked at.
    """

    def __init__(
        self,
        film: Film,
        landmarker: FaceLandmarker,
        face: Chosen | None,
        choose: Choose | None,
        rate: float,
    ) -> None:
        self._film, self._landmarker, self._face = film, landmarker, face
        self._choose, self._is_open = choose, face is None  # which face to follow
        self._follower: Follower | None = None
        self._is_chosen_here = face is not None and face.seconds is not None  # in the first picture
        first = 0 if face is None or face.seconds is None else film.index_at(face.seconds)
        self._first, count = first, len(film)
        # From the picture in which it was chosen to the end, and then back to the beginning.
        self.order = [*range(first, count), *range(first - 1, -1, -1)]
        self.seen = FilmLandmarks(
            film.path,
            film.times,
            rate,
            film.timecode,
            (0, 0),
            np.full((count, LANDMARKS, 3), np.nan),
            np.zeros(count),
            np.zeros((count, LANDMARKS, 3), np.uint8),
            np.zeros((count, SAMPLES, 3), np.uint8),
            film.remarks,
        )

    def has_face(self, index: int) -> bool:
        """Whether the face was found in a picture."""
        return bool(self.seen.probabilities[index] > 0)

    def look(self, index: int) -> Pixels | None:
        """Look for the face in a picture; return the picture, or None if it is damaged.

        Raises:
            NoFaceThere: this is where the face was chosen, and there is none.
        """
        is_back = index < self._first
        picture = self._film.picture(index, BEHIND if is_back else 0)
        if index in self._film.damaged:  # what is shown instead is of another moment
            return None
        image = Image.fromarray(np.ascontiguousarray(picture[..., 2::-1]))
        if self._follower is None:
            self._follower = self._started(*image.size)
        if index == self._first - 1 and self.has_face(self._first):
            self._follower.go_on_from(self.seen.points[self._first])
        found = self._follower.step(image)
        if found is not None and self._is_open:
            self._is_open = False
            found = self._chosen(picture, image) or found
        if found is not None:
            seen, points = self.seen, found.points
            seen.points[index], seen.probabilities[index] = points, found.probability
            seen.colors[index] = colors_at(image, points)
            assert seen.lips is not None
            seen.lips[index] = colors_across(image, points)
        elif self._face is not None and self._is_chosen_here and index == self._first:
            raise NoFaceThere(self._film.path, self._face)
        return picture

    def _chosen(self, picture: Pixels, image: Image.Image) -> FaceLandmarks | None:
        """The face that the user chooses, if a picture has several; else None."""
        boxes = boxes_of_faces(image, self._landmarker)
        if len(boxes) < 2:
            return None
        if self._choose is None:
            said = f"it shows {len(boxes)} faces: the largest was followed, as no place was given"
            self.seen = replace(self.seen, remarks=(*self.seen.remarks, said))
            return None
        left, top, right, bottom = boxes[self._choose(Faces(picture, boxes))].tolist()
        place = (left + right) / 2.0 * image.width, (top + bottom) / 2.0 * image.height
        self._follower = Follower(self._landmarker, place)
        return self._follower.step(image)

    def _started(self, width: int, height: int) -> Follower:
        self.seen = replace(self.seen, size=(width, height))
        face = self._face
        place = None if face is None else (face.x * width, face.y * height)
        return Follower(self._landmarker, place)


def boxes_of_faces(image: Image.Image, landmarker: FaceLandmarker) -> Doubles:
    """(n, 4) the faces of a picture that may be the one to follow, as `Faces.boxes`."""
    found = [landmarker.landmarks(image, square) for square in landmarker.faces(image)]
    points = [face.points[:, :2] for face in found if face and face.probability > CERTAIN]
    boxes = np.array([(*some.min(axis=0), *some.max(axis=0)) for some in points]).reshape(-1, 4)
    boxes /= (*image.size, *image.size)
    tall = boxes[:, 3] - boxes[:, 1]
    order = np.argsort(-tall, kind="stable")
    faces: Doubles = boxes[order[tall[order] >= _RIVAL * tall.max(initial=0.0)]]
    return faces


def usual_rate(times: Times) -> float:
    """Pictures per second, from their times (F,) in seconds; pauses of the camera do not count."""
    steps = np.diff(times)
    if not len(steps):
        return 0.0
    pauses = steps[steps > _PAUSE * float(np.median(steps))]
    shown = float(times[-1] - times[0]) - float(pauses.sum())
    return (len(steps) - len(pauses)) / shown


def check_kind(path: Path) -> None:
    """Refuse photos, animated pictures and films that are too large; quick enough to wait for.

    Raises:
        FileError: it is one of them, or cannot be read as a film.
        Unavailable: PyAV is not installed.
    """
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
