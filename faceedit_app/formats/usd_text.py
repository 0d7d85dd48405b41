"""The blendshapes of a skeletal animation in USD text (`.usda`).

`blendShapes` names the shapes, and `blendShapeWeights.timeSamples` has their weights by time code,
of which `timeCodesPerSecond` make a second (UsdSkel, openusd.org). Everything else in the file,
such as the head itself, is kept.
"""

from __future__ import annotations

import re
from functools import partial
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from faceedit_app.core.errors import FileError
from faceedit_app.core.names import canonical_channel
from faceedit_app.formats.files import LONGEST_NAME, check_text, shown
from faceedit_app.formats.number_spans import SpanSource
from faceedit_app.formats.rates import unsure
from faceedit_app.formats.take import Recording, Take, finish_take
from faceedit_app.formats.timing import BadRow, NoTimes, Timing, time_rows

FORMAT = "USD animation"
_DEFAULT_CODES = 24.0  # time codes per second, if the file does not say so
_MAGIC = b"#usda"
_ANIMATION = re.compile(rb'\bdef\s+SkelAnimation\s+"')
_NAMES = re.compile(rb"\btoken\[\]\s+blendShapes\s*=\s*\[([^\]]*)\]")
_SAMPLES = re.compile(rb"\bblendShapeWeights\.timeSamples\s*=\s*\{([^}]*)\}")
_SAMPLE = re.compile(rb"([-+\d.eE]+)\s*:\s*(None\b|\[([^\]]*)\])")
_TEXT = re.compile(rb'"([^"]*)"')
_NUMBER = re.compile(rb"[^\s,]+")
_CODES = re.compile(rb"\btimeCodesPerSecond\s*=\s*([-+\d.eE]+)")
_AGAIN = "export it again"

TextSpan = tuple[int, int]


def sniff(content: bytes) -> float:
    """How likely, 0..1, this is USD text with an animation of ARKit's shapes."""
    if not content.startswith(_MAGIC):
        return 0.0
    return 0.95 if any(_names(part) for part, _ in _animations(content)) else 0.0


def read(path: Path, content: bytes, fps: float | None) -> Take:
    """Open the first animation of ARKit's shapes in USD text.

    Raises:
        RateNeeded: its times are unusable, and `fps` is None.
        FileError: it is damaged.
    """
    check_text(path, content)
    found = [(part, start, _names(part)) for part, start in _animations(content)]
    found = [one for one in found if one[2]]
    part, start, names = found[0]
    times, rows = _samples(path, content, part, start, len(names))
    columns = _columns(path, names)
    lost = np.array([not row for row in rows])
    kept = np.flatnonzero(~lost)
    every = np.array([rows[t] for t in kept], np.int64).reshape(len(kept), len(names), 2)
    spans = every[:, list(columns.values())]
    recording = Recording(
        path=path,
        format=FORMAT,
        channels=tuple(columns),
        values=_numbers(path, content, spans),
        timing=_timing(path, content, times[kept]) if len(kept) else NoTimes("has no frames"),
        lost=lost,
        carried=tuple(
            shown(name, LONGEST_NAME) for k, name in enumerate(names) if k not in columns.values()
        ),
        notes=_notes(content),
        unread=_unread(len(found)),
    )
    source = partial(SpanSource, content, spans)
    return finish_take(
        recording,
        fps,
        lambda scale: source(scale=scale),
        lambda frame, k: _line(content, int(spans[frame, k, 0])),
    )


def _animations(content: bytes) -> list[tuple[bytes, int]]:
    """The text of each animation, up to the next one, and where it begins."""
    starts = [match.start() for match in _ANIMATION.finditer(content)]
    return [(content[a:b], a) for a, b in pairwise([*starts, len(content)])]


def _names(part: bytes) -> list[str]:
    """The names of an animation's shapes; none if no weight of ARKit's is animated."""
    match = _NAMES.search(part)
    names = [text.decode("utf-8", "replace") for text in _TEXT.findall(match[1])] if match else []
    is_animated = _SAMPLES.search(part) is not None
    return names if is_animated and any(map(canonical_channel, names)) else []


def _samples(
    path: Path, content: bytes, part: bytes, start: int, width: int
) -> tuple[NDArray[np.float64], list[list[TextSpan]]]:
    """The time codes, and where the weights of each are in the file; none if the face was lost."""
    body = _SAMPLES.search(part)
    assert body is not None  # as sniffed
    times: list[float] = []
    rows: list[list[TextSpan]] = []
    for match in _SAMPLE.finditer(body[1]):
        begin = start + body.start(1) + match.start(3)
        cells = list(_NUMBER.finditer(match[3] or b""))
        if cells and len(cells) != width:
            problem = f"has {len(cells)} weights where {width} shapes are named"
            raise FileError(path, problem, _AGAIN, _line(content, begin))
        times.append(_number(path, content, start + body.start(1) + match.start(1), match[1]))
        rows.append([(begin + cell.start(), begin + cell.end()) for cell in cells])
    if not rows:
        raise FileError(path, "has an animation without time samples", _AGAIN)
    return np.array(times), rows


def _columns(path: Path, names: list[str]) -> dict[str, int]:
    found: dict[str, int] = {}
    for k, name in enumerate(names):
        channel = canonical_channel(name)
        if channel in found:
            raise FileError(path, f'names the channel "{channel}" twice', "remove one of them")
        if channel is not None:
            found[channel] = k
    return found


def _number(path: Path, content: bytes, start: int, text: bytes) -> float:
    """The number that is written at a place of the file."""
    try:
        return float(text)
    except ValueError:
        problem = f'holds "{shown(text.decode("utf-8", "replace"))}", not a number'
        raise FileError(path, problem, _AGAIN, _line(content, start)) from None


def _numbers(path: Path, content: bytes, spans: NDArray[np.int64]) -> NDArray[np.float64]:
    places = spans.reshape(-1, 2).tolist()
    flat = [_number(path, content, start, content[start:end]) for start, end in places]
    values = np.array(flat, np.float64).reshape(spans.shape[:2])
    wrong = np.argwhere(~np.isfinite(values))
    if len(wrong):
        place = int(spans[tuple(wrong[0])][0])
        raise FileError(path, "has a weight that is not finite", _AGAIN, _line(content, place))
    return values


def _timing(path: Path, content: bytes, codes: NDArray[np.float64]) -> Timing | NoTimes:
    try:
        return time_rows(codes / _codes_per_second(path, content))
    except NoTimes as none:
        return none
    except BadRow as bad:
        problem = f"the time code {codes[bad.row]:g} does not come after {codes[bad.row - 1]:g}"
        raise FileError(path, problem, _AGAIN) from None


def _codes_per_second(path: Path, content: bytes) -> float:
    match = _CODES.search(content)
    found = _number(path, content, match.start(1), match[1]) if match else 0.0
    return found if found > 0 else _DEFAULT_CODES


def _notes(content: bytes) -> tuple[str, ...]:
    if _CODES.search(content):
        return ()
    note = "the file does not say how many time codes make a second"
    return (unsure(f"{note}: {_DEFAULT_CODES:g} are assumed, as is usual in USD"),)


def _unread(animations: int) -> tuple[str, ...]:
    note = f"{animations} animations have ARKit's shapes: the first is read"
    return (note,) if animations > 1 else ()


def _line(content: bytes, place: int) -> int:
    return content.count(b"\n", 0, place) + 1
