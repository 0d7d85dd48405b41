"""Recordings that an export must not replace by mistake: the open take, and takes of projects."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from pathlib import Path

from faceedit_app.core import on_disk
from faceedit_app.core.atomic import keep_backup, keep_other
from faceedit_app.core.errors import FileError
from faceedit_app.editing.files import PROJECT_SUFFIX
from faceedit_app.editing.files.project import read_project
from faceedit_app.formats.registry import is_take

_OTHER_NAME = "choose another name"


class KeptRecording(FileError):
    """A recording that would be replaced.

    Args:
        path: the recording.
        reason: what it is, as `why_keep` says.
        can_allow: whether a command has an option that allows it.
    """

    def __init__(self, path: Path, reason: str, can_allow: bool = True) -> None:
        super().__init__(
            path,
            reason,
            _OTHER_NAME,
            command_remedy=f"{_OTHER_NAME}, or add --overwrite, which keeps a copy of it (.bak)"
            if can_allow
            else "",
        )


def why_keep(path: Path, take: Path, projects: Iterable[Path] = ()) -> str:
    """Why a file should not be replaced, as a phrase that follows its name.

    Args:
        path: the file that would be written.
        take: the take that is exported.
        projects: project files to look into, besides those in the folder of `path`.

    Returns:
        "" if the file does not exist, or is neither the take nor that of a project.
    """
    if not on_disk.is_file(path):
        return ""
    if _same(path, take):
        return "is the recording itself"
    beside = sorted(path.absolute().parent.glob(f"*{PROJECT_SUFFIX}"))
    for project in dict.fromkeys([*beside, *(p for p in projects if p.suffix == PROJECT_SUFFIX)]):
        try:
            refers = _same(path, read_project(project).take)
        except FileError:  # a damaged project holds nobody back
            continue
        if refers:
            return f"is the recording of the project {project.name}"
    return ""


def is_replaced(path: Path, take: Path, overwrite: bool, can_allow: bool = True) -> bool:
    """Whether writing to `path` replaces a recording, which is allowed.

    Args:
        path, take, overwrite: as of `make_way`.
        can_allow: whether a command has an option for that.

    Raises:
        KeptRecording: it is not allowed.
    """
    reason = why_keep(path, take)
    if reason and not overwrite:
        raise KeptRecording(path, reason, can_allow)
    return bool(reason)


def make_way(
    path: Path, take: Path, overwrite: bool, is_ours: Callable[[Path], bool] = is_take
) -> Path | None:
    """Make sure that writing to `path` loses no recording, and nothing of another kind.

    Args:
        path: the file that will be written.
        take: the take that is exported.
        overwrite: replace a recording, after a copy of it has been made.
        is_ours: whether a file is of the kind that is written, so that no copy is needed.

    Returns:
        The copy, if one was made.

    Raises:
        KeptRecording: it is a recording and `overwrite` is False.
        FileError: the copy cannot be written.
    """
    if is_replaced(path, take, overwrite):
        return keep_backup(path)
    return keep_other(path, is_ours)


def _same(a: Path, b: Path) -> bool:
    try:
        return os.path.samefile(a, b)
    except OSError:
        return False
