"""The frame rate that a file states beside its frames: in a comment, a column, or a field.

It is used if the file's times do not show the rate. A number in running text is only proposed.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from faceedit_app.core.arrays import Indices
from faceedit_app.formats.csv_table import Table
from faceedit_app.formats.files import shown
from faceedit_app.formats.rates import SET_RATE, exact_rate, nominal_rate
from faceedit_app.formats.table_ends import lines_before
from faceedit_app.formats.timing import FASTEST, SLOWEST, NoTimes, Timing, format_rate, shown_step

_KINDS = "video|capture|source|camera|export|record(?:ing)?|nominal|avg|r|film|clip|anim(?:ation)?"
_NAME = re.compile(
    rf"(?:{_KINDS})?(?:fps|framerate|framespersecond|framespersec)(?:hz)?"
    r"|bildrate|bildfrequenz|bilderprosek(?:unde)?|imagesparsec(?:onde)?|fotogramasporsegundo",
    re.IGNORECASE,
)
_PERIOD = re.compile(r"(?:frame(?:duration|time|interval|delta)|secondsperframe)(?:ms|s|sec)?")
_NUMBER = r"(\d{1,5}(?:\.\d{1,9})?)(?:\s*/\s*(\d{1,5}))?"
_NAMED = re.compile(
    rf"(?<![a-z])(?:(?:{_KINDS})[ _-]?)?"
    r"(?:fps|frame[ _-]?rate|frames[ _-]?(?:per|/)[ _-]?s(?:ec(?:ond)?)?|bildrate|bildfrequenz"
    r"|(?:bilder (?:pro|je)|images par|fotogramas por|bilder/|images/) ?s[a-z]{0,7})(?![a-z])"
    rf"(?:[\"'\s:=,;]|is\b|\(\w*\))*{_NUMBER}",
    re.IGNORECASE,
)
_LOOSE = re.compile(rf"\brate(?:[\"'\s:=,;]|is\b)*{_NUMBER}", re.IGNORECASE)  # perhaps of the sound
_PROSE = re.compile(rf"{_NUMBER}\s*(?:fps|frames per second|frames/s|hz)\b", re.IGNORECASE)
_VALUE = re.compile(rf"{_NUMBER}(?:\s*(?:fps|hz))?", re.IGNORECASE)
_MARKS = "#/;%!*,\"' \t"  # what comments begin with, and empty cells
_SLOWEST_FILM, _FASTEST_CAMERA = 5.0, 245.0  # frames per second
_WHOLE, _FINE = 0.016, 0.001  # relative error of a period in whole milliseconds, or finer
_BROADCAST = 1.001  # a timecode's second at 23.976 fps and the like, in real seconds
_SAME = 5e-4  # relative difference of rates: less than that of 23.976 and 24
# Decimals after a comma, or another number: `23,976` but not `30, 2`, `30,2,5` or `fps,30,2`.
_COMMA = re.compile(r"(?<![\d.,])(\d{1,3}),(\d{1,3})(?![\d%]|[.,]\d)", re.ASCII)
_LONGEST = 400  # characters of a line of text that may state a rate


@dataclass(frozen=True)
class Stated:
    """A frame rate that a file states.

    Attributes:
        rate: frames per second.
        text: where, as the file has it.
        is_sure: whether it can be used without asking.
    """

    rate: float
    text: str
    is_sure: bool = True

    @property
    def says(self) -> str:
        """The text with the rate, also of a column, whose text is only its name."""
        has_rate = re.search(r"\d", self.text)
        return self.text if has_rate else f"{self.text}: {self.rate:g}"


def names_rate(name: str) -> bool:
    """Whether a column or field with this name holds a frame rate."""
    return _NAME.fullmatch(re.sub(r"[\W_]", "", name)) is not None


def rate_column(names: Sequence[str]) -> int | None:
    """The column that holds a frame rate, or None."""
    return next((k for k, name in enumerate(names) if names_rate(name)), None)


def rate_of(text: str) -> float | None:
    """The rate that a field's text is: `30`, `29.97`, `30000/1001`, `30 fps`."""
    match = _VALUE.fullmatch(text.strip().replace(",", "."))
    return _rate(match) if match else None


def rate_of_period(name: str, value: float) -> float | None:
    """The rate of frames that last `value`, in seconds or milliseconds, in a field of this name."""
    if not _PERIOD.fullmatch(re.sub(r"[\W_]", "", name).lower()) or value <= 0:
        return None
    for second in (1.0, 1000.0):
        if _SLOWEST_FILM <= second / value <= _FASTEST_CAMERA:
            error = _WHOLE if value == int(value) else _FINE
            return nominal_rate(second / value, error) or second / value
    return None


def rate_in_lines(lines: Iterable[str], decimal_comma: bool = False) -> Stated | None:
    """The rate that comments and other lines around a table state; None if they disagree.

    Args:
        decimal_comma: whether a comma between digits is a decimal one, also if it need not be.
    """
    short = (line for line in lines if len(line) <= _LONGEST)
    found = [one for line in short if (one := rate_in_text(line, decimal_comma))]
    sure = [one for one in found if one.is_sure] or found
    return sure[0] if len({one.rate for one in sure}) == 1 else None


def rate_in_text(text: str, decimal_comma: bool = False) -> Stated | None:
    """The rate that a line states; it is sure if it is named, or all that the line says.

    Of `30,60`, which may be two numbers, it is not.
    """
    says = shown(text.strip(_MARKS + "\r\n"))
    if ";" in text or "\t" in text:  # as the separator, so that a comma may be a decimal one
        text = text.replace(",", ".")
    text = _COMMA.sub(lambda match: _with_point(match, decimal_comma), text)
    bare = text.strip(_MARKS + "\r\n")
    matches = [match for match in _NAMED.finditer(text) if _rate(match)]
    named = {_rate(match) or 0.0 for match in matches}
    if len(named) == 1:
        is_sure = not any(_COMMA.match(text, match.start(1)) for match in matches)
        return Stated(named.pop(), says, is_sure)
    loose = (match for form in (_PROSE, _LOOSE) for match in form.finditer(text))
    prose = {rate for match in loose if (rate := _rate(match)) and rate <= _FASTEST_CAMERA}
    if named or len(prose) != 1:
        return None
    return Stated(prose.pop(), says, _PROSE.fullmatch(bare) is not None)


def rate_in_column(name: str, cells: Sequence[str]) -> Stated | None:
    """The rate that a column of this name gives in every row; None if it varies, as measured."""
    rates = {rate_of(cell) for cell in cells}
    rate = rates.pop() if len(rates) == 1 else None
    return Stated(rate, shown(name)) if rate else None


def rate_in_table(table: Table, cells: Callable[[int], Sequence[str]]) -> Stated | None:
    """The rate that a column of a table, or the lines before its header, state.

    Args:
        cells: the texts of the frames in a column.
    """
    column = rate_column(table.names)
    if column is not None:
        return rate_in_column(table.names[column], cells(column))
    return rate_in_lines(lines_before(table), table.delimiter != b",")


def settled(
    timing: Timing | NoTimes, stated: Stated | None, rows: Indices, counts_frames: bool = False
) -> Timing | NoTimes:
    """The timing, at the stated rate if times do not show it; a contradiction is noted.

    Args:
        rows: (T,) the rows of the frames in the file.
        counts_frames: whether the times are a timecode; if it is not drop-frame, it counts 24
            frames in a second also at 23.976 fps.
    """
    if stated is None:
        return timing
    if isinstance(timing, Timing):
        if not stated.is_sure or abs(timing.rate / stated.rate - 1.0) < _SAME:
            return timing
        if counts_frames and abs(timing.rate / stated.rate / _BROADCAST - 1.0) < 1e-4:
            return Timing(timing.times * _BROADCAST, stated.rate, timing.notes)
        note = f'{format_rate(timing.rate)} by its times, although the file says "{stated.says}"'
        note += f"; if the file is right, set that: {SET_RATE}"
        return Timing(timing.times, timing.rate, (*timing.notes, note))
    if not stated.is_sure:
        return NoTimes(timing.problem, stated.rate / timing.step, timing.numbers, timing.step)
    if timing.step != 1:
        return by_frame_numbers(timing, stated.rate, f'the file says "{stated.says}"', rows)
    found = timing.timing_at(stated.rate, rows)
    note = f'{format_rate(stated.rate)}, because the file says "{stated.text}"'
    return Timing(found.times, found.rate, (*found.notes, note))


def by_frame_numbers(numbers: NoTimes, rate: float, says: str, rows: Indices) -> Timing | NoTimes:
    """The timing of rows of which each is some frames after the one before.

    A rate that stands beside such numbers is that of the film whose frames they are.

    Args:
        numbers: those of the frames, `step` of them from row to row.
        rate: of the frames.
        says: where it is from, for the note.
        rows: (T,) the rows of the frames in the file.
    """
    slower = rate / numbers.step
    by = f"{says} and its frame numbers step by {shown_step(numbers.step)}"
    if slower < SLOWEST:
        problem = f"has a row in {1 / slower:.3g} s, because {by}"
        return NoTimes(problem, numbers.rate, numbers.numbers, numbers.step)
    found = numbers.timing_at(slower, rows)
    if numbers.step != round(numbers.step):  # the mean of steps that differ
        slower = nominal_rate(slower, 1 / (found.times[-1] * rate)) or slower
    note = f"{format_rate(slower)}, because {by}; if its rows have the rate that it says"
    return Timing(found.times, slower, (*found.notes[1:], f"{note}, set that: {SET_RATE}"))


def _with_point(match: re.Match[str], decimal_comma: bool) -> str:
    """A number with a point, if its comma is a decimal one: that of 23.976, 29.97, 25.0."""
    number = float(f"{match[1]}.{match[2]}")
    is_rate = number == int(number) or exact_rate(number) != number
    return f"{match[1]}.{match[2]}" if decimal_comma or is_rate else match[0]


def _rate(match: re.Match[str]) -> float | None:
    """The rate of a number or a fraction; None if it cannot be one."""
    rate = float(match[1]) / (float(match[2] or 1) or 1.0)
    return exact_rate(rate) if SLOWEST <= rate <= FASTEST else None
