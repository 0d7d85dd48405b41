"""Write a file completely or not at all."""

from __future__ import annotations

import contextlib
import filecmp
import itertools
import os
import shutil
import tempfile
from pathlib import Path

from faceedit_app.core.errors import FileError

BACKUP_SUFFIX = ".bak"


def write_atomically(path: Path | str, content: bytes) -> None:
    """Replace the content of `path`: temporary file in the same folder, fsync, rename.

    A reader sees the old file or the new one, never a part of it. After an error the old file is
    untouched and no temporary file remains.

    Raises:
        FileError: the folder is missing or read-only, or the disk is full.
    """
    path = Path(os.path.realpath(path))  # follow a link to its target
    if path.exists() and not path.is_file():  # a rename would replace /dev/null
        raise FileError(path, "cannot be written (it is not a file)", "choose another name")
    temporary: Path | None = None
    try:
        handle, name = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
        temporary = Path(name)
        with os.fdopen(handle, "wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        # mkstemp makes private files; an export gets the permissions of any other new file.
        temporary.chmod(_permissions(path))
        temporary.replace(path)
    except OSError as error:
        if temporary is not None:
            with contextlib.suppress(OSError):
                temporary.unlink()
        reason = (error.strerror or str(error)).lower()
        raise FileError(
            path, f"cannot be written ({reason})", "choose another folder or free some space"
        ) from error


def keep_backup(path: Path | str) -> Path:
    """Copy a file to `NAME.bak` beside it, before it is replaced.

    An earlier backup with other content stays, and the copy becomes `NAME.bak2` and so on: the
    first one may be the only copy of a recording.

    Returns:
        The file that now has the same content.

    Raises:
        FileError: the copy cannot be written; `path` must then not be replaced.
    """
    path = Path(os.path.realpath(path))
    for number in itertools.count(1):
        backup = path.with_name(f"{path.name}{BACKUP_SUFFIX}{number if number > 1 else ''}")
        try:
            if not backup.exists():
                shutil.copy2(path, backup)
                return backup
            if filecmp.cmp(path, backup, shallow=False):
                return backup
        except OSError as error:
            reason = (error.strerror or str(error)).lower()
            raise FileError(
                backup, f"cannot be written ({reason})", "choose another name for the new file"
            ) from error
    raise AssertionError("unreachable")


def _permissions(path: Path) -> int:
    if path.exists():
        return path.stat().st_mode & 0o777
    mask = os.umask(0)
    os.umask(mask)
    return 0o666 & ~mask
