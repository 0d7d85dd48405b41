"""Write a clip with other frames than a CSV has, in the style of that CSV.

Its separator, decimal sign, names, scale, digits, line ends and the base of its timecode are kept,
and the text of each number that is the one of the row it comes from.
Times that are neither timecodes nor numbers become seconds, and columns that are no channels are
left out. Rows without a face keep their cells in the columns that are left, and get new times.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from faceedit_app.core.arkit import ROTATION_INDEX
from faceedit_app.core.arrays import Floats, Indices, Times
from faceedit_app.core.clip import Clip
from faceedit_app.formats.csv_source import CsvSource, bare
from faceedit_app.formats.encodings import RecodedSource
from faceedit_app.formats.faceless import Faceless
from faceedit_app.formats.files import BOM, LONGEST_NAME, shown
from faceedit_app.formats.lost_faces import CONFIDENCE, confidence_cells, is_count
from faceedit_app.formats.numbers import shortest
from faceedit_app.formats.rotations import DEGREES, in_degrees
from faceedit_app.formats.take import Source
from faceedit_app.formats.timecode import start_of_day
from faceedit_app.formats.timecode_style import TimecodeStyle, style_of

_SECONDS = b"time_s"
_IN_SECONDS = "its times are now seconds, as time_s"
_IN_SIXTIETHS = "its timecode now is HH:MM:SS:FF.sss with 60 frames a second"
_IN_THOUSANDTHS = "its timecode now has thousandths of a frame, because times lie between frames"


@dataclass(frozen=True)
class Styled:
    """A file in the style of another one.

    Attributes:
        content: of the file.
        note: what of the style could not be kept; "" if all was.
        kept: the columns that are no channels and are kept all the same.
    """

    content: bytes
    note: str = ""
    kept: tuple[str, ...] = ()


@dataclass(frozen=True)
class _Column:
    """A column to write.

    Attributes:
        place: in the file whose style is kept; -1 to stand first, a large number to stand last.
        name: with its quotes.
        cells: (T) of the rows.
        numbers: (T,) that the cells stand for, if the file has them at `place`.
        scale: what the file has for a number of 1.
    """

    place: int
    name: bytes
    cells: Sequence[bytes]
    numbers: Floats | None = None
    scale: float = 1.0


@dataclass(frozen=True)
class _Clock:
    """How times are written.

    Attributes:
        place: as in `_Column`.
        name: of the column.
        text: the cell of a time, seconds from the first frame.
        note: what could not be kept; "" if all was.
    """

    place: int
    name: bytes
    text: Callable[[float], bytes]
    note: str = ""


def has_style(source: Source, clip: Clip) -> bool:
    """Whether a clip can be written in the style of a source's file: a CSV with these channels."""
    if isinstance(source, RecodedSource):
        return has_style(source.source, clip)
    return isinstance(source, CsvSource) and len(source.columns) == len(clip.channels)


def write_like(
    source: Source, clip: Clip, frames: Indices, faceless: Faceless | None = None
) -> Styled | None:
    """A clip in the style of a source's file; None if it is no CSV with these channels.

    Args:
        frames: (T,) the frame of the source that each frame of the clip is, or is made of. A cell
            with the number of that frame keeps its text.
        faceless: the rows of the source without a face that are written as well.
    """
    if isinstance(source, RecodedSource):
        found = write_like(source.source, clip, frames, faceless)
        if found is None:
            return None
        return replace(found, content=found.content.decode().encode(source.encoding))
    if not isinstance(source, CsvSource) or not has_style(source, clip):
        return None
    table = source.table
    names = table.cells(table.header)
    clock = _clock(source, clip, names, faceless)
    times = _Column(clock.place, clock.name, [clock.text(time) for time in clip.times.tolist()])
    columns = [times, *_weights(source, clip, names), *_rotations(source, clip, names)]
    if source.flag is not None and is_count(table.names[source.flag]):
        count = str(len(columns) - 1).encode()
        columns.append(_Column(source.flag, names[source.flag], [count] * len(clip)))
    if clip.confidence is not None:
        sure = [
            cell.encode().replace(b".", table.decimal) for cell in confidence_cells(clip.confidence)
        ]
        own = source.confidence
        name = CONFIDENCE.encode() if own is None else names[own]
        place, numbers = (len(names), None) if own is None else (own, clip.confidence)
        columns.append(_Column(place, name, sure, numbers))
    kept: tuple[str, ...] = ()
    if faceless and source.flag is not None and source.flag not in [c.place for c in columns]:
        # Nothing else may say which rows have a face.
        flags = [table.cells(source.lines[frame])[source.flag] for frame in frames.tolist()]
        columns.append(_Column(source.flag, names[source.flag], flags))
        kept = (shown(table.names[source.flag], LONGEST_NAME),)
    columns.sort(key=lambda column: column.place)
    head = [column.name.removeprefix(BOM) for column in columns]
    first = table.lines[table.header]
    end = first[len(first.rstrip(b"\r\n")) :] or b"\n"
    mark = BOM if table.lines[0].startswith(BOM) else b""
    rows = list(_rows(source, columns, frames))
    if faceless:
        rows += _faceless_rows(source, columns, columns.index(times), clock, faceless)
        order = np.argsort(np.concatenate([clip.times, faceless.times]), kind="stable")
        rows = [rows[k] for k in order.tolist()]
    lines = (table.delimiter.join(cells) + end for cells in (head, *rows))
    return Styled(mark + b"".join(lines), clock.note, kept)


def _rows(source: CsvSource, columns: Sequence[_Column], frames: Indices) -> Iterator[list[bytes]]:
    """The cells of each row."""
    table, scales = source.table, np.array([column.scale for column in columns])
    nothing = np.full(len(frames), np.nan, np.float32)
    numbers = [nothing if column.numbers is None else column.numbers for column in columns]
    known = [k for k, column in enumerate(columns) if column.numbers is not None]
    new = zip(*(column.cells for column in columns), strict=True)
    last = -1
    for frame, wanted, cells in zip(frames.tolist(), np.stack(numbers, axis=1), new, strict=True):
        if frame != last:  # at a higher rate, several are made of one
            last, texts = frame, table.cells(source.lines[frame])
            found = np.full(len(columns), np.nan)
            for k in known:
                text = bare(texts[columns[k].place]).replace(table.decimal, b".")
                found[k] = float(text or b"nan")
            found = (found / scales).astype(np.float32)
        # As they are read; the text may have more digits than single precision keeps.
        row = list(cells)
        for k in np.flatnonzero(found == wanted).tolist():
            row[k] = texts[columns[k].place]
        yield row


def _faceless_rows(
    source: CsvSource, columns: Sequence[_Column], times: int, clock: _Clock, faceless: Faceless
) -> Iterator[list[bytes]]:
    """The cells of each row without a face; a row that ends early still does.

    Args:
        times: which of the columns has the times.
    """
    for number, time in zip(faceless.rows.tolist(), faceless.times.tolist(), strict=True):
        own = source.table.cells(source.lost[number])
        count = max(sum(column.place < len(own) for column in columns), times + 1)
        row = [own[c.place] if c.place < len(own) else b"" for c in columns[:count]]
        row[times] = clock.text(time)
        yield row


def _weights(source: CsvSource, clip: Clip, names: Sequence[bytes]) -> list[_Column]:
    write, sign = source.writer(source.columns, source.scale), b"%" if source.table.percent else b""
    numbers = (shortest(clip.weights) * source.scale).T.tolist()
    return [
        _Column(place, names[place], [write(number) + sign for number in row], own, source.scale)
        for place, row, own in zip(source.columns, numbers, clip.weights.T, strict=True)
    ]


def _rotations(source: CsvSource, clip: Clip, names: Sequence[bytes]) -> list[_Column]:
    """The rotations of the clip; those that the file has no columns for stand after all others."""
    if clip.rotations is None:
        return []
    own, columns = source.turns, []
    alike = {
        unit: [place for name, place in own.items() if source.turn_unit(name) == unit]
        for unit in map(source.turn_unit, own)
    }
    writers = {unit: source.writer(places, unit) for unit, places in alike.items()}
    for name in clip.rotation_names:
        numbers = clip.rotations[:, ROTATION_INDEX[name]]
        if name in own:
            place, unit = own[name], source.turn_unit(name)
            written = in_degrees(numbers) if unit == DEGREES else numbers
            cells = [writers[unit](number) for number in written.tolist()]
            columns.append(_Column(place, names[place], cells, numbers, unit))
        else:
            texts = (f"{number:.6f}".encode() for number in numbers.tolist())
            cells = [text.replace(b".", source.table.decimal) for text in texts]
            columns.append(_Column(len(names), name.encode(), cells))
    return columns


def _clock(
    source: CsvSource, clip: Clip, names: Sequence[bytes], faceless: Faceless | None
) -> _Clock:
    """How the times are written; seconds begin with the first row."""
    decimal = source.table.decimal
    place = source.seconds
    if source.clock is not None and clip.timecodes:
        style, note = style_of(source.texts(source.clock)), ""
        seconds: Times = start_of_day(clip.timecodes) + clip.times
        if style is None:
            style, note = TimecodeStyle(), _IN_SIXTIETHS
        elif not style.fits(seconds):
            style, note = style.finer(), _IN_THOUSANDTHS
        day, form = start_of_day(clip.timecodes), style
        return _Clock(
            source.clock, names[source.clock], lambda time: form.text(day + time).encode(), note
        )
    if source.ticks is not None:
        place, ticks = source.ticks
        first = source.texts(place)[0]
        digits, begin = len(first.partition(".")[2]), float(first)
        return _Clock(
            place,
            names[place],
            lambda time: f"{begin + time * ticks:.{digits}f}".encode().replace(b".", decimal),
        )
    lead = -min(float(faceless.times[0]), 0.0) if faceless else 0.0

    def seconds_of(time: float) -> bytes:
        return f"{lead + time:.6f}".encode().replace(b".", decimal)

    if place is None:
        return _Clock(-1, _SECONDS, seconds_of, _IN_SECONDS)
    return _Clock(place, names[place], seconds_of)
