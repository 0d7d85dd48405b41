"""Project files (`.faceedit`): a take, what is done to it, and how it was being looked at.

The format is described in docs/project_format.md.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from enum import StrEnum
from pathlib import Path
from typing import Any

from faceedit_app.core.atomic import write_atomically
from faceedit_app.core.errors import FileError
from faceedit_app.core.fields import FieldError, Fields, read_document, to_text
from faceedit_app.editing.edits.edit import edits_from, to_json
from faceedit_app.editing.edits.media import MediaFile
from faceedit_app.editing.edits.settings import Mode, Settings
from faceedit_app.editing.files.fingerprint import (
    Fingerprint,
    find_by_content,
    find_by_name,
    fingerprint,
    fingerprint_from,
)
from faceedit_app.editing.steps import EditState

VERSION = 1


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
    """All that a project file holds; paths are absolute here and relative in the file.

    Attributes:
        take: the file that it is about.
        fingerprint: of that file.
        state: what is done to it.
        view: how it was being looked at.
        audio, film: what plays beside it.
        fps: the take's frame rate, if the user had to give it.
    """

    take: Path
    fingerprint: Fingerprint
    state: EditState = field(default_factory=EditState)
    view: ViewState = field(default_factory=ViewState)
    audio: MediaFile | None = None
    film: MediaFile | None = None
    fps: float | None = None


def write_project(path: Path | str, project: Project) -> None:
    """Save a project.

    Raises:
        FileError: it cannot be written; an existing file is then untouched.
    """
    path = Path(path)
    settings = project.state.settings
    take = {"path": _relative(project.take, path), **asdict(project.fingerprint)}
    if project.fps is not None:
        take["fps"] = project.fps
    head = {
        "version": VERSION,
        "take": take,
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
    edits = ",".join(f"\n    {to_text(to_json(e))}" for e in project.state.edits)
    begin, end = (to_text(part, indent=2) for part in (head, tail))
    text = f'{begin[:-2]},\n  "edits": [{edits}\n  ],{end[1:]}\n'
    write_atomically(path, text.encode())


def read_project(path: Path | str) -> Project:
    """Read a project; whether its take is still there is `locate_take`'s to say.

    Raises:
        FileError: it cannot be read, is no project, or something in it is not usable.
    """
    path = Path(path).absolute()
    fields = read_document(path, "FaceEdit project", VERSION)
    try:
        return _from_document(fields, path)
    except FieldError as error:
        raise FileError(path, f"is damaged: {error}", "correct it or use an older copy") from error


def _from_document(fields: Fields, path: Path) -> Project:
    take = fields.fields("take")
    project = Project(
        take=_absolute(take, path),
        fingerprint=fingerprint_from(take),
        state=EditState(edits_from(fields), settings_from(fields.fields("settings", {}))),
        view=_view(fields.fields("view", {})),
        audio=_media(fields, "audio", path),
        film=_media(fields, "film", path),
        fps=take.number_or_none("fps", 1.0, 1000.0),
    )
    take.finish()
    fields.finish()
    return project


def settings_from(fields: Fields) -> Settings:
    """Read `settings`; what is absent is as in a new session.

    Raises:
        FieldError: which field is wrong, and how.
    """
    settings = Settings(
        mode=fields.choice("mode", Mode, Mode.PRESERVE),
        naturalness=fields.number("naturalness", 1.0, 0.0, 1.0),
        reach=fields.number("reach", 1.0, 0.0, 1.0),
    )
    fields.finish()
    return settings


def _view(fields: Fields) -> ViewState:
    view = ViewState(
        playhead=fields.number("playhead", 0.0),
        visible=fields.span("visible"),
        selection=fields.span("selection"),
        falloff=fields.number("falloff", 0.2, 0.0),
        ui=fields.plain("ui"),
    )
    fields.finish()
    return view


def _media(fields: Fields, name: str, project: Path) -> MediaFile | None:
    entry = fields.fields_or_none(name)
    if entry is None:
        return None
    media = MediaFile(_absolute(entry, project), entry.number("offset", 0.0))
    entry.finish()
    return media


def _relative(file: Path, project: Path) -> str:
    """A path as it stands in the project: from the project's folder, with slashes."""
    try:
        return Path(os.path.relpath(file.absolute(), project.absolute().parent)).as_posix()
    except ValueError:  # another drive
        return file.absolute().as_posix()


def _absolute(fields: Fields, project: Path) -> Path:
    return Path(os.path.normpath(project.parent / fields.path("path")))


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
