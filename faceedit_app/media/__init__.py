"""The sound and the film of a take: read, indexed and played, without Qt.

PyAV (FFmpeg) reads the files and sounddevice (PortAudio) plays; both are imported only when a
file is opened, so that they do not delay the start.
"""

from __future__ import annotations

from pathlib import Path

from faceedit_app.core import on_disk

SOUND_ENDINGS = (".wav", ".m4a", ".mp3", ".flac", ".aif", ".aiff", ".ogg", ".opus", ".aac")
FILM_ENDINGS = (".mov", ".mp4", ".m4v", ".mkv", ".webm", ".avi", ".mpg", ".mpeg")
ENDINGS = FILM_ENDINGS + SOUND_ENDINGS
_NEAR = 60.0  # seconds from the start of the take within which a clock may place a film
# Suffixes that programs add to the name of a take: our export's, Live Link Face's, and those of
# tools that read a film.
_ADDED = ("_edited", "_tracked", "_cal", "_raw", "_neutral", "_blendshape_data")


def is_media(path: Path) -> bool:
    """Whether a file is a sound or a film by its ending."""
    return path.suffix.lower() in ENDINGS


def is_film(path: Path) -> bool:
    """Whether a file is a film by its ending."""
    return path.suffix.lower() in FILM_ENDINGS


def beside(take: Path) -> tuple[Path | None, Path | None]:
    """The sound and the film next to a take, by its name.

    Live Link Face writes `take_iPhone.csv` and `take_iPhone.mov`; an exported `take_cal_edited.csv`
    finds what belongs to `take_cal.csv`, else to `take.csv`.

    Returns:
        (sound, film), each None if there is none. A film's own sound is left to the caller: it
        counts only if there is no sound file.
    """
    stems = [take.stem]
    while (stem := _without_suffix(stems[-1])) != stems[-1]:
        stems.append(stem)

    def find(endings: tuple[str, ...]) -> Path | None:
        for stem in stems:
            for ending in endings:
                for spelled in (ending, ending.upper()):
                    path = take.with_name(stem + spelled)
                    if on_disk.is_file(path):
                        return path
        return None

    return find(SOUND_ENDINGS), find(FILM_ENDINGS)


def _without_suffix(stem: str) -> str:
    return next((stem.removesuffix(a) for a in _ADDED if stem.endswith(a) and stem != a), stem)


def offset_by_clock(
    take: float | None, began: float | None, lasts: float, lead: float = 0.0
) -> float:
    """When a sound or film begins in a take, by the time of day.

    If the clocks do not say, it begins with the file of the take, which may have no face at first.

    Args:
        take, began: when take and file began, in seconds since midnight, if known.
        lasts: seconds of the file.
        lead: seconds of the take's file before its first face, see `Take.lead`.
    """
    if take is None or began is None:
        return 0.0 - lead if lead < lasts else 0.0
    offset = round(began - take, 4)
    # If the clocks disagree, the offset would move it out of sight.
    return offset if -lasts < offset < _NEAR else 0.0
