"""`faceedit retime`: a new take that is shorter or longer, with its sound and film in step."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Optional

import typer

from faceedit_app.command_line import json_output
from faceedit_app.command_line.opening import edited_session
from faceedit_app.command_line.options import (
    EditsOption,
    FpsOption,
    JsonOption,
    ModelsOption,
    OverwriteOption,
    TakeArgument,
)
from faceedit_app.core import on_disk
from faceedit_app.core.atomic import check_writable, keep_inputs
from faceedit_app.core.errors import FaceEditError, FileError
from faceedit_app.core.texts import say

if TYPE_CHECKING:
    from faceedit_app.editing.edits.splice import Splice
    from faceedit_app.editing.splicing import Written
    from faceedit_app.words.transcript import Transcript

_NUMBER = r"(\d+(?:\.\d*)?|\.\d+)"
_CUT = re.compile(rf"{_NUMBER}-{_NUMBER}")
_INSERT = re.compile(rf"{_NUMBER}\+{_NUMBER}")


# typer reads annotations at run time, so they stay in the old form.
_OutputOption = Annotated[
    Path, typer.Option("-o", "--output", help="The new take; sound and film go beside it.")
]
_CutOption = Annotated[
    Optional[list[str]],  # noqa: UP045
    typer.Option(metavar="START-END", help="Seconds to cut out, such as 1.2-1.8; repeatable."),
]
_InsertOption = Annotated[
    Optional[list[str]],  # noqa: UP045
    typer.Option(
        metavar="AT+SECONDS",
        help="Seconds to insert, in which the face rests, such as 2.0+0.5; repeatable.",
    ),
]
_WordsOption = Annotated[
    Optional[Path],  # noqa: UP045
    typer.Option(help="Its words (TextGrid or JSON); those of the new take go beside it."),
]
_SoundOption = Annotated[
    Optional[Path],  # noqa: UP045
    typer.Option(help="Its sound; default: what is found beside the take."),
]
_FilmOption = Annotated[
    Optional[Path],  # noqa: UP045
    typer.Option(help="Its film; default: what is found beside the take."),
]
_NoFilmOption = Annotated[bool, typer.Option("--no-film", help="Do not write the film.")]


def retime(
    take: TakeArgument,
    output: _OutputOption,
    cut: _CutOption = None,
    insert: _InsertOption = None,
    words: _WordsOption = None,
    sound: _SoundOption = None,
    film: _FilmOption = None,
    no_film: _NoFilmOption = False,
    edits: EditsOption = None,
    fps: FpsOption = None,
    models: ModelsOption = None,
    overwrite: OverwriteOption = False,
    as_json: JsonOption = False,
) -> None:
    """Cut time out of a take, or insert time; times are those of the take.

    The take, its sound and its film stay as they are, also with --overwrite. About three frames on
    each side of a cut are blended (0.08 s), and before and after inserted time the face comes to
    rest and sets off (0.15 s). All other frames keep their weights. Inserted where the face is
    lost, time has no face.
    """
    from faceedit_app.editing.filming import media_of
    from faceedit_app.editing.splicing import write_spliced
    from faceedit_app.words.files import write_words

    splices = [*_cuts(cut or []), *_inserts(insert or [])]
    if not splices:
        raise FaceEditError("retime needs --cut START-END or --insert AT+SECONDS")
    grid = output.with_suffix(".TextGrid")
    targets = (output, *(output.with_suffix(ending) for ending in (".TextGrid", ".wav", ".mp4")))
    keep_inputs(targets, [take, edits, words, sound, film, models])
    check_writable(output)  # the others go beside it
    said = None if words is None else _timed_words(words, grid, overwrite)
    session = edited_session(take, fps, edits, models, None)
    media = media_of(session.take, sound, film)
    written = write_spliced(
        session.take,
        session.edited_clip(),
        splices,
        output,
        media,
        has_film=not no_film,
        overwrite=overwrite,
        filled=session.filled_rows(),
    )
    if said is not None:
        offset = 0.0 if media.sound is None else media.sound.offset
        new = written.words(said.shifted(offset))
        assert new is not None
        lead = 0.0 if written.sound is None else -written.begin  # words are timed by the sound
        length = lead + written.clip.duration
        json_output.say_kept(grid, write_words(grid, new.shifted(lead), length))
    _report(take, output, written, None if said is None else grid, as_json)


def _timed_words(words: Path, grid: Path, overwrite: bool) -> Transcript:
    """The take's words, if those of the new take can be written to `grid`."""
    from faceedit_app.words.files import read_words

    if on_disk.exists(grid) and not overwrite:
        raise FileError(grid, "exists", "choose another name for the new take")
    said = read_words(words).transcript
    if said is None:
        raise FaceEditError(f"{words}: does not say when each word is said; align them first")
    return said


def _report(take: Path, output: Path, written: Written, words: Path | None, as_json: bool) -> None:
    """Say what was written, with the words beside the take if there are any."""
    from faceedit_app.formats.timing import counted

    clip = written.clip
    json_output.say_kept(output, written.backup, *written.backups)
    if as_json:
        facts = json_output.written_facts(
            output, take, written.form, clip, written.remarks, written.backup
        )
        beside = {"sound": written.sound, "film": written.film, "words": words}
        json_output.say_json(facts | {k: None if p is None else str(p) for k, p in beside.items()})
        return
    names = written.names if words is None else f"{written.names}, {words.name}"
    say(f"{output}: {counted(len(clip), 'frame')}, {clip.duration:.2f} s; wrote {names}")
    for line in written.remarks:
        say(f"  {line}")


def _cuts(given: list[str]) -> list[Splice]:
    from faceedit_app.editing.edits.splice import Splice

    ranges = [_numbers(_CUT, "--cut", one, "START-END, such as 1.2-1.8") for one in given]
    for (start, end), one in zip(ranges, given, strict=True):
        if end <= start:
            how = f"its end is before its start; try {end:g}-{start:g}"
            raise FaceEditError(f"--cut {one}: {how if end < start else 'cuts nothing out'}")
    return [Splice(start, end) for start, end in ranges]


def _inserts(given: list[str]) -> list[Splice]:
    from faceedit_app.editing.edits.splice import Splice

    pairs = [_numbers(_INSERT, "--insert", one, "AT+SECONDS, such as 2.0+0.5") for one in given]
    for (_, seconds), one in zip(pairs, given, strict=True):
        if seconds == 0:
            raise FaceEditError(f"--insert {one}: inserts nothing")
    return [Splice(at, at, seconds) for at, seconds in pairs]


def _numbers(form: re.Pattern[str], name: str, text: str, wanted: str) -> tuple[float, float]:
    found = form.fullmatch(text.strip())
    if found is None:
        raise FaceEditError(f"{name} {text}: must be {wanted}")
    return float(found[1]), float(found[2])
