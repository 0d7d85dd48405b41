"""Write a clip with other frames than a CSV has, in the style of that CSV.

Its separator, decimal sign, names, scale, digits and line ends are kept; its times become seconds,
and columns that are no channels are left out.
"""

from __future__ import annotations

from faceedit_app.core.clip import Clip
from faceedit_app.formats.csv_source import CsvSource
from faceedit_app.formats.csv_take import confidence_cells
from faceedit_app.formats.encodings import RecodedSource
from faceedit_app.formats.files import BOM
from faceedit_app.formats.lost_faces import CONFIDENCE
from faceedit_app.formats.numbers import shortest
from faceedit_app.formats.take import Source

_SECONDS = b"time_s"


def write_like(source: Source, clip: Clip) -> bytes | None:
    """A clip in the style of a source's file; None if it is no CSV with these channels."""
    if isinstance(source, RecodedSource):
        found = write_like(source.source, clip)
        return None if found is None else found.decode().encode(source.encoding)
    if not isinstance(source, CsvSource) or len(source.columns) != len(clip.channels):
        return None
    table, write = source.table, source.writer()
    first = table.lines[table.header]
    names = table.cells(table.header)
    sign = b"%" if table.percent else b""
    head = [_SECONDS if source.seconds is None else names[source.seconds]]
    head += [names[column] for column in source.columns]
    rows = [
        [_time(time, table.decimal), *(write(weight * source.scale) + sign for weight in row)]
        for time, row in zip(clip.times.tolist(), shortest(clip.weights).tolist(), strict=True)
    ]
    if clip.confidence is not None:
        head.append(CONFIDENCE.encode())
        for cells, sure in zip(rows, confidence_cells(clip.confidence), strict=True):
            cells.append(sure.encode().replace(b".", table.decimal))
    end = first[len(first.rstrip(b"\r\n")) :] or b"\n"
    mark = BOM if table.lines[0].startswith(BOM) else b""
    head[0] = head[0].removeprefix(BOM)
    return mark + b"".join(table.delimiter.join(cells) + end for cells in (head, *rows))


def _time(seconds: float, decimal: bytes) -> bytes:
    return f"{seconds:.6f}".encode().replace(b".", decimal)
