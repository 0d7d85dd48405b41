"""`faceedit render`: a picture or a film of a take."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Optional

import typer

from faceedit_app.command_line.json_output import say_kept
from faceedit_app.command_line.opening import edited_session
from faceedit_app.command_line.options import (
    CharacterOption,
    EditsOption,
    FollowHeadOption,
    FpsOption,
    ModelsOption,
    TakeArgument,
)
from faceedit_app.command_line.progress import bar
from faceedit_app.core.atomic import check_folder, check_outputs, keep_inputs
from faceedit_app.core.errors import FaceEditError
from faceedit_app.core.texts import say
from faceedit_app.media import beside

if TYPE_CHECKING:
    from faceedit_app.editing.filming import FilmView, Shot
    from faceedit_app.editing.session import EditSession


# typer reads annotations at run time, so they stay in the old form.
_OutputOption = Annotated[
    Path, typer.Option("-o", "--output", help="A picture (.png), or a film (.mp4, .webm).")
]
_TimeOption = Annotated[
    float, typer.Option(help="For a picture: seconds from the first frame of the take.")
]
_SizeOption = Annotated[str, typer.Option(metavar="WxH", help="Pixels.")]
_ViewOption = Annotated[
    str,
    typer.Option(
        help="For a film: face, both (tracked, edited), film (beside the face), film-above or "
        "film-below."
    ),
]
_FilmFpsOption = Annotated[
    Optional[float],  # noqa: UP045
    typer.Option("--film-fps", help="Pictures per second of the film; default: the take's."),
]
_FormatOption = Annotated[
    Optional[str],  # noqa: UP045
    typer.Option("--format", help="mp4, webm, or png (numbered pictures in a folder)."),
]
_SoundOption = Annotated[
    Optional[Path],  # noqa: UP045
    typer.Option(help="For a film: its sound; default: what is found beside the take."),
]
_FilmOption = Annotated[
    Optional[Path],  # noqa: UP045
    typer.Option(help="The film of the take; default: what is found beside it."),
]
_SilentOption = Annotated[bool, typer.Option("--silent", help="A film without sound.")]


def render(
    take: TakeArgument,
    output: _OutputOption,
    time: _TimeOption = 0.0,
    size: _SizeOption = "800x800",
    view: _ViewOption = "face",
    film_fps: _FilmFpsOption = None,
    form: _FormatOption = None,
    sound: _SoundOption = None,
    film: _FilmOption = None,
    silent: _SilentOption = False,
    edits: EditsOption = None,
    character: CharacterOption = None,
    follow_head: FollowHeadOption = False,
    fps: FpsOption = None,
    models: ModelsOption = None,
) -> None:
    """Draw the face at a time of a take, or film the whole take."""

    heard, seen = beside(take.absolute())
    shot = _shot(output, form, view, size, film_fps, not silent, follow_head)
    _check_output(output, shot, (take, sound or heard, film or seen, edits, character, models))
    session = edited_session(take, fps, edits, models, character)
    duration = session.take.clip.duration
    if not 0 <= time <= duration:
        raise FaceEditError(f"--time {time:g}: {take} lasts from 0 to {duration:.3f} seconds")
    if shot is None:
        _draw(session, output, time, _size(size), follow_head)
    else:
        _film(session, output, shot, sound, film)


def _shot(
    output: Path,
    form: str | None,
    view: str,
    size: str,
    rate: float | None,
    has_sound: bool,
    follows_head: bool,
) -> Shot | None:
    """How to film what the options say, without reading the take; None for a picture.

    Raises:
        FaceEditError: one of the options is wrong.
    """
    if form is None and output.suffix.lower() not in ("", ".png", ".mp4", ".webm"):
        raise FaceEditError(
            f"{output}: must end in .png for a picture, or in .mp4 or .webm for a film"
        )
    pixels = _size(size)
    if form is None and output.suffix.lower() == ".png":
        return None
    from faceedit_app.editing.filming import Shot
    from faceedit_app.formats.opening import checked_rate

    rate = None if rate is None else checked_rate(output, rate)
    return Shot(_view(view), pixels, rate, form, has_sound=has_sound, follows_head=follows_head)


def _check_output(output: Path, shot: Shot | None, read: Iterable[Path | None]) -> None:
    """Check that the picture, the film or the folder of pictures can be written.

    Raises:
        FaceEditError: it cannot, or there is no such format.
    """
    if shot is not None:
        from faceedit_app.media.film_writer import film_format

        if not film_format(output, shot.form).ending:  # pictures in a folder
            keep_inputs([output], read)
            check_folder(output)
            return
    check_outputs([output], read)


def _size(text: str) -> tuple[int, int]:
    try:
        width, height = (int(part) for part in text.lower().split("x"))
    except ValueError:
        raise FaceEditError(f"--size {text}: must be WIDTHxHEIGHT, such as 800x800") from None
    if not (16 <= width <= 4096 and 16 <= height <= 4096):
        raise FaceEditError(f"--size {text}: each side must be 16 to 4096 pixels")
    return width, height


def _view(text: str) -> FilmView:
    from faceedit_app.editing.filming import FilmView

    if text not in list(FilmView):
        raise FaceEditError(f"--view {text}: must be {', '.join(FilmView)}")
    return FilmView(text)


def _draw(
    session: EditSession, output: Path, time: float, size: tuple[int, int], follow_head: bool
) -> None:
    """Draw the edited face at a time of the take, in seconds."""
    from faceedit_app.formats.converting import with_filled
    from faceedit_app.render.snapshot import snapshot, write_png

    take = session.take
    clip = with_filled(session.edited_clip(), take.lost_rows, session.filled_rows())
    row, frame = clip.frame_at(time), take.clip.frame_at(time)
    turns = clip.rotations if follow_head else None
    rotation = None if turns is None else turns[row]
    weights, shown = clip.arkit_weights()[row], session.shown_rig
    say_kept(output, write_png(output, snapshot(shown, weights, *size, rotation=rotation)))
    is_filled = clip.times[row] != take.clip.times[frame]
    what = f"the filled frame at {clip.times[row]:.3f} s" if is_filled else f"frame {frame}"
    say(f"{output}: {what} of {take.path}")


def _film(
    session: EditSession, output: Path, shot: Shot, sound: Path | None, film: Path | None
) -> None:
    """Film a take and show progress; without files for sound and film, with those beside it."""
    from faceedit_app.editing.filming import film_take, media_of, shown_by
    from faceedit_app.formats.timing import format_rate

    media = media_of(session.take, sound, film)
    take, weights, rotations = shown_by(session)
    with bar(output.name) as advance:
        filmed = film_take(
            take,
            weights,
            session.shown_rig,
            media,
            output,
            shot,
            advance,
            rotations=rotations,
        )
    assert filmed is not None  # nothing stops it
    say_kept(output, filmed.backup)
    say(f"{output}: {filmed.frames} pictures at {format_rate(filmed.rate)}, {filmed.codecs}")
    if filmed.size != shot.size:
        say(f"  {filmed.size[0]} x {filmed.size[1]} pixels, because films have even sides")
