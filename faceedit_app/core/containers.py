"""What a film or sound file holds, by how it begins: without FFmpeg, and without its name.

A name says little: an M4A and a film are both MP4 files, and a Matroska file may hold sound alone.
What counts is whether the file says that it has moving pictures.
"""

from __future__ import annotations

import io
import re
from collections.abc import Callable, Iterator
from enum import Enum, auto
from pathlib import Path
from typing import BinaryIO

_HEAD = 1 << 16  # bytes at the beginning in which other formats say what they hold
_LARGEST = 1 << 26  # bytes of an MP4's index; that of a film of ten hours has a third of them
_MOST_BOXES = 10_000  # at the top of an MP4; one that is cut into pieces has two for each

_SOUND_BRANDS = (b"M4A ", b"M4B ", b"M4P ", b"F4A ", b"F4B ")  # of MP4 files for players of music
_PICTURE_BRANDS = (b"heic", b"heix", b"hevc", b"mif1", b"msf1", b"avif", b"avis", b"crx ")
_MP4_BOXES = (b"ftyp", b"moov", b"mdat", b"wide", b"pnot")
_MP4_TRACK = re.compile(rb"hdlr.{8}(vide|soun)", re.DOTALL)
_AVI_STREAM = re.compile(rb"strh.{4}(vids|auds)", re.DOTALL)
_MPEG_STREAM = re.compile(rb"\x00\x00\x01([\xe0-\xef]|[\xc0-\xdf\xbd])", re.DOTALL)
_MATROSKA = b"\x1aE\xdf\xa3"
_SEGMENT, _TRACKS, _TRACK, _TRACK_TYPE = 0x18538067, 0x1654AE6B, 0xAE, 0x83
_MATROSKA_FILM, _MATROSKA_SOUND = 1, 2
_SOUNDS = (b"ID3", b"fLaC", b"OggS", b"caff", b"\xff\xfb", b"\xff\xf1", b"\xff\xf9")
_WAVES = (b"RIFF", b"RIFX", b"RF64", b"BW64")


class Holds(Enum):
    """What a media file holds."""

    FILM = auto()  # moving pictures, with or without sound
    SOUND = auto()  # sound alone
    UNKNOWN = auto()  # the file is of such a kind, but does not say, or is not complete


def holds(file: BinaryIO) -> Holds | None:
    """What a file holds that may be a film or a sound; None if it is neither.

    Args:
        file: open for reading, at its beginning; any size, as little of it is read.
    """
    head = file.read(_HEAD)
    if head[4:8] in _MP4_BOXES:
        return _of_mp4(file, head)
    if head.startswith(_MATROSKA):
        return _of_matroska(head)
    if head[:4] == b"RIFF" and head[8:11] == b"AVI":
        return _said(_AVI_STREAM, head, b"vids")
    if head.startswith(b"\0\0\1\xba"):
        kinds = {kind[:1] >= b"\xe0" for kind in _MPEG_STREAM.findall(head)}
        return Holds.FILM if True in kinds else Holds.SOUND if kinds else Holds.UNKNOWN
    is_aiff = head[:4] == b"FORM" and head[8:12] in (b"AIFF", b"AIFC")
    is_wave = head[:4] in _WAVES and head[8:12] == b"WAVE"
    return Holds.SOUND if is_aiff or is_wave or head.startswith(_SOUNDS) else None


def holds_film(path: Path) -> bool:
    """Whether a file says that it has moving pictures; False as well if it cannot be read."""
    try:
        with path.open("rb") as file:
            return holds(file) is Holds.FILM
    except OSError:
        return False


def content_holds(*wanted: Holds) -> Callable[[bytes], bool]:
    """A test whether the content of a file is of one of some kinds."""
    return lambda content: holds(io.BytesIO(content)) in wanted


def _said(pattern: re.Pattern[bytes], content: bytes, film: bytes) -> Holds:
    """What a pattern that finds the kinds of streams says about a content."""
    kinds = set(pattern.findall(content))
    return Holds.FILM if film in kinds else Holds.SOUND if kinds else Holds.UNKNOWN


def _of_mp4(file: BinaryIO, head: bytes) -> Holds | None:
    """What an MP4, QuickTime or 3GP file holds: its index says it, which may be at the end."""
    if head[4:8] == b"ftyp":
        if head[8:12] in _SOUND_BRANDS:
            return Holds.SOUND
        if head[8:12] in _PICTURE_BRANDS:
            return None
    at, end = 0, file.seek(0, io.SEEK_END)
    for _ in range(_MOST_BOXES):
        file.seek(at)
        begin = file.read(16)
        size = int.from_bytes(begin[:4], "big")
        if size == 1:  # too large for 32 bits
            size = int.from_bytes(begin[8:16], "big")
        if begin[4:8] == b"moov":
            file.seek(at)
            return _said(_MP4_TRACK, file.read(min(size or _LARGEST, _LARGEST)), b"vide")
        if len(begin) < 16 or size < 8:  # 0: it goes on to the end of the file
            break
        at += size
        if at >= end:
            break
    return Holds.UNKNOWN


def _of_matroska(head: bytes) -> Holds:
    """What a Matroska or WebM file holds: its tracks come before its pictures and its sound."""
    kinds = set()
    for name, segment in _elements(head):
        if name != _SEGMENT:
            continue
        for part, tracks in _elements(segment):
            if part != _TRACKS:
                continue
            for track in (content for key, content in _elements(tracks) if key == _TRACK):
                kinds |= {c[-1] for key, c in _elements(track) if key == _TRACK_TYPE and c}
    if _MATROSKA_FILM in kinds:
        return Holds.FILM
    return Holds.SOUND if _MATROSKA_SOUND in kinds else Holds.UNKNOWN


def _elements(content: bytes) -> Iterator[tuple[int, bytes]]:
    """The elements of Matroska in a content: their names, and what of them is there."""
    at = 0
    while at < len(content):
        width = 9 - content[at].bit_length()  # the zeros before the first bit say the length
        name = int.from_bytes(content[at : at + width], "big")
        at += width
        if width > 4 or at >= len(content) or not content[at]:
            return
        width = 9 - content[at].bit_length()
        size = int.from_bytes(content[at : at + width], "big") & ((1 << (7 * width)) - 1)
        at += width
        if size == (1 << (7 * width)) - 1:  # unknown, as in a film that was sent live
            size = len(content) - at
        yield name, content[at : at + size]
        at += size
