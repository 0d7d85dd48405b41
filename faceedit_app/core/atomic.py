"""Write a file completely or not at all."""

from __future__ import annotations

import contextlib
import os
import tempfile
from pathlib import Path

from faceedit_app.core.errors import FileError


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


def _permissions(path: Path) -> int:
    if path.exists():
        return path.stat().st_mode & 0o777
    mask = os.umask(0)
    os.umask(mask)
    return 0o666 & ~mask
