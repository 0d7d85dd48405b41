"""JSON of webcam recorders on MediaPipe: per frame a time and a score for each blendshape.

`[{"timestamp": epoch ms, "blendshapes": [{"name": "jawOpen", "score": 0.1}, ...]}, ...]`, or
`{"data": [{"value": {"timestamp": ISO 8601, "blendShapes": {"jawOpen": 0.1, ...}}}, ...]}`.
`_neutral`, which is not a shape, is carried.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from faceedit_app.formats.json_take import JsonFrames, json_take
from faceedit_app.formats.json_text import as_list, as_object, looks_like_json, read_json
from faceedit_app.formats.take import Take

FORMAT = "MediaPipe JSON"
_FRAME = re.compile(rb'"blend[sS]hapes"\s*:\s*[\[{]')
_WEIGHTS = ("blendshapes", "blendShapes")
_TIMES = ("timestamp", "timestamp_ms", "timestampMs", "time")
_NAMES = ("name", "categoryName")


def sniff(content: bytes) -> float:
    """How likely, 0..1, this is a recording of MediaPipe's categories."""
    return 0.7 if looks_like_json(content) and _FRAME.search(content) else 0.0


def read(path: Path, content: bytes, fps: float | None) -> Take:
    """Open a recording of MediaPipe's categories.

    Raises:
        RateNeeded: it has no times, and `fps` is None.
        FileError: it is damaged.
    """
    text = read_json(path, content)
    document = text.document
    entries = as_list(document) or as_list(as_object(document).get("data"))
    entries = entries or as_list(as_object(document).get("frames"))
    found = [as_object(as_object(entry).get("value", entry)) for entry in entries]
    scores = [_scores(_first(frame, _WEIGHTS)) for frame in found]
    names = list(dict.fromkeys(name for frame in scores for name in frame))
    clock = next((name for name in _TIMES if found and name in found[0]), "timestamp")
    times = [frame.get(clock) for frame in found]
    frames = JsonFrames(
        names,
        [[frame.get(name) for name in names] if frame else [] for frame in scores],
        times if None not in times else (),
        clock,
    )
    return json_take(text, FORMAT, frames, fps)


def _scores(entry: Any) -> Mapping[str, Any]:
    """The scores of a frame by name."""
    if isinstance(entry, dict):
        return entry
    categories = [as_object(category) for category in as_list(entry)]
    return {str(_first(category, _NAMES)): category.get("score") for category in categories}


def _first(entry: Mapping[str, Any], names: tuple[str, ...]) -> Any:
    return next((entry[name] for name in names if name in entry), None)
