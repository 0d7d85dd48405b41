"""Errors for the user: one plain line that says what is wrong, where, and what to do."""

from __future__ import annotations

from pathlib import Path
from typing import Self

from faceedit_app.core.texts import LONGEST, plain_line, printable

_LONGEST_PLACE = 120


class FaceEditError(Exception):
    """A problem the user can act on. `str(error)` is one line, ready to be shown in the window.

    Args:
        text: what is wrong, and what can be done about it in the window.
        for_command: the same where a command was typed, which has options; "" = the same text.

    Attributes:
        for_command: one line, ready to be printed by a command.
    """

    def __init__(self, text: str, for_command: str = ""):
        super().__init__(plain_line(text))
        self.for_command = plain_line(for_command or text)


class FileError(FaceEditError):
    """A file that cannot be used; the text is `file[, line N]: problem; remedy`.

    Where it would be longer than `LONGEST`, the beginning of the path and the end of the problem
    are left out.

    Args:
        path: the file as the user knows it.
        problem: what is wrong with it, without a full stop.
        remedy: what the user can do about it in the window, without a full stop.
        line: the line in the file, counted from 1, if there is one.
        command_remedy: what can be done about it where a command was typed, whose options it may
            name; "" = the same remedy.
    """

    def __init__(
        self,
        path: Path | str,
        problem: str,
        remedy: str,
        line: int | None = None,
        command_remedy: str = "",
    ):
        self.path, self.problem, self.remedy, self.line = Path(path), problem, remedy, line
        self.command_remedy = command_remedy or remedy
        super().__init__(self._with(self.remedy), self._with(self.command_remedy))

    def _with(self, remedy: str) -> str:
        """The line that ends in a remedy."""
        problem = self.problem
        place, at = printable(str(self.path)), "" if self.line is None else f", line {self.line}"
        if len(place) + len(at) + len(problem) + len(remedy) + 4 > LONGEST:
            place = place if len(place) <= _LONGEST_PLACE else f"…{place[1 - _LONGEST_PLACE :]}"
            room = max(LONGEST - len(place) - len(at) - len(remedy) - 4, 40)
            problem = plain_line(problem, room)
        return f"{place}{at}: {problem}; {remedy}"

    def with_remedy(self, remedy: str) -> Self:
        """The same kind of error with another remedy, as it is called elsewhere."""
        again = type(self).__new__(type(self))  # other kinds have other arguments
        again.__dict__.update(self.__dict__)
        FileError.__init__(again, self.path, self.problem, remedy, self.line)
        return again


def reason_of(error: OSError) -> str:
    """What the system says about an error, as part of a sentence."""
    return (error.strerror or str(error)).lower()


class Unavailable(FaceEditError):
    """Something the computer lacks, such as OpenGL; the text names the remedy."""
