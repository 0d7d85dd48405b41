"""Film with landmarks, tracked face and edited face side by side (paper, "Edition of a video")."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw

from faceedit_app.core import on_disk
from faceedit_app.core.arrays import Doubles, Floats, Pixels
from faceedit_app.core.atomic import keep_inputs
from faceedit_app.core.clip import Clip
from faceedit_app.core.errors import FileError
from faceedit_app.core.head import Head
from faceedit_app.core.rig import Rig
from faceedit_app.media.container import check, has_sound
from faceedit_app.media.film import Film
from faceedit_app.media.film_writer import Soundtrack, film_format, writing
from faceedit_app.media.sound import read_sound
from faceedit_app.render.camera import default_camera
from faceedit_app.render.renderer import FaceRenderer, open_renderer
from faceedit_app.render.snapshot import write_png
from faceedit_app.tracking.drawing import DRAWN, STROKES, places_of
from faceedit_app.tracking.film_landmarks import usual_rate
from faceedit_app.tracking.landmark_file import StoredLandmarks
from faceedit_app.tracking.moments import Column, moments, sheet
from faceedit_app.tracking.tracker import Tracked

HEIGHT = 480  # pixels of each picture
_FASTEST = 120.0  # pictures a second that are written
_MARGIN = 3.2  # of the square around the face, in heights from the brows to the lower lip
_GAP = 0.35  # how bright the face is while the film shows none
_KEPT = 4  # faces that were drawn last
_AROUND = 4  # pixels around the landmarks that are drawn
_SHARP = 2  # lines are drawn so many times as large and scaled down


@dataclass(frozen=True)
class SideBySide:
    """What is shown side by side, for each of the F pictures of a film.

    Attributes:
        film: the film.
        places: the landmarks (478, 2) in a picture by its number, shares of its width and height;
            None if it shows no face, or is a gap.
        faces: as tracked and, if there are edits, as edited.
        offset: seconds of the take at which the film begins.
    """

    film: Path
    places: Callable[[int], Doubles | None]
    faces: tuple[Column, ...]
    offset: float = 0.0

    @classmethod
    def of_tracked(cls, tracked: Tracked, edited: Clip | None = None) -> SideBySide:
        """What was tracked, and the take after edits, whose times begin with its first frame."""
        film, clip = tracked.landmarks, tracked.clip

        def places(index: int) -> Doubles | None:
            return film.points[index, :, :2] / film.size if tracked.sure[index] else None

        faces = [Column.of(clip, film.times)]
        if edited is not None:
            faces.append(Column.of(edited, film.times - clip.times[0]))
        return cls(film.path, places, tuple(faces), -float(clip.times[0]))

    @classmethod
    def of_take(
        cls,
        film: Film,
        stored: StoredLandmarks,
        tracked: Clip,
        edited: Clip,
        offset: float,
        follows_head: bool = False,
    ) -> SideBySide:
        """An open take.

        Args:
            film: its film, which begins at `offset` seconds of the take.
            stored: the landmarks beside it.
            tracked: whose times begin with its first frame.
            edited: the same after edits, with the frames that fill its gaps.
            offset: as above.
            follows_head: turn the heads as the take says, as the viewport does.

        Raises:
            FileError: the film is shown before or after the take only.
        """
        times = film.times + offset
        face, after = (Column.of(clip, times, follows_head) for clip in (tracked, edited))
        if not face.is_there.any():
            raise FileError(film.path, "shows nothing of the take", "move the film in time")
        same = np.array_equal(face.weights, after.weights)  # False if gaps were filled
        if face.turns is not None and after.turns is not None:
            same = same and np.array_equal(face.turns, after.turns)
        return cls(film.path, stored.at, (face,) if same else (face, after), offset)


def check_names(output: Path, inputs: Iterable[Path]) -> None:
    """Make sure that nothing is lost where an MP4 and the PNG beside it are written.

    Args:
        output: the MP4; if it is there, it is to be replaced, and so is its PNG.
        inputs: files that are read.

    Raises:
        FileError: one of the inputs, or a PNG that belongs to no such MP4, would be.
    """
    picture = output.with_suffix(".png")
    keep_inputs((output, picture), inputs)
    if on_disk.exists(picture) and not on_disk.exists(output):
        problem = f"is there already, and {output.name} comes with a picture of that name"
        raise FileError(picture, problem, "choose another name")


def write_side_by_side(
    output: Path,
    shown: SideBySide,
    rig: Rig,
    progress: Callable[[int, int], None] = lambda done, of: None,
    stopped: Callable[[], bool] | None = None,
) -> tuple[Path, tuple[Path | None, ...]]:
    """Write an MP4 with the film's sound and, beside it, a PNG of four moments.

    Args:
        output: the MP4.
        shown: what is shown.
        rig: the character.
        progress: called with the number of pictures that are done, and of all.
        stopped: True gives up, and nothing is written.

    Returns:
        The picture, and the copies that were kept of files of other kinds.

    Raises:
        FileError: a file cannot be written or read.
        Unavailable: this computer offers no OpenGL, or no encoder.
        Abandoned: `stopped` returned True.
    """
    picture = output.with_suffix(".png")
    with _Columns(shown, rig) as columns:
        found = moments(shown.faces[0], shown.faces[-1], columns.film.times, rig)
        rows = [columns.picture(index) for index in found]
        rate, numbers = _shown_pictures(columns.film)
        size = rows[0].shape[1], rows[0].shape[0]
        with writing(output, film_format(output), size, rate, _sound(shown.film)) as out:
            for done, number in enumerate(numbers, 1):
                check(stopped)
                out.add(columns.picture(number))
                progress(done, len(numbers))
        times = [float(columns.film.times[index]) + shown.offset for index in found]
        backup = write_png(picture, sheet(rows, times))
    return picture, (out.backup, backup)


def draw_landmarks(image: Image.Image, points: Doubles) -> Image.Image:
    """A picture with the landmarks (478, 2 or 3), pixels, drawn over it."""
    # Only the part of the picture where they are is scaled, which takes long.
    low = np.floor(points[list(DRAWN), :2].min(axis=0)).astype(int) - _AROUND
    high = np.ceil(points[list(DRAWN), :2].max(axis=0)).astype(int) + _AROUND
    low, high = np.maximum(low, 0), np.minimum(high, image.size)
    if (low >= high).any():
        return image
    box = (*low.tolist(), *high.tolist())
    part = image.crop(box)
    width, height = part.size
    large = part.resize((width * _SHARP, height * _SHARP), Image.Resampling.BICUBIC)
    draw = ImageDraw.Draw(large)
    for stroke in STROKES:
        places = [tuple(place) for place in (_SHARP * (places_of(points, stroke) - low)).tolist()]
        draw.line(places, fill=stroke.color, width=_SHARP)
        if stroke.is_control:
            for x, y in places:
                radius = 2 * _SHARP
                draw.ellipse((x - radius, y - radius, x + radius, y + radius), fill=stroke.color)
    drawn = image.copy()
    drawn.paste(large.resize((width, height), Image.Resampling.LANCZOS), box[:2])
    return drawn


def _sound(film: Path) -> Soundtrack | None:
    sound = read_sound(film) if has_sound(film) else None
    return None if sound is None else Soundtrack(sound)


def _shown_pictures(film: Film) -> tuple[float, list[int]]:
    """A rate at which pictures at even times show all those of a film, which may be uneven.

    Returns:
        Pictures per second, and the number of the picture that each of them shows.
    """
    shortest = float(np.diff(film.times).min(initial=1.0))
    rates = (film.rate, usual_rate(film.times), min(1.0 / shortest, _FASTEST))
    for rate in rates:
        count = round(film.duration * rate)
        shown = [film.index_at(number / rate) for number in range(count)]
        if len(set(shown)) == len(film):
            break
    return rate, shown


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
        self._head = Head(rig)
        self._drawn: dict[bytes, Pixels] = {}  # faces, by their weights and how they are turned
        self._last: tuple[int, Pixels] | None = None  # the picture that was drawn last

    def __enter__(self) -> _Columns:
        self._renderer = open_renderer(self._rig, HEIGHT, HEIGHT)
        return self

    def __exit__(self, *_: object) -> None:
        self.film.close()
        if self._renderer is not None:
            self._renderer.close()

    def picture(self, index: int) -> Pixels:
        """(HEIGHT, n HEIGHT, 3): film with landmarks, tracked and edited face."""
        if self._last is not None and self._last[0] == index:  # an uneven film shows it for long
            return self._last[1]
        columns = [self._seen(index)]
        for face in self._shown.faces:
            row = face.rows[index]
            turn = None if face.turns is None else face.turns[row]
            drawn = self._face(face.weights[row], turn)
            # In a gap the nearest face is shown, darkened.
            shade = 1.0 if face.is_there[index] else _GAP
            columns.append((drawn * shade).astype(np.uint8))
        self._last = index, np.concatenate(columns, axis=1)
        return self._last[1]

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

    def _face(self, weights: Floats, turn: Floats | None) -> Pixels:
        """(HEIGHT, HEIGHT, 3) of weights (52,) in ARKit's order, and rotations (9,), radians."""
        key = weights.tobytes() + (b"" if turn is None else turn.tobytes())
        # Most of a take is not edited: there the faces are the same.
        if key not in self._drawn:
            assert self._renderer is not None
            vertices = self._rig.vertices(self._rig.from_arkit(weights))
            if turn is not None:
                vertices = self._head.turned(vertices, turn)
            drawn = self._renderer.draw(vertices, default_camera(self._rig))
            if len(self._drawn) == _KEPT:
                self._drawn.pop(next(iter(self._drawn)))
            self._drawn[key] = drawn[..., 2::-1].copy()
        return self._drawn[key]


def _square(shown: SideBySide, size: tuple[int, int]) -> tuple[float, float, float]:
    """Middle and half the side of a square around the face, pixels, which stays still.

    It lies within the picture.
    """
    seen = [shown.places(int(index)) for index in np.flatnonzero(shown.faces[0].is_there)]
    places = np.stack([one[list(DRAWN)] for one in seen if one is not None]) * size
    low, high = places.min(axis=1), places.max(axis=1)
    x, y = np.median((low + high) / 2.0, axis=0).tolist()
    half = min(float(np.median((high - low)[:, 1])) * _MARGIN, *size) / 2.0
    x, y = (min(max(at, half), side - half) for at, side in zip((x, y), size, strict=True))
    return x, y, half
