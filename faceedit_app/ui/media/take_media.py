"""The open take's sound and film: reading them, and placing them in time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, Literal, TypeVar

from PySide6.QtCore import QObject, Signal

from faceedit_app.core import on_disk
from faceedit_app.core.errors import FaceEditError, FileError
from faceedit_app.editing.edits.media import MediaFile, Placement, describe_added
from faceedit_app.formats.timecode import time_of_day
from faceedit_app.media import beside, offset_by_clock
from faceedit_app.media.container import find_film, opened
from faceedit_app.ui.media.overlay import LandmarksOverlay
from faceedit_app.ui.state.background import Background

if TYPE_CHECKING:  # these import PyAV, which is loaded with the first file
    from faceedit_app.media.film import Film
    from faceedit_app.media.sound import Sound

Item = TypeVar("Item")
MediaKind = Literal["sound", "film"]
KINDS: tuple[MediaKind, ...] = ("film", "sound")
_FAR = 24 * 3600.0  # seconds; the largest offset


@dataclass(frozen=True)
class Placed(Generic[Item]):
    """A sound or a film in the take.

    Attributes:
        item: the sound or film.
        path: its file.
        offset: time in the take at which the file begins, in seconds.
    """

    item: Item
    path: Path
    offset: float

    @property
    def kept(self) -> MediaFile:
        """Its entry in a project."""
        return MediaFile(self.path, self.offset)


@dataclass(frozen=True)
class _Found:
    """The contents of a file that the user added; `errors` is why a part could not be read."""

    film: Film | None
    sound: Sound | None
    errors: tuple[FaceEditError, ...]


class TakeMedia(QObject):
    """Holds at most one sound and one film, reads them in the background and places them.

    A film brings its own sound, unless a sound file is there. Sound and picture of one film are
    moved together.

    Attributes:
        base: the placement of files found beside the take, used until the user changes it.
        is_held: sound or film is being dragged in time.
        overlay: the landmarks that are shown over the film.
        mirrored: the film is shown mirrored; some phones record selfies that way.

    Signals:
        sound_changed(), film_changed(): it was added, replaced or removed.
        placed(): an offset changed.
        turned(): the film was mirrored, or mirrored back.
        acted(): the user added, removed or moved something; the gesture is over.
        message(str): what was done, for the status bar.
        found(str): what was found beside the take, for the status bar if it says nothing else.
        failed(object): a FaceEditError about a file that the user added.
        missed(object): a FaceEditError about a file found beside the take, or in the project.
    """

    sound_changed = Signal()
    film_changed = Signal()
    placed = Signal()
    turned = Signal()
    acted = Signal()
    message = Signal(str)
    found = Signal(str)
    failed = Signal(object)
    missed = Signal(object)

    def __init__(self, background: Background, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._background = background
        self.overlay = LandmarksOverlay(background, self)
        self.sound: Placed[Sound] | None = None
        self.film: Placed[Film] | None = None
        self.base = Placement()
        self.is_held = self.mirrored = False
        # Files that are missing or still being read: saving must not lose them.
        self._kept: dict[MediaKind, MediaFile] = {}
        self._began: float | None = None
        self._lead = 0.0
        self._found = ""  # message for when everything is read
        self._job = 0  # results for an earlier take are ignored
        self.pending = 0

    @property
    def placement(self) -> Placement:
        """The sound and film, including those still being read, with their offsets."""

        def kept(kind: MediaKind, placed: Placed[Any] | None) -> MediaFile | None:
            return self._kept.get(kind) if placed is None else placed.kept

        return Placement(kept("sound", self.sound), kept("film", self.film))

    # --- another take ------------------------------------------------------------------------

    def follow(
        self,
        take: Path,
        began: float | None = None,
        placement: Placement | None = None,
        lead: float = 0.0,
    ) -> None:
        """Another take is open: drop the previous sound and film, and load those of this one.

        Args:
            began: its first timecode as seconds since midnight. A film with timecode and a
                Broadcast WAV are placed by it.
            placement: the project's; None: the files found beside the take.
            lead: seconds of its file before its first face.
        """
        self.clear()
        self._began, self._lead = began, lead
        self.overlay.follow(take.absolute())
        sound, film = beside(take.absolute())
        found = [path for path in (film, sound) if path is not None]
        heard = sound or film
        self.base = Placement(
            MediaFile(heard) if heard else None, MediaFile(film) if film else None
        )
        self.show(self.base if placement is None else placement, placement is None)
        if found and placement is None:
            names = " and ".join(path.name for path in found)
            self._found = f"Opened {names}, found beside the take"

    def show(self, wanted: Placement, beside_take: bool = False) -> None:
        """Replace sound and film, for undo or a project.

        A file that is gone is reported by `missed`, and stays in `placement` until another one
        replaces it.

        Args:
            beside_take: they were found, not chosen: each is placed by its clock, and one that
                cannot be read is ignored.
        """
        new: dict[MediaKind, Placed[Any] | None] = {"sound": self.sound, "film": self.film}
        unread: list[tuple[MediaKind, MediaFile]] = []
        for kind in KINDS:
            want, there = getattr(wanted, kind), new[kind]
            if getattr(self.placement, kind) == want:
                continue
            self._kept.pop(kind, None)
            new[kind] = None
            if want is not None and there is not None and there.path == want.path:
                new[kind] = replace(there, offset=want.offset)
            elif want is not None:
                self._kept[kind] = want
                unread.append((kind, want))
        self._put(new["sound"], new["film"])
        for kind, want in unread:
            self._read(kind, want, beside_take)

    def clear(self) -> None:
        """Remove both, and ignore what is still being read."""
        self._job += 1
        self._found, self.base = "", Placement()
        self._kept.clear()
        self.overlay.clear()
        self._put(None, None)
        self.mirror(False)

    # --- read --------------------------------------------------------------------------------

    def _read(self, kind: MediaKind, entry: MediaFile, beside_take: bool) -> None:
        """Read a file, and use it unless it is out of date by then."""
        path, job = entry.path, self._job
        if not on_disk.is_file(path):
            error = FileError(path, "is missing", "find it and add it again")
            self.missed.emit(error)
            return

        def done(item: Any) -> None:
            if job != self._job or item is None or self._kept.get(kind) != entry:
                return
            del self._kept[kind]
            at = self._by_clock(item) if beside_take else entry.offset
            if kind == "film":
                self._put(self.sound, Placed(item, path, at))
            else:
                if beside_take and self.film is not None and self.film.path == path:
                    at = self.film.offset
                self._put(Placed(item, path, at), self.film)
            if beside_take:
                self._place(at, path)  # its sound may have been read first
                self._rebase(path, at)
            self._announce()

        def missed(error: object) -> None:
            if beside_take and self._kept.get(kind) == entry:
                del self._kept[kind]
                self.base = replace(self.base, **{kind: None})
            self.missed.emit(error)

        self._run(self._reader(kind, path), done, missed)

    def _reader(self, kind: MediaKind, path: Path) -> Callable[[], Any]:
        job = self._job

        def read() -> Film | Sound | None:
            from faceedit_app.media.film import Film
            from faceedit_app.media.sound import read_sound

            reader: Callable[..., Film | Sound | None] = Film if kind == "film" else read_sound
            return reader(path, lambda: job != self._job)

        return read

    def _rebase(self, path: Path, offset: float) -> None:
        """Update `base` with the offset of a file that was found beside the take."""
        for kind in KINDS:
            entry = getattr(self.base, kind)
            if entry is not None and entry.path == path:
                self.base = replace(self.base, **{kind: MediaFile(path, offset)})

    def _by_clock(self, item: Film | Sound) -> float:
        """Offset of film or sound by the time of day, if take and file record it."""
        from faceedit_app.media.sound import Sound

        if isinstance(item, Sound):
            begins, lasts = item.began, item.end
        else:
            code = item.timecode
            begins = None if code is None else time_of_day(code, round(item.rate))
            lasts = item.duration
        return offset_by_clock(self._began, begins, lasts, self._lead)

    def _announce(self) -> None:
        """Emit the message once the last file is read."""
        if not self.pending and self._found:
            self.found.emit(self._found)
            self._found = ""

    def _run(
        self, work: Callable[[], Any], done: Callable[[Any], None], failed: Callable[[object], None]
    ) -> None:
        job = self._job
        self.pending += 1

        def arrived(result: Any) -> None:
            self.pending -= 1
            done(result)

        def missed(error: Exception) -> None:
            self.pending -= 1
            if job != self._job:
                return
            if not isinstance(error, FaceEditError):
                raise error
            failed(error)

        self._background.run(work, arrived, missed)

    # --- the user's changes ------------------------------------------------------------------

    def add(self, path: Path) -> None:
        """Read a file; its sound or film replaces the one there is."""
        path, job = path.absolute(), self._job
        self.message.emit(f"Opening {path.name}…")

        def read() -> _Found:
            has_sound, has_film = _contents(path)
            items: dict[str, Any] = {}
            errors: list[FaceEditError] = []
            for kind, has in zip(KINDS, (has_film, has_sound), strict=True):
                try:
                    items[kind] = self._reader(kind, path)() if has else None
                except FaceEditError as error:
                    errors.append(error)
            return _Found(items.get("film"), items.get("sound"), tuple(errors))

        def done(found: _Found) -> None:
            if job != self._job:
                return
            for error in found.errors:
                self.failed.emit(error)
            if found.film is not None or found.sound is not None:
                before = self.placement
                self._add(path, found)
                said = () if found.film is None else found.film.remarks
                self.message.emit("; ".join((describe_added(path, before, self.placement), *said)))
                self.acted.emit()

        self._run(read, done, self.failed.emit)

    def _add(self, path: Path, found: _Found) -> None:
        sound, film = self.sound, self.film
        at = 0.0 if found.sound is None else self._by_clock(found.sound)
        if found.film is not None:
            if sound is not None and self._is_films(sound.path):
                sound = None  # it belongs to the previous film
            at = self._by_clock(found.film)
            film = Placed(found.film, path, at)
        # A separate sound file takes precedence over a film's own sound.
        if found.sound is not None and (found.film is None or sound is None):
            sound = Placed(found.sound, path, at)
        if sound is not None:
            self._kept.pop("sound", None)
        if film is not None:
            self._kept.pop("film", None)
        self._put(sound, film)

    def _is_films(self, path: Path) -> bool:
        return self.film is not None and self.film.path == path

    def move_sound(self, offset: float) -> None:
        """Make the sound file begin at a time in the take."""
        if self.sound is not None:
            self._place(offset, self.sound.path)

    def move_film(self, offset: float) -> None:
        """Make the film begin at a time in the take."""
        if self.film is not None:
            self._place(offset, self.film.path)

    def _place(self, offset: float, path: Path) -> None:
        """Move sound and film of one file together."""
        offset = min(max(round(offset, 4), -_FAR), _FAR)
        sound, film = self.sound, self.film
        if sound is not None and sound.path == path:
            sound = replace(sound, offset=offset)
        if film is not None and film.path == path:
            film = replace(film, offset=offset)
        self._put(sound, film)

    def mirror(self, mirrored: bool) -> None:
        """Mirror the film, or show it as it is; this changes the view, and is not a step."""
        if mirrored != self.mirrored:
            self.mirrored = mirrored
            self.turned.emit()

    def remove_sound(self) -> None:
        """Remove the sound."""
        self._kept.pop("sound", None)
        self._put(None, self.film)
        self.acted.emit()

    def remove_film(self) -> None:
        """Remove the film, with its own sound."""
        self._kept.pop("film", None)
        brought = self.sound is not None and self._is_films(self.sound.path)
        self._put(None if brought else self.sound, None)
        self.acted.emit()

    def _put(self, sound: Placed[Sound] | None, film: Placed[Film] | None) -> None:
        """Set both, and emit what changed."""
        old = self.sound, self.film
        self.sound, self.film = sound, film
        changed, moved = zip(*map(_differ, old, (sound, film)), strict=True)
        for differs, signal in zip(changed, (self.sound_changed, self.film_changed), strict=True):
            if differs:
                signal.emit()
        if any(moved):
            self.placed.emit()


def _differ(old: Placed[Any] | None, new: Placed[Any] | None) -> tuple[bool, bool]:
    """Whether the item changed, and whether the same item moved."""
    if old is None or new is None or old.item is not new.item:
        return old is not new, False
    return False, old.offset != new.offset


def _contents(path: Path) -> tuple[bool, bool]:
    """Whether a file has sound, and film."""
    with opened(path) as container:
        has = bool(container.streams.audio), find_film(container) is not None
    if not any(has):
        raise FileError(path, "contains neither sound nor film", "choose another file")
    return has
