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
import uuid
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import platformdirs

from faceedit_app.core.errors import FileError, reason_of
from faceedit_app.core.filelock import lock
from faceedit_app.editing.edits.edit import Edit, to_json
from faceedit_app.editing.edits.media import to_json as placement_to_json
from faceedit_app.editing.files.fingerprint import Fingerprint, KnownFile, fingerprint
from faceedit_app.editing.steps import EditState, Origin
from faceedit_app.words.transcript import to_json as words_to_json

VERSION = 1
SUFFIX = ".jsonl"
NEW_SUFFIX = ".new"
EXPORTED_OVER, CHARACTER = "exported_over", "character"  # fields that also have their own lines
ORIGIN = "origin"
_LONG = 32 * 2**20  # bytes; a longer journal is written again without what no longer matters
_PATIENCE = 1.0  # seconds to wait for a slow disk when closing
_CREATE = os.O_RDWR | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0)


def journal_folder() -> Path:
    """The folder of this user's journals."""
    return Path(platformdirs.user_state_dir("FaceEdit", appauthor=False)) / "journals"


class Journal:
    """The journal of one session.

    `take` is its take. `note` is empty while all is well, else one line for the user. Connect it
    with `session.stepped.connect(journal.record)`.

    Args:
        take: the open take.
        project: the project that it was opened from, if any, as it was then.
        folder: where journals are; None = `journal_folder()`.
        fps: the take's frame rate, if the user had to give it.
        opened: the fingerprint of the take as it was opened; None = that of the file now.
        exported_over: the fingerprint of what was exported over the take, if anything was.
        character: the user's character, if one is shown.
        origin: where Undo is to lead after a recovery; None if that is not known.
    """

    def __init__(
        self,
        take: Path,
        project: KnownFile | None = None,
        folder: Path | None = None,
        fps: float | None = None,
        opened: Fingerprint | None = None,
        exported_over: Fingerprint | None = None,
        character: Path | None = None,
        origin: Origin | None = None,
    ) -> None:
        self.note = ""
        self.path = (folder or journal_folder()) / f"{uuid.uuid4().hex}{SUFFIX}"
        self.take, self._project, self._fps = take.absolute(), project, fps
        self._print, self._exported_over = opened, exported_over
        self._character, self._origin = character, origin
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
        self._note({EXPORTED_OVER: asdict(content)})

    def showing(self, character: Path | None) -> None:
        """Note which of the user's characters is shown now; None = FaceEdit's own."""
        if character != self._character:
            self._character = character
            self._note({CHARACTER: self._shown})

    @property
    def _shown(self) -> dict[str, str] | None:
        return {"path": str(self._character)} if self._character is not None else None

    def _note(self, entry: dict[str, Any]) -> None:
        """Append a line that is no gesture."""
        if self._file is not None and not self._closed:
            self._append(entry)
            self._wake.set()

    def _shorten(self) -> None:
        """Replace the file by one that holds only the state after its last line.

        A crash meanwhile leaves the old file. So does a failure, and it is not tried again soon.
        """
        self._longest = 2 * self._length
        if self._last is None:
            return
        new = self.path.with_suffix(NEW_SUFFIX)
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

    def saved(self, project: KnownFile | None = None, origin: Origin | None = None) -> None:
        """Forget the gestures so far: they are saved.

        Args:
            project: the project that holds them, if it is another one now.
            origin: where Undo is to lead now; None if that is not known.
        """
        self._origin = origin
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
        head: dict[str, Any] = {"version": VERSION, "take": str(self.take)}
        if self._project is not None:
            head["project"] = str(self._project.path.absolute())
            if self._project.mark is not None:
                head["project_fingerprint"] = asdict(self._project.mark)
        if self._print is not None:
            head["fingerprint"] = asdict(self._print)
        if self._fps is not None:
            head["fps"] = self._fps
        if self._exported_over is not None:
            head[EXPORTED_OVER] = asdict(self._exported_over)
        if self._character is not None:
            head[CHARACTER] = self._shown
        if self._origin is not None:
            head[ORIGIN] = _whole(self._origin.state) | {"saved": self._origin.is_saved}
            if self._origin.rate is not None:
                head[ORIGIN]["fps"] = self._origin.rate
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
        reason = reason_of(error)
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
