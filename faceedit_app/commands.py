"""The commands of `faceedit`, which use the same code as the window.

Commands import what needs numpy themselves, so that `--help` and `--version` answer at once.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Optional

import typer

from faceedit_app import (
    __version__,
    character_commands,
    export_commands,
    json_output,
    retime_commands,
    tracking_commands,
    word_commands,
)
from faceedit_app.core.errors import FaceEditError
from faceedit_app.core.optional import require
from faceedit_app.core.texts import say
from faceedit_app.options import (
    CharacterOption,
    EditsOption,
    FollowHeadOption,
    FpsOption,
    JsonOption,
    ModelsOption,
    OverwriteOption,
    TakeArgument,
)

if TYPE_CHECKING:
    from faceedit_app.editing.session import EditSession
    from faceedit_app.networks.engine import Engine

USAGE_ERROR = 2
# The laboratory's commands, named here because the installed application leaves it out.
LABORATORY = (
    *("bench", "train", "evaluate", "evaluate-character", "evaluate-words", "evaluate-tracking"),
    *("experiment", "synthesize", "statistics"),
    *("fuzz", "soak", "kill"),
)

app = typer.Typer(
    help="Edit tracked facial animation by dragging eight plain curves. "
    "`faceedit [TAKE.csv]` opens the window, `faceedit --demo` opens it on a demo take.",
    add_completion=False,
    pretty_exceptions_enable=False,
    no_args_is_help=False,
)

app.add_typer(character_commands.app, name="character")
app.command("words")(word_commands.words)
app.command("retime")(retime_commands.retime)
app.command()(export_commands.convert)
app.command()(export_commands.batch)
app.command()(export_commands.live)
app.command()(export_commands.record)
app.command("track")(tracking_commands.track)
app.command("webcam")(tracking_commands.webcam)


def run_command(given: list[str]) -> int:
    """Run one command; returns its exit code: 2 after one line about wrong usage."""
    try:
        return int(_command()(given, prog_name="faceedit", standalone_mode=False) or 0)
    except typer.TyperException as error:
        say(f"faceedit: {error.format_message()}", to=sys.stderr)
        return USAGE_ERROR
    except typer.Abort:
        return 130


@app.callback(invoke_without_command=True)
def root(
    version: Annotated[bool, typer.Option("--version", help="Show the version.")] = False,
) -> None:
    """Edit tracked facial animation by dragging eight plain curves."""
    if version:
        say(f"FaceEdit {__version__}")
        raise typer.Exit


@app.command()
def info(
    take: TakeArgument,
    fps: FpsOption = None,
    as_json: JsonOption = False,
) -> None:
    """Show a take's frames, rate, duration, channels, gaps and format."""
    from faceedit_app.formats.opening import open_take
    from faceedit_app.formats.summary import summarize, summary_text

    summary = summarize(open_take(take, fps))
    say(json.dumps(summary, indent=2) if as_json else summary_text(summary))


@app.command()
def apply(
    take: TakeArgument,
    edits: Annotated[Path, typer.Argument(help="Edits (JSON) as the window saves them.")],
    output: Annotated[Path, typer.Option("-o", "--output", help="The edited take.")],
    mode: Annotated[
        str, typer.Option(help="preserve: change the take; resynthesize: generate it again.")
    ] = "preserve",
    naturalness: Annotated[float, typer.Option(help="0: most exact, 1: most believable.")] = 1.0,
    reach: Annotated[
        float, typer.Option(help="0: as the networks answer, 1: all the way to what was asked for.")
    ] = 1.0,
    character: CharacterOption = None,
    fps: FpsOption = None,
    models: ModelsOption = None,
    follow_head: FollowHeadOption = False,
    overwrite: OverwriteOption = False,
    as_json: JsonOption = False,
) -> None:
    """Apply edits to a take and export it as it came, or in the format of the output's ending.

    With --character, lips and lids also close on that character where edits close them.
    """
    from faceedit_app.editing import exporting
    from faceedit_app.editing.edits.settings import Mode, Settings
    from faceedit_app.editing.opening import load_engine, open_session, shipped_rig
    from faceedit_app.formats.timing import counted

    if mode not in list(Mode):
        raise FaceEditError(f"--mode {mode}: must be {' or '.join(Mode)}")
    for name, value in (("naturalness", naturalness), ("reach", reach)):
        if not 0 <= value <= 1:
            raise FaceEditError(f"--{name} {value:g}: must be from 0 to 1")
    rig = shipped_rig()
    engine = load_engine(rig, models)
    session = open_session(take, rig, engine, fps)
    session.configure(Settings(Mode(mode), naturalness, reach))
    if character:
        session.use_character(character_commands.rig_of(character))
    session.load_edits(edits)
    warnings = _warnings(session, engine)
    for text in warnings:
        say(f"faceedit: warning: {text}", to=sys.stderr)
    form = exporting.by_ending(output, session.take)
    if form is None:
        clip, name, remarks = session.take.clip, session.take.format, tuple[str, ...]()
        backup = session.export(output, overwrite)
    else:
        options = exporting.Options(
            character=character, overwrite=overwrite, follows_head=follow_head
        )
        done = exporting.export_session(session, output, form, options)
        clip, name, remarks, backup = done.clip, form.name, done.remarks, done.backup
    if as_json:
        notes = (*warnings, *remarks)
        facts = json_output.written_facts(output, take, name, clip, notes, backup)
        changed = session.changed_frames()
        json_output.say_json(facts | {"edits": len(session.edits), "changed_frames": changed})
        return
    say(
        f"{output}: {counted(len(session.edits), 'edit')}, "
        f"{session.changed_frames()} of {len(session.take.clip)} frames changed"
    )


@app.command()
def render(
    take: TakeArgument,
    output: Annotated[
        Path,
        typer.Option("-o", "--output", help="A picture (.png), or a film (.mp4, .webm)."),
    ],
    time: Annotated[float, typer.Option(help="For a picture: seconds from the first frame.")] = 0.0,
    size: Annotated[str, typer.Option(metavar="WxH", help="Pixels.")] = "800x800",
    view: Annotated[
        str,
        typer.Option(
            help="For a film: face, both (tracked, edited), film (beside the face), film-above or "
            "film-below."
        ),
    ] = "face",
    film_fps: Annotated[
        Optional[float],  # noqa: UP045
        typer.Option("--film-fps", help="Pictures per second of the film; default: the take's."),
    ] = None,
    form: Annotated[
        Optional[str],  # noqa: UP045
        typer.Option("--format", help="mp4, webm, or png (numbered pictures in a folder)."),
    ] = None,
    sound: Annotated[
        Optional[Path],  # noqa: UP045
        typer.Option(help="For a film: its sound; default: what is found beside the take."),
    ] = None,
    film: Annotated[
        Optional[Path],  # noqa: UP045
        typer.Option(help="The film of the take; default: what is found beside it."),
    ] = None,
    silent: Annotated[bool, typer.Option("--silent", help="A film without sound.")] = False,
    edits: EditsOption = None,
    character: CharacterOption = None,
    follow_head: FollowHeadOption = False,
    fps: FpsOption = None,
    models: ModelsOption = None,
) -> None:
    """Draw the face at a time of a take, or film the whole take."""
    from faceedit_app.formats.opening import checked_rate
    from faceedit_app.render.snapshot import snapshot, write_png

    width, height = _size(size)
    if form is None and output.suffix.lower() not in ("", ".png", ".mp4", ".webm"):
        raise FaceEditError(
            f"{output}: must end in .png for a picture, or in .mp4 or .webm for a film"
        )
    session = export_commands.edited_session(take, fps, edits, models, character)
    duration = session.take.clip.duration
    if not 0 <= time <= duration:
        raise FaceEditError(f"--time {time:g}: {take} lasts from 0 to {duration:.3f} seconds")
    if form is not None or output.suffix.lower() != ".png":
        if film_fps is not None:
            film_fps = checked_rate(output, film_fps)
        shot = (view, (width, height), film_fps, form, not silent, follow_head)
        export_commands.film(session, output, shot, sound, film)
        return
    frame = session.take.clip.frame_at(time)
    turns = session.rotations if follow_head else None
    rotation = None if turns is None else turns[frame]
    weights, shown = session.weights[frame], session.shown_rig
    write_png(output, snapshot(shown, weights, width, height, rotation=rotation))
    say(f"{output}: frame {frame} of {take}")


def _warnings(session: EditSession, engine: Engine) -> list[str]:
    """Which edits the take's channels cannot answer, so that they change nothing."""
    from faceedit_app.editing.solving.answerable import unanswerable
    from faceedit_app.editing.solving.channel_edits import missing_channels

    found = []
    for number, edit in enumerate(session.edits, start=1):
        lacks = unanswerable(edit, session.take, session.rig, engine)
        found += [f"edit {number}: {lack}" for lack in lacks]
        if missing := missing_channels([edit], session.take.clip):
            found.append(f"edit {number}: {missing}")
    return found


def _size(text: str) -> tuple[int, int]:
    try:
        width, height = (int(part) for part in text.lower().split("x"))
    except ValueError:
        raise FaceEditError(f"--size {text}: must be WIDTHxHEIGHT, such as 800x800") from None
    if not (16 <= width <= 4096 and 16 <= height <= 4096):
        raise FaceEditError(f"--size {text}: each side must be 16 to 4096 pixels")
    return width, height


@cache
def _command() -> Callable[..., Any]:
    """All commands as one, which is built at the first call and kept."""
    _add_laboratory()
    return typer.main.get_command(app)


def _add_laboratory() -> None:
    if find_spec("faceedit_app.lab") is None:
        anything = {"ignore_unknown_options": True, "allow_extra_args": True}
        for name in LABORATORY:
            app.command(name, hidden=True, context_settings=anything)(_left_out)
        return
    from faceedit_app.lab import commands

    for name in LABORATORY:
        app.command(name)(getattr(commands, name.replace("-", "_")))


def _left_out() -> None:
    require("faceedit_app.lab", extra="training")
