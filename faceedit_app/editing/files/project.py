"""Project files (`.faceedit`): a reference to a take, its edits, and the view.

The format is described in docs/project_format.md.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from enum import StrEnum
from pathlib import Path
from typing import Any

from faceedit_app.core import on_disk
from faceedit_app.core.atomic import write_keeping
from faceedit_app.core.errors import FileError
from faceedit_app.core.fields import FieldError, Fields, is_document, read_document, to_text
from faceedit_app.editing.edits.edit import edits_from, to_json
from faceedit_app.editing.edits.media import MediaFile, Placement
from faceedit_app.editing.edits.settings import Mode, Settings
from faceedit_app.editing.files.fingerprint import (
    Fingerprint,
    find_by_content,
    find_by_name,
    fingerprint,
    fingerprint_from,
    original_of,
)
from faceedit_app.editing.steps import EditState
from faceedit_app.words.transcript import to_json as words_to_json
from faceedit_app.words.transcript import transcript_from

VERSION = 1


@dataclass(frozen=True)
class ViewState:
    """What the window showed of the take; all times in seconds of the take.

    Attributes:
        playhead: the playhead's time.
        visible: the visible range, None = all of it.
        selection: the selected range, if any.
        falloff: of the next edit.
        ui: other state of the window; only what JSON can hold.
    """

    playhead: float = 0.0
    visible: tuple[float, float] | None = None
    selection: tuple[float, float] | None = None
    falloff: float = 0.2
    ui: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class CharacterFile:
    """The user's character: its absolute path, and the fingerprint by which it is found again.

    A folder has no fingerprint.
    """

    path: Path
    fingerprint: Fingerprint | None = None


@dataclass(frozen=True)
class Project:
    """The content of a project file; paths are absolute here and relative in the file.

    Attributes:
        take: the file of the take.
        fingerprint: the fingerprint of that file.
        state: the edits, settings, media and words.
        view: what the window showed.
        audio, film: the sound and film of the take, if any.
        fps: the take's frame rate, if the user had to give it.
        character: the user's character, if one is shown.
        exported_over: the fingerprint of what was exported over the take, if anything was.
    """

    take: Path
    fingerprint: Fingerprint
    state: EditState = field(default_factory=EditState)
    view: ViewState = field(default_factory=ViewState)
    audio: MediaFile | None = None
    film: MediaFile | None = None
    fps: float | None = None
    character: CharacterFile | None = None
    exported_over: Fingerprint | None = None


def is_project(path: Path) -> bool:
    """Whether a file is a project, of any version."""
    return is_document(path, "version", "take", "settings", "edits")


def write_project(
    path: Path | str, project: Project, is_ours: Callable[[Path], bool] = is_project
) -> Path | None:
    """Save a project.

    Args:
        is_ours: whether a file that is there may be replaced without a copy; else one is kept.

    Returns:
        The copy that was kept; None if there was none.

    Raises:
        FileError: it cannot be written; an existing file is then untouched.
    """
    path = Path(path)
    settings = project.state.settings
    take = {"path": _relative(project.take, path), **asdict(project.fingerprint)}
    if project.fps is not None:
        take["fps"] = project.fps
    if project.exported_over is not None:
        take["exported_over"] = asdict(project.exported_over)
    head = {
        "version": VERSION,
        "take": take,
        "settings": {
            "mode": settings.mode.value,
            "naturalness": settings.naturalness,
            "reach": settings.reach,
            "closes": settings.closes,
        },
    }
    view = asdict(project.view) | {"ui": dict(project.view.ui)}
    tail: dict[str, Any] = {
        "view": {k: list(v) if isinstance(v, tuple) else v for k, v in view.items()}
    }
    for name, media in (("audio", project.audio), ("film", project.film)):
        if media is not None:
            tail[name] = {"path": _relative(media.path, path), "offset": media.offset}
    if project.character is not None:
        mark = project.character.fingerprint
        tail["character"] = {
            "path": _relative(project.character.path, path),
            **(asdict(mark) if mark is not None else {}),
        }
    if project.state.words is not None:
        tail["words"] = words_to_json(project.state.words)
    # One edit a line, so that people can read the file and compare versions.
    edits = ",".join(f"\n    {to_text(to_json(e))}" for e in project.state.edits)
    begin, end = (to_text(part, indent=2) for part in (head, tail))
    text = f'{begin[:-2]},\n  "edits": [{edits}\n  ],{end[1:]}\n'
    return write_keeping(path, text.encode(), is_ours)


def read_project(path: Path | str) -> Project:
    """Read a project; `locate_take` then looks for its take.

    Raises:
        FileError: it cannot be read, is not a project, or is damaged.
    """
    path = Path(path).absolute()
    fields = read_document(path, "FaceEdit project", VERSION)
    try:
        return _from_document(fields, path)
    except FieldError as error:
        raise FileError(path, f"is damaged: {error}", "correct it or use an older copy") from error


def holds(path: Path | str, wanted: Project) -> bool:
    """Whether a project file holds the same work as `wanted`, whatever its view.

    Args:
        wanted: sound and film are those of its state; None there means that any will do.
    """
    try:
        there = read_project(path)
    except FileError:
        return False
    ours, media = wanted.state, Placement(there.audio, there.film)
    return (
        there.fingerprint == wanted.fingerprint
        and there.fps == wanted.fps
        and there.state == replace(ours, media=None)
        and ours.media in (None, media)
    )


def _from_document(fields: Fields, path: Path) -> Project:
    take = fields.fields("take")
    project = Project(
        take=_absolute(take, path),
        fingerprint=fingerprint_from(take),
        state=EditState(
            edits_from(fields),
            settings_from(fields.fields("settings", {})),
            words=transcript_from(fields.fields_or_none("words")),
        ),
        view=_view(fields.fields("view", {})),
        audio=_media(fields, "audio", path),
        film=_media(fields, "film", path),
        fps=take.number_or_none("fps", 1.0, 1000.0),
        exported_over=exported_over_from(take),
        character=_character(fields, path),
    )
    take.finish()
    fields.finish()
    return project


def settings_from(fields: Fields) -> Settings:
    """Read `settings`; absent fields have their defaults.

    Raises:
        FieldError: a field is wrong; the text says which one and how.
    """
    settings = Settings(
        mode=fields.choice("mode", Mode, Mode.PRESERVE),
        naturalness=fields.number("naturalness", 1.0, 0.0, 1.0),
        reach=fields.number("reach", 1.0, 0.0, 1.0),
        closes=fields.flag("closes", True),
    )
    fields.finish()
    return settings


def exported_over_from(fields: Fields) -> Fingerprint | None:
    """Read `exported_over`, if it is there.

    Raises:
        FieldError: it is wrong.
    """
    exported_over = fields.fields_or_none("exported_over")
    if exported_over is None:
        return None
    found = fingerprint_from(exported_over)
    exported_over.finish()
    return found


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


def _character(fields: Fields, project: Path) -> CharacterFile | None:
    entry = fields.fields_or_none("character")
    if entry is None:
        return None
    mark = fingerprint_from(entry) if entry.has("sha256") else None
    character = CharacterFile(_absolute(entry, project), mark)
    entry.finish()
    return character


def _relative(file: Path, project: Path) -> str:
    """A path as written in the project: relative to its folder, with slashes."""
    try:
        return Path(os.path.relpath(file.absolute(), project.absolute().parent)).as_posix()
    except ValueError:  # another drive
        return file.absolute().as_posix()


def _absolute(fields: Fields, project: Path) -> Path:
    return Path(os.path.normpath(project.parent / fields.path("path")))


def locate_character(character: CharacterFile, path: Path | str) -> Path | None:
    """Look for a project's character: in its place, then near it and near the project at `path`."""
    if on_disk.exists(character.path) or character.fingerprint is None:
        return character.path if on_disk.exists(character.path) else None
    home = Path(path).absolute().parent
    folders = [character.path.parent, home, home.parent]
    return find_by_content(character.fingerprint, character.path.name, folders)


# --- locating the take ---------------------------------------------------------------------------


class Whereabouts(StrEnum):
    """What has happened to a project's take."""

    FOUND = "found"  # in its place, unchanged
    CHANGED = "changed"  # in its place, with other content
    EXPORTED = "exported"  # in its place, but the edits were exported over it
    MOVED = "moved"  # elsewhere, unchanged
    MISSING = "missing"  # not found


@dataclass(frozen=True)
class Located:
    """Where a project's take is.

    Attributes:
        where: see `Whereabouts`.
        path: the file to open; None if there is none that the edits can be applied to.
        others: other candidates: the unchanged take elsewhere, or files of the same name.
        message: one line for the user; empty if all is well.
    """

    where: Whereabouts
    path: Path | None
    others: tuple[Path, ...]
    message: str


def locate_take(project: Project, path: Path | str) -> Located:
    """Look for a project's take: in its place, then near it and near the project at `path`."""
    home = Path(path).absolute().parent
    return locate(project.take, project.fingerprint, project.exported_over, [home, home.parent])


def locate(
    take: Path,
    wanted: Fingerprint | None,
    exported_over: Fingerprint | None = None,
    folders: Sequence[Path] = (),
) -> Located:
    """Look for the take that edits were made on: in its place, then near it.

    Args:
        take: its place.
        wanted: its fingerprint; None if it is not known.
        exported_over: the fingerprint of what was exported over it, if anything was: the same edits
            must not be applied to that again.
        folders: where else to look.
    """
    folders = [take.parent, *folders]
    present, found = on_disk.is_file(take), None
    if present:
        try:
            found = fingerprint(take)
        except FileError as error:
            return Located(Whereabouts.MISSING, None, (), str(error))
        if found == wanted:
            return Located(Whereabouts.FOUND, take, (), "")
    same = find_by_content(wanted, take.name, folders) if wanted is not None else None
    if present and found == exported_over:
        holds = "already holds these edits as they were when you exported over it"
        if same is not None:
            shown = same.name if same.parent == take.parent else same
            message = f"{shown}, the take without the edits, is open: {take.name} {holds}"
            return Located(Whereabouts.MOVED, same, (), message)
        message = f"{take.name} {holds}; show where the take without them is"
        return Located(Whereabouts.EXPORTED, None, (), message)
    if present:
        message = f"{take.name} has changed since these edits were made"
        if same is not None and original_of(same) == take.absolute():
            message += (
                f", probably by an export over it that holds them already; {same.name} is the take "
                "as it was"
            )
        elif same is not None:
            message += f"; {same} is unchanged"
        return Located(Whereabouts.CHANGED, take, (same,) if same else (), message)
    if same is not None:
        return Located(Whereabouts.MOVED, same, (), f"{take.name} was found as {same}")
    others = find_by_name(take.name, folders)
    return Located(
        Whereabouts.MISSING, None, others, f"{take} is missing; show where the take is now"
    )
