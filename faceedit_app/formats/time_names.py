"""What the names of columns and fields say about times.

A name decides only what is tried first, and the unit if the times can have it.
"""

from __future__ import annotations

import re

TICKS = "ticks of 100 ns"  # of .NET and Windows
UNIT_WORDS = {
    **dict.fromkeys(("s", "sec", "secs", "seconds", "sekunden"), "seconds"),
    **dict.fromkeys(("ms", "msec", "millis", "milliseconds", "millisekunden"), "milliseconds"),
    **dict.fromkeys(("us", "usec", "micros", "microseconds"), "microseconds"),
    **dict.fromkeys(("ns", "nsec", "nanos", "nanoseconds"), "nanoseconds"),
    **dict.fromkeys(("msecs", "millisec", "millisecs"), "milliseconds"),
    **dict.fromkeys(("usecs", "microsec", "microsecs"), "microseconds"),
    **dict.fromkeys(("nsecs", "nanosec", "nanosecs"), "nanoseconds"),
    "ticks": TICKS,
}
_TIME_WORDS = {
    *("time", "times", "timestamp", "timestamps", "timecode", "tc", "t", "elapsed", "epoch"),
    *("ts", "pts", "date", "datetime", "stamp", "clock"),
    # In German, French, Spanish, Italian, Portuguese, Dutch, Polish, Russian, Chinese, Japanese.
    *("zeit", "zeitstempel", "uhrzeit", "temps", "tiempo", "tempo", "tijd", "czas"),
    *("время", "时间", "時間", "時刻"),
}
_STEP_WORDS = {"delta", "dt", "deltatime", "timedelta"}  # the time since the row before
_COUNT_WORDS = {
    *("frame", "frames", "framenumber", "frameid", "index", "idx"),
    *("bild", "bildnummer", "trame", "fotograma", "fotogramma", "帧", "フレーム"),
    *("image", "img", "picture", "filename"),  # pictures, numbered like frames
}
_MEDIA_WORDS = {"video", "media", "film", "movie", "clip", "presentation", "playback", "pts"}
# Of when a frame was worked on, not of the frame.
_WALL_WORDS = {
    *("system", "sys", "wall", "unix", "epoch", "utc", "host", "cpu", "server", "local", "now"),
    *("process", "processing", "processed", "received", "receive", "arrival", "log", "logged"),
}
_SCALE_WORDS = {"timescale", "timebase"}
_UNIX = "tv"  # before the parts of a time of Unix, `tv_sec` and `tv_usec`
NAMED_TIMES = 2  # the rank of columns whose names surely mean times
UNIT_ALONE = 3  # the rank of columns that are called by a unit
NUMBERED = 4  # the rank of columns that number frames or pictures
NO_TIMES = 9  # the rank of columns that have none


def words(name: str) -> list[str]:
    """The words of a name, in lower case."""
    name = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name)
    return [word.lower() for word in re.split(r"[\W_]+", name) if word]


def rank(name: str) -> int:
    """How likely a column has times by its name: 0 most, `NO_TIMES` if it is no candidate."""
    found = {*words(name), name.strip().lower()}
    unit = not found.isdisjoint(UNIT_WORDS)
    if not found.isdisjoint(_STEP_WORDS):
        return 6
    if "timecode" in found:
        return 0
    if is_scale(name):
        return 7
    if not found.isdisjoint(_TIME_WORDS):
        return 1 if unit else NAMED_TIMES
    if unit and not found.isdisjoint(_MEDIA_WORDS):
        return NAMED_TIMES
    if unit and len(found - {_UNIX, name.strip().lower()}) <= 1:
        return UNIT_ALONE
    if not found.isdisjoint(_COUNT_WORDS):
        return NUMBERED
    return NO_TIMES if name else 5


def unit_of(name: str) -> str | None:
    """The unit that a name says, a key of `time_numbers.UNITS`; the last if it says several."""
    return next((UNIT_WORDS[word] for word in reversed(words(name)) if word in UNIT_WORDS), None)


def names_frames(name: str) -> bool:
    """Whether a name has a word for frames or pictures."""
    return not _COUNT_WORDS.isdisjoint(words(name))


def only_names_frames(name: str) -> bool:
    """Whether a name says that a column numbers frames, and nothing about times."""
    return rank(name) == NUMBERED and unit_of(name) is None


def is_of_media(name: str) -> bool:
    """Whether a column of times says that it has those of the film's frames."""
    found = {*words(name)}
    return bool(found & _MEDIA_WORDS) or (names_frames(name) and bool(found & _TIME_WORDS))


def is_of_wall(name: str) -> bool:
    """Whether a column of times says that it has those of a clock on a wall."""
    return not _WALL_WORDS.isdisjoint(words(name))


def is_scale(name: str) -> bool:
    """Whether a column of this name says how many units of a time make a second."""
    found = words(name)
    return not _SCALE_WORDS.isdisjoint([*found, "".join(found[-2:])])


def stem(name: str) -> str:
    """A name without the words for units: the same for the parts of a time."""
    return " ".join(word for word in words(name) if word not in UNIT_WORDS)


def counts_steps(name: str) -> bool:
    """Whether a column of this name has the time since the row before."""
    return not _STEP_WORDS.isdisjoint(words(name))
