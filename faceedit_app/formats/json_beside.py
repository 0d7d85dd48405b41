"""What frames of JSON have besides weights and times: rotations by their names, and the rest.

`{"blendShapes": {...}, "headYaw": 0.1}` and `{"blendShapes": {...}, "head": {"yaw": 0.1}}` have the
rotation headYaw. Of the rest, only the keys are told: matrices and lists have no names inside.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from faceedit_app.formats.json_text import JsonText, NumberPlace, as_object
from faceedit_app.formats.lost_faces import CONFIDENCE, is_flag, letters
from faceedit_app.formats.rotations import rotation_named, unit_named
from faceedit_app.formats.time_columns import time_columns

_SAMPLE = 50  # frames that are looked at
_DEEPEST = 5
_MOST_KEYS = 200  # of a frame
# Words in the keys of fields that say a unit of angles.
_ABOUT = ("unit", "angle", "rotation", "euler", "head", "eye", "pose", "orientation")

Path = tuple[str, ...]
"""Keys, each below the one before."""


@dataclass(frozen=True)
class Beside:
    """What frames have besides weights and times.

    Attributes:
        turns: where in a frame rotations are, by their joined keys.
        keys: the keys of the rest.
    """

    turns: Mapping[str, Path] = field(default_factory=dict)
    keys: tuple[str, ...] = ()

    def row(self, frame: Any) -> list[Any]:
        """The rotations of a frame, as places in the document or None, in the order of `turns`."""
        found = []
        for path in self.turns.values():
            value = frame
            for key in path:
                value = as_object(value).get(key)
            found.append(value if isinstance(value, NumberPlace) else None)
        return found


def beside(
    frames: Sequence[Any],
    skips: Callable[[str, Any], bool],
    enters: Callable[[Any], bool] = lambda value: False,
) -> Beside:
    """What frames have besides weights and times.

    Args:
        skips: whether the value of a key is known: weights, or something else that is read.
        enters: whether an object has weights, so that what is beside these is looked for in it.
    """
    turns: dict[str, Path] = {}
    keys: dict[str, None] = {}
    step = max(1, len(frames) // _SAMPLE)
    for frame in frames[::step]:
        for path, value in _others(as_object(frame), (), skips, enters):
            leaves = dict(_leaves(value, path))
            own = {".".join(at): at for at in leaves if rotation_named(".".join(at))}
            turns |= {name: at for name, at in own.items() if name not in turns}
            if len(own) < len(leaves):
                keys[".".join(path)] = None
    return Beside(turns, tuple(keys))


def _others(
    entry: Mapping[str, Any],
    above: Path,
    skips: Callable[[str, Any], bool],
    enters: Callable[[Any], bool],
) -> Iterator[tuple[Path, Any]]:
    """The values of an object that are neither weights nor times, and their keys."""
    if len(above) > _DEEPEST or len(entry) > _MOST_KEYS:
        return
    clocks = {list(entry)[k] for k in time_columns([key or "-" for key in entry])}
    for key, value in entry.items():
        if isinstance(value, dict) and enters(value):
            yield from _others(value, (*above, key), skips, enters)
        elif key in clocks or is_flag(key) or letters(key) == CONFIDENCE:
            continue
        elif value not in (None, "", [], {}) and not skips(key, value):
            yield (*above, key), value


def _leaves(value: Any, path: Path) -> Iterator[tuple[Path, Any]]:
    """The values in an object that are no objects, and their keys."""
    if isinstance(value, dict) and value and len(path) <= _DEEPEST and len(value) <= _MOST_KEYS:
        for key, inner in value.items():
            yield from _leaves(inner, (*path, key))
    else:
        # A list under a rotation's name would be none.
        yield (path if isinstance(value, NumberPlace | None) else (*path, "[]")), value


def stated_units(text: JsonText) -> dict[str, float]:
    """What fields of a document say that it has for a radian, of "head", "eye" or "" for both.

    They are fields such as `"units": "degrees"` or `"rotation": "deg"`, of the document and of the
    objects in it; those that contradict one another say nothing.
    """
    found: dict[str, set[float]] = {}
    for entry in _objects(text.document, 0):
        for key, value in entry.items():
            unit = unit_named(value) if isinstance(value, str) else None
            bare = letters(key)
            if unit is not None and any(word in bare for word in _ABOUT):
                about = next((part for part in ("head", "eye") if part in bare), "")
                found.setdefault(about, set()).add(unit)
    return {about: units.pop() for about, units in found.items() if len(units) == 1}


def _objects(entry: Any, depth: int) -> Iterator[Mapping[str, Any]]:
    """The objects of a document, of lists those of the first entry."""
    if depth > _DEEPEST:
        return
    if isinstance(entry, dict):
        yield entry
        if len(entry) <= _MOST_KEYS:
            for inner in entry.values():
                yield from _objects(inner, depth + 1)
    elif isinstance(entry, list) and entry:
        yield from _objects(entry[0], depth + 1)
