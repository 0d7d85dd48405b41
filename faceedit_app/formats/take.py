"""A take: the file of a recorded performance, its clip, and the way back to a file."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import numpy as np

from faceedit_app.core.arrays import Bools, Doubles, Floats
from faceedit_app.core.clip import Clip
from faceedit_app.core.errors import FileError
from faceedit_app.formats.timing import (
    NoTimes,
    RateNeeded,
    Timing,
    find_gaps,
    format_rate,
    format_time,
    gap_notes,
    lost_notes,
)
from faceedit_app.formats.weights import first_impossible, impossible, scale_notes, scale_of

_LONGEST = 24 * 3600.0  # seconds


class Source(Protocol):
    """What a format keeps of a file so that it can write it again, changed only where edited."""

    def encode(self, tracked: Floats, edited: Floats) -> bytes:
        """The whole file with the weights of `edited` (T, K) in place of `tracked` (T, K).

        Cells whose weight is unchanged keep the source's own text, to the byte.
        """
        ...


@dataclass(frozen=True)
class Take:
    """A performance that the user has opened.

    Attributes:
        path: where it was read from.
        format: the name of the format, for the user.
        clip: the tracked weights.
        carried: names of the file's other columns, which are kept as they are.
        notes: one-line remarks on oddities that were found and how they were handled.
        source: what the format needs to write the file again.
        fps: the frame rate that the user gave, where the file does not tell or is not believed.
        kind: `registry.Format.name` of what it was read as.
    """

    path: Path
    format: str
    clip: Clip
    carried: tuple[str, ...]
    notes: tuple[str, ...]
    source: Source
    fps: float | None = None
    kind: str = ""


@dataclass(frozen=True)
class Recording:
    """What a reader found in a file, before it is known on what scale and at what rate it is.

    Attributes:
        path: the file.
        format: the name of the format, for the user.
        channels: K ARKit names.
        values: (T, K) float64, finite, as the file gives them.
        timing: when the frames are, or why that cannot be known.
        lost: (R,) which of the file's rows have no frame.
        timecodes: as `Clip.timecodes`.
        carried: as `Take.carried`.
        notes: remarks of the format's own.
    """

    path: Path
    format: str
    channels: tuple[str, ...]
    values: Doubles
    timing: Timing | NoTimes
    lost: Bools
    timecodes: tuple[str, ...] | None = None
    carried: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()


def finish_take(
    recording: Recording,
    fps: float | None,
    source: Callable[[float], Source],
    line_of: Callable[[int, int], int | None] = lambda frame, channel: None,
) -> Take:
    """The take in a recording.

    Args:
        fps: the frame rate, if the user gave one.
        source: makes the way back, given what stands for a full blendshape in the file.
        line_of: the line in the file (from 1) of a weight, by frame and channel.

    Raises:
        RateNeeded: the times are of no use, and there is no `fps`.
        FileError: there is no frame, or something in it cannot be.
    """
    path, values = recording.path, recording.values
    if not len(values):
        raise FileError(path, "has no row with a tracked face", "record the take again")
    scale = scale_of(values)
    wrong = first_impossible(values, scale)
    if wrong is not None:
        frame, k = wrong
        problem = f"{recording.channels[k]} {impossible(float(values[wrong]), scale)}"
        raise FileError(path, problem, "correct it or delete the row", line_of(frame, k))
    timing = _timing(recording, fps)
    gaps = find_gaps(timing.times, timing.rate)
    clip = Clip(
        weights=(values / scale).astype(np.float32),
        channels=recording.channels,
        times=timing.times,
        rate=timing.rate,
        gaps=gaps,
        timecodes=recording.timecodes,
    )
    notes = (
        *recording.notes,
        *timing.notes,
        *gap_notes(gaps),
        *lost_notes(recording.lost),
        *scale_notes(scale),
    )
    carried = recording.carried
    return Take(path, recording.format, clip, carried, notes, source(scale), fps)


def _timing(recording: Recording, fps: float | None) -> Timing:
    found = recording.timing
    if isinstance(found, NoTimes):
        if fps is None:
            raise RateNeeded(recording.path, found.problem, found.rate, len(recording.values))
        return found.timing_at(fps, np.flatnonzero(~recording.lost))
    if fps is not None and fps != found.rate:
        note = f"the frame rate was set to {format_rate(fps)}, by its times it is"
        notes = (*found.notes, f"{note} {format_rate(found.rate)}")
        found = Timing(found.times * (found.rate / fps), fps, notes)
    if found.times[-1] > _LONGEST:
        raise FileError(
            recording.path,
            f"lasts {format_time(found.times[-1])} by its times",
            "split it into shorter takes, or give its frame rate, such as --fps 60",
        )
    return found
