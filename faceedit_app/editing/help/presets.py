"""Presets: edits in files, ready to be put anywhere. The one-click fixes are those that ship.

A preset file is JSON: `name`, `hint`, `edits` as in an edits file with times from 0 to `seconds`,
and how it is placed: `find` (a place that the take itself names), `stretch` (a selection takes
the place of `seconds`) and `alone` (where it goes without a selection). Those that ship are named
`NN_id.json`: menus list them by number, in groups by its first digit. They also say how the window
offers them: `menu`, `key`, `icon` and `button`. Another fix takes one more file, and no code.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import cache
from pathlib import Path

import platformdirs

from faceedit_app.core.atomic import write_atomically
from faceedit_app.core.errors import FaceEditError, FileError
from faceedit_app.core.fields import FieldError, Fields, clean_text, read_document, to_text
from faceedit_app.editing.edits.edit import Edit, edits_from, to_json

VERSION = 1
SHIPPED = Path(__file__).parent / "presets"


class Find(StrEnum):
    """A place or an amount that depends on the take."""

    LIPS = "lips"  # a closure that stayed open
    BLINK = "blink"  # a blink that stopped half-way
    EYES = "eyes"  # `set` goes to how open the eyes usually are


class Alone(StrEnum):
    """Where a preset goes when nothing is selected."""

    TAKE = "take"  # over all of it
    PLAYHEAD = "playhead"  # its middle there
    FROM_PLAYHEAD = "from_playhead"  # its start there


@dataclass(frozen=True)
class Preset:
    """Edits that can be put somewhere.

    Attributes:
        id: the file's name without its ending and number, such as `close_lips`.
        name, hint: for the user; the hint is a sentence.
        edits: with times from 0 to `seconds`.
        find, stretch, alone: how it is placed.
        menu: its text in a menu, with an `&` before the letter that chooses it.
        key, icon: its shortcut and the name of its icon, if it has them.
        has_button: it stands in the tool bar, not under "More".
        group: menus draw a line between those of different groups.
        path: its file.
        own: the user made it.
    """

    id: str
    name: str
    hint: str
    edits: tuple[Edit, ...]
    seconds: float
    find: Find | None
    stretch: bool
    alone: Alone
    menu: str
    key: str
    icon: str
    has_button: bool
    group: str
    path: Path
    own: bool


def own_folder() -> Path:
    """Where the user's presets are."""
    return Path(platformdirs.user_data_dir("FaceEdit", appauthor=False)) / "presets"


@cache
def shipped_presets() -> tuple[Preset, ...]:
    """The one-click fixes, in the order of the menu.

    Raises:
        FileError: one of them is damaged.
    """
    return tuple(read_preset(path) for path in sorted(SHIPPED.glob("*.json")))


def load_presets(folder: Path | None = None) -> tuple[list[Preset], list[str]]:
    """The presets that ship, then the user's own by name.

    Args:
        folder: where the user's are; None = `own_folder()`.

    Returns:
        The presets, and a line on each file of the user's that is none.
    """
    own, notes = [], []
    for path in sorted((folder or own_folder()).glob("*.json")):
        try:
            own.append(read_preset(path, own=True))
        except FaceEditError as error:
            notes.append(str(error))
    return [*shipped_presets(), *sorted(own, key=lambda preset: preset.name.lower())], notes


def read_preset(path: Path, own: bool = False) -> Preset:
    """Read one preset.

    Raises:
        FileError: it cannot be read or is none.
    """
    fields = read_document(path, "preset", VERSION)
    try:
        return _from_document(fields, path, own)
    except FieldError as error:
        raise FileError(path, f"is no preset: {error}", "delete it and save it again") from error


def _from_document(fields: Fields, path: Path, own: bool) -> Preset:
    number, name = re.fullmatch(r"(\d*)_?(.*)", path.stem).groups()  # type: ignore[union-attr]
    preset = Preset(
        id=name,
        name=fields.text("name"),
        hint=fields.text("hint", ""),
        edits=edits_from(fields),
        seconds=fields.number("seconds", low=0.0),
        find=fields.choice_or_none("find", Find),
        stretch=fields.flag("stretch", True),
        alone=fields.choice("alone", Alone, Alone.FROM_PLAYHEAD),
        menu=fields.text("menu", "") or fields.text("name"),
        key=fields.text("key", ""),
        icon=fields.text("icon", ""),
        has_button=fields.flag("button", False),
        group=number[:1],
        path=path,
        own=own,
    )
    fields.finish()
    if not preset.name or not preset.edits:
        raise FieldError("it has no name" if not preset.name else "it has no edits")
    return preset


def save_preset(
    name: str,
    edits: Sequence[Edit],
    start: float,
    end: float,
    folder: Path | None = None,
    replace_old: bool = False,
) -> Preset:
    """Keep the edits of a selection as a preset of the user's.

    Args:
        name: what the user calls it.
        edits: all edits; those that hold within the selection are kept, cut at its ends.
        start, end: the selection, seconds.
        folder: where; None = `own_folder()`.
        replace_old: a preset of that name gives way.

    Raises:
        FileError: there is one of that name, or it cannot be written.
        FaceEditError: it has no name, or there is no edit in the selection.
    """
    name = clean_text(name.strip())
    if not name:
        raise FaceEditError("The preset has no name; give it one")
    kept = [
        replace(edit, start=max(edit.start, start), end=min(edit.end, end)).shifted(-start)
        for edit in edits
        if edit.effect is not None and edit.start <= end and edit.end >= start
    ]
    if not kept:
        raise FaceEditError("There is no edit in the selection; make one, then save the preset")
    folder = folder or own_folder()
    path = folder / f"{_file_name(name)}.json"
    if path.exists() and not replace_old:
        raise FileError(path, "there is already a preset of that name", "choose another name")
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise FileError(folder, f"cannot be made ({reason})", "check its permissions") from error
    head = to_text(
        {
            "version": VERSION,
            "name": name,
            "hint": f"Saved from {end - start:.2f} s",
            "stretch": True,
            "alone": Alone.FROM_PLAYHEAD.value,
            "seconds": end - start,
        },
        indent=2,
    )
    lines = ",\n    ".join(to_text(to_json(edit)) for edit in kept)
    text = f'{head[:-2]},\n  "edits": [\n    {lines}\n  ]\n}}\n'
    write_atomically(path, text.encode())
    return read_preset(path, own=True)


def delete_preset(preset: Preset) -> None:
    """Forget a preset of the user's.

    Raises:
        FileError: it cannot be deleted.
    """
    if not preset.own:
        raise ValueError(f"{preset.name} ships with FaceEdit")
    try:
        preset.path.unlink(missing_ok=True)
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise FileError(preset.path, f"cannot be deleted ({reason})", "check the folder") from error


def _file_name(name: str) -> str:
    """A name that every file system takes; two names that look alike may share it."""
    return re.sub(r"[^\w-]+", "_", name.lower()).strip("_")[:60] or "preset"
