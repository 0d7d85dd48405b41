"""Which sound and film belong to a take, and where in it they lie."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

LARGEST = 1e6  # seconds


@dataclass(frozen=True)
class MediaFile:
    """Sound or film of the take.

    Attributes:
        path: the file, absolute.
        offset: seconds of the take at which it begins.
    """

    path: Path
    offset: float = 0.0


@dataclass(frozen=True)
class Placement:
    """The sound and the film of a take, if any."""

    sound: MediaFile | None = None
    film: MediaFile | None = None


def to_json(placement: Placement | None) -> dict[str, Any] | None:
    """For the journal; `None` is what lies beside the take by itself."""

    def entry(media: MediaFile | None) -> dict[str, Any] | None:
        return None if media is None else {"path": str(media.path), "offset": media.offset}

    if placement is None:
        return None
    return {"sound": entry(placement.sound), "film": entry(placement.film)}


def from_json(entry: Mapping[str, Any] | None) -> Placement | None:
    """Read what `to_json` made.

    Raises:
        ValueError, KeyError, TypeError: it is damaged.
    """

    def media(entry: Mapping[str, Any] | None) -> MediaFile | None:
        if entry is None:
            return None
        offset = float(entry["offset"])
        if not math.isfinite(offset) or abs(offset) > LARGEST:
            raise ValueError("its offset is no number of seconds")
        return MediaFile(Path(entry["path"]), offset)

    return None if entry is None else Placement(media(entry["sound"]), media(entry["film"]))
