"""JSON of webcam recorders on MediaPipe: per frame a time and a score for each blendshape.

`[{"timestamp": epoch ms, "blendshapes": [{"name": "jawOpen", "score": 0.1}, ...]}, ...]`,
`{"data": [{"value": {"timestamp": ISO 8601, "blendShapes": {"jawOpen": 0.1, ...}}}, ...]}`, or
a list of MediaPipe's own results, `{"faceBlendshapes": [{"categories": [...]}]}`.
`_neutral`, which is not a shape, is carried.
"""

from __future__ import annotations

import re
from pathlib import Path

from faceedit_app.formats.json_text import looks_like_json
from faceedit_app.formats.named_weights import read_named
from faceedit_app.formats.take import Take

FORMAT = "MediaPipe JSON"
_FRAME = re.compile(
    rb'"(?:face_?blend_?shapes|categories)"\s*:\s*[\[{]'
    rb'|"blend_?shapes"\s*:\s*\[\s*\{[^{}]*"score"|"value"\s*:\s*\{[^{}]*"blend_?shapes"\s*:\s*\{',
    re.IGNORECASE,
)


def sniff(content: bytes) -> float:
    """How likely, 0..1, this is a recording of MediaPipe's categories."""
    return 0.7 if looks_like_json(content) and _FRAME.search(content) else 0.0


def read(path: Path, content: bytes, fps: float | None) -> Take:
    """Open a recording of MediaPipe's categories.

    Raises:
        RateNeeded: it has no times, and `fps` is None.
        FileError: it is damaged.
    """
    return read_named(path, content, fps, FORMAT)
