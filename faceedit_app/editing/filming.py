"""Film a take: the face, both faces, or the face with the take's film, with the take's sound."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import ExitStack, closing
from dataclasses import dataclass, replace
from enum import StrEnum
from pathlib import Path

import numpy as np
from PIL import Image

from faceedit_app import render
from faceedit_app.core.arrays import Floats, Pixels
from faceedit_app.core.atomic import keep_inputs
from faceedit_app.core.clip import Clip
from faceedit_app.core.errors import FaceEditError
from faceedit_app.core.head import Head
from faceedit_app.core.resample import at_rate
from faceedit_app.core.rig import Rig
from faceedit_app.editing.edits.media import MediaFile, Placement
from faceedit_app.editing.files.originals import is_replaced
from faceedit_app.editing.session import EditSession
from faceedit_app.formats.converting import with_filled
from faceedit_app.formats.take import Take, have_faces
from faceedit_app.formats.timecode import start_of_day, time_of_day
from faceedit_app.media import beside, offset_by_clock
from faceedit_app.media.container import Abandoned
from faceedit_app.media.film import Film
from faceedit_app.media.film_writer import FilmFormat, Soundtrack, film_format, writing
from faceedit_app.media.sound import read_sound

_BACKGROUND = (0x25, 0x28, 0x2F)  # around a film that does not fill its half


class FilmView(StrEnum):
    """What a film shows."""

    FACE = "face"  # the edited face
    BOTH = "both"  # the tracked face, and the edited one
    FILM = "film"  # the take's film, and beside it the edited face
    FILM_ABOVE = "film-above"  # the take's film above the edited face
    FILM_BELOW = "film-below"  # the take's film below the edited face

    @property
    def has_film(self) -> bool:
        """Whether the take's film is shown."""
        return self in (FilmView.FILM, FilmView.FILM_ABOVE, FilmView.FILM_BELOW)

    def room(self, size: tuple[int, int]) -> tuple[int, int]:
        """Width and height of the edited face in a picture of this size."""
        width, height = size
        if self is FilmView.FACE:
            return width, height
        return (
            (width // 2, height) if self in (FilmView.BOTH, FilmView.FILM) else (width, height // 2)
        )


@dataclass(frozen=True)
class Shot:
    """How a take is filmed.

    Attributes:
        view: what is shown.
        size: width and height of the film, pixels.
        rate: pictures per second; None = the take's frame rate.
        form: `FilmFormat.key`; None = by the file's ending.
        camera: None = a portrait from the front.
        has_sound: whether to add the take's sound.
        mirrored: the take's film is mirrored.
        overwrite: allow a recording to be replaced; a copy of it is kept.
        follows_head: turn the head as it was recorded.
    """

    view: FilmView = FilmView.FACE
    size: tuple[int, int] = (1080, 1080)
    rate: float | None = None
    form: str | None = None
    camera: render.Camera | None = None
    has_sound: bool = True
    mirrored: bool = False
    overwrite: bool = False
    follows_head: bool = False


@dataclass(frozen=True)
class Filmed:
    """What was written.

    Attributes:
        path: the film.
        form: its format.
        frames: the number of pictures.
        rate: pictures per second.
        codecs: the names of its encoders.
        size: its width and height, pixels; even, as encoders want them.
        backup: the copy of a file that was no film, and that it replaced; None if there was none.
    """

    path: Path
    form: FilmFormat
    frames: int
    rate: float
    codecs: str
    size: tuple[int, int]
    backup: Path | None = None


def media_of(take: Take, sound: Path | None = None, film: Path | None = None) -> Placement:
    """The sound and film of a take, placed by their clocks, if they have one.

    Args:
        sound, film: the files; None = those found beside the take.

    Raises:
        FileError: one of them cannot be read.
    """
    found_sound, found_film = beside(take.path.absolute())
    film = film or found_film
    sound = sound or (found_sound if film is None or film == found_film else None)
    heard = sound or film
    codes = take.clip.timecodes
    began = start_of_day(codes) if codes else None
    placed: dict[Path, MediaFile] = {}
    if film is not None:
        item = Film(film)
        code = item.timecode
        begins = None if code is None else time_of_day(code, round(item.rate))
        placed[film] = MediaFile(film, offset_by_clock(began, begins, item.duration, take.lead))
        item.close()
    if heard is not None and heard not in placed:
        track = read_sound(heard)
        at = 0.0 if track is None else offset_by_clock(began, track.began, track.end, take.lead)
        placed[heard] = MediaFile(heard, at)
    return Placement(placed[heard] if heard else None, placed[film] if film else None)


def film_take(
    take: Take,
    weights: Floats,
    rig: Rig,
    media: Placement,
    path: Path,
    shot: Shot | None = None,
    progress: Callable[[int, int], None] = lambda done, all_: None,
    stopped: Callable[[], bool] = lambda: False,
    rotations: Floats | None = None,
) -> Filmed | None:
    """Film a take.

    Args:
        take: the take.
        weights: (T, 52) in ARKit order, as edited.
        rig: the character.
        media: the take's sound and film.
        path: the file to write, or a folder for pictures.
        shot: how.
        progress: called with the number of pictures that are done, and of all.
        stopped: asked before each picture; True gives up, and nothing is written.
        rotations: (T, 9) radians, as edited; None = as tracked.

    Returns:
        What was written; None if `stopped` said so.

    Raises:
        FileError: a file cannot be read or written, or is a recording.
        Unavailable: this computer offers no OpenGL, or no encoder.
        FaceEditError: there is no film to show with the face.
    """
    shot = shot or Shot()
    form = film_format(path, shot.form)
    if shot.view.has_film and media.film is None:
        raise FaceEditError(
            f"{take.path}: has no film to show with the face; add one, or film the face alone"
        )
    rate = take.clip.rate if shot.rate is None else shot.rate
    edited, tracked = _poses(take.clip, weights, rotations, rate, shot.follows_head)
    size = shot.size[0] - shot.size[0] % 2, shot.size[1] - shot.size[1] % 2
    keep_inputs([path], (part.path for part in (media.sound, media.film) if part is not None))
    is_replaced(path, take.path, shot.overwrite, can_allow=False)  # a recording, which is no film
    with ExitStack() as opened:
        film = None
        if shot.view.has_film and media.film is not None:
            film = opened.enter_context(closing(Film(media.film.path))), media.film.offset
        track = _track(media.sound) if shot.has_sound and media.sound is not None else None
        room = shot.view.room(size)
        faces = opened.enter_context(closing(_Faces(rig, *room, shot.camera)))
        try:
            with writing(path, form, size, rate, track) as out:
                for number, poses in enumerate(zip(edited, tracked, strict=True)):
                    if stopped():
                        raise Abandoned
                    picture = _picture(shot, size, faces, poses, film, number / rate)
                    out.add(np.ascontiguousarray(picture))
                    progress(number + 1, len(edited))
        except Abandoned:
            return None
    return Filmed(path, form, len(edited), rate, out.codecs, size, out.backup)


def shown_by(session: EditSession) -> tuple[Take, Floats, Floats | None]:
    """What to film of a session: the take, its edited weights (T, 52), and rotations (T, 9).

    Rows that lost the face and were filled are frames of it.
    """
    session.live.work()
    take, filled, edited = session.take, session.filled_rows(), session.edited_clip()
    lost, clip = take.lost_rows, take.clip
    if lost is None or filled is None or not np.isfinite(filled).any():
        return take, session.weights.copy(), edited.rotations
    nothing = np.full_like(filled, np.nan)
    nothing[have_faces(filled)] = lost.with_faces(filled, clip).between(clip.weights)
    edited = with_filled(edited, lost, filled)
    tracked = with_filled(clip, lost, nothing)
    return replace(take, clip=tracked), edited.arkit_weights(), edited.rotations


def with_fills(session: EditSession) -> Clip:
    """The edited clip, with frames where fills fill the take's gaps."""
    session.live.work()
    return with_filled(session.edited_clip(), session.take.lost_rows, session.filled_rows())


_Pose = tuple[Floats, Floats | None]  # weights (52,), and rotations (9,) if the head turns


def _poses(
    clip: Clip, weights: Floats, rotations: Floats | None, rate: float, follows_head: bool
) -> tuple[list[_Pose], list[_Pose]]:
    """The edited and the tracked pose of each picture."""
    was = clip.rotations if follows_head else None
    now = was if rotations is None or was is None else rotations
    pairs = ((weights, now), (clip.arkit_weights(), was))
    edited, tracked = (
        [(w, None if turns is None else turns[k]) for k, w in enumerate(frames)]
        for frames, turns in (
            (_at_rate(clip, frames, rate), None if turns is None else _at_rate(clip, turns, rate))
            for frames, turns in pairs
        )
    )
    return edited, tracked


def _at_rate(clip: Clip, frames: Floats, rate: float) -> Floats:
    """Frames (T, K) of a clip as they are on each picture (N, K).

    At the take's own rate it is the frame that the window shows at that time.
    """
    if abs(rate / clip.rate - 1) > 1e-6:
        resampled: Floats = at_rate(clip.times, frames, rate, clip.rate).astype(np.float32)
        return resampled
    count = max(round(clip.duration * rate), 1)
    return frames[[clip.frame_at(number / rate) for number in range(count)]]


def _track(entry: MediaFile) -> Soundtrack | None:
    sound = read_sound(entry.path)
    return None if sound is None else Soundtrack(sound, entry.offset)


class _Faces:
    """Draws faces as RGB."""

    def __init__(self, rig: Rig, width: int, height: int, camera: render.Camera | None) -> None:
        self._rig, self._head = rig, Head(rig)
        self._camera = camera or render.default_camera(rig, width / height)
        self._renderer = render.open_renderer(rig, width, height)

    def draw(self, weights: Floats, rotation: Floats | None) -> Pixels:
        """(H, W, 3) uint8 of weights (52,) in ARKit order, and rotations; None = straight."""
        vertices = self._rig.vertices(self._rig.from_arkit(weights))
        if rotation is not None:
            vertices = self._head.turned(vertices, rotation)
        image = self._renderer.draw(vertices, self._camera, smooth=True)
        picture: Pixels = image[..., 2::-1].copy()
        self._renderer.prepare()
        return picture

    def close(self) -> None:
        """Free the graphics memory."""
        self._renderer.close()


def _picture(
    shot: Shot,
    size: tuple[int, int],
    faces: _Faces,
    poses: tuple[_Pose, _Pose],
    film: tuple[Film, float] | None,
    time: float,
) -> Pixels:
    """(H, W, 3) uint8: what a film shows at a time of the take.

    Args:
        poses: edited and tracked.
        film: the take's film, and the time at which it begins.
    """
    edited, tracked = poses
    face = faces.draw(*edited)
    if shot.view is FilmView.BOTH:
        return np.concatenate([faces.draw(*tracked), face], axis=1)
    if film is None:
        return face
    (width, height), (high, wide) = size, face.shape[:2]
    room = (width - wide, height) if shot.view is FilmView.FILM else (width, height - high)
    pictures = [_shown(film[0], time - film[1], room, shot.mirrored), face]
    if shot.view is FilmView.FILM_BELOW:
        pictures.reverse()
    return np.concatenate(pictures, axis=1 if shot.view is FilmView.FILM else 0)


def _shown(film: Film, second: float, room: tuple[int, int], mirrored: bool) -> Pixels:
    """(H, W, 3) uint8: the film's picture at a second of it, fitted into a room."""
    width, height = room
    out = np.empty((height, width, 3), np.uint8)
    out[:] = _BACKGROUND
    if not 0 <= second < film.duration:
        return out
    picture = film.frame_at(second)[..., 2::-1]
    if mirrored:
        picture = picture[:, ::-1]
    high, wide = picture.shape[:2]
    scale = min(width / wide, height / high)
    size = max(round(wide * scale), 1), max(round(high * scale), 1)
    scaled = Image.fromarray(np.ascontiguousarray(picture)).resize(size, Image.Resampling.BICUBIC)
    left, top = (width - size[0]) // 2, (height - size[1]) // 2
    out[top : top + size[1], left : left + size[0]] = np.asarray(scaled)
    return out
