"""The journal: every finished gesture on disk at once, for the start after a crash.

One file a running session, JSON lines: what the session is about, then one line a gesture with
the edits that it changed. A line is written before the next gesture can begin, so it survives
`kill -9`; a thread follows with fsync, so that it soon survives a power cut and no gesture waits
for a disk. Whatever goes wrong with the journal ends in `Journal.note`, never in the gesture.
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
from faceedit_app.editing.edits.edit import Edit, from_json, to_json
from faceedit_app.editing.edits.media import from_json as placement_from_json
from faceedit_app.editing.edits.media import to_json as placement_to_json
from faceedit_app.editing.files.filelock import lock, try_lock
from faceedit_app.editing.files.fingerprint import Fingerprint, fingerprint
from faceedit_app.editing.files.project import settings_from_json
from faceedit_app.editing.steps import EditState

VERSION = 1
_SUFFIX = ".jsonl"
_PATIENCE = 1.0  # seconds that closing waits for a slow disk
_YOUNG = 60.0  # seconds within which an empty journal may belong to a start in progress


def journal_folder() -> Path:
    """Where the journals of this user are."""
    return Path(platformdirs.user_state_dir("FaceEdit", appauthor=False)) / "journals"


class Journal:
    """Writes down one session.

    `note` is "" as long as all is well, else one line for the user. Connect it by
    `session.stepped.connect(journal.record)`.

    Args:
        take: the open take.
        project: the project file it was opened from, if any.
        folder: where journals are; None = `journal_folder()`.
    """

    def __init__(self, take: Path, project: Path | None = None, folder: Path | None = None) -> None:
        self.note = ""
        self.path = (folder or journal_folder()) / f"{uuid.uuid4().hex}{_SUFFIX}"
        self._take, self._project = take.absolute(), project
        self._print: Fingerprint | None = None  # as it was opened: it may be exported over
        with contextlib.suppress(FileError):
            self._print = fingerprint(take)
        self._file: int | None = None
        self._length = 0  # bytes that are known to be whole lines
        self._last: EditState | None = None  # what a reader has after those lines
        self._step = 0
        self._wake, self._closed = threading.Event(), False
        self._thread = threading.Thread(target=self._sync, name="journal", daemon=True)
        self._thread.start()
        self._open()

    def _open(self) -> bool:
        """Begin the file; False if that cannot be."""
        self._last, self._length = None, 0
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            flags = os.O_RDWR | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0)
            self._file = os.open(self.path, flags, 0o600)
            lock(self._file)
        except OSError as error:
            self._remove()
            self._fail(error)
            return False
        return self._append(self._head())

    def _is_there(self) -> bool:
        """Whether the file can be found after a crash: its drive or folder may have gone."""
        try:
            return self._file is not None and os.path.samestat(
                os.stat(self.path), os.fstat(self._file)
            )
        except OSError:
            return False

    def record(self, state: EditState) -> None:
        """Write down what a finished gesture led to; takes well under a millisecond."""
        if self._closed:
            return
        if not self._is_there():
            self._remove()
            if not self._open():
                return
        last = self._last
        entry: dict[str, Any] = {"step": self._step + 1}
        if last is None:
            entry["edits"] = [to_json(edit) for edit in state.edits]
        else:
            first, end, old_end = _difference(last.edits, state.edits)
            entry |= {"at": first, "drop": old_end - first}
            entry["add"] = [to_json(edit) for edit in state.edits[first:end]]
        if last is None or last.settings != state.settings:
            entry["settings"] = asdict(state.settings)
        if (last.media if last is not None else None) != state.media:
            entry["media"] = placement_to_json(state.media)
        if self._append(entry):
            self._last, self._step = state, self._step + 1
            self._wake.set()
        else:
            self._last = None  # begin anew with all edits, should the disk come back

    def saved(self, project: Path | None = None) -> None:
        """All gestures up to now are in a file: forget them."""
        if project is not None:
            self._project = project
        if self._file is None:
            return
        self._last, self._length = None, 0
        self._append(self._head())

    def close(self) -> None:
        """The session ends and nothing needs to be recovered: remove the file."""
        if self._closed:
            return
        self._closed = True
        self._wake.set()
        self._thread.join(_PATIENCE)
        if self._thread.is_alive():  # its fsync still uses the file
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
        return head

    def _append(self, entry: dict[str, Any]) -> bool:
        assert self._file is not None
        line = json.dumps(entry, separators=(",", ":")).encode() + b"\n"
        try:
            os.ftruncate(self._file, self._length)  # what a failed write may have left
            os.lseek(self._file, self._length, os.SEEK_SET)
            written = 0
            while written < len(line):
                written += os.write(self._file, line[written:])
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
                    if file == self._file:  # not closed meanwhile because it was gone
                        self._fail(error)

    def _fail(self, error: OSError) -> None:
        reason = (error.strerror or str(error)).lower()
        self.note = f"Edits are not being backed up ({reason}: {self.path.parent}); save often"


def _difference(old: Sequence[Edit], new: Sequence[Edit]) -> tuple[int, int, int]:
    """Where two lists differ: `new[first:end]` stands for `old[first:old_end]`."""
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
    """A session that ended without closing: what it had done.

    Attributes:
        path: its journal.
        take: the take it was about.
        fingerprint: the take's, to see whether it is still the same; None if it was unreadable.
        project: its project file, if it had one.
        state: after its last finished gesture.
        gestures: how many there were since the last save.
        when: seconds since the epoch at which the last one was made.
    """

    path: Path
    take: Path
    fingerprint: Fingerprint | None
    project: Path | None
    state: EditState
    gestures: int
    when: float

    def discard(self) -> None:
        """Forget it: it is recovered, or not wanted."""
        with contextlib.suppress(OSError):
            self.path.unlink()


def pending_journals(folder: Path | None = None) -> list[Pending]:
    """What crashed sessions left behind, the newest first; running sessions are left alone."""
    found = []
    for path in (folder or journal_folder()).glob(f"*{_SUFFIX}"):
        try:
            with path.open("r+b") as file:
                if not try_lock(file.fileno()):
                    continue  # its session runs
                when = os.fstat(file.fileno()).st_mtime
                pending = _read(path, file.read(), when)
        except OSError:
            continue
        if pending is not None:
            found.append(pending)
        elif time.time() - when > _YOUNG:
            with contextlib.suppress(OSError):
                path.unlink()
    return sorted(found, key=lambda pending: pending.when, reverse=True)


def _read(path: Path, content: bytes, when: float) -> Pending | None:
    """What a journal holds; None if there is nothing to recover."""
    lines = content.split(b"\n")[:-1]  # what no newline ends was being written
    try:
        head = json.loads(lines[0])
        if head["version"] != VERSION:
            return None
        take = Path(head["take"])
        project = Path(head["project"]) if "project" in head else None
        print_ = Fingerprint(**head["fingerprint"]) if "fingerprint" in head else None
    except (IndexError, KeyError, TypeError, ValueError):
        return None
    state, step, gestures = None, 0, 0
    for line in lines[1:]:
        try:
            entry = json.loads(line)
            state = _replay(state, step, entry)
            step = entry["step"]
        except (IndexError, KeyError, TypeError, ValueError):
            break  # a damaged disk: what came before is still good
        gestures += 1
    if state is None:
        return None
    return Pending(path, take, print_, project, state, gestures, when)


def _replay(state: EditState | None, step: int, entry: dict[str, Any]) -> EditState:
    if "edits" in entry:
        edits = [from_json(edit) for edit in entry["edits"]]
        media = placement_from_json(entry.get("media"))
        return EditState(tuple(edits), settings_from_json(entry["settings"]), media)
    if state is None or entry["step"] != step + 1:
        raise ValueError("a line is missing")
    edits = list(state.edits)
    at, drop = entry["at"], entry["drop"]
    if not 0 <= at <= at + drop <= len(edits):
        raise ValueError("it does not fit the edits before it")
    edits[at : at + drop] = [from_json(edit) for edit in entry["add"]]
    settings = settings_from_json(entry["settings"]) if "settings" in entry else state.settings
    media = placement_from_json(entry["media"]) if "media" in entry else state.media
    return EditState(tuple(edits), settings, media)
