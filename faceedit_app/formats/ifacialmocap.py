"""iFacialMocap's stream, saved as text: one line a frame, whole numbers from 0 to 100.

`mouthSmile_R-0|eyeLookOut_L-12|...|=head#rx,ry,rz,x,y,z|rightEye#rx,ry,rz|leftEye#rx,ry,rz|`; newer
versions write `&` for `-` (ifacialmocap.com). A line may begin with a time; the stream has none.
Rotations are carried.
"""

from __future__ import annotations

import re
from functools import partial
from pathlib import Path

import numpy as np

from faceedit_app.core.errors import FileError
from faceedit_app.core.names import canonical_channel
from faceedit_app.formats.files import BOM, check_text, shown
from faceedit_app.formats.number_spans import WHOLE, SpanSource
from faceedit_app.formats.stated_rate import rate_in_lines, settled
from faceedit_app.formats.take import Recording, Take, finish_take
from faceedit_app.formats.time_columns import text_times
from faceedit_app.formats.timecode import BadTimecode
from faceedit_app.formats.timing import BadRow, NoTimes, Timing
from faceedit_app.formats.weights import PERCENT

FORMAT = "iFacialMocap stream"
_HEAD = 1 << 16
_RATE = 60.0  # frames a second that the phone sends
# From where a word begins: a search in one long word would look at all of it from each letter.
_STREAM = re.compile(rb"\b\w{1,64}[-&]\d{1,3}(?:\.\d+)?\|\w+[-&]\d{1,3}(?:\.\d+)?\|")
_WEIGHT = re.compile(
    rb"(?:^|[|\s,;\]\"'])([A-Za-z_]+)\s*[-&]\s*(-?\d{1,4}(?:\.\d{1,9})?)(?=\s*(?:\||$))"
)
_TIME = re.compile(rb"\[?([\d:;.,T-]*\d)\]?[|,;\s]+\"?(?=[A-Za-z])")
_JSON = re.compile(rb"\s*(?:\{|\[\s*[{\"\[])")
_PARTS = ("head", "rightEye", "leftEye")


def sniff(content: bytes) -> float:
    """How likely, 0..1, this is a stream of iFacialMocap."""
    if b"|" not in content[:_HEAD] or _JSON.match(content.removeprefix(BOM)):
        return 0.0
    found = _STREAM.search(content[:_HEAD])
    names = re.findall(rb"[A-Za-z_]+", found[0]) if found else []
    return 0.9 if any(canonical_channel(name.decode()) for name in names) else 0.0


def read(path: Path, content: bytes, fps: float | None) -> Take:
    """Open a stream.

    Raises:
        RateNeeded: its lines have no times, and `fps` is None.
        FileError: it is damaged.
    """
    check_text(path, content)
    rows: list[dict[str, tuple[int, int]]] = []
    times: list[str] = []
    lines: list[int] = []
    before: list[str] = []
    start = 0
    for number, line in enumerate(content.splitlines(keepends=True), 1):
        text = line.rstrip(b"\r\n")
        weights = _weights(path, text, start, number)
        if not weights and not any(rows):
            before.append(text.decode("utf-8", "replace"))
        elif text.removeprefix(BOM).strip():
            rows.append(weights)
            stamp = _TIME.match(text.removeprefix(BOM).lstrip())
            times.append(stamp[1].decode() if stamp else "")
            lines.append(number)
        start += len(line)
    channels = tuple(dict.fromkeys(channel for row in rows for channel in row))
    for row, number in zip(rows, lines, strict=True):
        missing = next((channel for channel in channels if channel not in row), None)
        if row and missing:
            problem = f"has no {missing}, which other lines have"
            raise FileError(path, problem, "correct it or delete the line", number)
    lost = np.array([not row for row in rows])
    kept = np.flatnonzero(~lost)
    spans = np.array([[rows[t][channel] for channel in channels] for t in kept], np.int64)
    spans = spans.reshape(len(kept), len(channels), 2)
    values = [[float(content[a:b]) for a, b in row] for row in spans.tolist()]
    timing = _timing(path, [times[t] for t in kept], [lines[t] for t in kept])
    recording = Recording(
        path=path,
        format=FORMAT,
        channels=channels,
        values=np.array(values, np.float64).reshape(spans.shape[:2]),
        timing=settled(timing, rate_in_lines(before), kept),
        lost=lost,
        carried=tuple(part for part in _PARTS if part.encode() + b"#" in content),
        scale=PERCENT,
    )
    whole = not any(b"." in content[a:b] for a, b in spans.reshape(-1, 2).tolist())
    source = partial(SpanSource, content, spans, form=WHOLE if whole else None)
    return finish_take(
        recording,
        fps,
        lambda scale: source(scale=scale),
        lambda frame, _: lines[int(kept[frame])],
    )


def _weights(path: Path, text: bytes, start: int, line: int) -> dict[str, tuple[int, int]]:
    """Where the weights of a line are in the file, by channel."""
    found: dict[str, tuple[int, int]] = {}
    for match in _WEIGHT.finditer(text):
        channel = canonical_channel(match[1].decode())
        if channel in found:
            problem = f"has {shown(match[1].decode())} twice"
            raise FileError(path, problem, "write each frame on a line of its own", line)
        if channel is not None:
            found[channel] = (start + match.start(2), start + match.end(2))
    return found


def _timing(path: Path, times: list[str], lines: list[int]) -> Timing | NoTimes:
    if not times or not all(times):
        return NoTimes("is a stream of iFacialMocap, which has no times", _RATE)
    try:
        return text_times(times)
    except NoTimes as none:
        return none
    except (BadTimecode, BadRow) as bad:
        problem = f"begins with {shown(times[bad.row])}, which is not the next time"
        raise FileError(path, problem, "correct it or delete the line", lines[bad.row]) from None
