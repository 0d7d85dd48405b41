"""JSON with names and frames of weights, as the BEAT data set and LAM_Audio2Expression have it.

`{"names": [N names], "metadata": {"fps": 30.0}, "frames": [{"weights": [N], "time": seconds,
"rotation": []}, ...]}`. Some writers give `frames` as plain lists and `"frame_rate"`, or call the
frames `values`; BEAT itself has times and no rate.
"""

from __future__ import annotations

import re
from pathlib import Path

from faceedit_app.core.names import naming_of
from faceedit_app.formats.json_beside import beside
from faceedit_app.formats.json_rate import frame_rate
from faceedit_app.formats.json_take import JsonFrames, json_take
from faceedit_app.formats.json_text import as_list, as_object, looks_like_json, read_json
from faceedit_app.formats.take import Take

FORMAT = "JSON with names and frames"
_NAMES = re.compile(rb'"(?:names|blend_?shape_?names)"\s*:\s*\[', re.IGNORECASE)
_FRAMES = re.compile(rb'"(?:frames|values|weights|blend_?shape_?weights)"\s*:\s*\[', re.IGNORECASE)
_NAME_KEYS = {"names", "blendshapenames"}
_FRAME_KEYS = ("frames", "values", "blendshapeweights", "weights")
_TIME_KEYS = ("times", "time", "timestamps", "timecodes")


def sniff(content: bytes) -> float:
    """How likely, 0..1, this is a file of names and frames."""
    if not looks_like_json(content):
        return 0.0
    return 0.8 if _NAMES.search(content) and _FRAMES.search(content) else 0.0


def read(path: Path, content: bytes, fps: float | None) -> Take:
    """Open a file of names and frames.

    Raises:
        RateNeeded: it has neither times nor a rate, and `fps` is None.
        FileError: it is damaged.
    """
    text = read_json(path, content)
    document = as_object(text.document)
    lists = {name.replace("_", "").lower(): entry for name, entry in document.items() if entry}
    entries = next((as_list(lists[key]) for key in _FRAME_KEYS if key in lists), [])
    others = beside(entries, lambda key, value: key == "weights")
    weights = [as_object(entry).get("weights", entry) for entry in entries]
    if others.turns:
        rows = zip(entries, map(as_list, weights), strict=True)
        weights = [[*row, *others.row(entry)] if row else [] for entry, row in rows]
    times = [as_object(entry).get("time") for entry in entries]
    if None in times:
        times = next((as_list(lists[key]) for key in _TIME_KEYS if key in lists), [])
    names = next((as_list(lists[key]) for key in _NAME_KEYS if key in lists), [])
    known = (*_FRAME_KEYS, *_TIME_KEYS, *_NAME_KEYS)
    lists_beside = (
        key
        for key, value in document.items()
        if key.replace("_", "").lower() not in known and len(as_list(value)) == len(entries) > 1
    )
    frames = JsonFrames(
        [*names, *others.turns],
        weights,
        times if len(times) == len(entries) else (),
        rate=frame_rate(text, document),
        naming=naming_of(name for name in names if isinstance(name, str)),
        beside=(*others.keys, *lists_beside),
    )
    return json_take(text, FORMAT, frames, fps)
