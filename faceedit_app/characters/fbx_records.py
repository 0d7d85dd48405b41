"""Write the record tree of a binary FBX 7.4 file.

The layout is the one that Blender's, ufbx's and Autodesk's readers expect; `fbx_tree.py` reads it.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterable
from typing import Any

import numpy as np

from faceedit_app.characters.fbx_tree import MAGIC, Record

_VERSION = 7400
_HEAD = struct.Struct("<IIIB")
_END = b"\0" * _HEAD.size
_ARRAYS = {"<f4": b"f", "<f8": b"d", "<i4": b"i", "<i8": b"l"}
# Readers check these bytes at the end of the file; they are the same in every file without a date.
FILE_ID = bytes.fromhex("28b32aebb624ccc2bfc8b02aa92bfcf1")
_FOOT_ID = bytes.fromhex("fabcab09d0c8d466b176fb831cf72667")
_FOOT_MAGIC = bytes.fromhex("f85a8c6adef5d97eece90ce3758f290b")


def fbx_content(records: Iterable[Record]) -> bytes:
    """A file of these top-level records.

    Values of records may be bool, int (32 bits), `numpy.int64` (64 bits), float, str, bytes, and
    arrays of float32, float64, int32 and int64.
    """
    out = bytearray(MAGIC + b"\x1a\0" + struct.pack("<I", _VERSION))
    for record in records:
        _add(out, record)
    out += _END + _FOOT_ID + b"\0" * 4
    out += b"\0" * (16 - len(out) % 16)
    return bytes(out + struct.pack("<I", _VERSION) + b"\0" * 120 + _FOOT_MAGIC)


def _add(out: bytearray, record: Record) -> None:
    values = b"".join(map(_value, record.values))
    name = record.name.encode()
    start = len(out)
    out += b"\0" * _HEAD.size + name + values
    for child in record.children:
        _add(out, child)
    if record.children or not record.values:
        out += _END
    _HEAD.pack_into(out, start, len(out), len(record.values), len(values), len(name))


def _value(value: Any) -> bytes:
    if isinstance(value, np.int64):
        return b"L" + struct.pack("<q", int(value))
    match value:
        case bool():
            return b"C" + struct.pack("<?", value)
        case int():
            return b"I" + struct.pack("<i", value)
        case float():
            return b"D" + struct.pack("<d", value)
        case str():
            text = value.encode()
            return b"S" + struct.pack("<I", len(text)) + text
        case bytes():
            return b"R" + struct.pack("<I", len(value)) + value
        case np.ndarray():
            raw = value.tobytes()
            packed = zlib.compress(raw, 1)
            smaller = len(packed) < len(raw)
            data = packed if smaller else raw
            kind = _ARRAYS[value.dtype.newbyteorder("<").str]
            return kind + struct.pack("<III", value.size, smaller, len(data)) + data
    raise TypeError(f"FBX has no {type(value).__name__}")
