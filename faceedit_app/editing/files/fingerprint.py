"""Identify a file by its content, and find it after it was moved."""

from __future__ import annotations

import hashlib
import os
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from faceedit_app.core import on_disk
from faceedit_app.core.atomic import BACKUP_SUFFIX
from faceedit_app.core.errors import FileError, reason_of
from faceedit_app.core.fields import Fields
from faceedit_app.formats.take import Take

SEARCH_SECONDS = 5.0  # a network drive with a million files must not keep the user waiting
SEARCH_DEPTH = 2  # levels of folders that are searched


@dataclass(frozen=True)
class Fingerprint:
    """Identifies a file: its size in bytes and the SHA-256 of its content."""

    size: int
    sha256: str


def fingerprint_from(fields: Fields) -> Fingerprint:
    """Read `size` and `sha256`.

    Raises:
        FieldError: one of them is wrong.
    """
    return Fingerprint(fields.whole("size"), fields.text("sha256"))


def fingerprint(path: Path) -> Fingerprint:
    """The fingerprint of a file.

    Raises:
        FileError: it cannot be read.
    """
    if on_disk.exists(path) and not on_disk.is_file(path):  # a pipe or a device may never end
        raise FileError(path, "cannot be read (it is not a file)", "check the path")
    try:
        with path.open("rb") as file:
            digest = hashlib.file_digest(file, "sha256")
            return Fingerprint(file.tell(), digest.hexdigest())
    except OSError as error:
        reason = reason_of(error)
        raise FileError(path, f"cannot be read ({reason})", "check the path") from error


@dataclass(frozen=True)
class KnownFile:
    """A file as a session read or wrote it last.

    Attributes:
        path: the file.
        mark: its fingerprint then; None if that is not known.
    """

    path: Path
    mark: Fingerprint | None

    @property
    def was_changed(self) -> bool:
        """Whether it may have been changed since; a file that is gone has not."""
        if not on_disk.is_file(self.path):
            return False
        try:
            return fingerprint(self.path) != self.mark
        except FileError:
            return False  # writing will say why


def known(path: Path) -> KnownFile:
    """A file as it is now.

    Raises:
        FileError: it cannot be read.
    """
    return KnownFile(path, fingerprint(path))


def fingerprint_of(take: Take) -> Fingerprint:
    """The fingerprint of a take's file as it was when it was opened.

    The file is not read again: it may have been removed or overwritten since. A take that is
    written unchanged has the same bytes.
    """
    return fingerprint_of_content(take.source.encode(take.clip.weights, take.clip.weights))


def fingerprint_of_content(content: bytes) -> Fingerprint:
    """The fingerprint of a file with this content."""
    return Fingerprint(len(content), hashlib.sha256(content).hexdigest())


def find_by_content(wanted: Fingerprint, name: str, folders: Iterable[Path]) -> Path | None:
    """Search folders and their subfolders for a file: by its name first, then by its ending.

    A backup counts as named like its original. Copies with other names are found as well.

    Args:
        wanted: its fingerprint.
        name: its last known name.
        folders: where to search, the most likely first.

    Returns:
        The file, or None if it is not found in time.
    """
    ending = _ending(Path(name))
    alike = []
    for path in _files_below(folders):
        if _ending(path) == ending and _size(path) == wanted.size:
            if original_of(path).name != name:
                alike.append(path)
            elif _is(path, wanted):
                return path
    return next((path for path in alike if _is(path, wanted)), None)


def find_by_name(name: str, folders: Iterable[Path]) -> tuple[Path, ...]:
    """All files of this name in folders and their subfolders."""
    return tuple(path for path in _files_below(folders) if path.name == name)


def _files_below(folders: Iterable[Path]) -> Iterator[Path]:
    """Each file once, level by level, while time allows; hidden folders are skipped."""
    until = time.monotonic() + SEARCH_SECONDS
    level = [folder.absolute() for folder in folders]
    seen: set[str] = set()
    for _ in range(SEARCH_DEPTH + 1):
        below: list[Path] = []
        for folder in level:
            if time.monotonic() > until:
                return
            if os.path.realpath(folder) in seen:
                continue
            seen.add(os.path.realpath(folder))
            try:
                entries = sorted(os.scandir(folder), key=lambda entry: entry.name)
            except OSError:  # removed, or no permission: search elsewhere
                continue
            for entry in entries:
                if _is_folder(entry):
                    below.append(Path(entry.path))
                else:
                    yield Path(entry.path)
        level = below


def _is_folder(entry: os.DirEntry[str]) -> bool:
    try:
        return entry.is_dir() and not entry.name.startswith(".")
    except OSError:
        return False


def _ending(path: Path) -> str:
    """The ending in lower case; that of a backup is its original's."""
    return original_of(path).suffix.lower()


def original_of(path: Path) -> Path:
    """What a file is the backup of, or the file."""
    is_backup = path.suffix.rstrip("0123456789") == BACKUP_SUFFIX
    return path.with_suffix("") if is_backup else path


def _size(path: Path) -> int:
    try:
        return path.stat().st_size
    except OSError:
        return -1


def _is(path: Path, wanted: Fingerprint) -> bool:
    try:
        return fingerprint(path) == wanted
    except FileError:
        return False
