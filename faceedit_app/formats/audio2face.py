"""NVIDIA Audio2Face JSON: names, a matrix of weights, and the frames per second.

`{"exportFps": 60, "trackPath": "….wav", "numFrames": T, "facsNames": [N names], "weightMat":
[[N weights] x T]}`, indented or on one line; joints and rotations, if any, are carried. FaceEdit
adds `"confidence"`, a list of T numbers, to takes of films; Audio2Face's importers look for their
own keys only.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.clip import Clip
from faceedit_app.formats.json_rate import frame_rate
from faceedit_app.formats.json_take import JsonFrames, json_take
from faceedit_app.formats.json_text import as_list, as_object, looks_like_json, read_json
from faceedit_app.formats.lost_faces import CONFIDENCE
from faceedit_app.formats.take import Take

FORMAT = "Audio2Face JSON"
_NAMES = ("facsNames", "poseNames", "blendShapeNames")
_READ = (*_NAMES, "weightMat", "timeCodes", CONFIDENCE)


def sniff(content: bytes) -> float:
    """How likely, 0..1, this is an Audio2Face export of blendshapes."""
    if not looks_like_json(content) or b'"weightMat"' not in content:
        return 0.0
    return 0.95 if any(f'"{name}"'.encode() in content for name in _NAMES) else 0.0


def read(path: Path, content: bytes, fps: float | None) -> Take:
    """Open an Audio2Face export.

    Raises:
        RateNeeded: it does not give its frame rate, and `fps` is None.
        FileError: it is damaged.
    """
    text = read_json(path, content)
    document = as_object(text.document)
    rows = as_list(document.get("weightMat"))
    said = text.number(document.get("numFrames"))
    wrong = (
        () if said in (None, len(rows)) else (f"numFrames says {said:g}, there are {len(rows)}",)
    )
    frames = JsonFrames(
        next((as_list(document[name]) for name in _NAMES if name in document), []),
        rows,
        as_list(document.get("timeCodes")),
        rate=frame_rate(text, document),
        notes=wrong,
        sure=as_list(document.get(CONFIDENCE)),
        beside=tuple(key for key, value in document.items() if key not in _READ and as_list(value)),
    )
    return json_take(text, FORMAT, frames, fps)


def is_plain(content: bytes, clip: Clip) -> bool:
    """Whether Audio2Face's importers, which believe the counts, find a clip in an export."""
    try:
        document = as_object(json.loads(content.decode("utf-8-sig")))
    except ValueError:
        return False
    counts = {"numFrames": len(clip), "numPoses": len(as_list(document.get("facsNames")))}
    return all(document.get(key, count) == count for key, count in counts.items())


def write(clip: Clip) -> bytes:
    """A clip as an export of all 52 shapes; the format has no times, so frames must be even."""
    weights = np.round(clip.arkit_weights().astype(np.float64), 6)
    document: dict[str, Any] = {
        "exportFps": int(clip.rate) if clip.rate == int(clip.rate) else clip.rate,
        "trackPath": "",
        "numPoses": len(ARKIT_CHANNELS),
        "numFrames": len(clip),
        "facsNames": list(ARKIT_CHANNELS),
        "weightMat": weights.tolist(),
    }
    if clip.confidence is not None:
        document[CONFIDENCE] = np.round(clip.confidence.astype(np.float64), 3).tolist()
    return json.dumps(document, indent=1).encode()
