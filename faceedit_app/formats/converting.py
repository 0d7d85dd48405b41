"""Write a clip in another format, at its own frame rate or another."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from faceedit_app.core.arrays import Bools, Floats, Indices, Times
from faceedit_app.core.clip import Clip, nearest_rows
from faceedit_app.core.resample import at_rate
from faceedit_app.formats.faceless import Faceless, left_out_note
from faceedit_app.formats.gaps import find_gaps
from faceedit_app.formats.opening import encoded_take
from faceedit_app.formats.registry import Format
from faceedit_app.formats.take import LostRows, Source, Take
from faceedit_app.formats.timecode import start_of_day, write_timecode
from faceedit_app.formats.timecode_readings import DEFAULT_BASE

_FILLED = "get weights between those around them"


@dataclass(frozen=True)
class Like:
    """A file in whose style another one is written.

    Attributes:
        source: the file.
        frames: (N,) the frame of it that each frame of the other is, or is made of.
    """

    source: Source
    frames: Indices


@dataclass(frozen=True)
class Converted:
    """A take in another format, as a file holds it.

    Attributes:
        content: of the file.
        clip: what is in it.
        is_own: whether it is the take's own file with other weights.
        is_styled: whether it is a new file in the style of the take's.
        note: what of the take's layout could not be kept, if it should be, or that its times were
            kept although the user gave another rate; else "".
        faceless: what became of rows without a face that it does not have as they were; else "".
        kept: the take's columns that are no channels and are kept in a new file all the same.
    """

    content: bytes
    clip: Clip
    is_own: bool = False
    is_styled: bool = False
    note: str = ""
    faceless: str = ""
    kept: tuple[str, ...] = ()


def converted(
    path: Path,
    take: Take,
    form: Format,
    rate: float | None = None,
    edited: Clip | None = None,
    *,
    like: Like | None = None,
    own_layout: bool = True,
    filled: Floats | None = None,
) -> Converted:
    """A take in a format.

    In its own layout and at its own rate, all of it stays to the byte but weights and rotations
    that differ.

    Args:
        path: for messages.
        form: a format that can be written, or the take's own if `rate` is.
        rate: frames per second; None = the take's own.
        edited: the take's clip with other weights and rotations; None = as it is.
        like: a file in whose style it is written; None = the take's own, in its format.
        own_layout: whether a take of this format keeps its dialect; if not, it does so only if
            other programs read it as they read what the format writes.
        filled: the weights of its lost rows, as for `opening.encoded_take`.

    Raises:
        FileError: a weight is not a finite number.
    """
    clip = take.clip if edited is None else edited
    whole = with_filled(clip, take.lost_rows, filled)
    is_own = form.name == take.kind
    told = take.other_rate is None or form.write is None  # or nothing else can be written
    if is_own and (rate is None or (rate == clip.rate and told)):
        own = encoded_take(path, take, clip.weights, filled, clip.rotations, clip.confidence)
        others_read = take.other_rate is None and form.is_plain(own, whole)
        if own_layout or form.write is None or others_read:
            return Converted(own, whole, is_own=True, note=take.rate_note)
    assert form.write is not None
    clip = resampled(whole, rate, fill_gaps=not form.tells_times)
    style = like
    if is_own and own_layout:
        style = Like(take.source, nearest_rows(take.clip.times, clip.times))
    rows, styled = take.without_face(filled), None
    if style is not None:
        there = None if rows is None else rows.at_rate(whole, clip)
        styled = form.write_like(style.source, clip, style.frames, there)
    if styled is None:
        return Converted(form.write(clip), clip, faceless=_left_out(rows, whole, form))
    return Converted(styled.content, clip, is_styled=True, note=styled.note, kept=styled.kept)


def _left_out(rows: Faceless | None, clip: Clip, form: Format) -> str:
    """What becomes of rows without a face in a format's own layout."""
    if not form.tells_times:
        return left_out_note(rows, clip, f"{form.name} has no times", _FILLED)
    return left_out_note(rows, clip, "other programs need a number in every cell")


def with_filled(clip: Clip, lost: LostRows | None, filled: Floats | None) -> Clip:
    """A clip with frames for the lost rows that were filled.

    Args:
        lost: where the rows lie.
        filled: (L, K) their weights; a row of NaN is no frame.
    """
    if lost is None or filled is None:
        return clip
    found = lost.with_faces(filled, clip)
    if not len(found):
        return clip
    order = np.argsort(
        np.concatenate([np.arange(len(clip)), found.before + found.share]), kind="stable"
    )

    def joined(values: Floats, new: Floats) -> Floats:
        return np.concatenate([values, new.astype(np.float32, copy=False)])[order]

    times = np.concatenate([clip.times, found.times])[order]
    turned, sure = clip.rotations, clip.confidence
    return Clip(
        weights=joined(clip.weights, found.weights),
        channels=clip.channels,
        times=times,
        rate=clip.rate,
        gaps=find_gaps(times, clip.rate),
        timecodes=timecodes_at(clip.timecodes, times) if clip.timecodes else None,
        rotations=None if turned is None else joined(turned, found.between(turned)),
        rotation_names=clip.rotation_names,
        confidence=None if sure is None else joined(sure, np.zeros(len(found), np.float32)),
    )


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
        rotation_names=clip.rotation_names,
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
