"""Damage files at random, as disks, networks and other programs do, and worse."""

from __future__ import annotations

import io
import random
import re
import struct
import zipfile

# What readers trip over: limits of integers and floats, deep nesting, text that is not text.
_NUMBERS = (
    *(b"-1", b"0", b"0.5", b"97", b"1e18", b"1e308", b"1e999", b"NaN", b"-Infinity", b"null"),
    *(
        b"2147483648",
        b"4294967295",
        b"9223372036854775808",
        b"1" * 400,
        b"1_0",
        b"1.7e9",
        b"1e-320",
    ),
)
_TOKENS = (
    *(b"[]", b"{}", b'""', b"[" * 3000, b'{"a":' * 2000, b'"' * 9, b'"\\ud800"', b"\\u0000"),
    *(b"\0", b"\xff\xfe", b"\x1b[31m", b"<img src=x>", b"../" * 40, b"a" * 5000, b"\n" * 500),
    *(b",,,,", b";", b"\t", b"\r", b"\xe2\x80\xae", b'"a""b"', b"23:59:59:59", b"00:00:00:00"),
)
_NUMBER = re.compile(rb"-?\d+(?:\.\d+)?(?:[eE][+-]?\d+)?")
# What may stand where a document has something else.
_VALUES = (
    *(b"null", b"true", b"[]", b"{}", b'""', b'"x"', b"[[]]", b"-1", b"0", b"2.5", b"1e308"),
    *(b"[null]", b'{"": 0}', b'[1,"a"]', b'"\\u0000"', b'"' + b"y" * 500 + b'"'),
)
_VALUE = re.compile(rb'"(?:[^"\\]|\\.){0,300}"|-?\d+(?:\.\d+)?|true|false|null')
_BYTES = (0x00, 0x01, 0x7F, 0x80, 0xFE, 0xFF)
_MOST = 8  # changes to one file
_INSIDE = 0.7  # of the containers are whole, and what is in them is damaged
_GLB = struct.Struct("<4sIII4s")  # up to the first chunk
_CHUNK = struct.Struct("<I4s")


def mutated(content: bytes, chance: random.Random) -> bytes:
    """A damaged copy of a file's content."""
    if content.startswith(b"glTF") and chance.random() < _INSIDE:
        return _with_damaged_chunk(content, chance)
    if content.startswith(b"PK") and chance.random() < _INSIDE:
        return _with_damaged_member(content, chance)
    return _damaged(content, chance)


def _with_damaged_chunk(content: bytes, chance: random.Random) -> bytes:
    """A GLB that is damaged inside one of its two chunks, whose lengths are right."""
    magic, version, _, length, kind = _GLB.unpack_from(content)
    text = content[_GLB.size : _GLB.size + length]
    binary = content[_GLB.size + length + _CHUNK.size :]
    if chance.random() < _INSIDE:
        text = _damaged(text, chance)
        text += b" " * (-len(text) % 4)
    else:
        binary = _damaged(binary, chance)
        binary += b"\0" * (-len(binary) % 4)
    total = _GLB.size + len(text) + _CHUNK.size + len(binary)
    head = _GLB.pack(magic, version, total, len(text), kind)
    return head + text + _CHUNK.pack(len(binary), b"BIN\0") + binary


def _with_damaged_member(content: bytes, chance: random.Random) -> bytes:
    """An archive in which one member is damaged."""
    out = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(content)) as archive, zipfile.ZipFile(out, "w") as new:
        names = archive.namelist()
        damaged = chance.choice(names)
        for name in names:
            member = archive.read(name)
            new.writestr(name, _damaged(member, chance) if name == damaged else member)
    return out.getvalue()


def _damaged(content: bytes, chance: random.Random) -> bytes:
    """A copy with some changes."""
    data = bytearray(content)
    for _ in range(chance.choice((1, 1, 1, 2, 3, _MOST))):
        chance.choice(_CHANGES)(data, chance)
    return bytes(data)


def _place(data: bytearray, chance: random.Random) -> int:
    """A place in the data; half of them near its beginning, where lengths and names are."""
    end = len(data) if chance.random() < 0.5 else min(len(data), 300)
    return chance.randrange(end + 1)


def _flip(data: bytearray, chance: random.Random) -> None:
    at = _place(data, chance)
    if at < len(data):
        data[at] ^= 1 << chance.randrange(8)


def _set_byte(data: bytearray, chance: random.Random) -> None:
    at, count = _place(data, chance), chance.choice((1, 2, 4, 8))
    data[at : at + count] = bytes([chance.choice(_BYTES)]) * len(data[at : at + count])


def _insert(data: bytearray, chance: random.Random) -> None:
    at = _place(data, chance)
    data[at:at] = chance.choice(_TOKENS + _NUMBERS)


def _replace_number(data: bytearray, chance: random.Random) -> None:
    match = _NUMBER.search(data, _place(data, chance))
    if match is not None:
        tokens = _NUMBERS if chance.random() < 0.8 else _TOKENS
        data[match.start() : match.end()] = chance.choice(tokens)


def _replace_value(data: bytearray, chance: random.Random) -> None:
    match = _VALUE.search(data, _place(data, chance))
    if match is not None:
        data[match.start() : match.end()] = chance.choice(_VALUES)


def _delete(data: bytearray, chance: random.Random) -> None:
    at = _place(data, chance)
    del data[at : at + chance.choice((1, 2, 4, 30, 500))]


def _repeat(data: bytearray, chance: random.Random) -> None:
    at, count = _place(data, chance), chance.choice((1, 4, 60, 800))
    data[at:at] = data[at : at + count] * chance.choice((1, 2, 50))


def _cut_off(data: bytearray, chance: random.Random) -> None:
    del data[_place(data, chance) :]


def _move(data: bytearray, chance: random.Random) -> None:
    at, to, count = _place(data, chance), _place(data, chance), chance.choice((4, 40, 400))
    part = data[at : at + count]
    data[to : to + len(part)] = part


_CHANGES = (
    *(_flip, _set_byte, _insert, _delete, _repeat, _cut_off, _move),
    *(_replace_number,) * 5,  # what leaves a text valid goes deepest
    *(_replace_value,) * 3,
)
