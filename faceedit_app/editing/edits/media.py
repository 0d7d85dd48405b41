"""The sound and film of a take, and when they begin."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from faceedit_app.core.fields import Fields


@dataclass(frozen=True)
class MediaFile:
    """A sound or film file of a take.

    Attributes:
        path: its absolute path.
        offset: when it begins, in seconds of the take.
    """

    path: Path
    offset: float = 0.0


@dataclass(frozen=True)
class Placement:
    """The sound and the film of a take, if it has any."""

    sound: MediaFile | None = None
    film: MediaFile | None = None


def describe_change(before: Placement, after: Placement) -> str:
    """The name of a step from one placement to another, such as "Move film".

    A film and its own sound change together; such a step is named after the film.
    """
    for name, old, new in (
        ("film", before.film, after.film),
        ("sound", before.sound, after.sound),
    ):
        if old is None and new is not None:
            return f"Add {name}"
        if old is not None and new is None:
            return f"Remove {name}"
        if old is not None and new is not None and old != new:
            return f"Move {name}" if old.path == new.path else f"Replace {name}"
    return "Sound and film"


def describe_added(path: Path, before: Placement, after: Placement) -> str:
    """What to say of a file that was added: if it took the place of another one, which, too."""
    film, sound = _replaced(before.film, after.film), _replaced(before.sound, after.sound)
    if not (film or sound):
        return f"Added {path.name}"
    said = f"{path.name} replaces {film or sound}; Undo brings it back"
    return f"{said}; File > Track a film makes a new take of a film" if film else said


def _replaced(old: MediaFile | None, new: MediaFile | None) -> str:
    """The name of the file that another one took the place of; "" if there is none."""
    is_replaced = old is not None and new is not None and old.path != new.path
    return old.path.name if old is not None and is_replaced else ""


def sound_moved(before: Placement, after: Placement) -> float:
    """Seconds by which the same sound begins later; 0 if it is another one."""
    old, new = before.sound, after.sound
    if old is None or new is None or old.path != new.path:
        return 0.0
    return new.offset - old.offset


def to_json(placement: Placement | None) -> dict[str, Any] | None:
    """A placement as JSON values; None stands for the files found next to the take."""

    def entry(media: MediaFile | None) -> dict[str, Any] | None:
        return None if media is None else {"path": str(media.path), "offset": media.offset}

    if placement is None:
        return None
    return {"sound": entry(placement.sound), "film": entry(placement.film)}


def placement_from(fields: Fields | None) -> Placement | None:
    """Read what `to_json` returned.

    Raises:
        FieldError: it is damaged.
    """
    if fields is None:
        return None
    return Placement(*(_media(fields.fields_or_none(name)) for name in ("sound", "film")))


def _media(fields: Fields | None) -> MediaFile | None:
    return None if fields is None else MediaFile(Path(fields.path("path")), fields.number("offset"))
