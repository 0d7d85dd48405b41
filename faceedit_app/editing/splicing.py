"""Write a take with time cut out or inserted as a new take, with its sound and film in step.

Sound and film have to be cut as well, and their files are never changed. So this is no edit, but a
copy of the take as it is shown, beside which the cut sound and film lie under its name.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from itertools import chain, count
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from faceedit_app.core import on_disk
from faceedit_app.core.arrays import Floats, Samples
from faceedit_app.core.atomic import keep_backup, keep_inputs, write_atomically
from faceedit_app.core.clip import Clip, nearest_rows
from faceedit_app.core.errors import FileError, Unavailable
from faceedit_app.editing.edits.media import MediaFile, Placement
from faceedit_app.editing.edits.splice import Splice, Spliced, splice
from faceedit_app.editing.exporting import Options, OutFormat, choose, export_take, own_format
from faceedit_app.formats.converting import Like, with_filled
from faceedit_app.formats.csv_style import has_style
from faceedit_app.formats.faceless import Faceless
from faceedit_app.formats.registry import Format
from faceedit_app.formats.take import Take
from faceedit_app.media import beside
from faceedit_app.media.container import Abandoned
from faceedit_app.media.film import Film
from faceedit_app.media.film_writer import Soundtrack, film_format, writing
from faceedit_app.media.sound import Sound, read_sound, wav

if TYPE_CHECKING:
    from faceedit_app.words.transcript import Transcript

_FADE = 0.005  # seconds in which the sound fades at a joint, so that it does not click


@dataclass(frozen=True)
class Written:
    """A new take.

    Attributes:
        path: its file.
        clip: what is in it.
        sound, film: the files beside it, if the take had them.
        begin: when these begin, seconds of the take: with its first row, which may have no face.
        spliced: how its time relates to the old take's.
        remarks: sentences about what it does not hold.
        form: the name of its format.
        backup: the copy of the recording that it replaced, if it did.
        backups: the copies of the sound and the film that were replaced.
    """

    path: Path
    clip: Clip
    sound: Path | None
    film: Path | None
    spliced: Spliced
    remarks: tuple[str, ...]
    form: str = ""
    backup: Path | None = None
    backups: tuple[Path, ...] = ()
    begin: float = 0.0

    @property
    def names(self) -> str:
        """The names of all its files."""
        return ", ".join(p.name for p in (self.path, self.sound, self.film) if p is not None)

    def words(self, words: Transcript | None) -> Transcript | None:
        """The old take's words at their times in the new one.

        Those of which less than half is left are gone.
        """
        if words is None:
            return None
        ends = np.array([(word.start, word.end) for word in words.words]).reshape(-1, 2)
        left = np.diff(self.spliced.at(ends.ravel()).reshape(-1, 2), axis=1)[:, 0]
        there = left >= 0.5 * (ends[:, 1] - ends[:, 0])
        kept = tuple(word for word, is_there in zip(words.words, there, strict=True) if is_there)
        return replace(words, words=kept).at_times(self.spliced.at)


def write_spliced(
    take: Take,
    shown: Clip,
    splices: Sequence[Splice],
    path: Path,
    media: Placement,
    has_film: bool = True,
    progress: Callable[[float], bool] = lambda share: True,
    overwrite: bool = False,
    filled: Floats | None = None,
) -> Written:
    """Write a new take, its sound as a WAV, and its film as an MP4 or WebM.

    Args:
        take: the take.
        shown: its clip with the edits.
        splices: what is cut out and inserted.
        path: the new take; its ending says in which format it is written.
        media: the take's sound and film.
        has_film: whether the film is written.
        progress: is given 0..1 while the film is written; False gives up, and nothing is written.
        overwrite: replace files that exist, but none of the take; of a recording, a sound or a
            film a copy is kept.
        filled: the weights that fills gave to the take's lost rows, (L, K).

    Raises:
        FaceEditError: a splice is impossible.
        FileError: a file cannot be read or written, or exists.
        Abandoned: `progress` said so.
    """
    made = splice(with_filled(shown, take.lost_rows, filled), splices)
    form, remarks = _form_for(take, path)
    like, rows = None, take.without_face(filled)
    faceless = None if rows is None else made.without_face(rows)
    if form == own_format(take):
        like = Like(take.source, nearest_rows(take.clip.times, made.moments(made.clip.times)))
    keeps_rows = like is not None and has_style(like.source, made.clip)
    span = _span(made, faceless if keeps_rows else None)
    film = media.film if has_film else None
    sound = None if media.sound is None else read_sound(media.sound.path)
    paths = path.with_suffix(".wav"), path.with_suffix(".mp4")
    new = [p for p, there in zip(paths, (sound, film), strict=True) if there is not None]
    _check_room(path, new, overwrite)
    backups: tuple[Path, ...] = ()
    if overwrite:
        _check_other((path, *new), take, media)
        backups = tuple(keep_backup(file) for file in new if on_disk.exists(file))
    with ExitStack() as undo:  # of what was written, if anything fails
        if sound is not None and media.sound is not None:
            samples = spliced_sound(sound, media.sound.offset, made, span)
            write_atomically(paths[0], wav(samples, sound.rate))
            undo.callback(paths[0].unlink, missing_ok=True)
        if film is not None:
            try:
                _write_film(film, made, span, paths, sound is not None, progress)
                undo.callback(paths[1].unlink, missing_ok=True)
            except Unavailable as error:
                remarks.append(f"the film is left out: {error}")
                film = None
        # Of no kind: its own format would be written into the old file's rows.
        bare = replace(take, clip=made.clip, kind="", lost_rows=None, faceless=faceless)
        options = Options(overwrite=overwrite, like=like)
        exported = export_take(bare, made.clip, path, form, options)
        undo.pop_all()
    written = (paths[0] if sound is not None else None), (paths[1] if film is not None else None)
    lines = (*made.notes, *exported.said(), *remarks)
    return Written(
        path, made.clip, *written, made, lines, form.name, exported.backup, backups, span[0]
    )


def _span(made: Spliced, faceless: Faceless | None) -> tuple[float, float]:
    """When the first row of a new take is shown, and when the last one ends, seconds."""
    if not faceless:
        return 0.0, made.clip.duration
    rate = made.clip.rate
    # As `Take.lead` counts them.
    return -faceless.leading / rate, max(made.clip.duration, float(faceless.times[-1]) + 1.0 / rate)


def _form_for(take: Take, path: Path) -> tuple[OutFormat, list[str]]:
    """The format of a new take, and why it is not that of the old one, if it cannot be."""
    own = form = own_format(take)
    if form is None or path.suffix.lower() not in _endings(form):
        form = choose(path)
    if own is not None and not _endings(own):
        return form, [f"no new take can be {own.name}, so it is written as {form.name}"]
    return form, []


def ending_for(take: Take) -> str:
    """The ending of a new take: its own format's, if any clip can be written in it."""
    form = own_format(take)
    endings = () if form is None else _endings(form)
    own = take.path.suffix.lower()
    return own if own in endings else next(iter(endings), ".csv")


def free_name(path: Path) -> Path:
    """The name for a new take, numbered if there is a take, sound or film of that name already."""
    numbered = (path.with_stem(f"{path.stem}_{number}") for number in count(2))
    endings = {path.suffix, ".wav", ".mp4", ".webm"}
    return next(
        one
        for one in chain([path], numbered)
        if not any(on_disk.exists(one.with_suffix(ending)) for ending in endings)
    )


def _endings(form: OutFormat) -> tuple[str, ...]:
    kind = form.kind
    return kind.endings if isinstance(kind, Format) and kind.write is not None else ()


def _check_other(written: Sequence[Path], take: Take, media: Placement) -> None:
    """Check that no file of the take itself is replaced.

    Raises:
        FileError: one would be.
    """
    parts = (media.sound, media.film)
    keep_inputs(written, (take.path, *(part.path for part in parts if part is not None)))


def _check_room(path: Path, written: Sequence[Path], overwrite: bool) -> None:
    """Check that nothing is replaced, and that no other sound or film would be taken for its own.

    Args:
        overwrite: whether files may be replaced.

    Raises:
        FileError: something would.
    """
    for file in (path, *written):
        if on_disk.exists(file) and not overwrite:
            raise FileError(file, "exists", "choose another name for the new take")
    for found in beside(path.absolute()):
        if found is not None and found not in [p.absolute() for p in written]:
            problem = "is named like the new take, but has its old length"
            raise FileError(found, problem, "choose another name for the new take")


def spliced_sound(sound: Sound, offset: float, made: Spliced, span: tuple[float, float]) -> Samples:
    """(N, C) the samples of a sound from the beginning to the end of the spliced take.

    Args:
        offset: when its file begins, in seconds of the take.
        span: of the spliced take, seconds; rows without a face may lie beyond all others.
    """
    begin, end = span
    out = np.zeros((round((end - begin) * sound.rate), sound.channels), np.int16)
    fade, last = round(_FADE * sound.rate), len(made.pieces) - 1
    for number, piece in enumerate(made.pieces):
        earlier = -begin if number == 0 else 0.0
        later = end - made.clip.duration if number == last else 0.0
        start = round((piece.shown - earlier - begin) * sound.rate)
        length = round((earlier + piece.length + later) * sound.rate)
        stop = min(start + length, len(out))
        there = round((piece.start - earlier - offset - sound.start) * sound.rate)
        first, until = max(there, 0), min(there + stop - start, len(sound.samples))
        if first >= until:
            continue
        part = sound.samples[first:until].astype(np.float32)
        ramp = np.linspace(0.0, 1.0, min(fade, len(part)), dtype=np.float32)[:, None]
        if number and first == there:
            part[: len(ramp)] *= ramp
        if number < last and until == there + stop - start:
            part[len(part) - len(ramp) :] *= ramp[::-1]
        out[start + first - there : start + until - there] = np.rint(part)
    return out


def _write_film(
    film: MediaFile,
    made: Spliced,
    span: tuple[float, float],
    paths: tuple[Path, Path],
    has_sound: bool,
    progress: Callable[[float], bool],
) -> None:
    """Write the film with the same splices, over the same span as the sound."""
    heard = read_sound(paths[0]) if has_sound else None
    track = None if heard is None else Soundtrack(heard)
    source = Film(film.path)
    try:
        height, width = source.picture(0).shape[:2]
        size = width - width % 2, height - height % 2
        black = np.zeros((size[1], size[0], 3), np.uint8)
        count = max(round((span[1] - span[0]) * source.rate), 1)
        moments = made.moments(span[0] + np.arange(count) / source.rate) - film.offset
        with writing(paths[1], film_format(paths[1]), size, source.rate, track) as out:
            for number, moment in enumerate(moments.tolist()):
                if not progress(number / count):
                    raise Abandoned
                inside = -0.5 / source.rate <= moment < source.duration
                picture = source.frame_at(moment)[: size[1], : size[0], 2::-1] if inside else black
                out.add(np.ascontiguousarray(picture))
    finally:
        source.close()
