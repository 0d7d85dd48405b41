"""GLB: the animation of a character's shape keys (glTF 2.0, animation channels of `weights`).

A track is one such channel: key times in seconds, and for each key the weights of all shapes of
the mesh, named by `extras.targetNames`. Meshes that share a take, such as head and teeth, have one
track each: those that follow the first are edited along. Everything else, such as another person
or another take, is carried.

An export overwrites the changed weights in place, and with them the tangents of their keys
(CUBICSPLINE). Weights stored as integers or compressed are written to the end of the file, as
floats.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from faceedit_app.core.arrays import Bools, Doubles, Floats
from faceedit_app.core.errors import FileError
from faceedit_app.core.glb import MAGIC, join_glb
from faceedit_app.core.names import canonical_channel
from faceedit_app.formats.files import shown
from faceedit_app.formats.followers import WHOLE, Following, following
from faceedit_app.formats.glb_tracks import (
    FLOAT,
    Glb,
    Track,
    UnusualStorage,
    parse,
    shape_channels,
    tracks_of,
)
from faceedit_app.formats.key_times import time_keys
from faceedit_app.formats.take import Recording, Take, finish_take

FORMAT = "GLB animation"
_DAMAGE = (KeyError, IndexError, TypeError, ValueError, AttributeError, struct.error)
_EXPORT_AGAIN = "export it again"
_SLOPES = (
    "only edited keys get new slopes: each key is exact, and between an edited key and one that is "
    "not, the curve may bend"
)
_SLOW = 0.25  # seconds from key to key that no tracker leaves
_NOT_NUMBERS = "holds weights that are not numbers"


def sniff(content: bytes) -> float:
    """How likely, 0..1, this is a GLB with an animation of shapes with ARKit names."""
    if not content.startswith(MAGIC):
        return 0.0
    try:
        names = {
            name for _, _, _, found in shape_channels(parse(content).document) for name in found
        }
    except _DAMAGE:
        return 0.0
    return 0.9 if any(map(canonical_channel, names)) else 0.0


def read(path: Path, content: bytes, fps: float | None) -> Take:
    """Open the animation in a GLB.

    Raises:
        RateNeeded: its times are unusable, and `fps` is None.
        FileError: it is damaged, or stored in a way that cannot be read.
    """
    try:
        glb = parse(content)
        tracks = list(tracks_of(glb))
    except UnusualStorage as error:
        raise FileError(path, str(error), "save it without compression") from None
    except _DAMAGE:
        raise FileError(path, "is damaged", _EXPORT_AGAIN) from None
    main = max(tracks, key=lambda track: (len(track.columns), _pace(track)))
    if not _is_finite(main):
        raise FileError(path, _NOT_NUMBERS, _EXPORT_AGAIN)
    main = _leader(main, tracks)
    together, columns = _together(main, tracks)
    first = [found[0] for found in columns.values()]
    values = np.stack([together[one.track].values[:, one.column] for one in first], axis=1)
    if not np.isfinite(values).all():
        raise FileError(path, _NOT_NUMBERS, _EXPORT_AGAIN)
    used = {name for track in together for name in track.names if canonical_channel(name)}
    recording = Recording(
        path=path,
        format=FORMAT,
        channels=tuple(columns),
        values=values.astype(np.float64),
        timing=time_keys(path, main.times, _EXPORT_AGAIN),
        lost=np.zeros(len(values), bool),
        notes=(_SLOPES,) if any(track.is_cubic for track in together) else (),
        carried=tuple(n for track in together for n in track.names if n and n not in used),
        unread=_unread(glb, tracks, together),
    )
    edited = tuple(_own(track, tracks, together) for track in together)
    places = tuple(tuple(found) for found in columns.values())
    return finish_take(recording, fps, lambda scale: GlbSource(glb, edited, places, scale))


def _is_finite(track: Track) -> bool:
    return bool(np.isfinite(track.values[:, list(track.columns.values())]).all())


def _pace(track: Track) -> int:
    """How likely a track is what is to be read; of several that are as likely, it is the first.

    Programs play the first: an export puts its take before what the character came with. A single
    key is a pose, and a few that are far apart, or do not move, are no performance.
    """
    steps = np.diff(track.times)
    if not len(steps):
        return 0
    weights = track.values[:, list(track.columns.values())]
    is_slow = float(np.median(steps)) > _SLOW
    return 2 if len(steps) > 1 and not is_slow and (weights != weights[0]).any() else 1


def _leader(main: Track, tracks: list[Track]) -> Track:
    """What a track follows in the same animation: teeth may come before the head."""
    for track in tracks:
        if track.sampler[0] != main.sampler[0] or not _may_follow(track, main):
            continue
        shared, follows = _follows(main, _weights(track), main.rounding + track.rounding)
        if shared and follows and (follows.share < WHOLE or not follows.channels.all()):
            main = track
    return main


def _together(main: Track, tracks: list[Track]) -> tuple[list[Track], dict[str, list[Place]]]:
    """The tracks that are edited together, and the places of each channel in them."""
    together: list[Track] = []
    columns: dict[str, list[Place]] = {}
    known: dict[str, Doubles] = {}
    for track in [main, *(track for track in tracks if track is not main)]:
        if not _may_follow(track, main):
            continue
        shared, follows = _follows(track, known, main.rounding + track.rounding)
        if follows is None:
            continue
        shares = {channel: WHOLE for channel in track.columns if channel not in known}
        along = zip(shared, follows.channels.tolist(), strict=True)
        shares |= {channel: follows.share for channel, is_along in along if is_along}
        for channel, share in shares.items():
            place = Place(len(together), track.columns[channel], share)
            columns.setdefault(channel, []).append(place)
        together.append(track)
        known = _weights(track) | known
    return together, columns


def _may_follow(track: Track, main: Track) -> bool:
    return np.array_equal(track.times, main.times) and _is_finite(track)


def _weights(track: Track) -> dict[str, Doubles]:
    values = track.values.astype(np.float64)
    return {channel: values[:, column] for channel, column in track.columns.items()}


def _follows(
    track: Track, known: dict[str, Doubles], rounding: float
) -> tuple[list[str], Following | None]:
    """The channels that a track shares with the known ones, and how it follows them."""
    shared = [channel for channel in track.columns if channel in known]
    own = track.values[:, [track.columns[channel] for channel in shared]].astype(np.float64)
    lead = np.array([known[channel] for channel in shared]).reshape(own.shape[::-1]).T
    return shared, following(lead, own, rounding)


def _own(track: Track, tracks: list[Track], together: list[Track]) -> Track:
    """A track that is written elsewhere if its numbers are also those of another that is kept."""
    kept = {one.offset for one in tracks if all(one is not other for other in together)}
    return replace(track, offset=None) if track.offset in kept else track


def _unread(glb: Glb, tracks: list[Track], together: list[Track]) -> tuple[str, ...]:
    """The note about other animations, or about other meshes that move in their own way."""
    played = {track.sampler[0] for track in together}
    others = [track for track in tracks if all(track is not one for one in together)]
    if not others:
        return ()
    beside = {track.sampler for track in others if track.sampler[0] in played}
    apart = {track.sampler[0] for track in others} - played
    main, which = together[0], []
    if main.sampler[0] != tracks[0].sampler[0]:
        which.append(_animation_name(glb, main.sampler[0]))
    if beside and main.mesh:
        which.append(f'that of "{shown(main.mesh)}"')
    note = f"one of {1 + len(beside) + len(apart)} animations is read"
    return (": ".join([note, ", ".join(which)]) if which else note,)


def _animation_name(glb: Glb, number: int) -> str:
    name = glb.document["animations"][number].get("name")
    return f'"{shown(name)}"' if isinstance(name, str) and name else f"number {number + 1}"


@dataclass(frozen=True)
class Place:
    """Where the weights of a channel are.

    Attributes:
        track: which of the edited tracks.
        column: the shape in it.
        share: the part of the channel's weight that the shape has.
    """

    track: int
    column: int
    share: float


@dataclass(frozen=True)
class GlbSource:
    """A GLB, and where a clip's weights are in it (`take.Source`).

    Attributes:
        glb: the file.
        tracks: the edited tracks.
        places: (K) the places of each channel.
        scale: the value of a full blendshape in the file.
    """

    glb: Glb
    tracks: tuple[Track, ...]
    places: tuple[tuple[Place, ...], ...]
    scale: float = 1.0

    def encode(self, tracked: Floats, edited: Floats) -> bytes:
        """The whole file; see `take.Source.encode`."""
        changed = tracked != edited
        if not changed.any():
            return self.glb.content
        values = [track.values.copy() for track in self.tracks]
        touched = [np.zeros(track.values.shape, bool) for track in self.tracks]
        for k, found in enumerate(self.places):
            rows = changed[:, k]
            for one in found:
                full = np.float32(self.scale * one.share)
                values[one.track][rows, one.column] = edited[rows, k] * full
                touched[one.track][rows, one.column] = True
        content = bytearray(self.glb.content)
        moved: list[tuple[Track, Floats]] = []
        for track, new, where in zip(self.tracks, values, touched, strict=True):
            if not where.any():
                continue
            output = _edited_output(track, new, where)
            if track.offset is None:
                moved.append((track, output))
            else:
                flat = np.frombuffer(content, "<f4", output.size, track.offset)
                rewritten = np.broadcast_to(where[:, None], output.shape)
                flat[rewritten.ravel()] = output[rewritten]
        return _with_new_outputs(bytes(content), moved) if moved else bytes(content)


def _edited_output(track: Track, values: Floats, touched: Bools) -> Floats:
    """The output of a track with the weights of `values` (T, N) where they are `touched` (T, N).

    Tangents of these keys turn by the slope of what the edit adds: its own curve is smooth, and
    that of the file keeps its corners.
    """
    output = track.output.copy()
    if track.is_cubic:
        turn = _slopes(track, values)
        output[:, 0][touched] += turn[touched]
        output[:, 2][touched] += turn[touched]
    output[:, output.shape[1] // 2][touched] = values[touched]
    return output


def _slopes(track: Track, values: Floats) -> Floats:
    """(T, N) the slopes, per second, of what weights (T, N) add; 0 where times stand still."""
    if len(track.times) < 2:
        return np.zeros_like(values)
    with np.errstate(all="ignore"):
        slopes = np.gradient(values - track.values, track.times, axis=0)
    finite: Floats = np.nan_to_num(slopes, nan=0.0, posinf=0.0, neginf=0.0).astype(np.float32)
    return finite


def _with_new_outputs(content: bytes, moved: list[tuple[Track, Floats]]) -> bytes:
    """A GLB with the outputs of some tracks at the end, as plain floats."""
    glb = parse(content)
    document: Any = glb.document
    binary = bytearray(content[slice(*glb.binary)])
    for track, output in moved:
        animation, number = track.sampler
        binary += b"\0" * (-len(binary) % 4)
        data = output.astype("<f4").tobytes()
        view = {"buffer": 0, "byteOffset": len(binary), "byteLength": len(data)}
        document["bufferViews"].append(view)
        document["accessors"].append(
            {
                "bufferView": len(document["bufferViews"]) - 1,
                "componentType": FLOAT,
                "count": output.size,
                "type": "SCALAR",
            }
        )
        sampler = document["animations"][animation]["samplers"][number]
        sampler["output"] = len(document["accessors"]) - 1
        binary += data
    document["buffers"][0]["byteLength"] = len(binary)
    return join_glb(document, bytes(binary))
