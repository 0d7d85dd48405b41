"""Files that look like takes but cannot be opened: what they are, and what to do."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass

from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.containers import Holds, content_holds
from faceedit_app.core.names import canonical_channel
from faceedit_app.formats.csv_table import first_rows, plain_text

_HEAD = 1 << 16
_FEWEST_COLUMNS = 5  # columns of unnamed numbers that look like a face
_MATRIX = re.compile(rb"\s*\[\s*\[\s*-?[0-9]")
_EMPTY_NAME = re.compile(
    r"(?:unnamed:?|column|col|field|feature|value|var|dim|param|blend_?shape|shape|[a-z]{1,2})?"
    r"[ _]*\d*",
    re.IGNORECASE,
)
_CHANNELS = re.compile("|".join(rf"\b{name.lower()}\b" for name in ARKIT_CHANNELS).encode())
_ACTION_UNIT = re.compile(rb"^[^\n]*\bAU\d\d(?:_[rc])?\b[^\n]*\bAU\d\d", re.MULTILINE)
_GLTF = re.compile(rb'\s*\{.*"asset"\s*:\s*\{[^}]*"version"', re.DOTALL)
_PICKLE = re.compile(rb"\x80[\x02-\x05].*\.", re.DOTALL)
_WEB_PAGE = re.compile(rb"\s*<(?:!doctype html|html|head)\b", re.IGNORECASE)
_PICTURES = (b"\x89PNG", b"\xff\xd8\xff", b"GIF8", b"II*\0", b"MM\0*", b"8BPS")
_HEIC = (b"heic", b"heix", b"hevc", b"mif1", b"msf1", b"avif", b"avis")
_AS_GLB_OR_CSV = "export the animation as GLB or CSV"
_AS_USDA = "save it as text (.usda): usdcat -o TAKE.usda FILE"
_SAVE_AS_CSV = "save it as CSV with a line of ARKit names at the top"


@dataclass(frozen=True)
class Foreign:
    """A kind of file that is not a take.

    Attributes:
        problem: what it is, as a phrase about the file.
        remedy: what the user can do.
        sniff: whether a file's content is of this kind.
        command_remedy: what can be done where a command was typed; "" = the same.
    """

    problem: str
    remedy: str
    sniff: Callable[[bytes], bool]
    command_remedy: str = ""


def recognise_foreign(content: bytes) -> Foreign | None:
    """The kind of a file that is not a take, if known."""
    return next((kind for kind in _FOREIGN if kind.sniff(content)), None)


def _has(*texts: bytes) -> Callable[[bytes], bool]:
    return lambda content: all(text in content for text in texts)


def _starts(*texts: bytes) -> Callable[[bytes], bool]:
    return lambda content: content.startswith(texts)


def _matches(pattern: re.Pattern[bytes]) -> Callable[[bytes], bool]:
    return lambda content: pattern.match(content[:_HEAD]) is not None


def _is_archive_of(*names: bytes) -> Callable[[bytes], bool]:
    return lambda content: (
        content.startswith(b"PK\x03\x04") and any(name in content for name in names)
    )


def _is_picture(content: bytes) -> bool:
    """PNG, JPEG, GIF, WebP, BMP, TIFF, HEIC, AVIF or Photoshop, by how they begin."""
    is_webp = content[:4] == b"RIFF" and content[8:12] == b"WEBP"
    is_bitmap = content[:2] == b"BM" and content[6:10] == b"\0\0\0\0"
    is_heic = content[4:8] == b"ftyp" and content[8:12] in _HEIC
    return is_webp or is_bitmap or is_heic or content.startswith(_PICTURES)


def _is_number(cell: bytes) -> bool:
    try:
        float(plain_text(cell))
    except ValueError:
        return False
    return True


def _is_nameless(content: bytes) -> bool:
    """A table of numbers that begins with a row of numbers, or with names that say nothing."""
    names, row = first_rows(content)
    if len(names) < _FEWEST_COLUMNS or not row or not all(map(_is_number, row)):
        return False
    is_data = all(_is_number(name.encode()) for name in names)
    return is_data or sum(1 for name in names if _EMPTY_NAME.fullmatch(name)) > len(names) // 2


def _is_spaced(content: bytes) -> bool:
    """A table whose columns are separated by spaces."""
    names = next((line.split() for line in content[:_HEAD].splitlines() if line.strip()), [])
    if any(b"{" in name or b"<" in name for name in names):
        return False
    return sum(1 for name in names if canonical_channel(plain_text(name))) > 1


def _names_arkit(content: bytes) -> bool:
    """Text with the names of channels, but no table of them and no JSON."""
    return b"\0" not in content and len(set(_CHANNELS.findall(content[:_HEAD].lower()))) > 1


# fmt: off
_FOREIGN: tuple[Foreign, ...] = (
    Foreign("holds the emotions of an Audio2Face export, not its blendshapes",
            "open the file with facsNames that was exported with it",
            lambda content: b'"emotionNames"' in content or b'"emotionKeys"' in content),
    Foreign("is an OpenFaceFX track of sparse keys", "export it from there as an ARKit CSV",
            _has(b'"openfacefx.track"')),
    Foreign("is the journal of work that was not saved",
            "open FaceEdit, which offers to recover the work",
            _has(b'"fingerprint"', b'\n{"step"')),
    Foreign("is a project, not a take", "give its name the ending .faceedit, and open it",
            _has(b'"version"', b'"take"', b'"settings"', b'"edits"'),
            "open it in the window, or make its edits with faceedit apply TAKE PROJECT"),
    Foreign("is a list of edits, not a take", "open the take first, then load the edits",
            _has(b'"version"', b'"edits"'), "make its edits with faceedit apply TAKE EDITS"),
    Foreign("is a glTF in text form", "save it as one GLB file", _matches(_GLTF)),
    Foreign("is a GLB without an animation of shapes with ARKit names",
            "export the character with its shape keys and their animation", _starts(b"glTF")),
    Foreign("is a picture, not a take or a film", "choose a take, or a film such as an MP4",
            _is_picture),
    Foreign("is a film, not a take", "track it: File > Track a film", content_holds(Holds.FILM),
            "faceedit track makes a take of it"),
    Foreign("is a sound, not a take", "open its take first, then add the sound to it",
            content_holds(Holds.SOUND), "give its take; the sound is found beside it"),
    Foreign("begins like a film or a sound, but is not whole", "copy it again",
            content_holds(Holds.UNKNOWN)),
    Foreign("is an FBX file", _AS_GLB_OR_CSV, _starts(b"Kaydara FBX Binary", b"; FBX")),
    Foreign("is a USD file in binary form", _AS_USDA, _starts(b"PXR-USDC")),
    Foreign("is USD text without an animation of ARKit's shapes", _AS_GLB_OR_CSV,
            _starts(b"#usda")),
    Foreign("is a USD package", _AS_USDA, _is_archive_of(b".usd")),
    Foreign("is an Alembic cache, which has no blendshapes", _AS_GLB_OR_CSV,
            _starts(b"Ogawa", b"\x89HDF\r\n\x1a\n\0\0\0\0\0\x08\x08\0\x04\0\x10\0")),
    Foreign("is a Maya file", "write its curves as CSV with a line of ARKit names at the top",
            _starts(b"animVersion", b"atomVersion", b"//Maya", b"FOR4", b"FOR8")),
    Foreign("is a Blender file", "export the head as GLB with its shape keys and animation",
            _starts(b"BLENDER")),
    Foreign("is a file of Unity without curves of ARKit's shapes",
            "save the animation clip of the face as text (.anim)",
            _has(b"tag:unity3d.com")),
    Foreign("holds action units, which are not ARKit's blendshapes",
            "open the film itself, which FaceEdit tracks", _matches(_ACTION_UNIT)),
    Foreign("is a web page", "download the file itself, signed in if need be",
            _matches(_WEB_PAGE)),
    Foreign("is XML or HTML", "save its table as CSV, with a line of ARKit names at the top",
            lambda content: content.lstrip()[:1] == b"<"),
    Foreign("is a pointer of Git LFS, not the file itself", "fetch it with git lfs pull",
            _starts(b"version https://git-lfs")),
    Foreign("is a Python pickle, which can run programs", "save it as CSV or JSON",
            lambda content: _PICKLE.fullmatch(content) is not None),
    Foreign("is a table in another program's own form (Parquet, HDF5, MATLAB or SQLite)",
            _SAVE_AS_CSV, _starts(b"PAR1", b"\x89HDF", b"MATLAB", b"SQLite format 3\0")),
    Foreign("is a binary property list", "save it as JSON", _starts(b"bplist")),
    Foreign("is a workbook", "save its sheet as CSV",
            _is_archive_of(b"xl/", b"content.xml")),
    Foreign("holds numbers without the names of their channels", _SAVE_AS_CSV,
            _is_archive_of(b".npy")),
    Foreign("holds numbers without the names of their channels", _SAVE_AS_CSV,
            _starts(b"\x93NUMPY")),
    Foreign("is compressed", "unpack it, and open the take in it",
            _starts(b"PK\x03\x04", b"\x1f\x8b", b"7z\xbc\xaf", b"Rar!", b"\xfd7zXZ", b"BZh",
                    b"\x28\xb5\x2f\xfd")),
    Foreign("holds numbers without the names of their channels",
            'write it as {"names": [...], "frames": [...]} with ARKit names',
            lambda content: _MATRIX.match(content) is not None),
    Foreign("holds numbers without the names of their channels",
            "write the ARKit names of the columns in a line at the top", _is_nameless),
    Foreign("separates its columns by spaces", "save it as CSV with commas", _is_spaced),
    Foreign("names ARKit's channels, but in a layout that is not known", _SAVE_AS_CSV,
            _names_arkit),
    Foreign("is a BVH file, which has no blendshapes", "export the face as CSV or GLB",
            _starts(b"HIERARCHY")),
)
# fmt: on
