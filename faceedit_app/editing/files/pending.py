"""Sessions that crashed: what their journals say, for recovery."""

from __future__ import annotations

import contextlib
import os
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from faceedit_app.core.fields import MOST_BYTES, Fields, parse
from faceedit_app.core.filelock import try_lock
from faceedit_app.editing.edits.edit import edits_from
from faceedit_app.editing.edits.media import placement_from
from faceedit_app.editing.files import journal
from faceedit_app.editing.files.fingerprint import (
    Fingerprint,
    KnownFile,
    fingerprint_from,
    original_of,
)
from faceedit_app.editing.files.project import exported_over_from, settings_from
from faceedit_app.editing.steps import EditState, Origin
from faceedit_app.formats.timing import counted
from faceedit_app.words.transcript import transcript_from

_YOUNG = 60.0  # seconds; the session of a younger empty journal may be starting


@dataclass(frozen=True)
class Pending:
    """A session that crashed, and its state.

    Attributes:
        path: its journal.
        take: its take.
        fingerprint: the fingerprint of the take; None if the take could not be read.
        project: its project, if any, as it was opened or saved last.
        state: the state after the last finished gesture.
        gestures: the number of gestures since the last save.
        when: the time of the last gesture, in seconds since the epoch.
        fps: the take's frame rate, if the user had to give it.
        exported_over: the fingerprint of what was exported over the take, if anything was.
        character: the user's character, if one was shown.
        origin: where Undo is to lead; None if its journal does not say that, as older ones do not.
    """

    path: Path
    take: Path
    fingerprint: Fingerprint | None
    project: KnownFile | None
    state: EditState
    gestures: int
    when: float
    fps: float | None = None
    exported_over: Fingerprint | None = None
    character: Path | None = None
    origin: Origin | None = None

    @property
    def counted_edits(self) -> str:
        """ ": 2 edits", to be added to a sentence; "" if only sound, words or settings changed."""
        edits = self.state.edits
        return f": {counted(len(edits), 'edit')}" if edits else ""

    def discard(self) -> None:
        """Delete its journal."""
        with contextlib.suppress(OSError):
            self.path.unlink()


def pending_journals(folder: Path | None = None) -> list[Pending]:
    """The sessions that crashed, newest first; running sessions are skipped."""
    found = []
    folder = folder or journal.journal_folder()
    for path in folder.glob(f"*{journal.SUFFIX}"):
        try:
            if not path.is_file():
                continue
            with path.open("r+b") as file:
                if not try_lock(file.fileno()):
                    continue  # its session is running
                about = os.fstat(file.fileno())
                if about.st_size > MOST_BYTES:
                    continue
                content, when = file.read(), about.st_mtime
        except OSError:
            continue
        pending = _read(path, content, when)
        if pending is not None:
            found.append(pending)
        elif _without_gestures(content) and time.time() - when > _YOUNG:
            with contextlib.suppress(OSError):
                path.unlink()
    for path in folder.glob(f"*{journal.NEW_SUFFIX}"):  # left by a crash
        with contextlib.suppress(OSError):
            if time.time() - path.stat().st_mtime > _YOUNG:
                path.unlink()
    found.sort(key=lambda pending: pending.when, reverse=True)
    return [pending for k, pending in enumerate(found) if not _is_repeated(pending, found[:k])]


def open_elsewhere(own: journal.Journal, folder: Path | None = None) -> Path | None:
    """What another running session has of the take of this one: the file, or a copy (`.bak`) of it.

    Args:
        own: the journal of this session.

    Returns:
        Its file; None if there is none, as far as journals can be read.
    """
    wanted = original_of(Path(os.path.realpath(own.take)))
    for path in (folder or journal.journal_folder()).glob(f"*{journal.SUFFIX}"):
        if path == own.path:
            continue
        try:
            if not path.is_file():
                continue
            with path.open("r+b") as file:
                if try_lock(file.fileno()):
                    continue  # its session has ended
                head = Fields(parse(file.readline(MOST_BYTES)))
            take = Path(head.path("take"))
            if original_of(Path(os.path.realpath(take))) == wanted:
                return take
        except (OSError, ValueError):
            continue
    return None


def _is_repeated(pending: Pending, newer: Sequence[Pending]) -> bool:
    """Whether a newer session has the same edits: it recovered them, and crashed as well.

    Its journal is deleted then.
    """
    mine = pending.take, pending.fingerprint, pending.state
    if mine not in [(other.take, other.fingerprint, other.state) for other in newer]:
        return False
    pending.discard()
    return True


def _read(path: Path, content: bytes, when: float) -> Pending | None:
    """The session in a journal; None if there is nothing to recover."""
    lines = content.split(b"\n")[:-1]  # a line without a newline is incomplete
    if not lines:
        return None
    try:
        head = Fields(parse(lines[0]))
        if head.whole("version") != journal.VERSION:
            return None
        take = Path(head.path("take"))
        print_ = _mark(head, "fingerprint")
        project = None
        if head.has("project"):
            project = KnownFile(Path(head.path("project")), _mark(head, "project_fingerprint"))
        fps = head.number_or_none("fps", 1.0, 1000.0)
        exported_over = exported_over_from(head)
        character, origin = _character(head), _origin(head)
    except ValueError:
        return None
    state, step, gestures = None, 0, 0
    for line in lines[1:]:
        try:
            entry = Fields(parse(line))
            if entry.has(journal.EXPORTED_OVER):
                exported_over = exported_over_from(entry)
                continue
            if entry.has(journal.CHARACTER):
                character = _character(entry)
                continue
            state = _replay(state, step, entry)
            step = entry.whole("step")
        except ValueError:
            break  # damaged from here on: keep what came before
        gestures += 1
    if state is None:
        return None
    more = fps, exported_over, character, origin
    return Pending(path, take, print_, project, state, gestures, when, *more)


def _without_gestures(content: bytes) -> bool:
    """Whether a journal has no line of a gesture."""
    notes = tuple(f'{{"{name}":'.encode() for name in (journal.EXPORTED_OVER, journal.CHARACTER))
    return all(line.startswith(notes) for line in content.split(b"\n")[1:-1])


def _character(entry: Fields) -> Path | None:
    """The user's character in a line.

    Raises:
        ValueError: it is damaged.
    """
    shown = entry.fields_or_none(journal.CHARACTER)
    return Path(shown.path("path")) if shown is not None else None


def _origin(head: Fields) -> Origin | None:
    """Where Undo is to lead; None if that is missing or damaged: the gestures count more."""
    with contextlib.suppress(ValueError):
        if (entry := head.fields_or_none(journal.ORIGIN)) is not None:
            rate = entry.number_or_none("fps", 1.0, 1000.0)
            return Origin(_whole(entry), rate, entry.flag("saved", False))
    return None


def _whole(entry: Fields) -> EditState:
    """The state in an entry that does not depend on the one before it.

    Raises:
        ValueError: it is damaged.
    """
    media = placement_from(entry.fields_or_none("media"))
    words = transcript_from(entry.fields_or_none("words"))
    return EditState(edits_from(entry), settings_from(entry.fields("settings")), media, words)


def _mark(head: Fields, name: str) -> Fingerprint | None:
    """A fingerprint in the first line, if it is there.

    Raises:
        ValueError: it is damaged.
    """
    return fingerprint_from(head.fields(name)) if head.has(name) else None


def _replay(state: EditState | None, step: int, entry: Fields) -> EditState:
    """The state after a gesture.

    Raises:
        ValueError: the entry is damaged, or a gesture before it is missing.
    """
    if entry.has("edits"):
        return _whole(entry)
    if state is None or entry.whole("step") != step + 1:
        raise ValueError("a line is missing")
    edits = list(state.edits)
    at, drop = entry.whole("at"), entry.whole("drop")
    if at + drop > len(edits):
        raise ValueError("it does not fit the edits before it")
    edits[at : at + drop] = edits_from(entry, "add")
    settings, media, words = state.settings, state.media, state.words
    if entry.has("settings"):
        settings = settings_from(entry.fields("settings"))
    if entry.has("media"):
        media = placement_from(entry.fields_or_none("media"))
    if entry.has("words"):
        words = transcript_from(entry.fields_or_none("words"))
    return EditState(tuple(edits), settings, media, words)
