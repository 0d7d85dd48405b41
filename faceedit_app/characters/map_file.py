"""A character's map: the user's choice of shapes and control points, in a file next to it."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from faceedit_app.characters.bounded import read_file
from faceedit_app.characters.character import PartVertex
from faceedit_app.characters.matches import Half, ShapeMatch, Share
from faceedit_app.characters.points import POINTS
from faceedit_app.core import on_disk
from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.atomic import write_keeping
from faceedit_app.core.errors import FileError
from faceedit_app.core.fields import is_document
from faceedit_app.core.levels import STRONGEST_LEVEL, UNCHANGED, Level, is_level

ENDING = ".map.json"
_VERSION = 1
_LEVEL = ("multiplier", "offset", "limit")
_LARGEST = 4 << 20  # bytes
_REMEDY = "correct it, or delete it to have the shapes matched by their names"


@dataclass(frozen=True)
class CharacterMap:
    """What the user has set; everything else is found automatically.

    Attributes:
        channels: the shapes of a channel, instead of those found by name; () is no shape.
        points: the places of control points.
        levels: how strongly the character answers channels.
    """

    channels: Mapping[str, tuple[Share, ...]] = field(default_factory=dict)
    points: Mapping[str, PartVertex] = field(default_factory=dict)
    levels: Mapping[str, Level] = field(default_factory=dict)

    def applied(self, match: ShapeMatch) -> ShapeMatch:
        """A match with the user's channels applied."""
        shares = {c: s for c, s in {**match.shares, **self.channels}.items() if s}
        used = {share.name for parts in shares.values() for share in parts}
        gone = {n for c in self.channels for n in match.matched.get(c, ()) if n not in used}
        unknown = (*(name for name in match.unknown if name not in used), *sorted(gone))
        return replace(match, shares=shares, unknown=unknown)


def map_path(character: Path) -> Path:
    """The path of the map of a character file or folder: `Head.glb.map.json`."""
    return character.with_name(character.name + ENDING)


def read_map(path: Path) -> CharacterMap | None:
    """Read a map; None if there is no such file.

    Raises:
        FileError: it cannot be read, or an entry is wrong.
    """
    if not on_disk.exists(path):
        return None
    try:
        stored = json.loads(read_file(path, _LARGEST))
    except (ValueError, RecursionError) as error:
        raise FileError(path, "is not JSON", _REMEDY) from error
    try:
        return _parsed(path, stored)
    except (KeyError, TypeError, AttributeError, ValueError, OverflowError) as error:
        raise FileError(path, "is not a character map", _REMEDY) from error


def write_map(path: Path, mapping: CharacterMap) -> Path | None:
    """Write a map, completely or not at all.

    Returns:
        The copy that was kept of a file that was no map; None if there was none.

    Raises:
        FileError: it cannot be written.
    """
    channels = {c: [_stored(share) for share in shares] for c, shares in mapping.channels.items()}
    points = {n: {"part": p.part, "vertex": p.vertex} for n, p in mapping.points.items()}
    document = {"faceedit_character_map": _VERSION, "channels": channels, "points": points}
    if mapping.levels:
        document["strength"] = {
            channel: dict(zip(_LEVEL, level, strict=True))
            for channel, level in mapping.levels.items()
        }
    text = json.dumps(document, indent=2, ensure_ascii=False)
    return write_keeping(
        path,
        text.encode("utf-8", "replace") + b"\n",
        lambda there: is_document(there, "faceedit_character_map"),
    )


def _stored(share: Share) -> str | dict[str, Any]:
    """A share in its shortest form: its name alone if the rest is default."""
    if share.weight == 1.0 and share.half is Half.WHOLE:
        return share.name
    stored: dict[str, Any] = {"shape": share.name}
    if share.weight != 1.0:
        stored["weight"] = share.weight
    if share.half is not Half.WHOLE:
        stored["half"] = str(share.half)
    return stored


def _parsed(path: Path, stored: Any) -> CharacterMap:
    version = stored["faceedit_character_map"]
    if version != _VERSION:
        raise FileError(path, f"has version {str(version)[:20]}", "update FaceEdit")
    channels = {}
    for channel, shares in stored.get("channels", {}).items():
        if channel not in ARKIT_INDEX:
            raise FileError(path, f"names the channel {channel[:60]}, which ARKit lacks", _REMEDY)
        parts = [shares] if isinstance(shares, (str, dict)) else list(shares or ())
        channels[channel] = tuple(_share(path, share) for share in parts)
    points = {}
    for name, place in stored.get("points", {}).items():
        if name not in POINTS:
            problem = f"names the point {name[:60]}, which is not one of {', '.join(POINTS)}"
            raise FileError(path, problem, _REMEDY)
        vertex = place["vertex"]
        if isinstance(vertex, bool) or not isinstance(vertex, int):
            raise ValueError(vertex)
        points[name] = PartVertex(str(place["part"]), vertex)
    given = stored.get("strength", {}).items()
    levels = {channel: _level(path, channel, numbers) for channel, numbers in given}
    return CharacterMap(channels, points, {c: n for c, n in levels.items() if n != UNCHANGED})


def _level(path: Path, channel: str, stored: Any) -> Level:
    if channel not in ARKIT_INDEX:
        raise FileError(path, f"names the channel {channel[:60]}, which ARKit lacks", _REMEDY)
    factor, offset, limit = (
        float(stored.get(name, usual)) for name, usual in zip(_LEVEL, UNCHANGED, strict=True)
    )
    if not is_level((factor, offset, limit)):
        raise FileError(
            path,
            f"has a strength of {channel} that is out of range",
            f"use a multiplier of 0 to {STRONGEST_LEVEL:g}, an offset of -1 to 1 and a limit above "
            "0, at most 1",
        )
    return factor, offset, limit


def _share(path: Path, stored: Any) -> Share:
    if isinstance(stored, str):
        return Share(stored)
    weight = float(stored.get("weight", 1.0))
    if not math.isfinite(weight) or abs(weight) > 100:
        raise FileError(path, f"has the weight {weight:g}", "use one from -100 to 100")
    half = stored.get("half", "")
    if half not in tuple(Half):
        raise FileError(
            path, f"has the half {str(half)[:20]}", f"use {', '.join(filter(None, Half))}"
        )
    return Share(str(stored["shape"]), weight, Half(half))
