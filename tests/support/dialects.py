"""How tools write the time of a frame into a timecode: one function a dialect.

Each gives the text for frame n of a take at a rate, for takes that begin at second 0.
"""

from __future__ import annotations

from collections.abc import Callable

_EPSILON = 1e-6  # frames; keeps whole ones whole


def clock(seconds: float) -> str:
    """`HH:MM:SS` of a time of day."""
    whole = int(seconds) % 86_400
    return f"{whole // 3600:02d}:{whole // 60 % 60:02d}:{whole % 60:02d}"


def _at(n: int, rate: float) -> float:
    return (n + _EPSILON) / rate


def whole_frames(n: int, rate: float) -> str:
    """`HH:MM:SS:FF`."""
    return f"{clock(_at(n, rate))}:{int((n + _EPSILON) % rate):02d}"


def running_number(n: int, rate: float) -> str:
    """`HH:MM:SS:FF.nnn` with the number of the frame, from 1."""
    return f"{whole_frames(n + 1, rate)}.{(n + 1) % 1000:03d}"


def milliseconds(n: int, rate: float) -> str:
    """`HH:MM:SS:mmm`."""
    return f"{clock(_at(n, rate))}:{int(_at(n, rate) % 1 * 1000):03d}"


def rounded_milliseconds(n: int, rate: float) -> str:
    """`HH:MM:SS:mmm`, rounded to the nearest."""
    seconds, part = divmod(round(n / rate * 1000), 1000)
    return f"{clock(seconds)}:{part:03d}"


def milliseconds_of_the_second(n: int, rate: float) -> str:
    """`HH:MM:SS:FF.mmm`."""
    return f"{whole_frames(n, rate)}.{int(_at(n, rate) % 1 * 1000):03d}"


def seconds_with_milliseconds(n: int, rate: float) -> str:
    """`HH:MM:SS.mmm`."""
    return f"{clock(_at(n, rate))}.{int(_at(n, rate) % 1 * 1000):03d}"


def sixtieths(n: int, rate: float) -> str:
    """`HH:MM:SS:FF.FFF` as `%06.3f` of sixtieths of a second, which can print 60.000."""
    seconds = n / rate
    return f"{clock(seconds)}:{seconds % 1 * 60:06.3f}"


def drop_frame(n: int, separator: str = ";") -> str:
    """SMPTE drop-frame timecode of 29.97 fps: frames 0 and 1 of most minutes are left out."""
    tens, rest = divmod(n, 17_982)
    number = n + 18 * tens + (2 * ((rest - 2) // 1798) if rest > 1 else 0)
    return f"{clock(number // 30)}{separator}{number % 30:02d}"


DIALECTS: dict[str, Callable[[int, float], str]] = {
    "whole frames": whole_frames,
    "running number": running_number,
    "milliseconds": milliseconds,
    "rounded milliseconds": rounded_milliseconds,
    "milliseconds of the second": milliseconds_of_the_second,
    "seconds with milliseconds": seconds_with_milliseconds,
    "sixtieths": sixtieths,
}
