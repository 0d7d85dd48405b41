"""Export a take, edited or not, in any format: as a take, or as a character that plays it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from faceedit_app.characters.scenes import SCENES, SceneFormat, scene_content
from faceedit_app.core.arrays import Floats
from faceedit_app.core.atomic import begins_with, keep_inputs, write_atomically
from faceedit_app.core.clip import Clip
from faceedit_app.core.errors import FaceEditError, FileError
from faceedit_app.core.rig import Rig
from faceedit_app.editing.files.originals import make_way
from faceedit_app.editing.opening import open_character, shipped_rig
from faceedit_app.editing.session import EditSession
from faceedit_app.formats import registry
from faceedit_app.formats.converting import Like, converted, resampled, with_filled
from faceedit_app.formats.faceless import left_out_note
from faceedit_app.formats.lost_faces import CONFIDENCE
from faceedit_app.formats.opening import open_take
from faceedit_app.formats.rotations import rotation_named
from faceedit_app.formats.take import Take
from faceedit_app.formats.timing import format_rate
from faceedit_app.media.container import check

if TYPE_CHECKING:  # it imports SciPy and trimesh, which exports of takes do not need
    from faceedit_app.characters.fitted import FittedCharacter

_LIKE_THE_TAKE = (
    "The file is laid out like the take, for programs that open the take. For others, choose a "
    "format by its name."
)
_MOVES_ON = "the face moves on evenly there"
_HEAD = "head"  # rotations of the head begin so
_MARK = 8  # first bytes of a file, which tell its kind


@dataclass(frozen=True)
class OutFormat:
    """A format that any take can be exported in.

    Attributes:
        kind: of a take, or of a character that plays it.
        is_own: whether a take keeps its own layout; if not, it is written for other programs.
    """

    kind: registry.Format | SceneFormat
    is_own: bool = False

    @property
    def key(self) -> str:
        """The name on the command line."""
        return self.kind.key

    @property
    def name(self) -> str:
        """Shown to the user."""
        return self.kind.name

    @property
    def ending(self) -> str:
        """Of its files, with the dot."""
        return self.kind.endings[0]

    @property
    def has_character(self) -> bool:
        """Whether it holds a character."""
        return isinstance(self.kind, SceneFormat)

    @property
    def is_compact(self) -> bool:
        """Whether it can store weights compactly."""
        return isinstance(self.kind, SceneFormat) and self.kind.is_compact

    @property
    def takes_any_rate(self) -> bool:
        """Whether it can be written at another rate than the take's own."""
        return isinstance(self.kind, SceneFormat) or self.kind.write is not None

    def hints(self, rate: float) -> list[str]:
        """What to do with the file in other programs, a sentence each."""
        if self.is_own:
            return [_LIKE_THE_TAKE]
        shown = format_rate(rate)
        return [f"{tool}: {text.format(rate=shown)}." for tool, text in self.kind.hints]


@dataclass(frozen=True)
class Options:
    """How a take is exported.

    Attributes:
        rate: frames per second; None = the take's own.
        character: the user's character or its file, for formats with one; None = FaceEdit's own.
        compact: store weights in 16 bits, for formats that can.
        overwrite: allow a recording to be replaced; a copy of it is kept.
        follows_head: turn the head of a character as it was recorded.
        like: a file in whose style a take is written, if it can be; None = the take's own.
        filled: the weights that fills gave to the take's lost rows, (L, K).
    """

    rate: float | None = None
    character: FittedCharacter | Path | None = None
    compact: bool = False
    overwrite: bool = False
    follows_head: bool = False
    like: Like | None = None
    filled: Floats | None = None


@dataclass(frozen=True)
class Exported:
    """What was written.

    Attributes:
        path: the file.
        form: its format.
        clip: the take as written, at its rate.
        remarks: sentences about what the file does not hold, but for the head; see `said`.
        backup: the copy of the file that it replaced, if that was a recording or of another kind.
        is_straight: the head was recorded as it turns, but does not turn in the file.
        rate_note: that its times say another rate than the user gave, as `Take.rate_note`; it is
            among the remarks. "" if they do not.
    """

    path: Path
    form: OutFormat
    clip: Clip
    remarks: tuple[str, ...]
    backup: Path | None = None
    is_straight: bool = False
    rate_note: str = ""

    def said(self, turning: str = "") -> tuple[str, ...]:
        """All remarks.

        Args:
            turning: what the user can choose for the head to turn; "" if there is no choice.
        """
        if not self.is_straight:
            return self.remarks
        remedy = f"; {turning} turns it as recorded" if turning else ""
        return (*self.remarks, f"the head is straight{remedy}")


@dataclass(frozen=True)
class _Encoded:
    """A file that is ready to be written.

    Attributes:
        content: of the file.
        clip: the take as the file has it.
        lost: what the take's file carries beside its channels, and this one cannot.
        notes: further remarks.
        is_straight: as in `Exported`.
    """

    content: bytes
    clip: Clip
    lost: tuple[str, ...]
    notes: tuple[str, ...] = ()
    is_straight: bool = False


def out_formats() -> tuple[OutFormat, ...]:
    """All formats that any take can be exported in."""
    return (*(OutFormat(form) for form in registry.writable()), *map(OutFormat, SCENES))


def choose(
    path: Path,
    key: str | None = None,
    take: Take | None = None,
    rate: float | None = None,
    has_character: bool = False,
) -> OutFormat:
    """Choose the format of a file to be exported.

    Args:
        path: the file; its ending decides if `key` is None.
        key: `OutFormat.key`.
        take: if its file or its own format has this ending, its own layout is chosen.
        rate: frames per second to write, if not the take's own; not all layouts can have another.
        has_character: whether the user gave a character; then one is written if it can be.

    Raises:
        FaceEditError: there is no such format, or the file ends like one of another format.
    """
    formats = out_formats()
    ending = path.suffix.lower()
    if key is not None:
        for form in formats:
            if form.key == key:
                if ending in _all_endings(*formats) and ending not in _all_endings(form):
                    problem = f"does not end like a file of the format {form.name}"
                    raise FileError(path, problem, f"use {form.ending}, or another format")
                return form
        raise FaceEditError(f"{key}: must be one of {', '.join(form.key for form in formats)}")
    own = own_format(take) if take is not None else None
    if own is not None and take is not None:
        # A layout without times cannot say what rate it is written at.
        keeps = rate is None or (own.takes_any_rate and take.fps is None)
        own = own if keeps else None
    scenes = tuple(form for form in formats if form.has_character)
    if has_character and ending in _all_endings(*scenes):
        own = None
    elif own is not None and take is not None and ending == take.path.suffix.lower():
        return own
    for form in (*([own] if own is not None else []), *formats):
        if ending in _all_endings(form):
            return form
    known = ", ".join(dict.fromkeys(form.ending for form in formats))
    raise FaceEditError(f"{path}: no format with this ending can be written; use one of {known}")


def _all_endings(*formats: OutFormat) -> set[str]:
    return {ending for form in formats for ending in form.kind.endings}


def by_ending(path: Path, take: Take) -> OutFormat | None:
    """The format for a file by its ending; None = the take's own, also for an unknown ending."""
    try:
        form = choose(path, take=take)
    except FaceEditError:
        return None
    return None if form == own_format(take) else form


def own_format(take: Take) -> OutFormat | None:
    """The format that a take was opened from."""
    return next((OutFormat(f, True) for f in registry.FORMATS if f.name == take.kind), None)


def export_session(
    session: EditSession, path: Path, form: OutFormat, options: Options | None = None
) -> Exported:
    """Export the edited take; see `export_take`."""
    options = replace(options or Options(), filled=session.filled_rows())
    return export_take(session.take, session.edited_clip(), path, form, options)


def export_take(
    take: Take,
    edited: Clip,
    path: Path,
    form: OutFormat,
    options: Options | None = None,
    stopped: Callable[[], bool] | None = None,
) -> Exported:
    """Export a take.

    Args:
        take: the take.
        edited: its clip, or that with the edits.
        path: the file to write.
        form: its format.
        options: the rest.
        stopped: asked before the file is written; True gives up.

    Raises:
        Abandoned: `stopped` returned True; nothing was written.
        FileError: it cannot be written, or is a recording; an existing file is then untouched.
        FaceEditError: the format cannot be written at this frame rate.
    """
    options = options or Options()
    keep_inputs([path], _files_of(options.character))
    check(stopped)
    encoded = (_as_scene if form.has_character else _as_take)(take, edited, path, form, options)
    check(stopped)
    is_ours: Callable[[Path], bool] = registry.is_take
    if form.has_character and form.ending != ".glb":  # FaceEdit does not read these as takes
        is_ours = begins_with(encoded.content[:_MARK])
    backup = make_way(path, take.path, options.overwrite, is_ours)
    write_atomically(path, encoded.content)
    remarks = (*_left_out(encoded.lost, form), *filter(None, encoded.notes))
    rate_note = take.rate_note if take.rate_note in encoded.notes else ""
    return Exported(path, form, encoded.clip, remarks, backup, encoded.is_straight, rate_note)


def _left_out(lost: tuple[str, ...], form: OutFormat) -> tuple[str, ...]:
    """Sentences about the columns of a take that a file does not have."""
    turns = tuple(name for name in lost if rotation_named(name) is not None)
    others = tuple(name for name in lost if name not in turns)
    sentences: list[str] = []
    if turns and form.has_character:  # the head's are not lost
        why = "the eyes look where their weights say; their rotations are left out"
        sentences.append(f"{why}: {', '.join(turns)}")
    elif turns:
        keeps = isinstance(form.kind, registry.Format) and form.kind.keeps_rotations
        why = "" if keeps else f", as {form.name} has no place for them"
        sentences.append(f"rotations of head and eyes are left out{why}: {', '.join(turns)}")
    if others:
        sentences.append(f"left out because they are not channels: {', '.join(others)}")
    return tuple(sentences)


def _others(take: Take) -> tuple[str, ...]:
    """Sentences about what else the file has, such as the rows of another face."""
    return tuple(f"{note}; the rest is left out" for note in take.unread)


def _as_take(take: Take, edited: Clip, path: Path, form: OutFormat, options: Options) -> _Encoded:
    """A take as the file of a format of takes."""
    kind = form.kind
    assert isinstance(kind, registry.Format)
    same = kind.name == take.kind and options.rate in (None, take.clip.rate)
    if kind.write is None and not same:
        raise FaceEditError(
            f"{path}: {kind.name} can only be written as it was recorded; "
            f"choose another format, such as {registry.writable()[0].name}"
        )
    done = converted(
        path,
        take,
        kind,
        options.rate,
        edited,
        like=options.like,
        own_layout=form.is_own,
        filled=options.filled,
    )
    lost = () if done.is_own else take.carried
    if (kind.keeps_rotations or done.is_styled) and done.clip.rotations is not None:
        lost = tuple(name for name in lost if rotation_named(name) is None)
    if kind.keeps_confidence and done.clip.confidence is not None:
        lost = tuple(name for name in lost if name.lower() != CONFIDENCE)
    lost = tuple(name for name in lost if name not in done.kept)
    notes = (*(() if done.is_own else _others(take)), done.note, done.faceless)
    return _Encoded(done.content, done.clip, lost, notes)


def _as_scene(take: Take, edited: Clip, _path: Path, form: OutFormat, options: Options) -> _Encoded:
    """A take as the file of a character that plays it."""
    kind = form.kind
    assert isinstance(kind, SceneFormat)
    clip = resampled(with_filled(edited, take.lost_rows, options.filled), options.rate)
    character, compact, follows = _opened(options.character), options.compact, options.follows_head
    content = scene_content(kind, clip, character, take.path.stem, compact, follows)
    lost = tuple(n for n in take.carried if not (rotation_named(n) or "").startswith(_HEAD))
    turned = clip.rotations is not None and bool(np.any(clip.rotations[:, :3]))
    note = left_out_note(take.without_face(options.filled), take.clip, _MOVES_ON)
    return _Encoded(content, clip, lost, (*_others(take), note), turned and not follows)


def changed_frames(session: EditSession, path: Path) -> int:
    """The number of frames that differ between a take and its export in its own layout.

    It may be less than the session's: a change that is smaller than the file's digits is not in it.
    Rows that a fill gave a face count as well.

    Raises:
        FileError: the export cannot be read.
    """
    take = session.take
    tracked = with_filled(take.clip, take.lost_rows, session.filled_rows())
    written = open_take(path, take.fps).clip
    if len(written) != len(tracked):
        return session.changed_frames()
    differs = ~np.isin(tracked.times, take.clip.times)
    differs |= np.any(written.weights != tracked.weights, axis=1)
    if written.rotations is not None and tracked.rotations is not None:
        differs |= np.any(written.rotations != tracked.rotations, axis=1)
    return int(differs.sum())


def _files_of(character: FittedCharacter | Path | None) -> tuple[Path, ...]:
    """What is read for a character: its file or folder, and its map."""
    if character is None:
        return ()
    from faceedit_app.characters.map_file import map_path

    path = character if isinstance(character, Path) else character.character.path
    return path, map_path(path)


def _opened(character: FittedCharacter | Path | None) -> FittedCharacter | Rig:
    if character is None:
        return shipped_rig()
    return open_character(character) if isinstance(character, Path) else character
