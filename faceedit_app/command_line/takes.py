"""`faceedit info`, `apply` and `convert`: look at a take, edit it, write it in another format."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Optional

import typer

from faceedit_app.command_line import json_output
from faceedit_app.command_line.opening import rig_of
from faceedit_app.command_line.options import (
    CharacterOption,
    FollowHeadOption,
    FpsOption,
    JsonOption,
    ModelsOption,
    OverwriteOption,
    TakeArgument,
    TakeFpsOption,
)
from faceedit_app.core import on_disk
from faceedit_app.core.atomic import check_outputs
from faceedit_app.core.errors import FaceEditError
from faceedit_app.core.texts import say
from faceedit_app.media import FILM_ENDINGS

if TYPE_CHECKING:
    from faceedit_app.editing.edits.settings import Settings
    from faceedit_app.editing.exporting import OutFormat
    from faceedit_app.editing.session import EditSession
    from faceedit_app.formats.take import Take
    from faceedit_app.networks.engine import Engine


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
    from faceedit_app.editing.opening import load_engine, open_session, shipped_rig
    from faceedit_app.formats.timing import counted

    settings = _settings(mode, naturalness, reach)
    _check_edits(edits)
    if output.suffix.lower() in FILM_ENDINGS:
        raise FaceEditError(f"{output}: is the name of a film; use faceedit render for one")
    check_outputs([output], [edits, character, models])
    rig = shipped_rig()
    engine = load_engine(rig, models)
    session = open_session(take, rig, engine, fps)
    session.configure(settings)
    if character:
        session.use_character(rig_of(character))
    session.load_edits(edits)
    warnings = _warnings(session, engine)
    for text in warnings:
        say(f"faceedit: warning: {text}", to=sys.stderr)
    written, changed = _export(session, output, character, follow_head, overwrite)
    remarks = written.pop("notes")
    if as_json:
        notes = [*warnings, *remarks]
        counts = {"edits": len(session.edits), "changed_frames": changed}
        json_output.say_json(written | {"notes": notes} | counts)
        return
    say(
        f"{output}: {counted(len(session.edits), 'edit')}, "
        f"{changed} of {written['frames']} frames changed"
    )
    for text in remarks:
        say(f"  {text}")


def _check_edits(path: Path) -> None:
    """Refuse the name of a preset, which is no file."""
    from faceedit_app.editing.help.presets import load_presets

    if on_disk.exists(path):
        return
    if str(path).lower() in {name.lower() for p in load_presets()[0] for name in (p.id, p.name)}:
        raise FaceEditError(
            f"{path}: is a preset, not a file of edits; faceedit batch {path} FOLDER -o RESULTS "
            "applies it to the takes in a folder"
        )


def _settings(mode: str, naturalness: float, reach: float) -> Settings:
    from faceedit_app.editing.edits.settings import Mode, Settings

    if mode not in list(Mode):
        raise FaceEditError(f"--mode {mode}: must be {' or '.join(Mode)}")
    for name, value in (("naturalness", naturalness), ("reach", reach)):
        if not 0 <= value <= 1:
            raise FaceEditError(f"--{name} {value:g}: must be from 0 to 1")
    return Settings(Mode(mode), naturalness, reach)


def _export(
    session: EditSession, output: Path, character: Path | None, follow_head: bool, overwrite: bool
) -> tuple[dict[str, Any], int]:
    """Write the edited take as it came, or in the format of the ending.

    Returns:
        Facts about the file, and how many frames in it are changed.
    """
    from faceedit_app.editing import exporting
    from faceedit_app.formats.converting import with_filled

    take = session.take
    form = exporting.by_ending(output, take)
    if form is None:
        backup = session.export(output, overwrite)
        json_output.say_kept(output, backup)
        notes = (take.rate_note,) if take.rate_note else ()
        clip = with_filled(take.clip, take.lost_rows, session.filled_rows())
        facts = json_output.written_facts(output, take.path, take.format, clip, notes, backup)
        return facts, exporting.changed_frames(session, output)
    options = exporting.Options(character=character, overwrite=overwrite, follows_head=follow_head)
    done = exporting.export_session(session, output, form, options)
    json_output.say_kept(output, done.backup)
    facts = json_output.written_facts(
        output, take.path, form.name, done.clip, done.said("--follow-head"), done.backup
    )
    return facts, session.changed_frames()


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

    check_outputs([output], [character])
    if fps is not None:
        fps = checked_rate(output, fps)
    if form is not None or output.suffix.lower() != take.suffix.lower():
        exporting.choose(output, form)  # before a long take is read
    opened = _opened(take, take_fps, fps)
    chosen = exporting.choose(output, form, opened, fps, character is not None)
    _check_used(chosen, character, compact, follow_head)
    options = exporting.Options(fps, character, compact, overwrite, follow_head)
    written = exporting.export_take(opened, opened.clip, output, chosen, options)
    json_output.say_kept(output, written.backup)
    clip, remarks = written.clip, written.said("--follow-head")
    if as_json:
        facts = json_output.written_facts(output, take, chosen.name, clip, remarks, written.backup)
        json_output.say_json(facts | {"hints": chosen.hints(clip.rate)})
        return
    say(f"{output}: {chosen.name}, {len(clip)} frames at {format_rate(clip.rate)}")
    for line in (*remarks, *chosen.hints(clip.rate)):
        say(f"  {line}")


def _check_used(form: OutFormat, character: Path | None, compact: bool, follow_head: bool) -> None:
    """Refuse options that would do nothing in a format."""
    for name, is_given, is_used in (
        ("--character", character is not None, form.has_character),
        ("--follow-head", follow_head, form.has_character),
        ("--compact", compact, form.is_compact),
    ):
        if is_given and not is_used:
            others = "glb" if name == "--compact" else "glb, fbx, usd and usdz"
            where = f"the format {form.name}"
            raise FaceEditError(f"{name} does nothing in {where}: it is for {others}")


def _warnings(session: EditSession, engine: Engine) -> list[str]:
    """Which edits change nothing: they lie outside the take, or its channels cannot answer."""
    from faceedit_app.editing.solving.answerable import unanswerable
    from faceedit_app.editing.solving.channel_edits import missing_channels

    found, duration = [], session.take.clip.duration
    for number, edit in enumerate(session.edits, start=1):
        if edit.span[0] > duration:
            found.append(f"edit {number}: begins at {edit.span[0]:.3f} s, after the take's end")
        if edit.span[1] < 0:
            found.append(f"edit {number}: ends at {edit.span[1]:.3f} s, before the take begins")
        lacks = unanswerable(edit, session.take, session.rig, engine)
        found += [f"edit {number}: {lack}" for lack in lacks]
        if missing := missing_channels([edit], session.take.clip):
            found.append(f"edit {number}: {missing}")
    return found


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
