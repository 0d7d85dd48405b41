"""The commands of `faceedit` that write takes for other programs."""

from __future__ import annotations

import sys
import threading
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Optional

import typer

from faceedit_app import character_commands, json_output
from faceedit_app.core.errors import FaceEditError
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
    TakeFpsOption,
)

if TYPE_CHECKING:
    from rich.progress import Progress

    from faceedit_app.batch import Log, Outcome, Task
    from faceedit_app.editing.session import EditSession
    from faceedit_app.formats.take import Take


def convert(
    take: TakeArgument,
    output: Annotated[Path, typer.Argument(help="The file to write.")],
    form: Annotated[
        Optional[str],  # noqa: UP045  (typer reads the annotation at run time)
        typer.Option(
            "--format",
            help="livelink, csv, audio2face, glb, fbx, usd or usdz; default: by the ending.",
        ),
    ] = None,
    fps: Annotated[
        Optional[float],  # noqa: UP045
        typer.Option("--fps", help="Frames per second to write; default: the take's."),
    ] = None,
    take_fps: TakeFpsOption = None,
    character: CharacterOption = None,
    compact: Annotated[
        bool, typer.Option("--compact", help="For glb: weights in 16 bits, without zeros.")
    ] = False,
    follow_head: FollowHeadOption = False,
    overwrite: OverwriteOption = False,
    as_json: JsonOption = False,
) -> None:
    """Write a take in another format, or at another frame rate.

    glb, fbx, usd and usdz hold a character that plays the take: yours (--character) or FaceEdit's.
    """
    from faceedit_app.editing import exporting
    from faceedit_app.formats.opening import checked_rate
    from faceedit_app.formats.timing import format_rate

    if fps is not None:
        fps = checked_rate(output, fps)
    if form is not None or output.suffix.lower() != take.suffix.lower():
        exporting.choose(output, form)  # before a long take is read
    opened = _opened(take, take_fps, fps)
    keeps_layout = fps is None and character is None
    chosen = exporting.choose(output, form, opened if keeps_layout else None)
    options = exporting.Options(fps, character, compact, overwrite, follow_head)
    written = exporting.export_take(opened, opened.clip, output, chosen, options)
    clip = written.clip
    if as_json:
        facts = json_output.written_facts(
            output, take, chosen.name, clip, written.remarks, written.backup
        )
        json_output.say_json(facts | {"hints": chosen.hints(clip.rate)})
        return
    say(f"{output}: {chosen.name}, {len(clip)} frames at {format_rate(clip.rate)}")
    for line in (*written.remarks, *chosen.hints(clip.rate)):
        say(f"  {line}")


def batch(
    what: Annotated[
        str,
        typer.Argument(
            metavar="WHAT",
            help="Edits (JSON), a preset such as smile, fix:lips,blinks,shaking,gaps, or none.",
        ),
    ],
    source: Annotated[Path, typer.Argument(help="The folder with the takes.")],
    output: Annotated[Path, typer.Option("-o", "--output", help="The folder for the results.")],
    jobs: Annotated[int, typer.Option(min=1, help="How many takes are worked on at once.")] = 1,
    form: Annotated[
        Optional[str],  # noqa: UP045
        typer.Option("--format", help="As for convert; default: as each take came."),
    ] = None,
    fps: Annotated[
        Optional[float],  # noqa: UP045
        typer.Option("--fps", help="Frames per second to write; needs --format."),
    ] = None,
    take_fps: TakeFpsOption = None,
    character: CharacterOption = None,
    follow_head: FollowHeadOption = False,
    models: ModelsOption = None,
    scheduler: Annotated[
        Optional[str],  # noqa: UP045
        typer.Option(help="A Dask scheduler, such as tcp://host:8786, whose workers do the work."),
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Fix, edit or convert all takes in a folder; run it again to go on after a stop.

    Writes faceedit_report.csv and .html beside the results. The exit code is 1 if a take failed.
    With --character, lips and lids also close on that character; --format glb writes the character.
    """
    from faceedit_app import batch as batches
    from faceedit_app import batch_report

    if fps is not None and form is None:
        raise FaceEditError("--fps needs --format")
    recipe = replace(
        batches.parse_recipe(what),
        form=form or "",
        rate=fps,
        character=None if character is None else str(character.absolute()),
        fps=take_fps,
        models=None if models is None else str(models.absolute()),
        follows_head=follow_head,
    )
    tasks = batches.plan(source, output, recipe)
    outcomes = _worked_on(tasks, source.name, batches.Log(output), jobs, scheduler, quiet=as_json)
    pages = batch_report.write_reports(output, outcomes)
    if as_json:
        json_output.say_json(json_output.batch_facts(output, outcomes, pages))
    else:
        say(f"{batch_report.summary(outcomes)}; see {pages[1]}")
    if any(outcome.error for outcome in outcomes):
        raise typer.Exit(1)


def _worked_on(
    tasks: list[Task], title: str, log: Log, jobs: int, scheduler: str | None, quiet: bool
) -> list[Outcome]:
    """Work on takes, and say how far it is; the log is closed."""
    from faceedit_app.batch import run

    try:
        with _progress() as bar:
            shown = bar.add_task(title, total=len(tasks))

            def report(outcome: Outcome, done: int, of: int) -> None:
                bar.update(shown, completed=done)
                if not quiet:
                    said = outcome.error or f"{outcome.changed} of {outcome.frames} frames changed"
                    say(f"[{done}/{of}] {outcome.name}: {said}")

            return run(tasks, log, jobs, scheduler, report)
    finally:
        log.close()


def _progress() -> Progress:
    """A bar on standard error that goes when it is done; none if that is no terminal."""
    from rich.console import Console
    from rich.progress import Progress

    console = Console(stderr=True)
    return Progress(console=console, transient=True, disable=not console.is_terminal)


def edited_session(
    take: Path,
    fps: float | None,
    edits: Path | None,
    models: Path | None,
    character: Path | None = None,
) -> EditSession:
    """Open a take with the edits of a file; the networks are loaded only if there are any."""
    from faceedit_app.editing.opening import load_engine, open_session, shipped_rig

    rig = shipped_rig()
    session = open_session(take, rig, load_engine(rig, models) if edits else None, fps)
    if character is not None:
        session.use_character(character_commands.rig_of(character))
    if edits is not None:
        session.load_edits(edits)
    return session


def _opened(path: Path, take_fps: float | None, fps: float | None) -> Take:
    """Open a take; one without a rate is written frame by frame at the rate to write."""
    from faceedit_app.formats.opening import open_take
    from faceedit_app.formats.timing import RateNeeded

    try:
        return open_take(path, take_fps)
    except RateNeeded:
        if fps is None or take_fps is not None:
            raise
        return open_take(path, fps)


def film(
    session: EditSession,
    output: Path,
    shot: tuple[str, tuple[int, int], float | None, str | None, bool, bool],
    sound: Path | None,
    pictures: Path | None,
) -> None:
    """Film a take, and say how far it is.

    Args:
        shot: view, size, rate, format, whether to add the sound, and whether to turn the head.
        sound, pictures: the take's sound and film; None = those found beside it.
    """
    from faceedit_app.editing.filming import Shot, View, film_take, media_of
    from faceedit_app.formats.timing import format_rate

    view, size, rate, form, has_sound, follows_head = shot
    if view not in list(View):
        raise FaceEditError(f"--view {view}: must be {', '.join(View)}")
    media = media_of(session.take, sound, pictures)
    session.live.work()
    chosen = Shot(View(view), size, rate, form, has_sound=has_sound, follows_head=follows_head)
    with _progress() as bar:
        task = bar.add_task(output.name, total=None)
        filmed = film_take(
            session.take, session.weights, session.shown_rig, media, output, chosen,
            lambda done, of: bar.update(task, completed=done, total=of),
            rotations=session.rotations,
        )  # fmt: skip
    assert filmed is not None  # nothing stops it
    rate = filmed.rate
    say(f"{output}: {filmed.frames} pictures at {format_rate(rate)}, {filmed.codecs}")


def live(
    take: TakeArgument,
    host: Annotated[str, typer.Option(help="Where to send it.")] = "127.0.0.1",
    port: Annotated[
        Optional[int],  # noqa: UP045
        typer.Option(help="The port there; default: the protocol's."),
    ] = None,
    protocol: Annotated[
        str, typer.Option(help="livelink (Unreal) or vmc (VSeeFace, Warudo, Unity).")
    ] = "livelink",
    edits: EditsOption = None,
    loop: Annotated[bool, typer.Option("--loop", help="Begin again at the end.")] = False,
    follow_head: FollowHeadOption = False,
    fps: FpsOption = None,
    models: ModelsOption = None,
) -> None:
    """Play a take into another program, in real time; Ctrl+C stops it."""
    from faceedit_app.editing.streaming import play
    from faceedit_app.live.protocols import Sender, find_protocol

    chosen = find_protocol(protocol, sends=True)
    session = edited_session(take, fps, edits, models)
    session.live.work()
    sender = Sender(chosen, host, chosen.port if port is None else port)
    try:
        say(f"Sending {take.name} as {chosen.name} to {host}:{sender.address[1]}")
        say(f"  {chosen.hints[0]}.")
        play(session, sender, loop, follows_head=follow_head)
    finally:
        sender.close()


def record(
    output: Annotated[Path, typer.Argument(help="The new take: a Live Link Face CSV.")],
    protocol: Annotated[str, typer.Option(help="livelink, vmc or ifacialmocap.")] = "livelink",
    host: Annotated[str, typer.Option(help="The address to listen on.")] = "0.0.0.0",
    port: Annotated[
        Optional[int],  # noqa: UP045
        typer.Option(help="The port to listen on; default: the protocol's."),
    ] = None,
    phone: Annotated[
        str, typer.Option(help="For ifacialmocap: the phone's address, which the app shows.")
    ] = "",
    seconds: Annotated[
        Optional[float],  # noqa: UP045
        typer.Option(help="Stop after this many seconds; default: at Ctrl+C."),
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Record a take from a phone, or from another program."""
    from faceedit_app.editing.recording import Recorder
    from faceedit_app.formats.opening import open_take
    from faceedit_app.formats.summary import summarize
    from faceedit_app.live.protocols import find_protocol, own_address

    chosen = find_protocol(protocol)
    recorder = Recorder(output, chosen, host, port, phone)
    try:
        address = own_address() if host == "0.0.0.0" else host
        where = f"Listening for {chosen.name} on {address}:{recorder.address[1]}; Ctrl+C stops"
        for line in (where, f"  {chosen.hints[1]}."):
            say(line, to=sys.stderr if as_json else sys.stdout)
        wait_for_end(seconds)
    finally:
        has_frames = recorder.stop()
    if recorder.error is not None:
        raise recorder.error
    if not has_frames:
        raise FaceEditError(
            f"Nothing was received ({recorder.ignored} packets were not understood)"
        )
    if as_json:
        facts = summarize(open_take(output))
        json_output.say_json(facts | {"packets_ignored": recorder.ignored})
        return
    say(f"{output}: {recorder.frames} frames, {recorder.seconds:.2f} s")


def wait_for_end(seconds: float | None) -> None:
    """Wait so long, or until Ctrl+C."""
    with suppress(KeyboardInterrupt):
        threading.Event().wait(seconds)
