"""Film with landmarks, tracked face and edited face side by side (paper, "Edition of a video")."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw

from faceedit_app.core.arrays import Doubles, Floats, Indices, Pixels
from faceedit_app.core.rig import Rig
from faceedit_app.media.container import check
from faceedit_app.media.encode import write_film
from faceedit_app.media.film import Film
from faceedit_app.render.camera import default_camera
from faceedit_app.render.renderer import FaceRenderer, open_renderer
from faceedit_app.render.snapshot import write_png
from faceedit_app.tracking.drawing import STROKES, places_of
from faceedit_app.tracking.tracker import Tracked

HEIGHT = 480  # pixels of each picture
_ROWS = 4  # of the picture
_MARGIN = 1.6  # of the square around the face, in heights of the face
_SHARP = 2  # lines are drawn so many times as large and scaled down


def write_report(
    folder: Path,
    tracked: Tracked,
    rig: Rig,
    edited: Floats | None = None,
    stopped: Callable[[], bool] | None = None,
) -> tuple[Path, Path]:
    """Write `side_by_side.png`, four moments, and `side_by_side.mp4` into a folder.

    Args:
        folder: is made if it is missing.
        tracked: what was tracked.
        rig: the character.
        edited: (T, 52) in ARKit's order, the weights of `tracked.clip` after edits; None = only
            film and tracked face.
        stopped: True gives up.

    Returns:
        The two files.

    Raises:
        FileError: a file cannot be written or read.
        Unavailable: this computer offers no OpenGL, or no encoder.
        Abandoned: `stopped` returned True.
    """
    folder.mkdir(parents=True, exist_ok=True)
    frames = np.flatnonzero(tracked.sure)
    picture, film = folder / "side_by_side.png", folder / "side_by_side.mp4"
    with _Columns(tracked, rig, edited) as columns:
        rows = [columns.row(int(row)) for row in _moments(tracked, rig)]
        write_png(picture, np.concatenate(rows))

        def pictures() -> Iterator[Pixels]:
            for row in range(len(frames)):
                check(stopped)
                yield columns.row(row)

        times = tracked.landmarks.times[frames]
        write_film(film, pictures(), times - times[0], tracked.landmarks.rate)
    return picture, film


def draw_landmarks(image: Image.Image, points: Doubles) -> Image.Image:
    """A picture with the landmarks (478, 2 or 3), pixels, drawn over it."""
    width, height = image.size
    large = image.resize((width * _SHARP, height * _SHARP), Image.Resampling.BICUBIC)
    draw = ImageDraw.Draw(large)
    for stroke in STROKES:
        places = [(x * _SHARP, y * _SHARP) for x, y in places_of(points, stroke).tolist()]
        draw.line(places, fill=stroke.color, width=_SHARP)
        if stroke.is_control:
            for x, y in places:
                radius = 2 * _SHARP
                box = (x - radius, y - radius, x + radius, y + radius)
                draw.ellipse(box, fill=stroke.color)
    return large.resize((width, height), Image.Resampling.LANCZOS)


def _moments(tracked: Tracked, rig: Rig) -> Indices:
    """The frames of the picture: the lips shut and most open, and others spread between."""
    opening = rig.controls(rig.from_arkit(tracked.weights[tracked.sure].astype(np.float32)))[:, 0]
    order = np.argsort(opening, kind="stable")
    chosen = order[np.linspace(0, len(order) - 1, min(_ROWS, len(order))).astype(int)]
    return np.sort(chosen).astype(np.intp)


class _Columns:
    """Draws the columns of one frame; frames are those that are sure."""

    def __init__(self, tracked: Tracked, rig: Rig, edited: Floats | None) -> None:
        self._tracked, self._rig = tracked, rig
        self._frames = np.flatnonzero(tracked.sure)
        weights = tracked.clip.weights
        self._faces = [weights] if edited is None else [weights, edited]
        self._film = Film(tracked.landmarks.path)
        self._square = _square(tracked.landmarks.points[self._frames])
        self._renderer: FaceRenderer | None = None

    def __enter__(self) -> _Columns:
        self._renderer = open_renderer(self._rig, HEIGHT, HEIGHT)
        return self

    def __exit__(self, *_: object) -> None:
        self._film.close()
        if self._renderer is not None:
            self._renderer.close()

    def row(self, row: int) -> Pixels:
        """(HEIGHT, n HEIGHT, 3): film with landmarks, tracked and edited face."""
        index = int(self._frames[row])
        film = Image.fromarray(np.ascontiguousarray(self._film.picture(index)[..., 2::-1]))
        x, y, half = self._square
        box = (x - half, y - half, x + half, y + half)
        # Beyond the picture's edge it is black.
        cut = film.transform(
            (HEIGHT, HEIGHT), Image.Transform.EXTENT, box, Image.Resampling.BICUBIC
        )
        points = (self._tracked.landmarks.points[index, :, :2] - (x - half, y - half)) * (
            HEIGHT / (2 * half)
        )
        return np.concatenate(
            [np.asarray(draw_landmarks(cut, points)), *(self._face(w[row]) for w in self._faces)],
            axis=1,
        )

    def _face(self, weights: Floats) -> Pixels:
        assert self._renderer is not None
        vertices = self._rig.vertices(self._rig.from_arkit(weights))
        drawn = self._renderer.draw(vertices, default_camera(self._rig))
        return np.ascontiguousarray(drawn[..., 2::-1])


def _square(points: Doubles) -> tuple[float, float, float]:
    """Middle and half the side of a square around a face (T, 478, 3), which stays still."""
    low, high = points[..., :2].min(axis=1), points[..., :2].max(axis=1)
    x, y = np.median((low + high) / 2.0, axis=0).tolist()
    return x, y, float(np.median((high - low)[:, 1])) * _MARGIN / 2.0
