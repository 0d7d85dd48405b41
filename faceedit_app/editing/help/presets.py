"""Presets: files with edits that can be applied anywhere. The shipped ones are one-click fixes.

A preset file is JSON: `name`, `hint`, `edits` as in an edits file with times from 0 to `seconds`,
and where they go: `find` (a place found in the take), `stretch` (whether they are stretched to the
selection) and `alone` (where they go without a selection). Shipped presets are named `NN_id.json`:
menus list them by number, grouped by its first digit. They also say how the window offers them:
`menu`, `key`, `icon` and `button`. To add a fix, add a file; no code is needed.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import cache
from pathlib import Path

import platformdirs

from faceedit_app.core import on_disk
from faceedit_app.core.atomic import write_keeping
from faceedit_app.core.errors import FaceEditError, FileError, reason_of
from faceedit_app.core.fields import (
    FieldError,
    Fields,
    clean_text,
    is_document,
    read_document,
    to_text,
)
from faceedit_app.editing.edits.edit import Edit, Op, edits_from, to_json
from faceedit_app.formats.timing import counted

VERSION = 1
_NOTHING = "There is no edit in the selection; make one, then save the preset"
SHIPPED = Path(__file__).parent / "presets"


class Find(StrEnum):
    """What is looked up in the take."""

    LIPS = "lips"  # closures that stayed open
    BLINK = "blink"  # blinks that stopped half-way
    EYES = "eyes"  # how open the eyes usually are, for `set`


class Alone(StrEnum):
    """Where a preset goes if nothing is selected."""

    TAKE = "take"  # the whole take
    PLAYHEAD = "playhead"  # its middle is at the playhead
    FROM_PLAYHEAD = "from_playhead"  # it starts at the playhead, or ends with the take


@dataclass(frozen=True)
class Preset:
    """A file with a fix or an expression.

    Attributes:
        id: the file's name without number and ending, such as `close_lips`.
        name, hint: shown to the user; the hint is a sentence.
        edits: edits with times from 0 to `seconds`.
        find, stretch, alone: where they go; see the module.
        menu: the menu text, with an `&` before the access key.
        key, icon: the shortcut and the icon's name, if any.
        has_button: whether it has a button in the tool bar; else it is under "More".
        group: menus draw a separator between groups.
        path: the file.
        own: whether the user made it.
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
    """The folder of the user's presets."""
    return Path(platformdirs.user_data_dir("FaceEdit", appauthor=False)) / "presets"


@cache
def shipped_presets() -> tuple[Preset, ...]:
    """The one-click fixes, in the order of the menu.

    Raises:
        FileError: one of them is damaged.
    """
    return tuple(read_preset(path) for path in sorted(SHIPPED.glob("*.json")))


def load_presets(folder: Path | None = None) -> tuple[list[Preset], list[str]]:
    """The shipped presets, then the user's by name.

    Args:
        folder: the user's presets; None = `own_folder()`.

    Returns:
        The presets, and one line about each file that cannot be read.
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
        FileError: it cannot be read or is not a preset.
    """
    fields = read_document(path, "preset", VERSION)
    try:
        return _from_document(fields, path, own)
    except FieldError as error:
        problem = f"is not a valid preset: {error}"
        raise FileError(path, problem, "delete it and save it again") from error


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


def find_preset(name: str | Path) -> Preset:
    """A preset by its name or id, or its file.

    Raises:
        FaceEditError: there is none, or it is damaged.
    """
    if isinstance(name, Path) or str(name).endswith(".json"):
        return read_preset(Path(name), own=True)
    presets, _ = load_presets()
    for preset in presets:
        if name.lower() in (preset.id.lower(), preset.name.lower()):
            return preset
    known = ", ".join(preset.id for preset in presets)
    raise FaceEditError(f"{name}: there is no such preset; use one of {known}, or a file")


def left_out(edits: Sequence[Edit], start: float, end: float) -> list[Edit]:
    """The retimes that a preset of a selection leaves out: a part of a retime is none.

    Args:
        edits: all edits.
        start, end: the selection, seconds.
    """
    return [
        edit
        for edit in edits
        if edit.op is Op.RETIME and edit.start <= end and edit.end >= start
        if edit.start < start or edit.end > end
    ]


def described(preset: Preset, edits: Sequence[Edit], start: float, end: float) -> str:
    """A preset that was saved, for the user: its name, what it holds, and what it leaves out.

    Args:
        edits, start, end: as of `left_out`.
    """
    text = f"“{preset.name}”: {counted(len(preset.edits), 'edit')}"
    without = ", without the retimes that go on beyond the selection"
    return text + without if left_out(edits, start, end) else text


def _edits_within(edits: Sequence[Edit], start: float, end: float) -> list[Edit]:
    """The edits that a preset of the selection from `start` to `end` seconds is made of."""
    cut_off = left_out(edits, start, end)
    return [
        edit
        for edit in edits
        if edit.effect is not None and edit.start <= end and edit.end >= start
        if edit not in cut_off
    ]


def why_not_saved(edits: Sequence[Edit], selection: tuple[float, float] | None) -> str:
    """Why no preset can be made of a selection in seconds, before a name is asked; "" if it can."""
    if selection is None:
        return "Select the range whose edits to save first"
    return "" if _edits_within(edits, *selection) else _NOTHING


def save_preset(
    name: str,
    edits: Sequence[Edit],
    start: float,
    end: float,
    folder: Path | None = None,
    replace_old: bool = False,
) -> Preset:
    """Save the edits of a selection as a preset of the user's.

    Args:
        name: its name.
        edits: all edits; those whose hold overlaps the selection are saved, cut at its ends.
        start, end: the selection, seconds.
        folder: where; None = `own_folder()`.
        replace_old: whether to replace a preset of the same name.

    Raises:
        FileError: a preset of that name exists, or the file cannot be written.
        FaceEditError: the name is empty, or there is no edit in the selection.
    """
    name = _clean_name(name)
    kept = [
        replace(edit, start=max(edit.start, start), end=min(edit.end, end)).shifted(-start)
        for edit in _edits_within(edits, start, end)
    ]
    if not kept:
        raise FaceEditError(_NOTHING)
    folder = folder or own_folder()
    path = _path_for(name, folder)
    if on_disk.exists(path) and not replace_old:
        raise _taken(path)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        reason = reason_of(error)
        raise FileError(folder, f"cannot be created ({reason})", "check its permissions") from error
    head = {
        "name": name,
        "hint": f"Saved from {end - start:.2f} s",
        "stretch": True,
        "alone": Alone.FROM_PLAYHEAD.value,
        "seconds": end - start,
    }
    return _write(path, head, kept)


def rename_preset(preset: Preset, name: str) -> Preset:
    """Give a preset of the user's another name; its file is named after it.

    Raises:
        FileError: a preset of that name exists, or a file cannot be written or deleted.
        FaceEditError: the name is empty.
    """
    path = _path_for(name := _clean_name(name), preset.path.parent)
    if path != preset.path and on_disk.exists(path):
        raise _taken(path)
    head = {
        "name": name,
        "hint": preset.hint,
        **({"find": preset.find.value} if preset.find is not None else {}),
        "stretch": preset.stretch,
        "alone": preset.alone.value,
        "seconds": preset.seconds,
    }
    renamed = _write(path, head, preset.edits)
    if path != preset.path:
        delete_preset(preset)
    return renamed


def _clean_name(name: str) -> str:
    cleaned = clean_text(name.strip())
    if not cleaned:
        raise FaceEditError("The preset has no name; give it one")
    if cleaned.lower() in (preset.name.lower() for preset in shipped_presets()):
        raise FaceEditError(f"FaceEdit has a preset {cleaned!r} of its own; choose another name")
    return cleaned


def _path_for(name: str, folder: Path) -> Path:
    return folder / f"{_file_name(name)}.json"


def _taken(path: Path) -> FileError:
    return FileError(path, "there is already a preset of that name", "choose another name")


def _write(path: Path, head: Mapping[str, object], edits: Sequence[Edit]) -> Preset:
    """Write a preset of the user's, and read it again."""
    above = to_text({"version": VERSION, **head}, indent=2)
    lines = ",\n    ".join(to_text(to_json(edit)) for edit in edits)
    text = f'{above[:-2]},\n  "edits": [\n    {lines}\n  ]\n}}\n'
    write_keeping(path, text.encode(), lambda there: is_document(there, "version", "name", "edits"))
    return read_preset(path, own=True)


def delete_preset(preset: Preset) -> None:
    """Delete a preset of the user's.

    Raises:
        FileError: it cannot be deleted.
    """
    if not preset.own:
        raise ValueError(f"{preset.name} ships with FaceEdit")
    try:
        preset.path.unlink(missing_ok=True)
    except OSError as error:
        reason = reason_of(error)
        raise FileError(preset.path, f"cannot be deleted ({reason})", "check the folder") from error


def _file_name(name: str) -> str:
    """A file name that every file system accepts; similar names may share it."""
    return re.sub(r"[^\w-]+", "_", name.lower()).strip("_")[:60] or "preset"
