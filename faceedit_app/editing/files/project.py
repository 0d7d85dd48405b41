"""Project files (`.faceedit`): a take, what is done to it, and how it was being looked at.

The format is described in docs/project_format.md.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from enum import StrEnum
from pathlib import Path
from typing import Any

from faceedit_app.core.atomic import write_atomically
from faceedit_app.core.errors import FileError
from faceedit_app.editing.edits.edit import from_json, to_json
from faceedit_app.editing.edits.media import LARGEST, MediaFile
from faceedit_app.editing.files.documents import read_document
from faceedit_app.editing.files.fingerprint import (
    Fingerprint,
    find_by_content,
    find_by_name,
    fingerprint,
)
from faceedit_app.editing.session import EditState
from faceedit_app.editing.solving.solver import Mode, Settings

VERSION = 1
SUFFIX = ".faceedit"


@dataclass(frozen=True)
class ViewState:
    """How the take was being looked at; all times in seconds of the take.

    Attributes:
        playhead: where the playhead is.
        visible: the visible range, None = all of it.
        selection: the selected range, if any.
        falloff: of the next edit.
        ui: whatever else the window wants back; only what JSON can hold.
    """

    playhead: float = 0.0
    visible: tuple[float, float] | None = None
    selection: tuple[float, float] | None = None
    falloff: float = 0.2
    ui: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Project:
    """All that a project file holds; paths are absolute here and relative in the file."""

    take: Path
    fingerprint: Fingerprint
    state: EditState = field(default_factory=EditState)
    view: ViewState = field(default_factory=ViewState)
    audio: MediaFile | None = None
    film: MediaFile | None = None


def write_project(path: Path | str, project: Project) -> None:
    """Save a project.

    Raises:
        FileError: it cannot be written; an existing file is then untouched.
    """
    path = Path(path)
    settings = project.state.settings
    head = {
        "version": VERSION,
        "take": {"path": _relative(project.take, path), **asdict(project.fingerprint)},
        "settings": {
            "mode": settings.mode.value,
            "naturalness": settings.naturalness,
            "reach": settings.reach,
        },
    }
    view = asdict(project.view) | {"ui": dict(project.view.ui)}
    tail = {"view": {k: list(v) if isinstance(v, tuple) else v for k, v in view.items()}}
    for name, media in (("audio", project.audio), ("film", project.film)):
        if media is not None:
            tail[name] = {"path": _relative(media.path, path), "offset": media.offset}
    # One edit a line: the file can be read, and compared with an older one.
    edits = ",".join(f"\n    {json.dumps(to_json(e))}" for e in project.state.edits)
    begin, end = (json.dumps(part, indent=2, ensure_ascii=False) for part in (head, tail))
    text = f'{begin[:-2]},\n  "edits": [{edits}\n  ],{end[1:]}\n'
    write_atomically(path, text.encode())


def read_project(path: Path | str) -> Project:
    """Read a project; whether its take is still there is `locate_take`'s to say.

    Raises:
        FileError: it cannot be read, is no project, or something in it is not usable.
    """
    path = Path(path).absolute()
    document = read_document(path, "FaceEdit project", VERSION)
    try:
        return _from_document(document, path)
    except ValueError as error:
        raise FileError(path, f"is damaged: {error}", "correct it or use an older copy") from error


def _from_document(document: dict[str, Any], path: Path) -> Project:
    _only(document, {"version", "take", "settings", "edits", "view", "audio", "film"}, "it")
    take = _object(document.get("take"), "take", {"path", "size", "sha256"})
    size, digest = take.get("size"), take.get("sha256")
    if isinstance(size, bool) or not isinstance(size, int) or not isinstance(digest, str):
        raise ValueError("its take has no size and sha256")
    entries = document.get("edits")
    if not isinstance(entries, list):
        raise ValueError('it has no list of "edits"')
    edits = []
    for number, entry in enumerate(entries, start=1):
        try:
            edits.append(from_json(_object(entry, "edit")))
        except ValueError as error:
            raise ValueError(f"edit {number}: {error}") from error
    return Project(
        take=_absolute(take, path, "take"),
        fingerprint=Fingerprint(size, digest),
        state=EditState(tuple(edits), settings_from_json(document.get("settings", {}))),
        view=_view(document.get("view", {})),
        audio=_media(document, "audio", path),
        film=_media(document, "film", path),
    )


def settings_from_json(entry: Any) -> Settings:
    """Read `settings`; what is absent is as in a new session.

    Raises:
        ValueError: what is wrong with them, as a phrase.
    """
    entry = _object(entry, "settings", {"mode", "naturalness", "reach"})
    try:
        mode = Mode(entry.get("mode", Mode.PRESERVE))
    except ValueError:
        raise ValueError(f"its mode must be one of {', '.join(Mode)}") from None
    numbers = {k: _number(entry.get(k, 1.0), k, 0, 1) for k in ("naturalness", "reach")}
    return Settings(mode, **numbers)


def _view(entry: Any) -> ViewState:
    entry = _object(entry, "view", {"playhead", "visible", "selection", "falloff", "ui"})
    return ViewState(
        playhead=_number(entry.get("playhead", 0.0), "playhead"),
        visible=_range(entry.get("visible"), "visible"),
        selection=_range(entry.get("selection"), "selection"),
        falloff=_number(entry.get("falloff", 0.2), "falloff", 0),
        ui=_object(entry.get("ui", {}), "ui"),
    )


def _media(document: Mapping[str, Any], name: str, path: Path) -> MediaFile | None:
    if document.get(name) is None:
        return None
    entry = _object(document[name], name, {"path", "offset"})
    return MediaFile(_absolute(entry, path, name), _number(entry.get("offset", 0.0), "offset"))


def _relative(file: Path, project: Path) -> str:
    """A path as it stands in the project: from the project's folder, with slashes."""
    try:
        return Path(os.path.relpath(file.absolute(), project.absolute().parent)).as_posix()
    except ValueError:  # another drive
        return file.absolute().as_posix()


def _absolute(entry: Mapping[str, Any], project: Path, name: str) -> Path:
    text = entry.get("path")
    if not isinstance(text, str) or not text or "\0" in text:
        raise ValueError(f"its {name} has no path")
    return Path(os.path.normpath(project.parent / text))


def _object(entry: Any, name: str, known: set[str] | None = None) -> dict[str, Any]:
    if not isinstance(entry, dict):
        raise ValueError(f"its {name} is not an object")
    if known is not None:
        _only(entry, known, f"its {name}")
    return entry


def _only(entry: Mapping[str, Any], known: set[str], what: str) -> None:
    if extra := set(entry) - known:
        raise ValueError(f"{what} has an unknown field {sorted(extra)[0]!r}")


def _number(value: Any, name: str, low: float = -LARGEST, high: float = LARGEST) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ValueError(f"its {name} is not a number")
    if not low <= value <= high:
        raise ValueError(f"its {name} must lie between {low:g} and {high:g}")
    return float(value)


def _range(value: Any, name: str) -> tuple[float, float] | None:
    if value is None:
        return None
    if not isinstance(value, list) or len(value) != 2:
        raise ValueError(f"its {name} is no pair of seconds")
    first, last = (_number(end, name) for end in value)
    if last < first:
        raise ValueError(f"its {name} ends before it begins")
    return first, last


# --- where the take is ---------------------------------------------------------------------------


class Whereabouts(StrEnum):
    """What has become of a project's take."""

    FOUND = "found"  # where it was, as it was
    CHANGED = "changed"  # where it was, with other content
    MOVED = "moved"  # elsewhere, as it was
    MISSING = "missing"  # not to be found


@dataclass(frozen=True)
class Located:
    """Where a project's take is.

    Attributes:
        where: see `Whereabouts`.
        path: the file to open, unless it is missing.
        others: files that may be meant: the unchanged take elsewhere, or others of its name.
        message: one line for the user; empty if all is well.
    """

    where: Whereabouts
    path: Path | None
    others: tuple[Path, ...]
    message: str


def locate_take(project: Project, path: Path | str) -> Located:
    """Look for a project's take, at its place and around it and the project at `path`."""
    take, wanted = project.take, project.fingerprint
    home = Path(path).absolute().parent
    folders = [take.parent, home, home.parent]
    present = take.is_file()
    if present:
        try:
            if fingerprint(take) == wanted:
                return Located(Whereabouts.FOUND, take, (), "")
        except FileError as error:
            return Located(Whereabouts.MISSING, None, (), str(error))
    same = find_by_content(wanted, take.name, folders)
    if present:
        message = f"{take.name} has changed since the project was saved"
        if same is not None:
            message += f"; {same} is as it was"
        return Located(Whereabouts.CHANGED, take, (same,) if same else (), message)
    if same is not None:
        return Located(Whereabouts.MOVED, same, (), f"{take.name} was found as {same}")
    others = find_by_name(take.name, folders)
    return Located(
        Whereabouts.MISSING, None, others, f"{take} is not there; show where the take is now"
    )
