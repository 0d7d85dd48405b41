"""Files that look like takes but cannot be opened: what they are, and what to do."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass

from faceedit_app.core.names import canonical_channel
from faceedit_app.formats.csv_table import first_rows, plain_text

_HEAD = 1 << 16
_FEWEST_COLUMNS = 20  # columns of unnamed numbers that look like a face
_FEWEST_LINES = 5  # lines of a table that name a channel
_MATRIX = re.compile(rb"\s*\[\s*\[\s*-?[0-9]")
_SAVE_AS_CSV = "save it as CSV with a line of ARKit names at the top"


@dataclass(frozen=True)
class Foreign:
    """A kind of file that is not a take.

    Attributes:
        problem: what it is, as a phrase about the file.
        remedy: what the user can do.
        sniff: whether a file's content is of this kind.
    """

    problem: str
    remedy: str
    sniff: Callable[[bytes], bool]


def recognise_foreign(content: bytes) -> Foreign | None:
    """The kind of a file that is not a take, if known."""
    return next((kind for kind in _FOREIGN if kind.sniff(content)), None)


def _has(*texts: bytes) -> Callable[[bytes], bool]:
    return lambda content: all(text in content for text in texts)


def _starts(*texts: bytes) -> Callable[[bytes], bool]:
    return lambda content: content.startswith(texts)


def _is_archive_of(name: bytes) -> Callable[[bytes], bool]:
    return lambda content: content.startswith(b"PK\x03\x04") and name in content


def _is_number(cell: bytes) -> bool:
    try:
        float(plain_text(cell))
    except ValueError:
        return False
    return True


def _is_nameless(content: bytes) -> bool:
    """A table of numbers that begins with a row of numbers."""
    names, row = first_rows(content)
    cells = [name.encode() for name in names]
    return len(cells) >= _FEWEST_COLUMNS and all(map(_is_number, [*cells, *row]))


def is_transposed(content: bytes) -> bool:
    """A table with one line per channel."""
    lines = content[:_HEAD].splitlines()[:80]
    heads = [plain_text(re.split(rb"[,;\t]", line)[0]) for line in lines]
    return sum(1 for head in heads[1:] if canonical_channel(head)) > _FEWEST_LINES


# fmt: off
_FOREIGN: tuple[Foreign, ...] = (
    Foreign("holds the emotions of an Audio2Face export, not its blendshapes",
            "open the file with facsNames that was exported with it",
            lambda content: b'"emotionNames"' in content or b'"emotionKeys"' in content),
    Foreign("is an OpenFaceFX track of sparse keys", "export it from there as an ARKit CSV",
            _has(b'"openfacefx.track"')),
    Foreign("is a list of edits or a project, not a take",
            "open the take first, then load the edits", _has(b'"version"', b'"edits"')),
    Foreign("is a glTF in text form", "save it as one GLB file",
            lambda content: content.lstrip().startswith(b"{") and b'"bufferViews"' in content),
    Foreign("is a GLB without an animation of shapes with ARKit names",
            "export the character with its shape keys and their animation", _starts(b"glTF")),
    Foreign("is an FBX file", "export the animation as GLB or CSV",
            lambda content: content.startswith((b"Kaydara FBX Binary", b"; FBX"))),
    Foreign("is a workbook", "save its sheet as CSV", _is_archive_of(b"xl/")),
    Foreign("holds numbers without the names of their channels", _SAVE_AS_CSV,
            _is_archive_of(b".npy")),
    Foreign("holds numbers without the names of their channels", _SAVE_AS_CSV,
            _starts(b"\x93NUMPY")),
    Foreign("holds numbers without the names of their channels",
            'write it as {"names": [...], "frames": [...]} with ARKit names',
            lambda content: _MATRIX.match(content) is not None),
    Foreign("holds numbers without the names of their channels",
            "write the ARKit names of the columns in a line at the top", _is_nameless),
    Foreign("has a line for each channel, not for each frame",
            "transpose it in a spreadsheet and save it as CSV", is_transposed),
    Foreign("is a BVH file, which has no blendshapes", "export the face as CSV or GLB",
            _starts(b"HIERARCHY")),
)
# fmt: on
