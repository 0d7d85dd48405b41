"""All commands of `faceedit`, which use the same code as the window."""

from __future__ import annotations

import sys
from collections.abc import Callable
from functools import cache
from importlib.util import find_spec
from typing import Annotated, Any

import typer

from faceedit_app import __version__
from faceedit_app.command_line import (
    attacks,
    batch,
    character,
    ctrl_c,
    laboratory,
    live,
    pictures,
    retime,
    takes,
    tracking,
    words,
)
from faceedit_app.core.optional import require
from faceedit_app.core.texts import say

USAGE_ERROR = 2
_STOPPED = 130
_Command = Callable[..., object]
COMMANDS: tuple[_Command, ...] = (
    *(takes.info, takes.apply, takes.convert),
    *(pictures.render, batch.batch, words.words, retime.retime),
    *(live.live, live.record, tracking.track, tracking.webcam),
)
LABORATORY: tuple[_Command, ...] = (*laboratory.COMMANDS, *attacks.COMMANDS)


def run_command(given: list[str]) -> int:
    """Run one command; returns its exit code: 2 after one line about wrong usage.

    Raises:
        KeyboardInterrupt: the user pressed Ctrl+C.
    """
    try:
        with ctrl_c.heard():
            code = int(_all()(given, prog_name="faceedit", standalone_mode=False) or 0)
    except typer.TyperException as error:
        say(f"faceedit: {error.format_message()}", to=sys.stderr)
        return USAGE_ERROR
    except typer.Abort:
        code = _STOPPED
    if code == _STOPPED:  # what the library makes of Ctrl+C
        raise KeyboardInterrupt
    return code


def build_app(has_laboratory: bool) -> typer.Typer:
    """All commands; without a laboratory, its commands are hidden and say how to install it."""
    app = typer.Typer(
        help="Edit tracked facial animation by dragging eight plain curves. "
        "`faceedit [TAKE.csv]` opens the window, `faceedit --demo` opens it on a demo take.",
        add_completion=False,
        pretty_exceptions_enable=False,
        no_args_is_help=False,
    )
    app.callback(invoke_without_command=True)(_root)
    for command in COMMANDS:
        app.command()(command)
    app.add_typer(character.app, name="character")
    anything = {"ignore_unknown_options": True, "allow_extra_args": True}
    for command in LABORATORY:
        if has_laboratory:
            app.command()(command)
        else:
            name = command.__name__.replace("_", "-")
            app.command(name, hidden=True, context_settings=anything)(_left_out)
    return app


@cache
def _all() -> Callable[..., Any]:
    """All commands as one, which is built at the first call and kept."""
    return typer.main.get_command(build_app(find_spec("faceedit_app.lab") is not None))


def _root(
    version: Annotated[bool, typer.Option("--version", help="Show the version.")] = False,
) -> None:
    """Edit tracked facial animation by dragging eight plain curves."""
    if version:
        say(f"FaceEdit {__version__}")
        raise typer.Exit


def _left_out() -> None:
    require("faceedit_app.lab", extra="training")
