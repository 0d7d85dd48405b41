"""An error is one short line that prints, whatever a file or its name contains."""

from __future__ import annotations

import ast
import os
import re
from pathlib import Path

import pytest

import faceedit_app
from faceedit_app.core.errors import FaceEditError, FileError
from faceedit_app.core.texts import LONGEST, plain_line, say
from faceedit_app.formats.timing import RateNeeded

PACKAGE = Path(faceedit_app.__file__).parent
SHARED = [  # all that the window uses; `api.py` calls the options by their names in Python
    room
    for room in sorted(PACKAGE.iterdir())
    if room.suffix in {"", ".py"}
    and room.stem not in {"__pycache__", "command_line", "batch", "lab", "cli", "api"}
]


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


def test_options_of_commands_are_named_only_where_a_command_was_typed() -> None:
    error = FileError("a.csv", "has no times", "give them", command_remedy="give them, or --fps")
    assert str(error) == "a.csv: has no times; give them"
    assert error.for_command == "a.csv: has no times; give them, or --fps"
    assert str(error.with_remedy("give fps=60")) == "a.csv: has no times; give fps=60"
    needed = RateNeeded("a.csv", "has no times", 60, 5).with_remedy("give fps=60")
    assert (type(needed), needed.rate, needed.for_command) == (RateNeeded, 60, str(needed))


_OPTION = re.compile("--[a-z]")


@pytest.mark.parametrize("room", SHARED, ids=lambda room: room.name)
def test_errors_of_code_that_the_window_shares_name_no_option_of_a_command(room: Path) -> None:
    for file in [room] if room.is_file() else sorted(room.rglob("*.py")):
        content = file.read_text("utf-8")
        if _OPTION.search(content) is None:
            continue  # parsing all files would take seconds
        tree = ast.parse(content)
        docstrings = [one.value for one in ast.walk(tree) if isinstance(one, ast.Expr)]
        for_commands = [
            given.value
            for call in ast.walk(tree)
            if isinstance(call, ast.Call)
            for given in call.keywords
            if given.arg in {"for_command", "command_remedy"}
        ]
        may_name = {text for part in [*docstrings, *for_commands] for text in ast.walk(part)}
        for text in ast.walk(tree):
            if isinstance(text, ast.Constant) and isinstance(text.value, str):
                names = re.search(r"(^|\s)--[a-z]", text.value)
                assert names is None or text in may_name, f"{file}, line {text.lineno}"


def test_a_short_error_is_shown_as_it_is() -> None:
    assert str(FileError("a.csv", "is empty", "choose a take")) == "a.csv: is empty; choose a take"


def test_commands_print_no_terminal_escapes(capsys: pytest.CaptureFixture[str]) -> None:
    say("  name \x1b[2J\n  caf\udce9.csv")
    assert capsys.readouterr().out == "  name ?[2J\n  caf?.csv\n"
