"""The blend shapes that Azure's text to speech gives with a voice, saved as JSON.

Each viseme event has `{"FrameIndex": 0, "BlendShapes": [[55 numbers], ...]}`, at 60 frames a
second; a file holds one of them, a list, or one per line. The numbers have no names: the order is
that of Microsoft's page "Get facial position with viseme" (learn.microsoft.com), ARKit's 52 shapes
and three angles.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.formats.json_rate import frame_rate
from faceedit_app.formats.json_take import JsonFrames, json_take
from faceedit_app.formats.json_text import JsonText, as_list, as_object, looks_like_json, read_json
from faceedit_app.formats.take import Take

FORMAT = "Azure speech JSON"
_RATE = 60.0
_EVENT = re.compile(
    rb'"FrameIndex"\s*:\s*"?\d+"?\s*,\s*"BlendShapes"\s*:\s*\[|'
    rb'"BlendShapes"\s*:\s*\[\s*\[[-+\d.eE,\s]*\][^{]*"FrameIndex"',
    re.IGNORECASE,
)
_DEEPEST = 4
_MOST_FRAMES = 24 * 3600 * 60


def _in_order() -> tuple[str, ...]:
    """The 55 names: as `ARKIT_CHANNELS`, but left before right for jaw and mouth."""
    names = list(ARKIT_CHANNELS)
    for left, right in (("jawLeft", "jawRight"), ("mouthLeft", "mouthRight")):
        a, b = sorted((names.index(left), names.index(right)))
        names[a], names[b] = left, right
    return (*names, "headRoll", "leftEyeRoll", "rightEyeRoll")


NAMES = _in_order()
"""What each number of a frame is."""


def sniff(content: bytes) -> float:
    """How likely, 0..1, these are events of Azure's speech."""
    return 0.85 if looks_like_json(content) and _EVENT.search(content) else 0.0


def read(path: Path, content: bytes, fps: float | None) -> Take:
    """Open the blend shapes of Azure's speech.

    Raises:
        FileError: it is damaged.
    """
    text = read_json(path, content)
    rows: list[list[Any]] = []
    begin = 0
    for event in _events(text.document, 0):
        first = _first(text, event)
        if begin + first < len(rows):  # the next sentence, which begins at 0 again
            begin = len(rows)
        rows += [[]] * (begin + first - len(rows))
        rows += map(as_list, event["shapes"])
    frames = JsonFrames(NAMES, rows, rate=frame_rate(text, text.document) or _RATE)
    return json_take(text, FORMAT, frames, fps)


def _events(entry: Any, depth: int) -> Iterator[dict[str, Any]]:
    """The events in a document, in its order: `index` and `shapes` of each."""
    if depth > _DEEPEST:
        return
    found = {key.lower(): value for key, value in as_object(entry).items()}
    if isinstance(found.get("blendshapes"), list):
        yield {"index": found.get("frameindex"), "shapes": found["blendshapes"]}
        return
    for inner in [*found.values(), *as_list(entry)]:
        if isinstance(inner, dict | list):
            yield from _events(inner, depth + 1)


def _first(text: JsonText, event: dict[str, Any]) -> int:
    number = text.number(event["index"])
    if number is None:
        raise text.error('has "BlendShapes" without a "FrameIndex"')
    if not 0 <= number <= _MOST_FRAMES:
        raise text.error(f'has {number:g} as its "FrameIndex"')
    return int(number)
