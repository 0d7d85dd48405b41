"""Errors for the user: one plain line that says what is wrong, where, and what to do."""

from __future__ import annotations

from pathlib import Path

from faceedit_app.core.texts import LONGEST, plain_line, printable

_LONGEST_PLACE = 120


class FaceEditError(Exception):
    """A problem the user can act on. `str(error)` is one line, ready to be shown."""

    def __init__(self, text: str):
        super().__init__(plain_line(text))


class FileError(FaceEditError):
    """A file that cannot be used; the text is `file[, line N]: problem; remedy`.

    Where it would be longer than `LONGEST`, the beginning of the path and the end of the problem
    are left out.

    Args:
        path: the file as the user knows it.
        problem: what is wrong with it, without a full stop.
        remedy: what the user can do about it, without a full stop.
        line: the line in the file, counted from 1, if there is one.
    """

    def __init__(self, path: Path | str, problem: str, remedy: str, line: int | None = None):
        self.path, self.problem, self.remedy, self.line = Path(path), problem, remedy, line
        place, at = printable(str(path)), "" if line is None else f", line {line}"
        if len(place) + len(at) + len(problem) + len(remedy) + 4 > LONGEST:
            place = place if len(place) <= _LONGEST_PLACE else f"…{place[1 - _LONGEST_PLACE :]}"
            room = max(LONGEST - len(place) - len(at) - len(remedy) - 4, 40)
            problem = plain_line(problem, room)
        super().__init__(f"{place}{at}: {problem}; {remedy}")

    def with_remedy(self, remedy: str) -> FileError:
        """The same error with another remedy, as it is called elsewhere."""
        return FileError(self.path, self.problem, remedy, self.line)


class Unavailable(FaceEditError):
    """Something the computer lacks, such as OpenGL; the text names the remedy."""
