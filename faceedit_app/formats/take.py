"""A take: its file, its clip, and how it is written again."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol, runtime_checkable

import numpy as np

from faceedit_app.core.arkit import ROTATIONS
from faceedit_app.core.arrays import Bools, Doubles, Floats, Indices, Times
from faceedit_app.core.clip import UNSURE, Clip
from faceedit_app.core.errors import FileError
from faceedit_app.formats.changing_rates import stretches
from faceedit_app.formats.faceless import Faceless, find_faceless
from faceedit_app.formats.gaps import find_gaps, gap_notes, lost_notes
from faceedit_app.formats.lost_faces import blank_notes
from faceedit_app.formats.name_notes import misspelled_notes, version_notes
from faceedit_app.formats.rates import sure_notes
from faceedit_app.formats.timing import (
    NoTimes,
    RateNeeded,
    Timing,
    counted,
    format_rate,
    format_time,
)
from faceedit_app.formats.weights import (
    first_impossible,
    impossible,
    mixed_notes,
    odd_notes,
    scale_notes,
    scale_of,
)

_RESOLUTION = 1e-3  # seconds
_MOST_SHOWN = 4  # rates in a note
_LONGEST = 24 * 3600.0  # seconds


class Source(Protocol):
    """What a format keeps of a file, to write it again with only the edited weights changed."""

    def encode(self, tracked: Floats, edited: Floats) -> bytes:
        """The whole file with the weights of `edited` (T, K) in place of `tracked` (T, K).

        Cells whose weight is unchanged keep the source's own text, to the byte.
        """
        ...


@runtime_checkable
class RotatingSource(Source, Protocol):
    """A source that also holds the rotations of head and eyes."""

    def rotated(self, tracked: Floats, edited: Floats) -> Source:
        """The source with the rotations of `edited` (T, 9) in place of `tracked` (T, 9), radians.

        Cells whose rotation is unchanged keep the source's own text, to the byte.
        """
        ...


@runtime_checkable
class SureSource(Source, Protocol):
    """A source that also says how sure a tracker was."""

    def as_sure(self, tracked: Floats, edited: Floats) -> Source:
        """The source with the confidence of `edited` (T,) in place of `tracked` (T,)."""
        ...


@runtime_checkable
class RoundingSource(Source, Protocol):
    """A source whose numbers have few digits."""

    def as_written(self, weights: Floats) -> Doubles:
        """(N,) numbers that differ where those that the file would show for weights (N,) do."""
        ...


@runtime_checkable
class FillableSource(Source, Protocol):
    """A source with rows in which the face was lost."""

    def with_faces(self, weights: Floats) -> Source:
        """The source with weights (L, K) in these rows; a row of NaN stays as it is."""
        ...


@dataclass(frozen=True, eq=False)
class RowsBetween:
    """Rows of a file that lie between the frames of a clip, in order of time.

    Attributes:
        weights: (M, K) of the clip's channels.
        times: (M,) seconds.
        before: (M,) the frame of the clip before each of them.
        share: (M,) where it lies between that one and the next, 0..1.
    """

    weights: Floats
    times: Times
    before: Indices
    share: Doubles

    def __len__(self) -> int:
        return len(self.times)

    def between(self, values: Floats, rows: int | slice = slice(None)) -> Floats:
        """(M, K) what lies between the values (T, K) of the frames around the rows; (K,) of one."""
        frame, share = self.before[rows], self.share[rows, None]
        mixed: Floats = ((1 - share) * values[frame] + share * values[frame + 1]).astype(np.float32)
        return mixed


@dataclass(frozen=True)
class LostRows:
    """The rows of a file in which the face was lost between two frames.

    Attributes:
        positions: (L) where they lie, in frames: 4.5 is half-way between frames 4 and 5.
        timecodes: (L) as the file writes them, "" where it has none; empty if it never has any.
    """

    positions: tuple[float, ...]
    timecodes: tuple[str, ...] = ()

    def times(self, clip: Clip) -> Times:
        """(L,) seconds of the rows in the take's clip."""
        times: Times = np.interp(self.positions, np.arange(len(clip)), clip.times)
        return times

    def with_faces(self, rows: Floats, clip: Clip) -> RowsBetween:
        """Those of the rows (L, K) that have a face, and where they lie in the take's clip."""
        there = have_faces(rows)
        places = np.array(self.positions)[there]
        before = np.clip(np.floor(places), 0, len(clip) - 2).astype(np.intp)
        return RowsBetween(rows[there], self.times(clip)[there], before, places - before)


def have_faces(rows: Floats) -> Bools:
    """(L,) which rows (L, K) have a face: one without is NaN."""
    return np.asarray(np.isfinite(rows).all(axis=1), np.bool_)


@dataclass(frozen=True)
class Take:
    """A take as it was read from its file.

    Attributes:
        path: the file.
        format: the name of the format, shown to the user.
        clip: the tracked weights.
        carried: names of the file's other columns, which stay unchanged.
        notes: one-line notes about what is unusual in the file and how it was read.
        source: writes the file again.
        fps: the frame rate that the user gave, if any.
        kind: `registry.Format.name` of its format.
        lost_rows: the rows that a fill can give weights to; None if the file has none.
        lead: seconds that the file has before its first face, which is at 0 s of the clip.
        own_rate: frames per second by the file's own times; None if it has none to go by.
        faceless: all rows of the file without a face; None if there are none.
        unread: the notes about what else the file has, such as other faces; `notes` has them too.
    """

    path: Path
    format: str
    clip: Clip
    carried: tuple[str, ...]
    notes: tuple[str, ...]
    source: Source
    fps: float | None = None
    kind: str = ""
    lost_rows: LostRows | None = None
    lead: float = 0.0
    own_rate: float | None = None
    faceless: Faceless | None = None
    unread: tuple[str, ...] = ()

    def without_face(self, filled: Floats | None) -> Faceless | None:
        """The rows that have no face, also after fills gave `lost_rows` weights (L, K)."""
        if self.faceless is None or filled is None:
            return self.faceless
        gone = self.faceless.between(self.clip)
        gone[gone] = have_faces(filled)
        return self.faceless.only(~gone)

    @property
    def other_rate(self) -> float | None:
        """The rate that the file's own times say, if the user gave another; None if not."""
        own, fps = self.own_rate, self.fps
        if own is None or fps is None or format_rate(own) == format_rate(fps):
            return None
        return own

    @property
    def rate_note(self) -> str:
        """What to say of a file that keeps this take's own times; "" if they are believed."""
        own = self.other_rate
        if own is None:
            return ""
        return (
            f"it keeps the take's own times, which say {format_rate(own)} and not "
            f"{format_rate(self.clip.rate)}"
        )


@dataclass(frozen=True)
class Recording:
    """What a reader found in a file, before its scale and rate are known.

    Attributes:
        path: the file.
        format: the name of the format, for the user.
        channels: the K ARKit names.
        values: (T, K) float64, finite, on the file's scale.
        timing: the times of the frames, or why they are unknown.
        lost: (R,) which rows of the file have no frame.
        timecodes: as `Clip.timecodes`.
        carried: as `Take.carried`.
        own: the file's own names of the channels, if they may be others.
        notes: the format's own notes.
        unread: as `Take.unread`.
        rotations, rotation_names, confidence: as in `Clip`.
        scale: the value of a full blendshape in the file, if the format says it.
        told: (R,) seconds of all rows on a clock of their own, if the format says them.
    """

    path: Path
    format: str
    channels: tuple[str, ...]
    values: Doubles
    timing: Timing | NoTimes
    lost: Bools
    timecodes: tuple[str, ...] | None = None
    carried: tuple[str, ...] = ()
    own: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    unread: tuple[str, ...] = ()
    rotations: Floats | None = None
    rotation_names: tuple[str, ...] = ROTATIONS
    confidence: Floats | None = None
    scale: float | None = None
    told: Times | None = None


def finish_take(
    recording: Recording,
    fps: float | None,
    source: Callable[[float], Source],
    line_of: Callable[[int, int], int | None] = lambda frame, channel: None,
) -> Take:
    """Make the take of a recording.

    Args:
        fps: the frame rate, if the user gave one.
        source: makes the source, given the value of a full blendshape in the file.
        line_of: the line in the file (from 1) of a weight, by frame and channel.

    Raises:
        RateNeeded: the times are unusable, and `fps` is None.
        FileError: there is no frame, or a weight is impossible.
    """
    path, values = recording.path, recording.values
    if not len(values):
        raise FileError(path, "has no row with a tracked face", "record the take again")
    scale = recording.scale or scale_of(values)
    wrong = first_impossible(values, scale)
    if wrong is not None:
        frame, k = wrong
        problem = f"{recording.channels[k]} {impossible(float(values[wrong]), scale)}"
        raise FileError(path, problem, "correct it or delete the row", line_of(frame, k))
    timing = _timing(recording, fps)
    gaps = find_gaps(timing.times, timing.rate)

    def place(frame: int, k: int) -> str:
        line = line_of(frame, k)
        return f"at {format_time(timing.times[frame])}" if line is None else f"in line {line}"

    clip = Clip(
        weights=(values / scale).astype(np.float32),
        channels=recording.channels,
        times=timing.times,
        rate=timing.rate,
        gaps=gaps,
        timecodes=recording.timecodes,
        rotations=recording.rotations,
        rotation_names=recording.rotation_names,
        confidence=recording.confidence,
    )
    notes = (
        *recording.unread,
        *recording.notes,
        *timing.notes,
        *_rate_notes(timing),
        *gap_notes(gaps),
        *lost_notes(recording.lost),
        *blank_notes(clip.weights),
        *scale_notes(scale),
        *mixed_notes(values, scale, recording.channels),
        *odd_notes(values, scale, recording.channels, place),
        *misspelled_notes(recording.channels, recording.carried),
        *version_notes(recording.channels, recording.own, recording.carried),
        *_unsure_notes(recording.confidence),
    )
    lead = float(np.argmin(recording.lost)) / timing.rate if len(recording.lost) else 0.0
    found = recording.timing
    return Take(
        path=path,
        format=recording.format,
        clip=clip,
        carried=recording.carried,
        notes=notes,
        source=source(scale),
        fps=fps,
        lead=lead,
        own_rate=None if isinstance(found, NoTimes) else found.rate,
        faceless=find_faceless(recording.lost, clip, recording.told),
        unread=recording.unread,
    )


def _rate_notes(timing: Timing) -> tuple[str, ...]:
    """The note about a frame rate that changes in the take."""
    found = stretches(timing.times) or stretches(timing.times, _RESOLUTION)
    if not found:
        return ()
    until = [
        f"{format_rate(one.rate)} until {format_time(timing.times[one.last])}" for one in found
    ]
    parts = [*until[:-1], f"then {format_rate(found[-1].rate)}"]
    if len(parts) > _MOST_SHOWN:
        parts[_MOST_SHOWN - 1 :] = [f"then {len(found) - _MOST_SHOWN + 1} times another"]
    return (f"the frame rate changes: {', '.join(parts)}",)


def _unsure_notes(confidence: Floats | None) -> tuple[str, ...]:
    """The note that counts the frames of which the tracker was not sure."""
    count = 0 if confidence is None else int((confidence < UNSURE).sum())
    if not count:
        return ()
    return (f"the tracker was less than {100 * UNSURE:.0f} % sure of {counted(count, 'frame')}",)


def _timing(recording: Recording, fps: float | None) -> Timing:
    found = recording.timing
    if isinstance(found, NoTimes):
        rows = np.flatnonzero(~recording.lost)
        if fps is None:
            length = found.timing_at(found.rate, rows).times[-1] * found.rate
            raise RateNeeded(recording.path, found.problem, found.rate, round(float(length)) + 1)
        return found.timing_at(fps, rows)
    if fps is not None:
        notes = sure_notes(found.notes)
        if fps != found.rate:
            note = f"the frame rate was set to {format_rate(fps)}; by its times it is"
            notes = (*notes, f"{note} {format_rate(found.rate)}")
        found = Timing(found.times * (found.rate / fps), fps, notes)
    if found.times[-1] > _LONGEST:
        raise FileError(
            recording.path,
            f"lasts {format_time(found.times[-1])} by its times",
            "split it into shorter takes",
            command_remedy="split it into shorter takes, or give its frame rate, such as --fps 60",
        )
    return found
