"""Errors that are meant for the user: one plain line that says what, where and what to do."""

from __future__ import annotations

from pathlib import Path


class FaceEditError(Exception):
    """A problem the user can act on. `str(error)` is one line, ready to be shown."""


class FileError(FaceEditError):
    """A file that cannot be used, told as `file[, line N]: problem; remedy`.

    Args:
        path: the file as the user knows it.
        problem: what is wrong with it, without a full stop.
        remedy: what the user can do about it, without a full stop.
        line: the 1-based line in the file, where there is one.
    """

    def __init__(self, path: Path | str, problem: str, remedy: str, line: int | None = None):
        self.path, self.problem, self.remedy, self.line = Path(path), problem, remedy, line
        where = f"{path}, line {line}" if line is not None else f"{path}"
        super().__init__(f"{where}: {problem}; {remedy}".replace("\n", " "))


class Unavailable(FaceEditError):
    """A part of the machine (such as OpenGL) that is missing; the text names the remedy."""
