"""Write a clip in another format, at its own frame rate or another."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from faceedit_app.core.arrays import Bools, Times
from faceedit_app.core.atomic import write_atomically
from faceedit_app.core.clip import Clip
from faceedit_app.core.resample import at_rate
from faceedit_app.formats.opening import write_take
from faceedit_app.formats.registry import Format
from faceedit_app.formats.take import Source, Take
from faceedit_app.formats.timecode import start_of_day, write_timecode
from faceedit_app.formats.timecode_readings import DEFAULT_BASE
from faceedit_app.formats.timing import find_gaps


def convert(
    path: Path,
    take: Take,
    form: Format,
    rate: float | None = None,
    edited: Clip | None = None,
    like: Source | None = None,
) -> Clip:
    """Write a take in a format, and return its clip as written.

    In its own format and at its own rate, a take is written byte for byte, except for weights and
    rotations that differ.

    Args:
        form: a format that can be written, or the take's own if `rate` is.
        rate: frames per second; None = the take's own.
        edited: the take's clip with other weights and rotations; None = as it is.
        like: a source in whose style the file is written; None = the take's own, in its format.

    Raises:
        FileError: the file cannot be written.
    """
    clip = take.clip if edited is None else edited
    if form.name == take.kind and (rate is None or rate == clip.rate):
        write_take(path, take, clip.weights, clip.rotations, clip.confidence)
        return clip
    assert form.write is not None
    clip = resampled(clip, rate, fill_gaps=not form.tells_times)
    own = take.source if form.name == take.kind else like
    styled = None if own is None else form.write_like(own, clip)
    write_atomically(path, form.write(clip) if styled is None else styled)
    return clip


def resampled(clip: Clip, rate: float | None = None, fill_gaps: bool = False) -> Clip:
    """A clip at another frame rate.

    Args:
        rate: frames per second; None = its own.
        fill_gaps: interpolate over gaps, for formats that have no times.

    Returns:
        The clip itself if nothing has to change; else a clip with even times.
    """
    keeps_rate = rate is None or abs(rate / clip.rate - 1) < 1e-6
    steady = bool(np.allclose(clip.times, np.arange(len(clip)) / clip.rate, rtol=0, atol=1e-4))
    if keeps_rate and (steady or not fill_gaps):
        return clip
    rate = clip.rate if rate is None else rate
    parts = [clip.weights, *([] if clip.rotations is None else [clip.rotations])]
    if clip.confidence is not None:
        parts.append(clip.confidence[:, None])
    values = at_rate(clip.times, np.concatenate(parts, axis=1), rate, clip.rate)
    times = np.arange(len(values)) / rate
    inside = _inside_gaps(times, clip)
    if not fill_gaps:
        times, values = times[~inside], values[~inside]
    elif clip.confidence is not None:
        values[inside, -1] = 0.0  # nothing was seen there
    floats = values.astype(np.float32)
    channels, turns = len(clip.channels), clip.rotations
    return Clip(
        weights=np.ascontiguousarray(floats[:, :channels]),
        channels=clip.channels,
        times=times,
        rate=rate,
        gaps=find_gaps(times, rate),
        timecodes=timecodes_at(clip.timecodes, times) if clip.timecodes else None,
        rotations=None if turns is None else floats[:, channels : channels + turns.shape[1]],
        confidence=None if clip.confidence is None else np.clip(floats[:, -1], 0.0, 1.0),
    )


def timecodes_at(before: tuple[str, ...], times: Times) -> tuple[str, ...]:
    """The timecodes of a clip for other times (N,), seconds from its first frame."""
    begin = start_of_day(before)
    return tuple(write_timecode(begin + time, DEFAULT_BASE) for time in times.tolist())


def _inside_gaps(times: Times, clip: Clip) -> Bools:
    """(T,) which times are in a gap."""
    inside = np.zeros(len(times), bool)
    for gap in clip.gaps:
        last = clip.times[gap.frame] + 0.5 / clip.rate
        following = clip.times[gap.frame + 1] - 0.5 / clip.rate
        inside |= (times > last) & (times < following)
    return inside
