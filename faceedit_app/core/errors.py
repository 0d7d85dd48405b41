"""Errors for the user: one plain line that says what is wrong, where, and what to do."""

from __future__ import annotations

from pathlib import Path


class FaceEditError(Exception):
    """A problem the user can act on. `str(error)` is one line, ready to be shown."""


class FileError(FaceEditError):
    """A file that cannot be used; the text is `file[, line N]: problem; remedy`.

    Args:
        path: the file as the user knows it.
        problem: what is wrong with it, without a full stop.
        remedy: what the user can do about it, without a full stop.
        line: the line in the file, counted from 1, if there is one.
    """

    def __init__(self, path: Path | str, problem: str, remedy: str, line: int | None = None):
        self.path, self.problem, self.remedy, self.line = Path(path), problem, remedy, line
        where = f"{path}, line {line}" if line is not None else f"{path}"
        super().__init__(f"{where}: {problem}; {remedy}".replace("\n", " "))


class Unavailable(FaceEditError):
    """Something the computer lacks, such as OpenGL; the text names the remedy."""
