"""The sound and the film beside the open take: which, where in the take, and how they are read."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from PySide6.QtCore import QObject, Signal

from faceedit_app.core.errors import FaceEditError, FileError
from faceedit_app.formats.timecode import time_of_day
from faceedit_app.media import beside
from faceedit_app.ui.loading import Background

if TYPE_CHECKING:  # PyAV comes with these; it is loaded with the first file
    from faceedit_app.media.film import Film
    from faceedit_app.media.sound import Sound

Item = TypeVar("Item")
_NEAR = 60.0  # seconds after the take's beginning at which a film may be found by timecode
_FAR = 24 * 3600.0  # seconds; an offset beyond is a slip of the hand


@dataclass(frozen=True)
class Placed(Generic[Item]):
    """A sound or a film in the take.

    Attributes:
        item: what was read.
        path: its file.
        offset: seconds of the take at which the file's beginning lies.
    """

    item: Item
    path: Path
    offset: float


class Media(QObject):
    """Holds at most one sound and one film, reads them in the background and places them.

    A film brings its own sound, unless a sound file is there. Sound and picture of one film are
    moved together.

    Signals:
        sound_changed(), film_changed(): another one is there, or none.
        placed(): an offset changed.
        told(str): something went well, for the status bar.
        failed(object): a FaceEditError about a file that the user named.
        missed(object): a FaceEditError about a file that was found or remembered.
    """

    sound_changed = Signal()
    film_changed = Signal()
    placed = Signal()
    told = Signal(str)
    failed = Signal(object)
    missed = Signal(object)

    def __init__(self, background: Background, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._background = background
        self.sound: Placed[Sound] | None = None
        self.film: Placed[Film] | None = None
        # What a project named and is not there, or not yet: it must not be lost by saving.
        self._kept: dict[str, dict[str, str | float]] = {}
        self._began: float | None = None
        self._yields = False  # the sound that is there came with a film
        self._found = ""  # what to say when all is read
        self._job = 0  # what is read for an earlier take is not wanted any more
        self.pending = 0

    # --- open --------------------------------------------------------------------------------

    def follow(self, take: Path, began: float | None = None) -> None:
        """Another take is open: let go of the last one's, and take what lies beside this one.

        Args:
            began: its first timecode as seconds since midnight. A film with timecode is placed
                by it.
        """
        self.clear()
        self._began = began
        sound, film = beside(take)
        found = [path for path in (film, sound) if path is not None]
        if film is not None:
            self._read_film(film, None, self.missed.emit)
        if found:
            self._read_sound(sound or found[0], 0.0, self.missed.emit, yields=sound is None)
            names = " and ".join(path.name for path in found)
            self._found = f"Opened {names}, found beside the take"

    def add(self, path: Path) -> None:
        """Read a file that the user named; it takes the place of its like when it is read."""
        job = self._job

        def probed(contents: tuple[bool, bool]) -> None:
            if job == self._job:
                self._add(path, *contents)

        self._run(lambda: _contents(path), probed, self.failed.emit)

    def _add(self, path: Path, has_sound: bool, has_film: bool) -> None:
        self.told.emit(f"Opening {path.name}…")
        if has_film:
            self._read_film(path, None, self.failed.emit)
        if has_sound:
            self._read_sound(path, 0.0, self.failed.emit, yields=has_film)

    def _read_film(
        self, path: Path, offset: float | None, failed: Callable[[object], None]
    ) -> None:
        """Place a film at `offset`, or where its timecode says."""
        job = self._job

        def read() -> Film:
            from faceedit_app.media.film import Film

            return Film(path, lambda: job != self._job)

        def done(film: Film) -> None:
            if job == self._job:
                at = self._by_timecode(film) if offset is None else offset
                self._kept.pop("film", None)
                self.film = Placed(film, path, at)
                self.film_changed.emit()
                if self._yields and self.sound is not None and self.sound.path != path:
                    self.remove_sound()  # it came with the film that was here
                self._place(at, path)  # its sound may have been there first
                self._tell(path)

        self._run(read, done, failed)

    def _by_timecode(self, film: Film) -> float:
        """Where the film begins in the take if both tell the time of day, else at 0."""
        if self._began is None or film.timecode is None:
            return 0.0
        begins = time_of_day(film.timecode, round(film.rate))
        if begins is None:
            return 0.0
        offset = round(begins - self._began, 4)
        # Clocks that were not set alike would only carry it out of sight.
        return offset if -film.duration < offset < _NEAR else 0.0

    def _read_sound(
        self, path: Path, offset: float, failed: Callable[[object], None], yields: bool = False
    ) -> None:
        """Place a sound; a film's `yields` to a sound file, which is there for a reason."""
        job = self._job

        def read() -> Sound | None:
            from faceedit_app.media.sound import read_sound

            return read_sound(path, lambda: job != self._job)

        def done(sound: Sound | None) -> None:
            beaten = yields and self.sound is not None and not self._yields
            if job == self._job:
                self._kept.pop("sound", None)
            if job == self._job and sound is not None and not beaten:
                self._yields = yields
                at = self.film.offset if self.film and self.film.path == path else offset
                self.sound = Placed(sound, path, at)
                self.sound_changed.emit()
                self._tell(path)

        self._run(read, done, failed)

    def _tell(self, path: Path) -> None:
        """What is there now, when the last file is read."""
        if not self.pending:
            self.told.emit(self._found or f"Added {path.name}")
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

    # --- place -------------------------------------------------------------------------------

    def move_sound(self, offset: float) -> None:
        """Put the beginning of the sound's file at a second of the take."""
        if self.sound is not None:
            self._place(offset, self.sound.path)

    def move_film(self, offset: float) -> None:
        """Put the first picture at a second of the take."""
        if self.film is not None:
            self._place(offset, self.film.path)

    def _place(self, offset: float, path: Path) -> None:
        """Sound and picture of one file keep together."""
        offset = min(max(round(offset, 4), -_FAR), _FAR)
        moved = False
        if self.sound is not None and self.sound.path == path and self.sound.offset != offset:
            self.sound, moved = Placed(self.sound.item, path, offset), True
        if self.film is not None and self.film.path == path and self.film.offset != offset:
            self.film, moved = Placed(self.film.item, path, offset), True
        if moved:
            self.placed.emit()

    # --- remove ------------------------------------------------------------------------------

    def remove_sound(self) -> None:
        """Without sound from now on."""
        self._kept.pop("sound", None)
        if self.sound is not None:
            self.sound = None
            self.sound_changed.emit()

    def remove_film(self) -> None:
        """Without film from now on; the sound that it brought goes with it."""
        self._kept.pop("film", None)
        film = self.film
        if film is not None:
            self.film = None
            self.film_changed.emit()
            if self.sound is not None and self.sound.path == film.path:
                self.remove_sound()

    def clear(self) -> None:
        """Without either, and without what is still being read."""
        self._job += 1
        self._found = ""
        self.remove_sound()
        self.remove_film()

    # --- project files -----------------------------------------------------------------------

    def state(self) -> dict[str, dict[str, str | float] | None]:
        """What a project keeps: `{"sound": {"path", "offset"} or None, "film": the same}`."""

        def kept(kind: str, placed: Placed[Any] | None) -> dict[str, str | float] | None:
            if placed is None:
                return self._kept.get(kind)
            return {"path": str(placed.path), "offset": placed.offset}

        return {"sound": kept("sound", self.sound), "film": kept("film", self.film)}

    def restore(self, state: dict[str, Any]) -> None:
        """Read what a project kept, in place of what is there.

        A file that is gone is told by `missed`, and stays in the state until another one takes
        its place; a damaged entry counts as none.
        """
        self.clear()
        film: Path | None = None
        for kind in ("film", "sound"):
            entry = state.get(kind) if isinstance(state, dict) else None
            if not isinstance(entry, dict) or not isinstance(entry.get("path"), str):
                continue
            offset, path = entry.get("offset", 0.0), Path(entry["path"])
            at = float(offset) if isinstance(offset, int | float) else 0.0
            self._kept[kind] = {"path": str(path), "offset": at}
            if not path.is_file():
                error = FileError(path, "is not there any more", "add it again where it is now")
                self.missed.emit(error)
                continue
            if kind == "film":
                film = path
                self._read_film(path, at, self.missed.emit)
            else:
                self._read_sound(path, at, self.missed.emit, yields=path == film)


def _contents(path: Path) -> tuple[bool, bool]:
    """Whether a file has sound, and film."""
    from faceedit_app.media.container import find_film, opened

    with opened(path) as container:
        has = bool(container.streams.audio), find_film(container) is not None
    if not any(has):
        raise FileError(path, "has neither sound nor film in it", "choose another file")
    return has
