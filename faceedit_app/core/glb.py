"""The container of a GLB file: a JSON chunk and a binary chunk (glTF 2.0, section 4.4)."""

from __future__ import annotations

import json
import struct
from collections.abc import Mapping
from typing import Any

MAGIC = b"glTF"
_JSON, _BIN = b"JSON", b"BIN\0"


def split_glb(content: bytes) -> tuple[dict[str, Any], tuple[int, int]]:
    """The document of a GLB, and where its binary chunk starts and stops.

    Raises:
        ValueError, struct.error: it is damaged.
    """
    document: Any = None
    binary = (0, 0)
    start = 12
    while start + 8 <= len(content):
        length, kind = struct.unpack_from("<I4s", content, start)
        stop = start + 8 + length
        if stop > len(content):
            raise ValueError("a chunk is cut off")
        if kind == _JSON and document is None:
            try:
                document = json.loads(content[start + 8 : stop])
            except RecursionError as error:
                raise ValueError("its JSON is nested too deeply") from error
        elif kind == _BIN and binary == (0, 0):
            binary = start + 8, stop
        start = stop
    if not isinstance(document, dict):
        raise ValueError("there is no document")
    return document, binary


def join_glb(document: Mapping[str, Any], binary: bytes) -> bytes:
    """A GLB of a document and its binary chunk, whose `byteLength` it must state."""
    text = json.dumps(document, separators=(",", ":"), ensure_ascii=False).encode()
    text += b" " * (-len(text) % 4)
    binary += b"\0" * (-len(binary) % 4)
    chunks = struct.pack("<I4s", len(text), _JSON) + text
    chunks += struct.pack("<I4s", len(binary), _BIN) + binary
    return struct.pack("<4sII", MAGIC, 2, 12 + len(chunks)) + chunks
