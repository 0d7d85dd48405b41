"""From a film to a take: find the face, find out about the person, fit, judge each picture."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from faceedit_app.core import on_disk
from faceedit_app.core.arkit import ARKIT_CHANNELS, ARKIT_INDEX
from faceedit_app.core.arrays import Bools, Doubles, Times
from faceedit_app.core.atomic import keep_backup, write_atomically
from faceedit_app.core.clip import Clip
from faceedit_app.core.errors import FileError
from faceedit_app.core.resample import at_rate
from faceedit_app.core.rig import Rig
from faceedit_app.formats import livelink
from faceedit_app.formats.opening import checked_rate
from faceedit_app.formats.timing import counted
from faceedit_app.media.container import check
from faceedit_app.tracking.face_model import FaceModel
from faceedit_app.tracking.film_landmarks import (
    Choose,
    Chosen,
    FilmLandmarks,
    Progress,
    Report,
    read_landmarks,
)
from faceedit_app.tracking.fit import DEFAULT, Fit, FitSettings, fit_weights
from faceedit_app.tracking.hidden import seen_share
from faceedit_app.tracking.landmarker import SURE, FaceLandmarker
from faceedit_app.tracking.lips import with_lip_edges
from faceedit_app.tracking.person import Person, find_person

_FEWEST = 8  # pictures with a face
_GOOD = 0.9  # probability of a face in pictures that show the person's neutral face
_TURNED = np.radians((35.0, 60.0))  # from here the far side is hidden, and there nothing is left
_STRANGE = (2.0, 4.0)  # times the usual residual: what does not look like a face, or is hidden
_MOMENT = 3  # pictures from one that is lost to the next, between which there is hardly a face
_SMALLEST = 2.2  # mm, the least of these residuals; a wide open mouth of another shape has 2
# Radians of Live Link Face's eye rotations at weight 1, measured on its recordings.
_EYE_YAW, _EYE_PITCH = 0.6, 0.5
_SMALL_FACE = 90.0  # pixels between chin and forehead


@dataclass(frozen=True)
class Tracked:
    """What was tracked in a film of F pictures.

    Attributes:
        landmarks: what was seen, with the edges of the lips where their colours end.
        weights: (F, 52) in ARKit's order; 0 where there is no face.
        head: (F, 3) yaw, pitch and roll of the head, radians, as `Poses.angles`.
        confidence: (F,) 0..1; frames below `SURE` are gaps.
        person: the person's own.
    """

    landmarks: FilmLandmarks
    weights: Doubles
    head: Doubles
    confidence: Doubles
    person: Person

    @property
    def sure(self) -> Bools:
        """(F,) the frames that are kept."""
        sure: Bools = self.confidence >= SURE
        return sure

    @property
    def clip(self) -> Clip:
        """The frames that are kept, timed as in the film."""
        film, code = self.landmarks, self.landmarks.timecode
        return Clip(
            self.weights[self.sure].astype(np.float32),
            ARKIT_CHANNELS,
            film.times[self.sure],
            film.rate,
            timecodes=None if code is None else (code,),
            confidence=self.confidence[self.sure].astype(np.float32),
        )

    @property
    def notes(self) -> tuple[str, ...]:
        """What the user should know."""
        notes = list(self.landmarks.remarks)
        damaged = self.landmarks.damaged
        if damaged:
            so = "is damaged: it is a gap" if damaged == 1 else "are damaged: they are gaps"
            notes.append(f"{damaged} of {len(self.sure)} pictures {so}")
        lost = int((~self.sure).sum()) - damaged
        if lost > 0:
            so = "shows the face badly: it is a gap"
            so = so if lost == 1 else "show the face badly: they are gaps"
            notes.append(f"{lost} of {len(self.sure)} pictures {so}")
        if self.person.is_ajar:
            notes.append("the lips never touch: how far they are open is less exact")
        turns = self.landmarks.quarter_turns
        if turns:
            way = ("", "on its left side", "upside down", "on its right side")[turns]
            notes.append(f"the face is {way} in the film: it was tracked as if it were upright")
        tall = np.nanmedian(np.ptp(self.landmarks.upright[..., 1], axis=1))
        if tall < _SMALL_FACE:
            notes.append(f"the face is only {tall:.0f} pixels high: lips and lids are less exact")
        return tuple(notes)

    def take_at(self, fps: float | None = None) -> tuple[Clip, Times]:
        """The take with the rotations of head and eyes, and the (L,) times of the frames it lost.

        Args:
            fps: frames per second; None = one frame for each picture of the film.
        """
        film, sure = self.landmarks, self.sure
        rotations = np.concatenate([self.head, eye_rotations(self.weights)], axis=1)[sure]
        clip = replace(self.clip, rotations=rotations.astype(np.float32))
        if fps is None:
            return clip, film.times[~sure]
        began, count = clip.times[0], clip.weights.shape[1]
        whole = np.concatenate([clip.weights, rotations, self.confidence[sure, None]], axis=1)
        values = at_rate(clip.times - began, whole, fps, film.rate)
        times = began + np.arange(len(values)) / fps
        nearest = np.abs(film.times[:, None] - times).argmin(axis=0)
        kept = sure[nearest]
        values, lost = values[kept].astype(np.float32), times[~kept]
        clip = replace(
            clip,
            weights=values[:, :count],
            rotations=values[:, count:-1],
            confidence=np.clip(values[:, -1], SURE, 1.0),
            times=times[kept],
            rate=fps,
        )
        return clip, lost

    def to_livelink(self, fps: float | None = None) -> bytes:
        """The take as a Live Link Face CSV.

        Args:
            fps: as in `take_at`.
        """
        clip, lost = self.take_at(fps)
        assert clip.rotations is not None
        return livelink.write_with(clip, clip.rotations, lost)


def track_film(
    path: Path,
    rig: Rig,
    report: Report = lambda progress: None,
    stopped: Callable[[], bool] | None = None,
    face: Chosen | None = None,
    settings: FitSettings = DEFAULT,
    choose: Choose | None = None,
) -> Tracked:
    """Track the face in a film.

    Args:
        path: the film.
        rig: the shipped character.
        report: called in this thread with the progress.
        stopped: True gives up.
        face, choose: as in `read_landmarks`.
        settings: of the fit.

    Raises:
        FileError, Unavailable, Abandoned: as `read_landmarks`.
    """
    model = FaceModel.of(rig)
    seen = read_landmarks(path, FaceLandmarker(threads=2), report, stopped, face, choose)

    def fitting(done: int, of: int) -> None:
        check(stopped)
        report(Progress("Fitting the character", done, of))

    tracked = fit_landmarks(seen, model, settings, fitting)
    check(stopped)
    return tracked


def fit_landmarks(
    film: FilmLandmarks,
    model: FaceModel,
    settings: FitSettings = DEFAULT,
    progress: Callable[[int, int], None] = lambda done, of: None,
) -> Tracked:
    """Fit the character to landmarks.

    Args:
        film, model, settings: what was seen, where it is on the character, and how it is fitted.
        progress: as in `fit_weights`.

    Raises:
        FileError: too few pictures show a face, or show it well enough to be kept.
    """
    found = np.flatnonzero(film.probabilities > 0)
    if len(found) < _FEWEST:
        raise FileError(
            film.path,
            f"shows a face in only {counted(len(found), 'picture')}",
            "use a film in which a face looks at the camera, the right way up",
        )
    if film.lips is not None:
        points = film.points.copy()
        points[found] = with_lip_edges(points[found], film.lips[found])
        film = replace(film, points=points)
    seen = film.upright[found][:, model.numbers] * (1.0, -1.0, -1.0)
    middle = 0.5 * np.array(film.size) * (1.0, -1.0)
    good = film.probabilities[found] > _GOOD
    if good.sum() < _FEWEST:
        good[:] = True
    person = find_person(model, seen, good, middle)
    trust = np.clip(film.probabilities[found], 0.05, 1.0)
    fit = fit_weights(model, person, seen, film.times[found], trust, settings, progress)
    count = len(film.times)
    weights, head, confidence = np.zeros((count, 52)), np.zeros((count, 3)), np.zeros(count)
    weights[found], head[found] = fit.weights, fit.poses.angles
    plain = seen_share(model, film.colors[found], fit.poses.angles[:, 0])
    confidence[found] = film.probabilities[found] * _likeness(fit) * plain
    _doubt_moments(confidence)
    tracked = Tracked(film, weights, head, confidence, person)
    if (kept := int(tracked.sure.sum())) < _FEWEST:
        raise FileError(
            film.path,
            f"shows the face well in only {counted(kept, 'picture')} of {count}",
            "use a film in which it looks at the camera, with nothing before the mouth",
        )
    return tracked


def _doubt_moments(confidence: Doubles) -> None:
    """Make pictures between lost ones as uncertain as these, if they are very few; (F,)."""
    lost = np.flatnonzero(confidence < SURE)
    for before, after in zip(lost[:-1].tolist(), lost[1:].tolist(), strict=True):
        if 1 < after - before <= _MOMENT:
            moment = slice(before + 1, after)
            confidence[moment] = np.minimum(
                confidence[moment], max(confidence[before], confidence[after])
            )


def _likeness(fit: Fit) -> Doubles:
    """(T,) 0..1: how well each picture can be seen and explained."""
    turned = np.abs(fit.poses.angles[:, :2]).max(axis=1)
    facing = np.interp(turned, _TURNED, (1.0, 0.0))
    usual = max(float(np.median(fit.residuals)), _SMALLEST / _STRANGE[0])
    plain = np.interp(fit.residuals / usual, _STRANGE, (1.0, 0.0))
    likeness: Doubles = facing * plain
    return likeness


def eye_rotations(weights: Doubles) -> Doubles:
    """(T, 6) radians: yaw, pitch and roll of the left and the right eye, from weights (T, 52)."""

    def look(direction: str, side: str) -> Doubles:
        found: Doubles = weights[:, ARKIT_INDEX[f"eyeLook{direction}{side}"]]
        return found

    columns = []
    for side, sign in (("Left", -1.0), ("Right", 1.0)):
        columns += [
            sign * _EYE_YAW * (look("Out", side) - look("In", side)),
            _EYE_PITCH * (look("Down", side) - look("Up", side)),
            np.zeros(len(weights)),
        ]
    return np.stack(columns, axis=1)


def write_take(tracked: Tracked, output: Path, fps: float | None = None) -> Path | None:
    """Write the take as a Live Link Face CSV, completely or not at all.

    A file that is there already may be a recording: it is kept.

    Args:
        fps: as in `Tracked.take_at`.

    Returns:
        The copy of the file that was there, if there was one.

    Raises:
        FileError: it cannot be written, or a take cannot have this frame rate.
    """
    if fps is not None:
        fps = checked_rate(output, fps)
    content = tracked.to_livelink(fps)
    backup = None
    if on_disk.is_file(output):
        if output.samefile(tracked.landmarks.path):
            raise FileError(output, "is the film itself", "choose another name for the take")
        if output.read_bytes() != content:
            backup = keep_backup(output)
    write_atomically(output, content)
    return backup
