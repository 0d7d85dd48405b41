"""What the lips should do at a phoneme, from files: when it is missing, and which edit helps.

A file of `sounds/` is JSON: `name`, `lips` (`speech_sounds.Lips`), `control` with `about` and
`most` (the curve should go down to `most` mm above closed lips, or above its usual value), and
`edit`, whose times are from 0 and whose strength follows from how much is missing.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from functools import cache
from pathlib import Path

from faceedit_app.core.controls import CONTROL_IDS
from faceedit_app.core.errors import FileError
from faceedit_app.core.fields import FieldError, Fields, read_document
from faceedit_app.editing.edits.edit import Edit, from_json
from faceedit_app.words.speech_sounds import Lips

VERSION = 1
SHIPPED = Path(__file__).parent / "sounds"


class About(StrEnum):
    """What the curve is compared with."""

    CLOSED = "closed"  # lips that touch
    USUAL = "usual"  # the take's median


@dataclass(frozen=True)
class SoundPreset:
    """What the lips should do at some phonemes.

    Attributes:
        name: of the edits that it makes.
        lips: the phonemes, by what they ask of the lips.
        control: the curve that shows it.
        about, most: the curve should go down to `most` mm above this.
        edit: brings it down by its whole value; times from 0.
    """

    name: str
    lips: Lips
    control: str
    about: About
    most: float
    edit: Edit


@cache
def sound_presets() -> tuple[SoundPreset, ...]:
    """Those that ship with FaceEdit.

    Raises:
        FileError: one of them is damaged.
    """
    return tuple(_read(path) for path in sorted(SHIPPED.glob("*.json")))


def _read(path: Path) -> SoundPreset:
    fields = read_document(path, "preset of a sound", VERSION)
    try:
        return _from_document(fields)
    except ValueError as error:
        problem = f"is not a valid preset of a sound: {error}"
        raise FileError(path, problem, "install FaceEdit again") from error


def _from_document(fields: Fields) -> SoundPreset:
    preset = SoundPreset(
        fields.text("name"),
        fields.choice("lips", Lips),
        fields.text("control"),
        fields.choice("about", About),
        fields.number("most"),
        from_json(fields.plain("edit")),
    )
    fields.finish()
    if preset.control not in CONTROL_IDS or preset.edit.value >= 0:
        raise FieldError("its control is unknown, or its edit does not bring it down")
    return preset
