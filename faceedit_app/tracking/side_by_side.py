"""Film with landmarks, tracked face and edited face side by side (paper, "Edition of a video")."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw

from faceedit_app.core.arrays import Bools, Doubles, Floats, Indices, Pixels, Times
from faceedit_app.core.clip import Clip
from faceedit_app.core.rig import Rig
from faceedit_app.media.container import check, has_sound
from faceedit_app.media.film import Film
from faceedit_app.media.film_writer import Soundtrack, film_format, writing
from faceedit_app.media.sound import read_sound
from faceedit_app.render.camera import default_camera
from faceedit_app.render.renderer import FaceRenderer, open_renderer
from faceedit_app.render.snapshot import write_png
from faceedit_app.tracking.drawing import DRAWN, STROKES, places_of
from faceedit_app.tracking.landmark_file import StoredLandmarks
from faceedit_app.tracking.tracker import Tracked

HEIGHT = 480  # pixels of each picture
_ROWS = 4  # of the picture
_MARGIN = 3.2  # of the square around the face, in heights from the brows to the lower lip
_GAP = 0.35  # how bright the face is while the film shows none
_SHARP = 2  # lines are drawn so many times as large and scaled down


@dataclass(frozen=True)
class SideBySide:
    """What is shown side by side, for each of the F pictures of a film.

    Attributes:
        film: the film.
        places: the landmarks (478, 2) in a picture by its number, shares of its width and height;
            None if it shows no face.
        rows: (F,) the frame of the take.
        sure: (F,) whether the take has that frame; else it is the nearest one.
        faces: weights (T, 52) in ARKit's order: tracked and, if there are edits, edited.
    """

    film: Path
    places: Callable[[int], Doubles | None]
    rows: Indices
    sure: Bools
    faces: tuple[Floats, ...]

    @classmethod
    def of_tracked(cls, tracked: Tracked, edited: Floats | None = None) -> SideBySide:
        """What was tracked, and the weights of `tracked.clip` after edits."""
        film = tracked.landmarks

        def places(index: int) -> Doubles | None:
            points = film.points[index, :, :2] / film.size
            return points if np.isfinite(points[0, 0]) else None

        clip, times = tracked.clip, film.times
        return cls._of(film.path, places, clip, times, edited)

    @classmethod
    def of_take(
        cls, film: Film, stored: StoredLandmarks, clip: Clip, offset: float, edited: Floats
    ) -> SideBySide:
        """An open take.

        Args:
            film, offset: its film, which begins at `offset` seconds of the take.
            stored: the landmarks beside it.
            clip: as tracked, whose times begin with its first frame.
            edited: (T, 52) as edited.
        """
        return cls._of(film.path, stored.at, clip, film.times + offset, edited)

    @classmethod
    def _of(
        cls,
        film: Path,
        places: Callable[[int], Doubles | None],
        clip: Clip,
        times: Times,
        edited: Floats | None,
    ) -> SideBySide:
        """`times` (F,) of the pictures on the clip's clock."""
        rows = np.array([clip.frame_at(seconds) for seconds in times.tolist()], np.intp)
        sure = np.abs(clip.times[rows] - times) < 0.75 / clip.rate
        tracked = clip.arkit_weights()
        changed = edited is not None and not np.array_equal(edited, tracked)
        faces = (tracked, edited) if edited is not None and changed else (tracked,)
        return cls(film, places, rows, sure, faces)


def write_side_by_side(
    output: Path,
    shown: SideBySide,
    rig: Rig,
    progress: Callable[[int, int], None] = lambda done, of: None,
    stopped: Callable[[], bool] | None = None,
) -> tuple[Path, Path]:
    """Write an MP4 with the film's sound and, beside it, a PNG of four moments.

    Args:
        output: the MP4.
        shown: what is shown.
        rig: the character.
        progress: called with the number of pictures that are done, and of all.
        stopped: True gives up, and nothing is written.

    Returns:
        The picture and the film.

    Raises:
        FileError: a file cannot be written or read.
        Unavailable: this computer offers no OpenGL, or no encoder.
        Abandoned: `stopped` returned True.
    """
    picture = output.with_suffix(".png")
    with _Columns(shown, rig) as columns:
        rows = [columns.picture(index) for index in _moments(shown, rig)]
        size, rate = (rows[0].shape[1], rows[0].shape[0]), columns.film.rate
        with writing(output, film_format(output), size, rate, _sound(shown.film)) as out:
            count = round(columns.film.duration * rate)
            for number in range(count):
                check(stopped)
                out.add(columns.picture(columns.film.index_at(number / rate)))
                progress(number + 1, count)
        write_png(picture, np.concatenate(rows))
    return picture, output


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


def _sound(film: Path) -> Soundtrack | None:
    sound = read_sound(film) if has_sound(film) else None
    return None if sound is None else Soundtrack(sound)


def _moments(shown: SideBySide, rig: Rig) -> list[int]:
    """The pictures of the PNG: the lips shut and most open, and others spread between."""
    pictures = np.flatnonzero(shown.sure)
    opening = rig.arkit_distances.measure(shown.faces[0][shown.rows[pictures]])[:, 0]
    order = np.argsort(opening, kind="stable")
    chosen = order[np.linspace(0, len(order) - 1, _ROWS).astype(int)]
    moments: list[int] = pictures[np.sort(chosen)].tolist()
    return moments


class _Columns:
    """Draws the columns of any picture of the film.

    Attributes:
        film: the film.
    """

    def __init__(self, shown: SideBySide, rig: Rig) -> None:
        self._shown, self._rig = shown, rig
        self.film = Film(shown.film)
        self._square: tuple[float, float, float] | None = None
        self._renderer: FaceRenderer | None = None

    def __enter__(self) -> _Columns:
        self._renderer = open_renderer(self._rig, HEIGHT, HEIGHT)
        return self

    def __exit__(self, *_: object) -> None:
        self.film.close()
        if self._renderer is not None:
            self._renderer.close()

    def picture(self, index: int) -> Pixels:
        """(HEIGHT, n HEIGHT, 3): film with landmarks, tracked and edited face."""
        shown = self._shown
        # In a gap the nearest face is shown, darkened.
        shade = 1.0 if shown.sure[index] else _GAP
        faces = [self._face(weights[shown.rows[index]], shade) for weights in shown.faces]
        return np.concatenate([self._seen(index), *faces], axis=1)

    def _seen(self, index: int) -> Pixels:
        film = Image.fromarray(np.ascontiguousarray(self.film.picture(index)[..., 2::-1]))
        if self._square is None:
            self._square = _square(self._shown, film.size)
        x, y, half = self._square
        box = (x - half, y - half, x + half, y + half)
        cut = film.transform(
            (HEIGHT, HEIGHT), Image.Transform.EXTENT, box, Image.Resampling.BICUBIC
        )
        places = self._shown.places(index)
        if places is not None:
            points = places * film.size - (x - half, y - half)
            cut = draw_landmarks(cut, points * (HEIGHT / (2 * half)))
        return np.asarray(cut)

    def _face(self, weights: Floats, shade: float) -> Pixels:
        assert self._renderer is not None
        vertices = self._rig.vertices(self._rig.from_arkit(weights))
        drawn = self._renderer.draw(vertices, default_camera(self._rig))
        return (drawn[..., 2::-1] * shade).astype(np.uint8)


def _square(shown: SideBySide, size: tuple[int, int]) -> tuple[float, float, float]:
    """Middle and half the side of a square around the face, pixels, which stays still.

    It lies within the picture.
    """
    seen = [shown.places(int(index)) for index in np.flatnonzero(shown.sure)]
    places = np.stack([one[list(DRAWN)] for one in seen if one is not None]) * size
    low, high = places.min(axis=1), places.max(axis=1)
    x, y = np.median((low + high) / 2.0, axis=0).tolist()
    half = min(float(np.median((high - low)[:, 1])) * _MARGIN, *size) / 2.0
    x, y = (min(max(at, half), side - half) for at, side in zip((x, y), size, strict=True))
    return x, y, half
