"""Read FaceEdit's own JSON: every field is checked, and named if it is wrong.

Results are bounded: numbers are finite and at most `LARGEST`, texts can be written again and have
a limited length, and lists are no longer than their reader allows.
"""

from __future__ import annotations

import json
import os
import re
import stat
from enum import StrEnum
from pathlib import Path
from typing import Any, TypeVar

from faceedit_app.core.errors import FileError, reason_of

Member = TypeVar("Member", bound=StrEnum)

# Seconds or millimetres: far beyond any take and any face, far below where sums overflow.
LARGEST = 1e6
LONGEST_TEXT = 1_000
LONGEST_PATH = 32_767  # the limit on Windows; other systems allow less
MOST_BYTES = 256 * 2**20
MOST_ITEMS = 100_000
DEEPEST = 8  # nested objects and lists, in a field that may hold anything
_WIDEST = 8  # numbers in a row of `Fields.rows`
_QUOTED = 40  # characters of a text that an error quotes
_SURROGATE = re.compile("[\ud800-\udfff]")


class FieldError(ValueError):
    """A field that is wrong; the text says which one and how, as a phrase."""


def parse(content: bytes | str) -> Any:
    """Parse a JSON text.

    Raises:
        json.JSONDecodeError: it is not JSON.
        ValueError: it is not UTF-8, nested too deeply, or has a number with thousands of digits.
    """
    try:
        return json.loads(content.decode("utf-8-sig") if isinstance(content, bytes) else content)
    except RecursionError as error:
        raise FieldError("it is nested too deeply") from error


def to_text(value: Any, indent: int | None = None) -> str:
    """Readable JSON; characters that UTF-8 cannot hold are escaped."""
    text = json.dumps(value, indent=indent, ensure_ascii=False, allow_nan=False)
    return _SURROGATE.sub(lambda match: f"\\u{ord(match[0]):04x}", text)


def clean_text(text: str, longest: int = LONGEST_TEXT) -> str:
    """A text from the user, without anything that could not be read back from a file."""
    return _SURROGATE.sub("\ufffd", text)[:longest]


class Fields:
    """The fields of a JSON object; each is checked when it is read.

    Args:
        value: the object; anything else raises `FieldError`.
        name: its place in the document, such as `view`; empty for the document itself.

    Raises:
        FieldError: `value` is not an object.
    """

    def __init__(self, value: Any, name: str = "") -> None:
        if not isinstance(value, dict):
            raise FieldError(f'"{name}" is not an object' if name else "it is not an object")
        self._values: dict[str, Any] = value
        self._name = name
        self._known: set[str] = set()

    def has(self, name: str) -> bool:
        """Whether there is such a field."""
        self._known.add(name)
        return name in self._values

    def finish(self) -> None:
        """Check that every field was read: the others would be lost when the file is saved.

        Raises:
            FieldError: there is an unknown field.
        """
        for name in sorted(self._values.keys() - self._known):
            raise FieldError(f"unknown field {_quoted(self._full(name))}")

    def number(
        self,
        name: str,
        default: float | None = None,
        low: float = -LARGEST,
        high: float = LARGEST,
    ) -> float:
        """A number in a range; the field is required if there is no default."""
        return self._number(name, self._value(name, default), low, high)

    def number_or_none(
        self, name: str, low: float = -LARGEST, high: float = LARGEST
    ) -> float | None:
        """A number in a range, or None if the field is null or absent."""
        return self.number(name, None, low, high) if self.has(name) else None

    def whole(self, name: str, low: int = 0, high: int = 2**53) -> int:
        """A whole number in a range."""
        value = self._value(name, None)
        if isinstance(value, bool) or not isinstance(value, int):
            raise FieldError(f"{self._full(name)} is not a whole number")
        self._within(name, value, low, high)
        return value

    def span(self, name: str) -> tuple[float, float] | None:
        """Two numbers in order, or None if the field is null or absent."""
        if self._is_null(name):
            return None
        (span,) = self._pairs(name, [self._values[name]])
        if span[1] < span[0]:
            raise FieldError(f"{self._full(name)} ends before it begins")
        return span

    def pairs(self, name: str, most: int = MOST_ITEMS) -> tuple[tuple[float, float], ...]:
        """A list of pairs of numbers; empty if the field is absent."""
        return self._pairs(name, self.items(name, [], most))

    def rows(self, name: str, most: int = MOST_ITEMS) -> tuple[tuple[float, ...], ...]:
        """A list of lists of numbers; empty if the field is absent."""
        rows = self.items(name, [], most)
        if not all(isinstance(row, list) and len(row) <= _WIDEST for row in rows):
            raise FieldError(f"{self._full(name)} is not a list of lists of numbers")
        return tuple(
            tuple(self._number(name, cell, -LARGEST, LARGEST) for cell in row) for row in rows
        )

    def text(self, name: str, default: str | None = None, longest: int = LONGEST_TEXT) -> str:
        """A text."""
        return self._text(name, self._value(name, default), longest)

    def path(self, name: str) -> str:
        """A path as the file spells it: not empty, and valid on this system."""
        value = self._value(name, None)
        if not isinstance(value, str) or not 0 < len(value) <= LONGEST_PATH or "\0" in value:
            raise FieldError(f"{self._full(name)} is not a path")
        try:
            os.fsencode(value)  # accepts all that the system does, even names outside Unicode
        except UnicodeEncodeError:
            raise FieldError(f"{self._full(name)} is not a path") from None
        return value

    def flag(self, name: str, default: bool | None = None) -> bool:
        """True or false."""
        value = self._value(name, default)
        if not isinstance(value, bool):
            raise FieldError(f"{self._full(name)} is neither true nor false")
        return value

    def choice(self, name: str, kind: type[Member], default: Member | None = None) -> Member:
        """One of the words of an enumeration."""
        value = self._value(name, default)
        if not isinstance(value, str) or value not in list(kind):
            raise FieldError(f"{self._full(name)} must be one of {', '.join(kind)}")
        return kind(value)

    def choice_or_none(self, name: str, kind: type[Member]) -> Member | None:
        """One of the words of an enumeration, or None if the field is null or absent."""
        return None if self._is_null(name) else self.choice(name, kind)

    def items(
        self, name: str, default: list[Any] | None = None, most: int = MOST_ITEMS
    ) -> list[Any]:
        """A list."""
        value = self._value(name, default)
        if not isinstance(value, list):
            raise FieldError(f"{self._full(name)} is not a list")
        if len(value) > most:
            raise FieldError(f"{self._full(name)} has more than {most:,} entries")
        return value

    def texts(self, name: str, most: int = MOST_ITEMS) -> tuple[str, ...]:
        """A list of texts."""
        return tuple(self._text(name, text, LONGEST_TEXT) for text in self.items(name, most=most))

    def fields(self, name: str, default: dict[str, Any] | None = None) -> Fields:
        """An object; `default` if the field is absent."""
        return Fields(self._value(name, default), self._path(name))

    def fields_or_none(self, name: str) -> Fields | None:
        """An object, or None if the field is null or absent."""
        return None if self._is_null(name) else self.fields(name)

    def plain(self, name: str) -> dict[str, Any]:
        """An object whose fields are checked only for size; `{}` if the field is absent."""
        value = self._value(name, {})
        if not isinstance(value, dict):
            raise FieldError(f"{self._full(name)} is not an object")
        self._check_plain(name, value)
        return value

    # --- checks ------------------------------------------------------------------------------

    def _path(self, name: str) -> str:
        return f"{self._name}.{name}" if self._name else name

    def _full(self, name: str) -> str:
        return f'"{self._path(name)}"'

    def _is_null(self, name: str) -> bool:
        return not self.has(name) or self._values[name] is None

    def _value(self, name: str, default: Any) -> Any:
        if not self.has(name) and default is None:
            raise FieldError(f"{self._full(name)} is missing")
        return self._values.get(name, default)

    def _number(self, name: str, value: Any, low: float, high: float) -> float:
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise FieldError(f"{self._full(name)} is not a number")
        self._within(name, value, low, high)
        return float(value)

    def _within(self, name: str, value: float, low: float, high: float) -> None:
        if not low <= value <= high:  # true for NaN as well
            raise FieldError(f"{self._full(name)} must be between {low:,.10g} and {high:,.10g}")

    def _text(self, name: str, value: Any, longest: int) -> str:
        if not isinstance(value, str):
            raise FieldError(f"{self._full(name)} is not text")
        if len(value) > longest:
            raise FieldError(f"{self._full(name)} is longer than {longest:,} characters")
        if _SURROGATE.search(value):
            raise FieldError(f"{self._full(name)} has a damaged character")
        return value

    def _pairs(self, name: str, values: list[Any]) -> tuple[tuple[float, float], ...]:
        if not all(isinstance(pair, list) and len(pair) == 2 for pair in values):
            raise FieldError(f"{self._full(name)} is not a list of pairs of numbers")
        low, high = -LARGEST, LARGEST
        return tuple(
            (self._number(name, a, low, high), self._number(name, b, low, high)) for a, b in values
        )

    def _check_plain(self, name: str, value: Any) -> None:
        left = [(value, 1)]
        for item, depth in left:  # it grows as it is walked
            if depth > DEEPEST or len(left) > MOST_ITEMS:
                raise FieldError(f"{self._full(name)} holds too much")
            match item:
                case dict():
                    left += [(part, depth + 1) for pair in item.items() for part in pair]
                case list():
                    left += [(part, depth + 1) for part in item]
                case str():
                    self._text(name, item, LONGEST_TEXT)
                case int() | float() if not -(2**53) <= item <= 2**53:
                    raise FieldError(f"{self._full(name)} holds a number out of range")


def _quoted(text: str) -> str:
    """A text from a file, made fit for an error: short and on one line."""
    short = text if len(text) <= _QUOTED else f'{text[:_QUOTED]}…"'
    return short.encode("unicode_escape").decode() if not short.isprintable() else short


def read_document(path: Path, kind: str, version: int) -> Fields:
    """Read a JSON file with a version.

    Args:
        path: the file.
        kind: what it should be, such as "edits file".
        version: the only version that this FaceEdit reads.

    Raises:
        FileError: it cannot be read, is something else, or was written by a newer FaceEdit.
    """
    try:
        document = parse(_content(path))
        fields = Fields(document)
    except OSError as error:
        reason = reason_of(error)
        raise FileError(path, f"cannot be read ({reason})", "check the path") from error
    except json.JSONDecodeError as error:
        problem = f"is not JSON ({_json_problem(error)} at column {error.colno})"
        raise FileError(
            path, problem, f"correct it, or choose another {kind}", error.lineno
        ) from error
    except FieldError as error:
        remedy = "choose one that FaceEdit saved"
        raise FileError(path, f"is not a valid {kind}: {error}", remedy) from error
    except ValueError as error:  # not UTF-8, or a number with thousands of digits
        raise FileError(path, f"is not a valid {kind}", "choose one that FaceEdit saved") from error
    found = document["version"] if fields.has("version") else None
    if found != version or isinstance(found, bool):
        raise FileError(
            path,
            f"has version {_quoted(repr(found))}, this FaceEdit reads version {version}",
            "update FaceEdit",
        )
    return fields


def is_document(path: Path, *keys: str, only: bool = False) -> bool:
    """Whether a file is a JSON object with some keys, of any version; False if it cannot be read.

    Args:
        keys: those that it must have.
        only: and no others.
    """
    try:
        document = parse(_content(path))
    except (OSError, ValueError):
        return False
    if not isinstance(document, dict):
        return False
    return set(document) == set(keys) if only else set(keys) <= set(document)


def _json_problem(error: json.JSONDecodeError) -> str:
    """What is wrong at the place of an error."""
    before, there = error.doc[: error.pos].rstrip(), error.doc[error.pos : error.pos + 1]
    if before.endswith(",") and there and there in "]}":
        return f'the comma before "{there}" is one too many,'
    return error.msg[:1].lower() + error.msg[1:]


def _content(path: Path) -> bytes:
    """The content of a file.

    Raises:
        OSError: it cannot be read.
        FieldError: it is too large for a document, or not a regular file (a pipe may never end).
    """
    about = path.stat()
    if not stat.S_ISREG(about.st_mode) and not stat.S_ISDIR(about.st_mode):
        raise FieldError("it is not a file")
    if about.st_size > MOST_BYTES:
        raise FieldError(f"it is larger than {MOST_BYTES // 2**20} MB")
    return path.read_bytes()
