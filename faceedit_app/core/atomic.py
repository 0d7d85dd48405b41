"""Write a file completely or not at all."""

from __future__ import annotations

import contextlib
import errno
import filecmp
import itertools
import os
import shutil
import tempfile
import time
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path

from faceedit_app.core import on_disk
from faceedit_app.core.errors import FileError, reason_of
from faceedit_app.core.filelock import lock, try_lock
from faceedit_app.core.texts import listed

_SUFFIX = ".faceedit-new"
_LONGEST_NAME = 255  # bytes, on most file systems
_YOUNG = 5.0  # seconds; a younger temporary file may not be locked yet

BACKUP_SUFFIX = ".bak"
OTHER_NAME = "choose another name for the new file"
PNG = b"\x89PNG"
GLB = b"glTF"


def write_atomically(path: Path | str, content: bytes) -> None:
    """Replace the content of `path`: temporary file in the same folder, fsync, rename.

    A reader sees the old file or the new one, never a part of it. After an error the old file is
    untouched and no temporary file remains; one that was left by a process that was killed is
    removed by the next write into its folder.

    Raises:
        FileError: the folder is missing or read-only, the disk is full, or the system does not
            allow the name.
    """
    path = target_of(path)
    temporary: Path | None = None
    try:
        handle, name = tempfile.mkstemp(_SUFFIX, _prefix(path), path.parent)
        temporary = Path(name)
        with os.fdopen(handle, "wb") as file:
            with contextlib.suppress(OSError):  # not on every file system
                lock(file.fileno())
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        # mkstemp makes private files; an export gets the permissions of any other new file.
        temporary.chmod(_permissions(path))
        temporary.replace(path)
    except BaseException as error:  # Ctrl+C leaves nothing behind either
        if temporary is not None:
            with contextlib.suppress(OSError):
                temporary.unlink()
        if isinstance(error, OSError):
            raise not_written(path, error) from error
        raise
    remove_leftovers(path.parent)


def target_of(path: Path | str) -> Path:
    """The file that is replaced if `path` is written: that which a link leads to.

    Raises:
        FileError: the system does not allow the name, or something else than a file is there.
    """
    path = Path(path)
    try:
        os.fsencode(path)
    except UnicodeEncodeError:
        problem = "cannot be written (the name is not valid here)"
        raise FileError(path, problem, "choose another name") from None
    if on_disk.exists(path) and not on_disk.is_file(path):  # a rename would replace /dev/null
        raise FileError(path, "cannot be written (it is not a file)", "choose another name")
    return Path(os.path.realpath(path))


def check_writable(path: Path) -> None:
    """Check that a file can be written, before work whose result it will hold.

    Nothing is left behind, and a file that is there stays as it is.

    Raises:
        FileError: as `write_atomically` would.
    """
    real = target_of(path)
    try:
        with contextlib.suppress(FileNotFoundError):
            real.stat()  # fails if the name is too long
        with tempfile.TemporaryFile(dir=real.parent):
            pass
    except OSError as error:
        raise not_written(path, error) from error


def check_folder(folder: Path) -> None:
    """Check that files can be written into a folder, which may have to be made for them.

    Raises:
        FileError: they cannot.
    """
    there = Path(os.path.realpath(folder))
    while not os.path.lexists(there):
        there = there.parent
    try:
        if not there.is_dir():
            raise FileError(
                folder, f"cannot be a folder ({there.name} is a file)", "choose another"
            )
        with tempfile.TemporaryFile(dir=there):
            pass
    except OSError as error:
        reason = reason_of(error)
        raise FileError(folder, f"cannot be written into ({reason})", "choose another") from error


def not_written(path: Path | str, error: OSError) -> FileError:
    """The error about a file that the system did not let be written."""
    if isinstance(error, FileNotFoundError) and not on_disk.exists(Path(path).parent):
        problem = "cannot be written (its folder does not exist)"
        return FileError(path, problem, "make the folder, or choose another one")
    if error.errno == errno.ENAMETOOLONG:
        return FileError(path, "has too long a name", "choose a shorter one")
    reason = reason_of(error)
    return FileError(
        path, f"cannot be written ({reason})", "choose another folder or free some space"
    )


def remove_leftovers(folder: Path) -> None:
    """Remove the temporary files in a folder whose writers were killed."""
    with contextlib.suppress(OSError), os.scandir(folder) as entries:
        for entry in entries:
            if not (entry.name.startswith(".") and entry.name.endswith(_SUFFIX)):
                continue
            with contextlib.suppress(OSError):
                if time.time() - entry.stat(follow_symlinks=False).st_mtime < _YOUNG:
                    continue
                with open(entry.path, "r+b") as file:
                    is_left = try_lock(file.fileno())
                if is_left:
                    os.unlink(entry.path)


def _prefix(path: Path) -> str:
    """The beginning of a temporary name, short enough if the name itself is a long one."""
    room = _LONGEST_NAME - len(_SUFFIX) - 16
    return os.fsdecode(os.fsencode(f".{path.name}")[:room]) + "."


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
    backup = backup_of(path)
    try:
        if not backup.exists():
            _copy(path, backup)
    except OSError as error:
        raise _not_kept(backup, error) from error
    return backup


def backup_of(path: Path | str) -> Path:
    """The copy that `keep_backup` makes of a file, or has made of the same content.

    Raises:
        FileError: an earlier copy, or the file, cannot be read.
    """
    path = Path(os.path.realpath(path))
    for number in itertools.count(1):
        backup = path.with_name(f"{path.name}{BACKUP_SUFFIX}{number if number > 1 else ''}")
        try:
            if not backup.exists() or filecmp.cmp(path, backup, shallow=False):
                return backup
        except OSError as error:
            raise _not_kept(backup, error) from error
    raise AssertionError("unreachable")


def where_kept(path: Path | str) -> str:
    """What a question says of the copy that `keep_backup` makes, after “is kept”."""
    try:
        return f"as {backup_of(path).name}"
    except FileError:
        return "beside it"


def _not_kept(backup: Path, error: OSError) -> FileError:
    return FileError(backup, f"cannot be written ({reason_of(error)})", OTHER_NAME)


def keep_other(path: Path | str, is_ours: Callable[[Path], bool]) -> Path | None:
    """Copy a file to `NAME.bak` before it is replaced, unless it is of the kind that is written.

    Whoever replaces pictures by pictures means it; whoever replaces a recording by a picture
    chose the wrong name.

    Args:
        path: the file that will be written.
        is_ours: whether a file is of the kind that will be written there.

    Returns:
        The copy; None if none was needed.

    Raises:
        FileError: the copy cannot be written; `path` must then not be replaced.
    """
    path = Path(path)
    if not on_disk.is_file(path) or not path.stat().st_size or is_ours(path):
        return None
    try:
        return keep_backup(path)
    except FileError as error:
        if isinstance(error.__cause__, OSError):  # about the file that the user named
            raise not_written(path, error.__cause__) from error
        raise


def write_keeping(path: Path | str, content: bytes, is_ours: Callable[[Path], bool]) -> Path | None:
    """Write a file, of which one of another kind that is there is kept: `keep_other`.

    Raises:
        FileError: it cannot be written.
    """
    backup = keep_other(path, is_ours)
    write_atomically(path, content)
    return backup


def said_of(*backups: Path | str | None) -> str:
    """What to add to a message about files that were written, if copies of others were kept.

    Args:
        backups: what `keep_other` returned; "" is none as well.
    """
    names = [backup.name if isinstance(backup, Path) else backup for backup in backups if backup]
    if len(names) > 1:
        return f"; the files that were there are now {listed(names)}"
    return f"; the file that was there is now {names[0]}" if names else ""


def begins_with(*marks: bytes) -> Callable[[Path], bool]:
    """A test whether a file begins with one of some bytes, for `keep_other`."""

    def is_ours(path: Path) -> bool:
        try:
            with path.open("rb") as file:
                return file.read(max(map(len, marks))).startswith(marks)
        except OSError:
            return False

    return is_ours


def _copy(path: Path, copy: Path) -> None:
    """Copy a file, or leave nothing behind."""
    try:
        shutil.copy2(path, copy)
    except BaseException:
        copy.unlink(missing_ok=True)
        raise


def keep_inputs(
    written: Iterable[Path | None],
    read: Iterable[Path | None] | Mapping[Path, str],
    remedy: str = OTHER_NAME,
) -> None:
    """Make sure that no file that is read is written over, whatever name or link leads to it.

    Args:
        written: the files that will be written; None is none.
        read: the files that are read, and folders whose files are; None is none. A mapping says
            what each of them is, as a phrase that follows its name.
        remedy: what the user can do about it.

    Raises:
        FileError: one of them would be written over.
    """
    said = read if isinstance(read, Mapping) else {}
    inputs = [path for path in read if path is not None]
    for path in written:
        if path is None or not on_disk.is_file(path):
            continue
        for other in inputs:
            if is_same_file(path, other) or is_same_file(
                Path(os.path.realpath(path)).parent, other
            ):
                problem = "would be written over, but it is read here as well"
                raise FileError(path, said.get(other, problem), remedy)


def check_outputs(
    written: Iterable[Path | None],
    read: Iterable[Path | None],
    remedy: str = OTHER_NAME,
) -> None:
    """Check files before the work whose results they will hold.

    Args:
        written, read, remedy: as of `keep_inputs`.

    Raises:
        FileError: one of them is read as well, or cannot be written.
    """
    files = [path for path in written if path is not None]
    keep_inputs(files, read, remedy)
    for path in files:
        check_writable(path)


def is_same_file(one: Path, other: Path) -> bool:
    """Whether two paths name the same file, or would if it existed."""
    try:
        return one.samefile(other)
    except (OSError, ValueError):
        return os.path.realpath(one) == os.path.realpath(other)


def _permissions(path: Path) -> int:
    if on_disk.exists(path):
        return path.stat().st_mode & 0o777
    mask = os.umask(0)
    os.umask(mask)
    return 0o666 & ~mask
