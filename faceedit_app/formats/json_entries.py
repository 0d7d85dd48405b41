"""The frames of JSON that has an entry for each frame, or for each weight, in any layout.

Each frame has ARKit names somewhere inside, as `{"jawOpen": 0.1, ...}`, as
`[{"name": "jawOpen", "score": 0.1}, ...]`, or as `["jawOpen", 0.1, ...]`, which Swift makes of
ARKit's own dictionary. An entry per weight has a name, a number and a time.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cache
from itertools import islice
from typing import Any

from faceedit_app.formats.files import shown
from faceedit_app.formats.json_beside import Beside, beside
from faceedit_app.formats.json_clocks import clock_keys, running_clocks, text_of, value_at
from faceedit_app.formats.json_take import JsonFrames, Naming
from faceedit_app.formats.json_text import JsonText, NumberPlace, as_object
from faceedit_app.formats.long_form import Key, Repeated, group
from faceedit_app.formats.lost_faces import CONFIDENCE, is_flag, says_lost
from faceedit_app.formats.several_faces import names_faces, take_turns
from faceedit_app.formats.timecode import is_timecode

DEEPEST = 5
MOST_NAMES = 10_000  # of a frame, or of the lists of a document
TRIED = 50  # entries of a list that are looked at for weights, since the first may have no face
# Keys, in lower case, without separators.
NAMES = (
    *("name", "categoryname", "displayname", "shape", "shapename", "blendshape", "blendshapename"),
    *("key", "channel", "channelname", "curve", "parameter", "param", "target", "id", "k"),
    *("datapath", "attribute", "property", "propertyname"),
)
NUMBERS = ("score", "value", "weight", "val", "v", "w")
_SIDES = ("left", "right", "l", "r")
_DEEPEST_NAME = 3  # parts of a name before its last
_FEW = 6  # entries of an object that holds one weight
_LONGEST_KEY = 60
_PLAIN = re.compile(r"\d+(?:\.\d+)?")
_NUMBERED = re.compile(r"([A-Za-z]{1,12}[ _-]?)(\d+)")
_FEWEST_FRAMES = 2  # of a list beside the one that is read, which may hold a pose only
_MORE = 4  # entries that an inner list must have to be the frames of one face

FrameList = tuple[Sequence[str], Sequence[Any]]
"""The entries of frames, and their keys if they have some."""

Weights = Mapping[str, Any]
"""Numbers by name, as places in the document or None."""


def entry_frames(text: JsonText, naming: Naming, rate: float | None) -> JsonFrames | None:
    """The frames of a list with an entry for each."""
    found = next((one for one in _lists(text.document, 0) if _have_weights(one[1], naming)), None)
    if found is None:
        return None
    (keys, entries), faces = _of_one_face(found, naming)
    faces = faces or _other_lists(text.document, found, naming)
    if not keys:
        entries, numbered = _of_first_face(text, _without_ends(entries, naming))
        faces = (*faces, *numbered)
    sets = [list(_sets(entry, naming)) for entry in entries]
    weights = [_merged(one) for one in sets]
    lost = [_is_lost(text, entry) for entry in entries]
    if not all(lost):  # else the flag is never set
        weights = [{} if gone else row for gone, row in zip(lost, weights, strict=True)]
    clock, *clocks = running_clocks(
        text, [entry for entry, row in zip(entries, sets, strict=True) if row]
    )
    named = dict.fromkeys(name for row in weights for name in row)
    names = [name for name in named if not clock or name != clock[-1]]
    times = [value_at(entry, clock) for entry in entries] if clock else list(keys)
    others = _beside([e for e, row in zip(entries, weights, strict=True) if row], named, naming)
    rows = [
        [*(row.get(name) for name in names), *others.row(entry)] if row else []
        for entry, row in zip(entries, weights, strict=True)
    ]
    return JsonFrames(
        [*names, *others.turns],
        rows,
        times if None not in times else (),
        clock[-1] if clock else "time",
        rate,
        naming,
        others=[(at[-1], [value_at(entry, at) for entry in entries]) for at in clocks],
        unread=(*faces, *_unread(sets)),
        sure=[_sureness(entry) for entry in entries],
        beside=others.keys,
    )


def _beside(frames: Sequence[Any], names: Mapping[str, None], naming: Naming) -> Beside:
    """What frames have besides the weights of these names, and times."""

    def skips(key: str, value: Any) -> bool:
        if isinstance(value, dict):
            return bool(naming(key)) or any(_nested((key,), value, naming))
        return key in names or bool(next(_sets(value, naming), {}))

    return beside(frames, skips, lambda value: bool(next(_sets(value, naming), {})))


def _lists(entry: Any, depth: int) -> Iterator[FrameList]:
    """Lists that may be the frames, the outermost first, with the names of their entries."""
    if depth > DEEPEST:
        return
    if isinstance(entry, list):
        yield (), entry
    elif isinstance(entry, dict):
        if len(entry) > 1 and all(map(_is_number, entry)):
            keys = sorted(entry, key=float)
            yield keys, [entry[key] for key in keys]
        elif len(entry) > 1 and (numbers := _numbered(entry)):
            ordered = sorted(zip(numbers, entry.values(), strict=True), key=lambda one: one[0])
            yield [str(number) for number, _ in ordered], [value for _, value in ordered]
        elif len(entry) > 1 and all(map(is_timecode, entry)):
            yield list(entry), list(entry.values())
        for inner in islice(entry.values(), MOST_NAMES):
            yield from _lists(inner, depth + 1)


def _of_one_face(found: FrameList, naming: Naming) -> tuple[FrameList, tuple[str, ...]]:
    """The frames, of the first face if the entries found are faces with frames of their own."""
    entries = found[1]
    inner = [one for one in _lists(entries[0], 1) if _have_weights(one[1], naming)]
    own = max(inner, key=lambda one: len(one[1]), default=((), ()))
    if len(own[1]) <= max(len(entries), _MORE):
        return found, ()
    first, second = (set(next(_sets(entry, naming), {})) for entry in own[1][:2])
    if not first & second:  # parts of one frame
        return found, ()
    note = f"holds the frames of {len(entries)} faces or takes: the first are read"
    return own, (note,) if len(entries) > 1 else ()


def _of_first_face(text: JsonText, entries: Sequence[Any]) -> tuple[Sequence[Any], tuple[str, ...]]:
    """The entries without those of other faces, if faces that are numbered take turns."""
    key = next((key for key in as_object(entries[0]) if names_faces(key)), None)
    labels = [] if key is None else [text_of(text, as_object(e).get(key)) for e in entries]
    if not take_turns(labels):
        return entries, ()
    of_first = [entry for entry, one in zip(entries, labels, strict=True) if one == labels[0]]
    return of_first, (f"has frames of {len(set(labels))} faces: those of the first are read",)


def _other_lists(document: Any, found: FrameList, naming: Naming) -> tuple[str, ...]:
    """The note about other lists with frames of the same weights, beside the one that is read."""
    keys, entries = found
    if keys:
        return ()
    first = next(filter(None, (next(_sets(e, naming), None) for e in entries[:TRIED])), {})
    own = set(filter(naming, first))
    count = 1
    for _, others in _lists(document, 0):
        if others is entries or len(others) < _FEWEST_FRAMES:
            continue
        if _have_weights(others, naming):
            count += not own.isdisjoint(next(_sets(others[0], naming), {}))
    if count < 2:
        return ()
    name = shown(_key_of(document, entries) or "")
    return (f'holds {count} lists of frames, of several faces or takes: "{name}" is read',)


def _key_of(entry: Any, wanted: Sequence[Any]) -> str | None:
    """The outermost key of an object below which a list is, or None."""
    for key, value in islice(as_object(entry).items(), MOST_NAMES):
        if value is wanted or _key_of(value, wanted) is not None:
            return key
    return None


def _without_ends(entries: Sequence[Any], naming: Naming) -> Sequence[Any]:
    """The entries without a first or last one that is no frame, such as a header of JSON Lines."""
    frame = next((e for e in entries[:TRIED] if next(_sets(e, naming), {})), None)
    keys = as_object(frame).keys()

    def is_other(entry: Any) -> bool:
        if not entry or not isinstance(entry, dict) or next(_sets(entry, naming), {}):
            return False
        return keys.isdisjoint(entry)

    start = 1 if keys and is_other(entries[0]) else 0
    end = len(entries) - (1 if keys and is_other(entries[-1]) else 0)
    return entries[start:end]


def _numbered(keys: Iterable[str]) -> list[int]:
    """The numbers of keys such as `frame_12`, all with the same word; empty if they are others."""
    matches = [_NUMBERED.fullmatch(key) for key in keys]
    found = [match for match in matches if match]
    is_same = len(found) == len(matches) and len({match[1] for match in found}) == 1
    return [int(match[2]) for match in found] if is_same else []


def _is_number(text: str) -> bool:
    return _PLAIN.fullmatch(text.strip()) is not None


def _is_lost(text: JsonText, entry: Any) -> bool:
    """Whether a frame says that the face was not tracked: false, or a confidence of 0."""
    flags = ((key, value) for key, value in as_object(entry).items() if is_flag(key))
    return any(says_lost(key, text_of(text, value)) for key, value in flags)


def _sureness(entry: Any) -> Any:
    """What a frame says about how sure the tracker was, or None."""
    named = as_object(entry).items()
    return next((value for key, value in named if letters(key) == CONFIDENCE), None)


def _unread(sets: Sequence[Sequence[Weights]]) -> tuple[str, ...]:
    """The note about frames that have the weights of several faces."""
    most = max(sum(1 for one in row if not one.keys().isdisjoint(row[0])) for row in sets if row)
    return (f"a frame has the weights of {most} faces: the first is read",) if most > 1 else ()


def _merged(sets: Sequence[Weights]) -> Weights:
    """All weights of a frame; of those with the same name, the first."""
    if len(sets) == 1:
        return sets[0]
    return {name: value for one in reversed(sets) for name, value in one.items()}


def _have_weights(entries: Sequence[Any], naming: Naming) -> bool:
    """Whether entries are frames: each may have weights, rather than be one weight."""
    tried = entries[:TRIED]
    pairs = (_named_number(entry) for entry in tried)
    if any(pair is not None and naming(pair[0]) for pair in pairs):
        return False
    return any(next(_sets(entry, naming), {}) for entry in tried)


def _sets(entry: Any, naming: Naming, depth: int = 0) -> Iterator[Weights]:
    """The sets of weights in a frame, wherever they are in it."""
    if depth > DEEPEST or not isinstance(entry, dict | list) or len(entry) > MOST_NAMES:
        return
    own = _of_object(entry, naming) if isinstance(entry, dict) else _of_list(entry)
    if any(map(naming, own)):
        yield own
        if isinstance(entry, list):
            return
    inner = entry.values() if isinstance(entry, dict) else islice(entry, TRIED)
    for one in inner:
        if isinstance(one, dict | list):
            yield from _sets(one, naming, depth + 1)


def _of_object(entry: Mapping[str, Any], naming: Naming) -> Weights:
    """The numbers of `{"jawOpen": 0.1}`, also as `{"value": 0.1}`, and of nested names."""
    found = {n: v for n, v in entry.items() if v is None or isinstance(v, NumberPlace)}
    for name, value in entry.items():
        number = _number_of(value) if isinstance(value, dict) and len(value) <= _FEW else None
        if number is not None and naming(name):
            found[name] = number
        elif isinstance(value, dict):
            found |= dict(_nested((name,), value, naming))
    return found


def _nested(
    path: tuple[str, ...], entry: Mapping[str, Any], naming: Naming
) -> Iterator[tuple[str, Any]]:
    """The numbers of `{"jaw": {"open": 0.1}}` or `{"left": {"eyeBlink": 0.1}}`, by joined name.

    A name that is a channel without the outermost one is found there.
    """
    if len(path) > _DEEPEST_NAME or len(entry) > MOST_NAMES:
        return
    for name, value in entry.items():
        longer = (*path, name)
        if isinstance(value, dict):
            number = _number_of(value) if len(value) <= _FEW else None
            if number is None:
                yield from _nested(longer, value, naming)
                continue
            value = number
        if not isinstance(value, NumberPlace | None):
            continue
        joined = _joined(longer)
        if naming(joined) and not any(naming(_joined(longer[k:])) for k in range(1, len(longer))):
            yield joined, value


def _joined(path: tuple[str, ...]) -> str:
    """A name from its parts, a side last."""
    return "_".join(sorted(path, key=lambda part: letters(part) in _SIDES))


def _of_list(entries: Sequence[Any]) -> Weights:
    """The numbers of a list of names and numbers: objects, pairs, or one after the other."""
    if entries and isinstance(entries[0], str):
        names, numbers = entries[::2], entries[1::2]
        pairs = list(zip(names, numbers, strict=False))
    else:
        pairs = [pair for one in entries if (pair := _named_number(one)) is not None]
    return {
        n: v for n, v in pairs if isinstance(n, str) and (v is None or isinstance(v, NumberPlace))
    }


def _named_number(entry: Any) -> tuple[str, Any] | None:
    """The name and the number of `{"name": "jawOpen", "score": 0.1}` or `["jawOpen", 0.1]`."""
    if isinstance(entry, list):
        return (entry[0], entry[1]) if len(entry) == 2 and isinstance(entry[0], str) else None
    if not isinstance(entry, dict):
        return None
    keys = {letters(key): key for key in reversed(entry)}
    name = next((entry[keys[k]] for k in NAMES if k in keys and is_text(entry[keys[k]])), None)
    number = next((keys[key] for key in NUMBERS if key in keys), None)
    if name is None or number is None:
        return None
    value = entry[number]
    return (name, value) if value is None or isinstance(value, NumberPlace) else None


def _number_of(entry: Mapping[str, Any]) -> NumberPlace | None:
    numbers = (value for key, value in entry.items() if letters(key) in NUMBERS)
    return next((value for value in numbers if isinstance(value, NumberPlace)), None)


def is_text(value: Any) -> bool:
    """Whether a value may be a name."""
    return isinstance(value, str) and bool(value)


@cache
def letters(key: str) -> str:
    """A key without case and separators."""
    return re.sub(r"[\W_]", "", key[:_LONGEST_KEY]).lower()


# --- an entry per weight -------------------------------------------------------------------------


def single_weights(text: JsonText, naming: Naming, rate: float | None) -> JsonFrames | None:
    """The frames of a list with an entry for each weight: a name, a number and a time."""
    for _, entries in _lists(text.document, 0):
        pairs = [_named_number(entry) for entry in entries[:TRIED]]
        named = [pair for pair in pairs if pair is not None and naming(pair[0])]
        if entries and 2 * len(named) > len(pairs):
            break
    else:
        return None
    clocks = clock_keys(as_object(entries[0]))
    named = [pair for entry in entries if (pair := _named_number(entry)) is not None]
    kept = [as_object(entry) for entry in entries if _named_number(entry) is not None]
    keys: list[Key] = [tuple(text_of(text, entry.get(k)) for k in clocks) for entry in kept]
    try:
        _, names, places = group([name for name, _ in named], keys)
    except Repeated as repeated:
        name, place = named[repeated.entry]
        problem = f'gives "{shown(name)}" twice at the same time'
        raise text.error(problem, "keep the weights of one face", int(place)) from None
    weights = [[named[n][1] if n >= 0 else None for n in row] for row in places.tolist()]
    times = [kept[int(row.max())].get(clocks[0]) for row in places] if clocks else ()
    return JsonFrames(names, weights, times, clocks[0] if clocks else "time", rate, naming)
