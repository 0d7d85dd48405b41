"""Read the record tree of a binary FBX file (versions 7.0 to 7.7).

This is our own code because the Python bindings of ufbx are immature. The layout is the one that
Blender's and ufbx's readers expect.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from faceedit_app.characters.bounded import Damaged, read_file
from faceedit_app.core.errors import FileError

MAGIC = b"Kaydara FBX Binary  \x00"
_OLDEST, _NEWEST, _WIDE = 7000, 7999, 7500
_DEEPEST = 40
_LARGEST_ARRAY = 400_000_000  # bytes
_SCALARS = {"Y": "<h", "I": "<i", "F": "<f", "D": "<d", "L": "<q", "C": "<?", "B": "<?"}
_ARRAYS = {"f": "<f4", "d": "<f8", "l": "<i8", "i": "<i4", "b": "i1", "c": "u1"}


@dataclass(frozen=True)
class Record:
    """A record: a name, values and child records.

    Attributes:
        values: numbers, texts, bytes or one-dimensional arrays.
    """

    name: str
    values: tuple[Any, ...]
    children: tuple[Record, ...] = ()

    def all(self, name: str) -> Iterator[Record]:
        """The child records with a name."""
        return (child for child in self.children if child.name == name)

    def first(self, name: str) -> Record | None:
        """The first child record with a name, or None."""
        return next(self.all(name), None)

    def array(self, name: str) -> NDArray[Any] | None:
        """The array in the first child record with a name, or None."""
        child = self.first(name)
        value = child.values[0] if child and child.values else None
        return value if isinstance(value, np.ndarray) else None

    def text(self, name: str) -> str:
        """The text in the first child record with a name; "" if there is none."""
        child = self.first(name)
        value = child.values[0] if child and child.values else None
        return value if isinstance(value, str) else ""


def read_tree(path: Path) -> Record:
    """The records of a file, as children of a record without a name.

    Raises:
        FileError: it cannot be read, is a text FBX, or its version is not supported.
        Damaged: it contradicts itself.
    """
    content = read_file(path)
    if not content.startswith(MAGIC[:18]):
        if content[:1] == b";" or b"FBXHeaderExtension" in content[:2000]:
            raise FileError(path, "is a text FBX", "export it as binary FBX, or as GLB")
        raise FileError(path, "is not an FBX file", "export it as binary FBX, or as GLB")
    if len(content) < 27:
        raise Damaged("it is cut short")
    version = struct.unpack_from("<I", content, 23)[0]
    if not _OLDEST <= version <= _NEWEST:
        age = "older" if version < _OLDEST else "newer"
        problem = f"is FBX {version / 1000:.1f}, {age} than FaceEdit supports"
        raise FileError(path, problem, "export it as FBX 2014 to 2020, or as GLB")
    return Record("", (), tuple(_Reader(content, version >= _WIDE).records(27)))


class _Reader:
    """Reads records from a file's bytes.

    Args:
        content: the whole file.
        is_wide: whether sizes take eight bytes (from version 7.5 on), or four.
    """

    def __init__(self, content: bytes, is_wide: bool) -> None:
        self._content = content
        self._head = struct.Struct("<QQQB" if is_wide else "<IIIB")

    def records(self, place: int, end: int | None = None, depth: int = 0) -> Iterator[Record]:
        """The records from a place up to an empty record, or to `end`."""
        if depth > _DEEPEST:
            raise Damaged("its records are nested too deep")
        stop = len(self._content) if end is None else end
        while place < stop:
            if end is None and place + self._head.size > stop:
                raise Damaged("it is cut short")
            record, place = self._record(place, stop, depth)
            if record is None:
                return
            yield record

    def _record(self, place: int, stop: int, depth: int) -> tuple[Record | None, int]:
        end, count, size, length = self._unpack(self._head, place)
        place += self._head.size
        if end == 0:
            return None, place
        values_end = place + length + size
        if not place + length <= values_end <= end <= stop:
            raise Damaged("it is cut short")
        if count > size:
            raise Damaged("a record has more values than bytes")
        name = self._content[place : place + length].decode("utf-8", "replace")
        values, at = [], place + length
        for _ in range(count):
            value, at = self._value(at, values_end)
            values.append(value)
        children = tuple(self.records(values_end, end, depth + 1))
        return Record(name, tuple(values), children), end

    def _value(self, place: int, stop: int) -> tuple[Any, int]:
        kind = chr(self._content[place]) if place < stop else ""
        place += 1
        if kind in _SCALARS and kind:
            layout = struct.Struct(_SCALARS[kind])
            return self._unpack(layout, place)[0], place + layout.size
        if kind in _ARRAYS and kind:
            count, encoding, size = self._unpack(struct.Struct("<III"), place)
            place += 12
            if place + size > stop:
                raise Damaged("an array is cut short")
            return self._array(place, size, count, encoding, _ARRAYS[kind]), place + size
        if kind in ("S", "R") and kind:
            size = self._unpack(struct.Struct("<I"), place)[0]
            place += 4
            if place + size > stop:
                raise Damaged("a text is cut short")
            content = self._content[place : place + size]
            return content.decode("utf-8", "replace") if kind == "S" else content, place + size
        raise Damaged("it holds a value of an unknown kind")

    def _array(self, place: int, size: int, count: int, encoding: int, kind: str) -> NDArray[Any]:
        dtype = np.dtype(kind)
        wanted = count * dtype.itemsize
        content = self._content[place : place + size]
        # Deflate makes at best 1032 bytes of one.
        if wanted > _LARGEST_ARRAY or (encoding and wanted > 1040 * size + 64):
            raise Damaged("an array claims more than it can hold")
        if encoding:
            try:
                content = zlib.decompressobj().decompress(content, wanted + 1)
            except zlib.error as error:
                raise Damaged("an array cannot be decompressed") from error
        if len(content) != wanted:
            raise Damaged("an array has another size than it claims")
        return np.frombuffer(content, dtype)

    def _unpack(self, layout: struct.Struct, place: int) -> tuple[Any, ...]:
        if place + layout.size > len(self._content):
            raise Damaged("it is cut short")
        return layout.unpack_from(self._content, place)
