"""Presets: edits in files, ready to be put anywhere. The one-click fixes are those that ship.

A preset file is JSON: `name`, `hint`, `edits` as in an edits file with times from 0 to `seconds`,
and how it is placed: `find` (a place that the take itself names), `stretch` (a selection takes
the place of `seconds`) and `alone` (where it goes without a selection). One that ships also says
how it stands in the Fix menu: `menu` (its text there, “&” before the letter that chooses it),
`keys`, `icon` and `toolbar` (whether it has a button of its own). The number before a file's name
gives its place, and the first digit of the number its group.
"""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import cache
from pathlib import Path
from typing import Any

import platformdirs

from faceedit_app.core.atomic import write_atomically
from faceedit_app.core.errors import FaceEditError, FileError
from faceedit_app.editing.edits.edit import Edit, from_json, to_json
from faceedit_app.editing.files.documents import read_document

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
        name, hint: for the user.
        edits: with times from 0 to `seconds`.
        find, stretch, alone: how it is placed.
        path: its file.
        own: the user made it.
        menu, keys, icon, toolbar: how one that ships stands in the Fix menu.
    """

    id: str
    name: str
    hint: str
    edits: tuple[Edit, ...]
    seconds: float
    find: Find | None
    stretch: bool
    alone: Alone
    path: Path
    own: bool
    menu: str = ""
    keys: str = ""
    icon: str = ""
    toolbar: bool = False

    @property
    def group(self) -> str:
        """Those of one group stand together in the menu."""
        return self.path.name[0]


def own_folder() -> Path:
    """Where the user's presets are."""
    return Path(platformdirs.user_data_dir("FaceEdit", appauthor=False)) / "presets"


@cache
def shipped_presets() -> tuple[Preset, ...]:
    """The one-click fixes, in the order of the Fix menu.

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
    document = read_document(path, "preset", VERSION)
    try:
        return _from_document(document, path, own)
    except (ValueError, TypeError, KeyError) as error:
        reason = f"it lacks {error}" if isinstance(error, KeyError) else str(error)
        raise FileError(path, f"is no preset: {reason}", "delete it and save it again") from error


def _from_document(document: dict[str, Any], path: Path, own: bool) -> Preset:
    name, hint, seconds = document["name"], document.get("hint", ""), document["seconds"]
    if not isinstance(name, str) or not isinstance(hint, str) or not name:
        raise ValueError("its name or hint is not a text")
    if isinstance(seconds, bool) or not isinstance(seconds, int | float) or not 0 <= seconds < 1e6:
        raise ValueError('its "seconds" is no length of time')
    entries = document["edits"]
    if not isinstance(entries, list) or not entries:
        raise ValueError("it has no edits")
    if not all(isinstance(entry, dict) for entry in entries):
        raise ValueError("one of its edits is not an object")
    find = document.get("find")
    return Preset(
        id=re.sub(r"^\d+_", "", path.stem),
        name=name,
        hint=hint,
        edits=tuple(from_json(entry) for entry in entries),
        seconds=float(seconds),
        find=Find(find) if find is not None else None,
        stretch=bool(document.get("stretch", True)),
        alone=Alone(document.get("alone", Alone.FROM_PLAYHEAD)),
        path=path,
        own=own,
        **{key: str(document[key]) for key in ("menu", "keys", "icon") if key in document},
        toolbar=bool(document.get("toolbar", False)),
    )


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
    name = name.strip()
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
    head = json.dumps(
        {
            "version": VERSION,
            "name": name,
            "hint": f"Saved from {end - start:.2f} s",
            "stretch": True,
            "alone": Alone.FROM_PLAYHEAD.value,
            "seconds": end - start,
        },
        indent=2,
        ensure_ascii=False,
    )
    lines = ",\n    ".join(json.dumps(to_json(edit), ensure_ascii=False) for edit in kept)
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
