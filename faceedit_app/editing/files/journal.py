"""The journal: every finished gesture goes to disk at once, so that a crash loses nothing.

Each running session has a file of JSON lines: one line about the session, then one line per gesture
with the edits that it changed. A line is written before the next gesture can begin, so it survives
`kill -9`. A thread calls fsync, so that the line soon survives a power cut and no gesture waits for
the disk. Errors are reported in `Journal.note` and never disturb a gesture.
"""

from __future__ import annotations

import contextlib
import json
import os
import threading
import time
import uuid
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import platformdirs

from faceedit_app.core.errors import FileError
from faceedit_app.core.fields import MOST_BYTES, Fields, parse
from faceedit_app.core.filelock import lock, try_lock
from faceedit_app.editing.edits.edit import Edit, edits_from, to_json
from faceedit_app.editing.edits.media import placement_from
from faceedit_app.editing.edits.media import to_json as placement_to_json
from faceedit_app.editing.files.fingerprint import Fingerprint, fingerprint, fingerprint_from
from faceedit_app.editing.files.project import exported_over_from, settings_from
from faceedit_app.editing.steps import EditState
from faceedit_app.words.transcript import to_json as words_to_json
from faceedit_app.words.transcript import transcript_from

VERSION = 1
_SUFFIX = ".jsonl"
_NEW_SUFFIX = ".new"
_LONG = 32 * 2**20  # bytes; a longer journal is written again without what no longer matters
_PATIENCE = 1.0  # seconds to wait for a slow disk when closing
_CREATE = os.O_RDWR | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0)
_YOUNG = 60.0  # seconds; the session of a younger empty journal may be starting


def journal_folder() -> Path:
    """The folder of this user's journals."""
    return Path(platformdirs.user_state_dir("FaceEdit", appauthor=False)) / "journals"


class Journal:
    """The journal of one session.

    `note` is empty while all is well, else one line for the user. Connect it with
    `session.stepped.connect(journal.record)`.

    Args:
        take: the open take.
        project: the project that it was opened from, if any.
        folder: where journals are; None = `journal_folder()`.
        fps: the take's frame rate, if the user had to give it.
        opened: the fingerprint of the take as it was opened; None = that of the file now.
        exported_over: the fingerprint of what was exported over the take, if anything was.
    """

    def __init__(
        self,
        take: Path,
        project: Path | None = None,
        folder: Path | None = None,
        fps: float | None = None,
        opened: Fingerprint | None = None,
        exported_over: Fingerprint | None = None,
    ) -> None:
        self.note = ""
        self.path = (folder or journal_folder()) / f"{uuid.uuid4().hex}{_SUFFIX}"
        self._take, self._project, self._fps = take.absolute(), project, fps
        self._print, self._exported_over = opened, exported_over
        if opened is None:
            with contextlib.suppress(FileError):
                self._print = fingerprint(take)
        self._file: int | None = None
        self._length = 0  # bytes that are complete lines
        self._longest = _LONG
        self._last: EditState | None = None  # the state after those lines
        self._step = 0
        self._wake, self._closed = threading.Event(), False
        self._thread = threading.Thread(target=self._sync, name="journal", daemon=True)
        self._thread.start()
        self._open()

    def _open(self) -> bool:
        """Create the file; False if that fails."""
        self._last, self._length = None, 0
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            self._file = os.open(self.path, _CREATE, 0o600)
            lock(self._file)
        except OSError as error:
            self._remove()
            self._fail(error)
            return False
        return self._append(self._head())

    def _is_there(self) -> bool:
        """Whether the file still exists: its drive or folder may have been removed."""
        try:
            return self._file is not None and os.path.samestat(
                os.stat(self.path), os.fstat(self._file)
            )
        except OSError:
            return False

    def record(self, state: EditState) -> None:
        """Write the state after a finished gesture; takes well under a millisecond."""
        if self._closed:
            return
        if not self._is_there():
            self._remove()
            if not self._open():
                return
        if self._length > self._longest:
            self._shorten()
        last = self._last
        entry: dict[str, Any] = {"step": self._step + 1}
        if last is None:
            entry |= _whole(state)
        else:
            first, end, old_end = _difference(last.edits, state.edits)
            entry |= {"at": first, "drop": old_end - first}
            entry["add"] = [to_json(edit) for edit in state.edits[first:end]]
            if last.settings != state.settings:
                entry["settings"] = asdict(state.settings)
            if last.media != state.media:
                entry["media"] = placement_to_json(state.media)
            if last.words is not state.words:
                entry["words"] = words_to_json(state.words)
        if self._append(entry):
            self._last, self._step = state, self._step + 1
            self._wake.set()
        else:
            self._last = None  # write all edits again if the disk comes back

    def exporting(self, content: Fingerprint) -> None:
        """Note that the take is about to be exported over: its edits must not be applied to that.

        Args:
            content: the fingerprint of what will be written.
        """
        self._exported_over = content
        if self._file is not None and not self._closed:
            self._append({"exported_over": asdict(content)})
            self._wake.set()

    def _shorten(self) -> None:
        """Replace the file by one that holds only the state after its last line.

        A crash meanwhile leaves the old file. So does a failure, and it is not tried again soon.
        """
        self._longest = 2 * self._length
        if self._last is None:
            return
        new = self.path.with_suffix(_NEW_SUFFIX)
        content = _line(self._head()) + _line({"step": self._step} | _whole(self._last))
        try:
            file = os.open(new, _CREATE, 0o600)
        except OSError:
            return
        try:
            lock(file)
            _write(file, content)
            os.fsync(file)
            new.replace(self.path)
        except OSError:  # Windows does not replace a file that is open
            os.close(file)
            with contextlib.suppress(OSError):
                new.unlink()
            return
        old, self._file, self._length = self._file, file, len(content)
        self._longest = max(_LONG, 2 * self._length)
        if old is not None:
            os.close(old)

    def saved(self, project: Path | None = None) -> None:
        """Forget the gestures so far: they are saved."""
        if project is not None:
            self._project = project
        if self._file is None:
            return
        self._last, self._length = None, 0
        self._append(self._head())

    def close(self) -> None:
        """Remove the file: the session has ended and nothing has to be recovered."""
        if self._closed:
            return
        self._closed = True
        self._wake.set()
        self._thread.join(_PATIENCE)
        if self._thread.is_alive():  # fsync is still using the file
            self._file = None
        self._remove()

    def _remove(self) -> None:
        file, self._file = self._file, None
        with contextlib.suppress(OSError):
            if file is not None:
                os.close(file)
        with contextlib.suppress(OSError):
            self.path.unlink()

    def _head(self) -> dict[str, Any]:
        head: dict[str, Any] = {"version": VERSION, "take": str(self._take)}
        if self._project is not None:
            head["project"] = str(self._project.absolute())
        if self._print is not None:
            head["fingerprint"] = asdict(self._print)
        if self._fps is not None:
            head["fps"] = self._fps
        if self._exported_over is not None:
            head["exported_over"] = asdict(self._exported_over)
        return head

    def _append(self, entry: dict[str, Any]) -> bool:
        assert self._file is not None
        line = _line(entry)
        try:
            os.ftruncate(self._file, self._length)  # remove what a failed write may have left
            os.lseek(self._file, self._length, os.SEEK_SET)
            _write(self._file, line)
        except OSError as error:
            self._fail(error)
            return False
        self._length += len(line)
        self.note = ""
        return True

    def _sync(self) -> None:
        while not self._closed:
            self._wake.wait()
            self._wake.clear()
            file = self._file
            if file is not None and not self._closed:
                try:
                    os.fsync(file)
                except OSError as error:
                    if file == self._file:  # it may have been closed meanwhile
                        self._fail(error)

    def _fail(self, error: OSError) -> None:
        reason = (error.strerror or str(error)).lower()
        self.note = f"Edits are not being backed up ({reason}: {self.path.parent}); save often"


def _line(entry: dict[str, Any]) -> bytes:
    return json.dumps(entry, separators=(",", ":")).encode() + b"\n"


def _write(file: int, content: bytes) -> None:
    written = 0
    while written < len(content):
        written += os.write(file, content[written:])


def _whole(state: EditState) -> dict[str, Any]:
    """The entry of a state that does not depend on the one before it."""
    entry: dict[str, Any] = {
        "edits": [to_json(edit) for edit in state.edits],
        "settings": asdict(state.settings),
    }
    if state.media is not None:
        entry["media"] = placement_to_json(state.media)
    if state.words is not None:
        entry["words"] = words_to_json(state.words)
    return entry


def _difference(old: Sequence[Edit], new: Sequence[Edit]) -> tuple[int, int, int]:
    """The difference of two lists: `new[first:end]` replaces `old[first:old_end]`."""
    shorter = min(len(old), len(new))
    first = 0
    while first < shorter and (old[first] is new[first] or old[first] == new[first]):
        first += 1
    same = 0
    while same < shorter - first and (old[~same] is new[~same] or old[~same] == new[~same]):
        same += 1
    return first, len(new) - same, len(old) - same


@dataclass(frozen=True)
class Pending:
    """A session that crashed, and its state.

    Attributes:
        path: its journal.
        take: its take.
        fingerprint: the fingerprint of the take; None if the take could not be read.
        project: its project, if any.
        state: the state after the last finished gesture.
        gestures: the number of gestures since the last save.
        when: the time of the last gesture, in seconds since the epoch.
        fps: the take's frame rate, if the user had to give it.
        exported_over: the fingerprint of what was exported over the take, if anything was.
    """

    path: Path
    take: Path
    fingerprint: Fingerprint | None
    project: Path | None
    state: EditState
    gestures: int
    when: float
    fps: float | None = None
    exported_over: Fingerprint | None = None

    def discard(self) -> None:
        """Delete its journal."""
        with contextlib.suppress(OSError):
            self.path.unlink()


def pending_journals(folder: Path | None = None) -> list[Pending]:
    """The sessions that crashed, newest first; running sessions are skipped."""
    found = []
    for path in (folder or journal_folder()).glob(f"*{_SUFFIX}"):
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
        elif content.count(b"\n") <= 1 and time.time() - when > _YOUNG:  # no gesture was made
            with contextlib.suppress(OSError):
                path.unlink()
    for path in (folder or journal_folder()).glob(f"*{_NEW_SUFFIX}"):  # left by a crash
        with contextlib.suppress(OSError):
            if time.time() - path.stat().st_mtime > _YOUNG:
                path.unlink()
    found.sort(key=lambda pending: pending.when, reverse=True)
    return [pending for k, pending in enumerate(found) if not _is_repeated(pending, found[:k])]


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
        if head.whole("version") != VERSION:
            return None
        take = Path(head.path("take"))
        project = Path(head.path("project")) if head.has("project") else None
        print_ = fingerprint_from(head.fields("fingerprint")) if head.has("fingerprint") else None
        fps = head.number_or_none("fps", 1.0, 1000.0)
        exported_over = exported_over_from(head)
    except ValueError:
        return None
    state, step, gestures = None, 0, 0
    for line in lines[1:]:
        try:
            entry = Fields(parse(line))
            if entry.has("exported_over"):
                exported_over = exported_over_from(entry)
                continue
            state = _replay(state, step, entry)
            step = entry.whole("step")
        except ValueError:
            break  # damaged from here on: keep what came before
        gestures += 1
    if state is None:
        return None
    return Pending(path, take, print_, project, state, gestures, when, fps, exported_over)


def _replay(state: EditState | None, step: int, entry: Fields) -> EditState:
    """The state after a gesture.

    Raises:
        ValueError: the entry is damaged, or a gesture before it is missing.
    """
    if entry.has("edits"):
        media = placement_from(entry.fields_or_none("media"))
        words = transcript_from(entry.fields_or_none("words"))
        return EditState(edits_from(entry), settings_from(entry.fields("settings")), media, words)
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
