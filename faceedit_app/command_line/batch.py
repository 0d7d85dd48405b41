"""`faceedit batch`: the same for all takes in a folder."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Optional

import typer

from faceedit_app.command_line import json_output
from faceedit_app.command_line.options import (
    CharacterOption,
    FollowHeadOption,
    JsonOption,
    ModelsOption,
    TakeFpsOption,
)
from faceedit_app.command_line.progress import bar
from faceedit_app.core.atomic import said_of
from faceedit_app.core.errors import FaceEditError
from faceedit_app.core.texts import say

if TYPE_CHECKING:
    from faceedit_app.batch.log import Log
    from faceedit_app.batch.tasks import Outcome, Task


# typer reads annotations at run time, so they stay in the old form.
_WhatArgument = Annotated[
    str,
    typer.Argument(
        metavar="WHAT",
        help="Edits (JSON), a preset such as smile, fix:lips,blinks,shaking,gaps, or none.",
    ),
]
_SourceArgument = Annotated[Path, typer.Argument(help="The folder with the takes.")]
_OutputOption = Annotated[Path, typer.Option("-o", "--output", help="The folder for the results.")]
_JobsOption = Annotated[int, typer.Option(min=1, help="How many takes are worked on at once.")]
_FormatOption = Annotated[
    Optional[str],  # noqa: UP045
    typer.Option("--format", help="As for convert; default: as each take came."),
]
_FpsOption = Annotated[
    Optional[float],  # noqa: UP045
    typer.Option("--fps", help="Frames per second to write; needs --format."),
]
_SchedulerOption = Annotated[
    Optional[str],  # noqa: UP045
    typer.Option(help="A Dask scheduler, such as tcp://host:8786, whose workers do the work."),
]


def batch(
    what: _WhatArgument,
    source: _SourceArgument,
    output: _OutputOption,
    jobs: _JobsOption = 1,
    form: _FormatOption = None,
    fps: _FpsOption = None,
    take_fps: TakeFpsOption = None,
    character: CharacterOption = None,
    follow_head: FollowHeadOption = False,
    models: ModelsOption = None,
    scheduler: _SchedulerOption = None,
    as_json: JsonOption = False,
) -> None:
    """Fix, edit or convert all takes in a folder; run it again to go on after a stop.

    Writes faceedit_report.csv and .html beside the results. The exit code is 1 if a take failed;
    files that are no takes are skipped and reported. A result that was removed or changed since is
    made again; a file there that is not as a batch wrote it is kept as NAME.bak.
    With --character, lips and lids also close on that character; --format glb writes the character.
    """
    from faceedit_app.batch.log import Log
    from faceedit_app.batch.recipe import parse_recipe
    from faceedit_app.batch.report import summary, write_reports
    from faceedit_app.batch.tasks import plan
    from faceedit_app.formats.opening import checked_rate

    if fps is not None and form is None:
        raise FaceEditError("--fps needs --format")
    for rate in (fps, take_fps):
        if rate is not None:
            checked_rate(source, rate)
    recipe = replace(
        parse_recipe(what),
        form=form or "",
        rate=fps,
        character=None if character is None else str(character.absolute()),
        fps=take_fps,
        models=None if models is None else str(models.absolute()),
        follows_head=follow_head,
    )
    tasks, others = plan(source, output, recipe)
    outcomes = _worked_on(tasks, source.name, Log(output), jobs, scheduler, quiet=as_json)
    pages = write_reports(output, outcomes, others)
    if as_json:
        json_output.say_json(json_output.batch_facts(output, outcomes, pages, others))
    else:
        for other in others:
            say(f"skipped {other.name}: {other.reason}")
        say(f"{summary(outcomes, others)}; see {pages[1]}")
    if any(outcome.error for outcome in outcomes):
        raise typer.Exit(1)


def _worked_on(
    tasks: list[Task], title: str, log: Log, jobs: int, scheduler: str | None, quiet: bool
) -> list[Outcome]:
    """Work on takes and show progress; the log is closed at the end."""
    from faceedit_app.batch.workers import run

    try:
        with bar(title, len(tasks)) as advance:

            def report(outcome: Outcome, done: int, of: int) -> None:
                advance(done)
                if not quiet:
                    said = outcome.error or f"{outcome.changed} of {outcome.frames} frames changed"
                    if outcome.again:
                        said += f"; made again, because the result {outcome.again}"
                    if outcome.note:
                        said += f"; {outcome.note}"
                    say(f"[{done}/{of}] {outcome.name}: {said}{said_of(outcome.backup)}")

            return run(tasks, log, jobs, scheduler, report)
    except KeyboardInterrupt:
        say("what was written stays; run the same command again to go on", to=sys.stderr)
        raise
    finally:
        log.close()
