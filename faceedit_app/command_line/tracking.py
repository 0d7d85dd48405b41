"""`faceedit track` and `faceedit webcam`: from a performance to a take."""

from __future__ import annotations

import json
import math
import sys
import threading
from collections import Counter
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Optional

import typer

from faceedit_app.command_line.json_output import say_kept
from faceedit_app.command_line.options import JsonOption, check_csv
from faceedit_app.core import on_disk
from faceedit_app.core.atomic import check_folder, check_writable, keep_inputs
from faceedit_app.core.errors import FaceEditError, FileError, Unavailable, reason_of
from faceedit_app.media import FILM_ENDINGS

_REPORT = "side_by_side"  # the name of its files

if TYPE_CHECKING:
    from faceedit_app.core.rig import Rig
    from faceedit_app.tracking.film_landmarks import Chosen
    from faceedit_app.tracking.tracker import Tracked


# typer reads annotations at run time, so they stay in the old form.
_FilmArgument = Annotated[Path, typer.Argument(help="A film of a face, or a folder of films.")]
_OutputOption = Annotated[
    Optional[Path],  # noqa: UP045
    typer.Option("-o", "--output", help="The take (Live Link Face CSV), or a folder for them."),
]
_FpsOption = Annotated[
    Optional[float],  # noqa: UP045
    typer.Option("--fps", help="Frames per second of the take; default: the film's."),
]
_FaceOption = Annotated[
    Optional[str],  # noqa: UP045
    typer.Option(
        metavar="X,Y[,SECONDS]",
        help="A place on the face to follow, as shares of width and height, and when it is "
        "there; default: the largest face.",
    ),
]
_ReportOption = Annotated[
    Optional[Path],  # noqa: UP045
    typer.Option(help="Folder for film and face side by side, as picture and MP4."),
]
_EditsOption = Annotated[
    Optional[Path],  # noqa: UP045
    typer.Option(help="With --report: edits (JSON) for a third column, the edited face."),
]


def track(
    film: _FilmArgument,
    output: _OutputOption = None,
    fps: _FpsOption = None,
    face: _FaceOption = None,
    report: _ReportOption = None,
    edits: _EditsOption = None,
    as_json: JsonOption = False,
) -> int:
    """Track the face in a film: write the take that a phone would have recorded.

    Of a folder, a film that cannot be tracked stops nothing; the exit code is then 1.
    """
    from faceedit_app.editing.opening import shipped_rig
    from faceedit_app.formats.opening import checked_rate

    place = None if face is None else _place(face)
    if fps is not None:
        fps = checked_rate(film, fps)
    jobs = _jobs(film, output)
    keep_inputs(_written(jobs[0][1], None), [edits])
    _check_report(report, edits, fps)
    for path in _written(jobs[0][1], None):  # a long film is not tracked in vain
        check_writable(path)
    rig, code, facts = shipped_rig(), 0, []
    for path, take in jobs:
        try:
            keep_inputs(_written(take, None if on_disk.is_folder(film) else report), [path, edits])
            found = _track_one(path, take, rig, fps, place, None if as_json else _Line(path))
        except FileError as error:
            if on_disk.is_file(film):
                raise
            print(f"faceedit: {error.for_command}", file=sys.stderr)
            code = 1
            continue
        facts.append(_facts(found, take, fps))
        if not as_json:
            print(_text(facts[-1]))
        if report is not None:
            folder = (
                report / take.name.removesuffix("_tracked.csv")
                if on_disk.is_folder(film)
                else report
            )
            for written in _report(folder, found, take, rig, edits):
                if not as_json:
                    print(written)
    if as_json:
        print(json.dumps(facts if on_disk.is_folder(film) else facts[0], indent=2))
    return code


def webcam(
    output: Annotated[Path, typer.Argument(help="The new film: an MP4.")],
    name: Annotated[
        str,
        typer.Option("--webcam", help="Part of the webcam's name; default: the system's choice."),
    ] = "",
    seconds: Annotated[
        Optional[float],  # noqa: UP045
        typer.Option(min=0.1, help="Stop after this many seconds; default: at Ctrl+C."),
    ] = None,
    sound: Annotated[bool, typer.Option(help="Record the microphone.")] = True,
) -> None:
    """Record a film from a webcam, to be tracked."""
    from faceedit_app.media.microphone import Microphone
    from faceedit_app.media.webcam import WebcamRecorder, find_webcam

    if output.suffix.lower() != ".mp4":
        raise FileError(output, "does not end in .mp4", "choose a name that does")
    chosen = find_webcam(name)
    started, ended, errors = threading.Event(), threading.Event(), list[FaceEditError]()

    def failed(error: FaceEditError) -> None:
        errors.append(error)
        ended.set()
        started.set()

    microphone = None
    if sound:
        try:
            microphone = Microphone()
        except Unavailable as error:
            print(f"{error}: the film has no sound", file=sys.stderr)
    recorder = WebcamRecorder(chosen, lambda picture: started.set(), failed)
    has_film = False
    try:
        recorder.begin(output, microphone)
        print(f"Recording {chosen.name}; Ctrl+C stops")
        with suppress(KeyboardInterrupt):
            started.wait()  # it may take a second or two
            ended.wait(seconds)
        has_film = recorder.end()
    finally:
        recorder.close()
    if has_film:
        print(f"{output}: {recorder.seconds:.1f} s; faceedit track {output} makes a take of it")
    if errors:
        raise errors[0]
    if not has_film:
        raise FaceEditError(f"{chosen.name} sent no picture")


def _check_report(report: Path | None, edits: Path | None, fps: float | None) -> None:
    """Check what a report needs before a long film is tracked."""
    from faceedit_app.editing.files.edits_file import read_edits

    if edits is not None:
        if report is None:
            raise FaceEditError("--edits shows edits in the report: give --report DIR as well")
        if fps is not None:
            raise FaceEditError("--edits needs the film's own frame rate: leave --fps out")
        read_edits(edits)
    if report is not None:
        check_folder(report)


def _written(take: Path, report: Path | None) -> list[Path]:
    """The files of a take that is tracked, and of its report."""
    from faceedit_app.tracking.landmark_file import files_of

    pages = [] if report is None else [report / f"{_REPORT}{end}" for end in (".mp4", ".png")]
    return [*files_of(take), *pages]


def _jobs(film: Path, output: Path | None) -> list[tuple[Path, Path]]:
    """The films and the takes to write."""

    if not on_disk.exists(film):
        raise FileError(film, "does not exist", "check the name and the folder")
    if not on_disk.is_folder(film):
        take = output or film.with_name(f"{film.stem}_tracked.csv")
        take = take / f"{film.stem}_tracked.csv" if on_disk.is_folder(take) else take
        check_csv(take)
        return [(film, take)]
    films = sorted(path for path in film.iterdir() if path.suffix.lower() in FILM_ENDINGS)
    if not films:
        raise FileError(film, "has no films", f"put {', '.join(FILM_ENDINGS)} files into it")
    if output is not None and output.suffix.lower() == ".csv" and not on_disk.exists(output):
        raise FileError(output, "would be a folder of takes", "give a folder, or a single film")
    folder = output or film
    if output is not None:
        try:
            output.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            reason = reason_of(error)
            raise FileError(output, f"cannot be a folder ({reason})", "choose another") from error
    return [(path, folder / f"{name}_tracked.csv") for path, name in _names(films).items()]


def _names(films: list[Path]) -> dict[Path, str]:
    """What each film's files are called: `me` for me.mp4, but `me.mp4` if there is a me.mov."""
    stems = Counter(path.stem.lower() for path in films)
    return {p: p.stem if stems[p.stem.lower()] == 1 else p.name for p in films}


def _track_one(
    path: Path,
    take: Path,
    rig: Rig,
    fps: float | None,
    place: Chosen | None,
    line: _Line | None,
) -> Tracked:
    from faceedit_app.tracking.landmark_file import write_landmarks
    from faceedit_app.tracking.tracker import track_film, write_take

    tracked = track_film(path, rig, line or (lambda progress: None), face=place)
    if line is not None:
        line.clear()
    backup = write_take(tracked, take, fps)
    say_kept(take, backup, write_landmarks(tracked, take))
    return tracked


def _report(
    folder: Path, tracked: Tracked, take: Path, rig: Rig, edits: Path | None
) -> tuple[Path, Path]:
    from faceedit_app.editing.filming import with_fills
    from faceedit_app.editing.opening import load_engine, open_session
    from faceedit_app.tracking.side_by_side import SideBySide, write_side_by_side

    edited = None
    if edits is not None:
        session = open_session(take, rig, load_engine(rig))
        session.load_edits(edits)
        edited = with_fills(session)
    folder.mkdir(parents=True, exist_ok=True)
    shown = SideBySide.of_tracked(tracked, edited)
    film = folder / f"{_REPORT}.mp4"
    picture, backups = write_side_by_side(film, shown, rig)
    say_kept(film, *backups)
    return picture, film


def _facts(tracked: Tracked, take: Path, fps: float | None) -> dict[str, Any]:
    from faceedit_app.formats.opening import open_take

    _, gone = tracked.take_at(fps)
    clip = open_take(take).clip  # the rate is what the take has wherever it is opened
    return {
        "film": str(tracked.landmarks.path),
        "path": str(take),
        "frames": len(clip),
        "lost": len(gone),
        "rate": round(clip.rate, 6),
        "duration_s": round(clip.duration, 6),
        "confidence": round(float(tracked.confidence[tracked.sure].mean()), 3),
        "notes": list(tracked.notes),
    }


def _text(facts: dict[str, Any]) -> str:
    from faceedit_app.formats.timing import format_rate

    lines = [
        f"{facts['path']}: {facts['frames']} frames at {format_rate(facts['rate'])} "
        f"from {facts['film']}, "
        f"confidence {facts['confidence']:.0%}"
    ]
    return "\n".join([*lines, *(f"  {note}" for note in facts["notes"])])


def _place(text: str) -> Chosen:
    from faceedit_app.tracking.film_landmarks import Chosen

    try:
        x, y, *when = (float(part) for part in text.split(","))
        face = Chosen(x, y, *when)
    except (ValueError, TypeError):
        raise FaceEditError(f"--face {text}: must be X,Y or X,Y,SECONDS, such as 0.3,0.4") from None
    if not (0 <= x <= 1 and 0 <= y <= 1):
        raise FaceEditError(f"--face {text}: X and Y must be from 0 to 1")
    if when and not 0 <= when[0] < math.inf:
        raise FaceEditError(f"--face {text}: SECONDS must be 0 or more")
    return face


class _Line:
    """Shows progress in one line of a terminal."""

    def __init__(self, path: Path) -> None:
        self._path, self._shown = path, ""

    def __call__(self, progress: Any) -> None:
        text = f"{self._path.name}: {progress.pass_}, {progress.done} of {progress.of}"
        if sys.stderr.isatty() and text != self._shown:
            print(f"\r{text.ljust(len(self._shown))}", end="", file=sys.stderr, flush=True)
            self._shown = text

    def clear(self) -> None:
        """Make room for what is printed next."""
        if self._shown:
            print("\r" + " " * len(self._shown), end="\r", file=sys.stderr, flush=True)
            self._shown = ""
