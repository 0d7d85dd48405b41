"""`faceedit words`: when each word of a take was said, and lips that close on m, b and p."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Optional

import typer

from faceedit_app.command_line.json_output import say_kept
from faceedit_app.command_line.opening import rig_of
from faceedit_app.command_line.options import (
    CharacterOption,
    FpsOption,
    JsonOption,
    ModelsOption,
    OverwriteOption,
)
from faceedit_app.core.atomic import check_outputs, keep_inputs
from faceedit_app.core.errors import FaceEditError, FileError
from faceedit_app.core.texts import say
from faceedit_app.media import beside, is_media

if TYPE_CHECKING:
    from faceedit_app.editing.help.dubbing import DubMatch
    from faceedit_app.editing.help.spoken import Closure
    from faceedit_app.editing.session import EditSession
    from faceedit_app.media.sound import Sound
    from faceedit_app.words.imported import Imported
    from faceedit_app.words.transcript import Transcript

_NOISY = "the sound is noisy ({:.0f} dB above the noise): check the times of the words"


# typer reads annotations at run time, so they stay in the old form.
_SourceArgument = Annotated[
    Path,
    typer.Argument(metavar="TAKE|SOUND", help="A take with its sound beside it, or a sound."),
]
_TextOption = Annotated[Optional[str], typer.Option(help="What is said.")]  # noqa: UP045
_WordsOption = Annotated[
    Optional[Path],  # noqa: UP045
    typer.Option("--words", help="What is said: TextGrid, SRT, VTT, JSON or TXT."),
]
_SoundsLikeOption = Annotated[
    Optional[list[str]],  # noqa: UP045
    typer.Option(help="WORD=SPELLING, for a word not in the dictionary; repeatable."),
]
_SaveOption = Annotated[
    Optional[Path],  # noqa: UP045
    typer.Option(help="Write the words to this file: TextGrid, SRT or JSON."),
]
_FixOption = Annotated[
    bool, typer.Option("--fix", help="Close the lips at each m, b and p that stays open.")
]
_RetimeToOption = Annotated[
    Optional[Path],  # noqa: UP045
    typer.Option(
        metavar="SOUND|FILE",
        help="Retime the take to another sound, or to a file with the times of its words.",
    ),
]
_TheirTextOption = Annotated[
    Optional[str],  # noqa: UP045
    typer.Option(help="With --retime-to SOUND: what it says, if it is not the same."),
]
_TheirStartOption = Annotated[
    Optional[float],  # noqa: UP045
    typer.Option(
        help="With --retime-to: when the other sound begins, in seconds of the take; "
        "default: where the words are nearest to each other."
    ),
]
_OutputOption = Annotated[
    Optional[Path],  # noqa: UP045
    typer.Option("-o", "--output", help="With --fix or --retime-to: the edited take."),
]


def words(
    source: _SourceArgument,
    text: _TextOption = None,
    file: _WordsOption = None,
    sounds_like: _SoundsLikeOption = None,
    save: _SaveOption = None,
    as_json: JsonOption = False,
    fix: _FixOption = False,
    retime_to: _RetimeToOption = None,
    their_text: _TheirTextOption = None,
    their_start: _TheirStartOption = None,
    output: _OutputOption = None,
    character: CharacterOption = None,
    fps: FpsOption = None,
    models: ModelsOption = None,
    overwrite: OverwriteOption = False,
) -> None:
    """Find when each word was said, and whether the lips close on m, b and p.

    With --retime-to, the take says its words when another sound does. With --character, the lips
    are measured, and close, on that character.
    """
    from faceedit_app.words.aligning import TextLine
    from faceedit_app.words.files import as_tables, read_words, write_words
    from faceedit_app.words.imported import Imported

    _check_said(text, file)
    _check_written(output, fix, retime_to)
    _check_theirs(retime_to, their_text, their_start)
    check_outputs([save, output], _read(source, file, retime_to, character, models))
    _check_kinds(source, save, output, overwrite)
    said = read_words(file) if file is not None else Imported((TextLine(text or ""),))
    spellings = _spellings(sounds_like or [])
    more: dict[str, Any] = {"closures": []}
    if is_media(source):
        transcript, seconds = _words_of_sound(source, said, spellings)
        offset = 0.0
    else:
        session, transcript, offset, seconds = _words_of_take(source, said, spellings, fps)
        if character is not None:
            session.use_character(rig_of(character))
        if retime_to is not None:
            found, end = _match(session, transcript, retime_to, their_text, spellings, their_start)
            transcript, more["retime"] = found.words, _matched(found)
            if end is not None:  # from now on, the take has the other sound
                offset, seconds = found.offset, end
        more["closures"] = _closures(session, fix, output, models, overwrite)
        more |= {} if output is None else {"path": str(output)}
    _warn_of_noise(transcript)
    if save is not None:
        say_kept(save, write_words(save, transcript.shifted(-offset), seconds))
    report = {**as_tables(transcript), **more}
    report |= {"noise_db": transcript.noise, "sound_start": offset}
    say(json.dumps(report, indent=2) if as_json else _text(report))


def _read(source: Path, *others: Path | None) -> tuple[Path | None, ...]:
    """The files that are read besides a take: also the sound and the film beside it."""

    return others if is_media(source) else (*others, *beside(source.absolute()))


def _warn_of_noise(transcript: Transcript) -> None:
    from faceedit_app.words.aligning import NOISY

    if transcript.noise is not None and transcript.noise < NOISY:
        say(f"faceedit: warning: {_NOISY.format(transcript.noise)}", to=sys.stderr)


def _check_said(text: str | None, file: Path | None) -> None:
    from faceedit_app.words.files import READ_ENDINGS

    if text is None and file is None:
        raise FaceEditError("words needs what is said: --text TEXT, or --words FILE")
    if text is not None and file is not None:
        raise FaceEditError("--text and --words both give what is said: leave one of them out")
    if text is not None and not text.strip():
        raise FaceEditError("--text is empty: give the words that are said")
    if len((text or "").split()) == 1 and Path(text or "").suffix.lower() in READ_ENDINGS:
        raise FaceEditError(f"--text {text}: is the name of a file; give it as --words {text}")


def _check_written(output: Path | None, fix: bool, retime_to: Path | None) -> None:
    changes = fix or retime_to is not None
    if output is not None and not changes:
        raise FaceEditError(
            "-o writes the edited take: add --fix or --retime-to, or write the words with --save"
        )
    if output is None and changes:
        raise FaceEditError("--fix and --retime-to change the take: say with -o where to write it")


def _check_kinds(source: Path, save: Path | None, output: Path | None, overwrite: bool) -> None:
    """Check that what is written is no recording, and has an ending for words."""
    from faceedit_app.editing.files.originals import is_replaced
    from faceedit_app.words.files import writer_for

    keep_inputs([save], [source])
    if save is not None:
        writer_for(save)
    if output is not None:
        if is_media(source):
            raise FaceEditError(f"{source}: is a sound; --fix and --retime-to need a take")
        is_replaced(output, source, overwrite)


def _check_theirs(retime_to: Path | None, text: str | None, start: float | None) -> None:
    if retime_to is None and (text is not None or start is not None):
        raise FaceEditError("--their-text and --their-start belong to --retime-to")


def _spellings(given: list[str]) -> dict[str, str]:
    pairs = [one.partition("=") for one in given]
    for (word, _, spelling), one in zip(pairs, given, strict=True):
        if not word.strip() or not spelling.strip():
            raise FaceEditError(f"--sounds-like {one}: must be WORD=SPELLING, such as 2=two")
    return {word.strip().lower(): spelling.strip() for word, _, spelling in pairs}


def _words_of_sound(
    path: Path, said: Imported, spellings: dict[str, str]
) -> tuple[Transcript, float]:
    from faceedit_app.media.sound import read_sound

    if said.transcript is not None:
        return said.transcript, said.transcript.words[-1].end
    sound = read_sound(path)
    if sound is None:
        raise FileError(path, "has no sound", "choose another file")
    return _aligned(sound, said, spellings, (sound.start, sound.end)), sound.end


def _words_of_take(
    path: Path, said: Imported, spellings: dict[str, str], fps: float | None
) -> tuple[EditSession, Transcript, float, float]:
    """A session with its words, and when its sound begins, in the take, and ends, in its file.

    A take without a sound is its own: times in files of words count from its beginning.
    """
    from faceedit_app.editing.opening import open_session, open_sound
    from faceedit_app.words.imported import spread

    session = open_session(path, fps=fps)
    duration = session.take.clip.duration
    found = open_sound(session.take)
    sound, offset = found or (None, 0.0)
    if said.transcript is not None:
        transcript = said.transcript.shifted(offset)
    elif sound is not None:
        span = (max(sound.start, -offset), min(sound.end, duration - offset))
        transcript = _aligned(sound, said, spellings, span).shifted(offset)
    elif all(line.end is not None for line in said.lines):
        transcript = spread(said.lines, duration)
    else:
        raise FileError(path, "has no sound beside it", "add one of the same name, such as a WAV")
    session.say(transcript)
    return session, transcript, offset, duration if sound is None else sound.end


def _aligned(
    sound: Sound, said: Imported, spellings: dict[str, str], span: tuple[float, float]
) -> Transcript:
    """Words in seconds of the sound's file, looked for in a range of it."""
    from faceedit_app.words.aligning import align_part

    try:
        return align_part(sound.samples, sound.rate, sound.start, span, said.lines, spellings)
    except FileError:
        raise
    except FaceEditError as error:
        raise FaceEditError(f"{sound.path}: {error.for_command}") from error


def _match(
    session: EditSession,
    ours: Transcript,
    path: Path,
    text: str | None,
    spellings: dict[str, str],
    start: float | None,
) -> tuple[DubMatch, float | None]:
    """Retime a take to another sound, which ends at a second, or to a file with its words."""
    from faceedit_app.editing.help.dubbing import keep, match
    from faceedit_app.words.aligning import TextLine
    from faceedit_app.words.files import read_words
    from faceedit_app.words.imported import Imported, spread

    end: float | None = None
    if is_media(path):
        said = Imported((TextLine(ours.text if text is None else text),))
        theirs, end = _words_of_sound(path, said, spellings)
    else:
        said = read_words(path)
        if said.transcript is None and any(line.end is None for line in said.lines):
            raise FileError(path, "does not say when its words are said", "give the sound instead")
        theirs = said.transcript or spread(said.lines, 0.0)
    try:
        found = match(session.take.clip, ours, theirs, start)
    except FaceEditError as error:
        raise FaceEditError(f"{path}: {error}") from error
    keep(session, found)
    return found, end


def _matched(found: DubMatch) -> dict[str, Any]:
    return {
        "matched": found.matched,
        "phonemes": found.total,
        "unmatched": list(found.unmatched),
        "their_start": found.offset,
        "limited": [list(stretch) for stretch in found.limited],
        "message": found.message,
    }


def _closures(
    session: EditSession, fix: bool, output: Path | None, models: Path | None, overwrite: bool
) -> list[dict[str, Any]]:
    """Each m, b and p; the take is written to an output, with those that were open closed."""
    from faceedit_app.editing.help.spoken import closing_edits, closures_of
    from faceedit_app.editing.opening import load_engine

    before = after = closures_of(session)
    if output is not None:
        session.use_engine(load_engine(session.rig, models))
        if fix:
            session.add(*closing_edits(session), name="Close lips")
        say_kept(output, session.export(output, overwrite))
        if note := session.take.rate_note:
            say(f"{output}: {note}", to=sys.stderr)
        after = closures_of(session)
    return [_entry(*pair) for pair in zip(before, after, strict=True)]


def _entry(before: Closure, after: Closure) -> dict[str, Any]:
    return {
        "phoneme": before.phoneme.symbol,
        "word": before.word.text,
        "time": round(before.time, 3),
        "gap_mm": round(before.gap, 2),
        "gap_after_mm": round(after.gap, 2),
        "fixed": before.is_open and not after.is_open,
    }


def _text(report: dict[str, Any]) -> str:
    from faceedit_app.formats.timing import counted

    lines = [f"{w['start']:8.2f} {w['end']:8.2f}  {w['text']}" for w in report["words"]]
    if "retime" in report:
        lines.append(report["retime"]["message"])
    closures = report["closures"]
    if closures:
        lines.append(f"{len(closures)} times lips should meet (m, b, p):")
    for closure in closures:
        what = f"{closure['phoneme'].lower()} of {closure['word']}"
        state = "fixed" if closure["fixed"] else f"{closure['gap_after_mm']:.1f} mm apart"
        lines.append(f"{closure['time']:8.2f}  {what}: {state}")
    if "path" in report:
        closed = counted(sum(closure["fixed"] for closure in closures), "closure")
        lines.append(f"{report['path']}: the edited take, {closed} fixed")
    return "\n".join(lines)
