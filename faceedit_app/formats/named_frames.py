"""JSON with names and frames of weights, as the BEAT data set and LAM_Audio2Expression have it.

`{"names": [N names], "metadata": {"fps": 30.0}, "frames": [{"weights": [N], "time": seconds,
"rotation": []}, ...]}`. Some writers give `frames` as plain lists and `"frame_rate"`, or call the
frames `values`; BEAT itself has times and no rate.
"""

from __future__ import annotations

import re
from pathlib import Path

from faceedit_app.formats.json_take import JsonFrames, json_take
from faceedit_app.formats.json_text import as_list, as_object, looks_like_json, read_json
from faceedit_app.formats.take import Take

FORMAT = "JSON with names and frames"
_NAMES = re.compile(rb'"names"\s*:\s*\[')
_FRAMES = re.compile(rb'"(?:frames|values)"\s*:\s*\[')
_RATES = ("fps", "frame_rate", "frameRate")


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
    places = (document, as_object(document.get("metadata")))
    rates = [text.number(place.get(name)) for place in places for name in _RATES]
    entries = as_list(document.get("frames")) or as_list(document.get("values"))
    weights = [as_object(entry).get("weights", entry) for entry in entries]
    times = [as_object(entry).get("time") for entry in entries]
    frames = JsonFrames(
        as_list(document.get("names")),
        weights,
        times if None not in times else (),
        rate=next((rate for rate in rates if rate is not None), None),
    )
    return json_take(text, FORMAT, frames, fps)
