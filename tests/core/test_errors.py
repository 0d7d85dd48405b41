"""An error is one short line that prints, whatever a file or its name contains."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from faceedit_app.core.errors import FaceEditError, FileError
from faceedit_app.core.texts import LONGEST, plain_line, say


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("one\ntwo\r\n three", "one two three"),
        ("\x1b[31mred\x1b]0;title\x07", "?[31mred?]0;title?"),
        ("txt.\u202eexe", "txt.?exe"),
        (os.fsdecode(b"caf\xe9.csv"), "caf?.csv"),
        ("“Lächeln” – 5 °", "“Lächeln” – 5 °"),
    ],
)
def test_a_text_from_a_file_becomes_one_line_that_prints(text: str, line: str) -> None:
    assert plain_line(text) == line
    assert str(FaceEditError(text)) == line


@pytest.mark.parametrize("path", ["take.csv", "folder/" * 600 + "take.csv"])
@pytest.mark.parametrize("problem", ["is damaged", "holds " + "x" * 5000])
def test_an_error_of_a_file_names_file_line_and_remedy_in_300_characters(
    path: str, problem: str
) -> None:
    error = FileError(Path(path), problem, "delete the row", 12)
    assert len(str(error)) <= LONGEST
    assert "take.csv, line 12: " in str(error)
    assert problem[:8] in str(error)
    assert str(error).endswith("; delete the row")
    assert error.path == Path(path)


def test_a_short_error_is_shown_as_it_is() -> None:
    assert str(FileError("a.csv", "is empty", "choose a take")) == "a.csv: is empty; choose a take"


def test_commands_print_no_terminal_escapes(capsys: pytest.CaptureFixture[str]) -> None:
    say("  name \x1b[2J\n  caf\udce9.csv")
    assert capsys.readouterr().out == "  name ?[2J\n  caf?.csv\n"
