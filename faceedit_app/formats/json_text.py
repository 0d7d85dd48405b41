"""JSON whose numbers can be replaced in place, while all other bytes stay the same.

Python's json module reads the document. It reports each number once, in the order of the file, so
the n-th number of the document is the n-th number of the text.
"""

from __future__ import annotations

import json
import re
from array import array
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from faceedit_app.core.arkit import ROTATIONS
from faceedit_app.core.arrays import Doubles, Floats
from faceedit_app.core.errors import FileError
from faceedit_app.formats.files import BOM, check_text
from faceedit_app.formats.lost_faces import LEAST_SURE
from faceedit_app.formats.numbers import (
    NumberFormat,
    as_written,
    detect_format,
    kept_text,
    shortest,
)
from faceedit_app.formats.rotations import in_degrees

# Strings are matched too, so that numbers inside them do not count.
_TOKEN = re.compile(rb'"(?:[^"\\]|\\.)*"|(-?\d+(?:\.\d+)?(?:[eE][+-]?\d+)?)', re.DOTALL)
# Numbers that are written as texts, but are no keys.
_NUMBER = r"-?\d+(?:\.\d+)?(?:[eE][+-]?\d+)?"
_AS_TEXT = re.compile(rf'"{_NUMBER}"\s*[,}}\]]'.encode())
_STRING = re.compile(rb'"(?:[^"\\]|\\.)*"(?:\s*:)?', re.DOTALL)
_QUOTED = re.compile(rf'"({_NUMBER})"'.encode())
_SPACE = re.compile(r"[ \t\r\n]*")
_FORMAT_SAMPLE = 10_000
# Python needs up to a hundred bytes for a number: this is a gigabyte or two.
_LARGEST, _MOST_NUMBERS = 400 << 20, 25_000_000
_SMALLER = "split the take, or save it as CSV"
_DAMAGED = "copy it from its source again"

Places = NDArray[np.int64]
"""Numbers of a document: n for the n-th, -1 for one that is missing (null or NaN)."""


class NumberPlace(int):
    """A number of a document: the n-th."""

    __slots__ = ()


@dataclass(frozen=True)
class JsonText:
    """A JSON file in memory.

    Attributes:
        path: the file, for messages.
        content: its bytes.
        numbers: its bytes, as long, with spaces for the quotes around numbers.
        document: the parsed document, with a `NumberPlace` for each number.
        values: (N,) float64 of its numbers, in order.
    """

    path: Path
    content: bytes
    numbers: bytes
    document: Any
    values: Doubles

    def error(self, problem: str, remedy: str = _DAMAGED, place: int = -1) -> FileError:
        """An error about this file, at one of its numbers."""
        return FileError(self.path, problem, remedy, self.line(place) if place >= 0 else None)

    def line(self, place: int) -> int:
        """The line of a number, counted from 1."""
        start = int(self.spans[place][0])
        return self.content.count(b"\n", 0, start) + 1

    @cached_property
    def spans(self) -> NDArray[np.int64]:
        """(N, 2) where each number begins and ends in `content`."""
        flat = array("q")
        for match in _TOKEN.finditer(self.numbers):
            if match[1] is not None:
                flat.extend(match.span(1))
        return np.frombuffer(flat, np.int64).reshape(-1, 2)

    def number(self, entry: Any) -> float | None:
        """The number at an entry of the document; None if the entry is not a number."""
        return float(self.values[entry]) if isinstance(entry, NumberPlace) else None

    def written(self, entry: NumberPlace) -> str:
        """A number as the file has it."""
        start, end = self.spans[entry].tolist()
        return self.content[start:end].decode("ascii", "replace")

    def places(self, entries: Sequence[Any]) -> Places:
        """Where the numbers of a list are; null counts as missing.

        Raises:
            FileError: an entry is neither a number nor null.
        """
        out = np.full(len(entries), -1, np.int64)
        for k, entry in enumerate(entries):
            if isinstance(entry, NumberPlace):
                out[k] = entry
            elif entry is not None:
                raise self.error("has a weight that is not a number")
        return out

    def look_up(self, places: Places) -> Doubles:
        """The numbers at some places; NaN where they are missing."""
        return np.where(places >= 0, np.append(self.values, np.nan)[places], np.nan)

    def replaced(self, places: Places, numbers: Sequence[bytes]) -> bytes:
        """The file with other numbers at some places (N,), in increasing order."""
        pieces, done = [], 0
        for (start, end), number in zip(self.spans[places].tolist(), numbers, strict=True):
            pieces += [self.content[done:start], number]
            done = end
        return b"".join([*pieces, self.content[done:]])


def looks_like_json(content: bytes) -> bool:
    """Whether a file begins like a JSON object or list."""
    return content[:64].removeprefix(BOM).lstrip()[:1] in (b"{", b"[")


def read_json(path: Path, content: bytes) -> JsonText:
    """Read a JSON file.

    Raises:
        FileError: it is not text, or not JSON.
    """
    check_text(path, content)
    if len(content) > _LARGEST:
        raise FileError(path, f"is JSON of over {_LARGEST >> 20} MB", _SMALLER)
    values = array("d")

    def number(text: str) -> NumberPlace:
        if len(values) >= _MOST_NUMBERS:
            raise FileError(path, f"has over {_MOST_NUMBERS:,} numbers", _SMALLER)
        values.append(float(text))
        return NumberPlace(len(values) - 1)

    decoder = json.JSONDecoder(
        parse_float=number, parse_int=number, parse_constant=lambda name: None
    )
    try:
        numbers = _without_quotes(content)
        document = _documents(decoder, numbers.removeprefix(BOM).decode())
    except UnicodeDecodeError:
        raise FileError(path, "is not UTF-8 text", "save it as UTF-8") from None
    except json.JSONDecodeError as error:
        ends = not error.doc[error.pos :].strip() or error.msg.startswith("Unterminated")
        problem = f"is damaged: {'it is cut off' if ends else error.msg.lower()}"
        raise FileError(path, problem, _DAMAGED, error.lineno) from None
    except RecursionError:
        raise FileError(path, "is damaged: it is nested too deeply", _DAMAGED) from None
    return JsonText(path, content, numbers, document, np.frombuffer(values, np.float64))


def _without_quotes(content: bytes) -> bytes:
    """The content with spaces for the quotes around numbers, as some programs write them."""
    if not _AS_TEXT.search(content):
        return content

    def bare(match: re.Match[bytes]) -> bytes:
        number = _QUOTED.fullmatch(match[0])  # a key, which a colon follows, stays
        return b" %b " % number[1] if number else match[0]

    return _STRING.sub(bare, content)


def _documents(decoder: json.JSONDecoder, text: str) -> Any:
    """The document of a text, or a list of them if it has several, as JSON Lines has."""
    found: list[Any] = []
    place = _after_space(text, 0)
    while place < len(text) or not found:
        document, end = decoder.raw_decode(text, place)
        found.append(document)
        place = _after_space(text, end)
        if place < len(text) and "\n" not in text[end:place] and text[place] not in "{[":
            raise json.JSONDecodeError("Extra data", text, place)
    return found if len(found) > 1 else found[0]


def _after_space(text: str, place: int) -> int:
    match = _SPACE.match(text, place)
    return match.end() if match else place


@dataclass(frozen=True)
class JsonSource:
    """A JSON file, and where a clip's weights are in it (`take.Source`).

    Attributes:
        text: the file.
        places: (T, K) the numbers of the weights; -1 if a weight is missing.
        scale: the value of a full blendshape in the file.
        sure_places: (T,) the numbers of the tracker's confidence; None if there are none.
        sure: (T,) what is to be written there; NaN = what is there.
        turn_places: (T, 9) the numbers of the rotations; -1 if one is missing; None if all are.
        turns: (T, 9) radians to be written there; NaN = what is there.
        degrees: the names of the rotations that the file has in degrees, not radians.
    """

    text: JsonText
    places: Places
    scale: float = 1.0
    sure_places: Places | None = None
    sure: Floats | None = None
    turn_places: Places | None = None
    turns: Floats | None = None
    degrees: frozenset[str] = frozenset()

    def encode(self, tracked: Floats, edited: Floats) -> bytes:
        """The whole file; see `take.Source.encode`."""
        changed = (tracked != edited) & (self.places >= 0)
        where, numbers = self._other_numbers()
        if changed.any():
            values = shortest(edited[changed]) * self.scale
            write = self._form.write
            where = np.concatenate([where, self.places[changed]])
            numbers = [*numbers, *(write(value) for value in values.tolist())]
        if not numbers:
            return self.text.content
        order = np.argsort(where)
        where = where[order]
        old = [self.text.content[a:b] for a, b in self.text.spans[where].tolist()]
        new = (numbers[k] for k in order.tolist())
        return self.text.replaced(where, list(map(kept_text, old, new)))

    def as_sure(self, tracked: Floats, edited: Floats) -> JsonSource:
        """The source with other confidence; see `take.SureSource.as_sure`."""
        # 0 would mean a frame without a face.
        new = np.where(edited == tracked, np.nan, np.maximum(edited, LEAST_SURE))
        return replace(self, sure=new.astype(np.float32))

    def rotated(self, tracked: Floats, edited: Floats) -> JsonSource:
        """The source with other rotations; see `take.RotatingSource.rotated`."""
        return replace(self, turns=np.where(edited == tracked, np.nan, edited).astype(np.float32))

    def _other_numbers(self) -> tuple[Places, list[bytes]]:
        """The places where confidence and rotations change, and the numbers that they become."""
        where, numbers = np.zeros(0, np.int64), list[bytes]()
        if self.sure is not None and self.sure_places is not None:
            changed = np.isfinite(self.sure)
            where = self.sure_places[changed]
            numbers += [f"{value:.3f}".encode() for value in self.sure[changed].tolist()]
        if self.turns is not None and self.turn_places is not None:
            changed = np.isfinite(self.turns) & (self.turn_places >= 0)
            where = np.concatenate([where, self.turn_places[changed]])
            is_degrees = np.array([name in self.degrees for name in ROTATIONS])
            turns = np.where(is_degrees, in_degrees(self.turns), self.turns)[changed]
            numbers += [f"{value:.6f}".encode() for value in turns.tolist()]
        return where, numbers

    def as_written(self, weights: Floats) -> Doubles:
        """See `take.RoundingSource.as_written`."""
        return as_written(weights, self.scale, self._form)

    @cached_property
    def _form(self) -> NumberFormat:
        return detect_format(self._sample(), self.scale)

    def _sample(self) -> list[bytes]:
        places = self.places[self.places >= 0]
        stride = max(1, len(places) // _FORMAT_SAMPLE)
        spans = self.text.spans[places[::stride]].tolist()
        return [self.text.content[a:b] for a, b in islice(spans, _FORMAT_SAMPLE)]


def as_object(entry: Any) -> Mapping[str, Any]:
    """The entry if it is a JSON object, else an empty one."""
    return entry if isinstance(entry, dict) else {}


def as_list(entry: Any) -> list[Any]:
    """The entry if it is a JSON list, else an empty one.

    An object with the keys 0, 1, 2 and so on is a list, as JavaScript writes typed arrays.
    """
    if isinstance(entry, dict) and "0" in entry:
        values = [entry.get(str(k)) for k in range(len(entry))]
        return values if None not in values else []
    return entry if isinstance(entry, list) else []
