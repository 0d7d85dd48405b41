"""JSON of any layout with ARKit's names opens, and an export changes the edited number alone."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support import recordings

from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.errors import FileError
from faceedit_app.formats.opening import open_take, write_take
from faceedit_app.formats.registry import find_format
from faceedit_app.formats.timing import RateNeeded

WEIGHTS = recordings.face()
ROWS: list[list[float]] = WEIGHTS.tolist()
NAMES = list(ARKIT_CHANNELS)


def rows(frame: Callable[[int, dict[str, float]], Any]) -> list[Any]:
    return [frame(n, dict(zip(ARKIT_CHANNELS, row, strict=True))) for n, row in enumerate(ROWS)]


def categories(weights: dict[str, float], name: str = "categoryName") -> list[dict[str, Any]]:
    return [
        {"index": k, "score": value, name: channel, "displayName": ""}
        for k, (channel, value) in enumerate(weights.items())
    ]


SERIES = {name: [row[k] for row in ROWS] for k, name in enumerate(ARKIT_CHANNELS)}
TIMES = [n / 30 for n in range(len(ROWS))]
# All are at 30 fps.
LAYOUTS: dict[str, Any] = {
    "MediaPipe's results": rows(
        lambda n, w: {
            "timeMs": n * 100 // 3,
            "faceBlendshapes": [{"categories": categories(w)}],
        }
    ),
    "MediaPipe's results in Python": {
        "fps": 30,
        "frames": rows(
            lambda n, w: {"frame": n, "face_blendshapes": [categories(w, "category_name")]}
        ),
    },
    "categories": rows(lambda n, w: {"timestamp": n * 100 // 3, "categories": categories(w)}),
    "flat rows": rows(lambda n, w: {"time": n / 30, **w}),
    "frames by number": {
        "frameRate": 30,
        "data": dict(rows(lambda n, w: (str(n), w))),
    },
    "rows in a section": {"meta": {"fps": "30"}, "take": {"samples": rows(lambda n, w: w)}},
    "deep rows": rows(lambda n, w: {"face": {"t": n / 30, "weights": {"arkit": w}}}),
    "a list per channel": {"time": TIMES, **SERIES},
    "lists per channel in a section": {"fps": 30, "curves": SERIES},
    "a list of channels": {
        "frame_rate": 30,
        "tracks": [{"name": name, "values": values} for name, values in SERIES.items()],
    },
    "tracks of three.js": [
        {
            "name": "clip",
            "tracks": [
                {"name": f"head.morphTargetInfluences[{name}]", "times": TIMES, "values": values}
                for name, values in SERIES.items()
            ],
        }
    ],
    "timecodes": rows(lambda n, w: {"timecode": f"01:00:{n // 30:02d}:{n % 30:02d}", "face": w}),
    "names and lists of numbers": {
        "fps": 30,
        "blendshapes": NAMES,
        "result": [
            {"timeCode": time, "shapes": row} for time, row in zip(TIMES, ROWS, strict=True)
        ],
    },
    "Audio2Face with poseNames": {"exportFps": 30, "poseNames": NAMES, "weightMat": ROWS},
    "Audio2Face with a rate in text": {"exportFps": "30", "facsNames": NAMES, "weightMat": ROWS},
    "blendShapeNames": {"fps": 30, "blendShapeNames": NAMES, "blendShapeWeights": ROWS},
    "names, frames and times": {"names": NAMES, "frames": ROWS, "times": TIMES},
    "weights as texts": rows(
        lambda n, w: {"time": f"{n / 30:.4f}", "face": {c: str(v) for c, v in w.items()}}
    ),
    "lists of texts": {"names": NAMES, "fps": "30", "frames": [list(map(str, r)) for r in ROWS]},
    "names and numbers in turn, as Swift writes": rows(
        lambda n, w: {
            "timestamp": 5000.25 + n / 30,
            "blendShapes": [x for e in w.items() for x in e],
        }
    ),
    "pairs": rows(lambda n, w: {"t": n / 30, "shapes": list(w.items())}),
    "k and v": rows(
        lambda n, w: {
            "Timestamp": 1_652_000_000_000 + n * 100 // 3,
            "FaceFound": True,
            "Rotation": {"x": 1.5, "y": 2, "z": 3},
            "BlendShapes": [{"k": c[0].upper() + c[1:], "v": v} for c, v in w.items()],
        }
    ),
    "parameters of a message": rows(
        lambda n, w: {
            "timestamp": 1_652_000_000_000 + n * 100 // 3,
            "data": {"parameterValues": [{"id": c, "value": v} for c, v in w.items()]},
        }
    ),
    "an object per weight": rows(
        lambda n, w: {"time": n / 30, "face": {c: {"value": v, "min": 0} for c, v in w.items()}}
    ),
    "weights by region": rows(
        lambda n, w: {
            "time": n / 30,
            "eyes": {c: v for c, v in w.items() if c.startswith("eye")},
            "others": {c: v for c, v in w.items() if not c.startswith("eye")},
        }
    ),
    "weights by side": rows(
        lambda n, w: {
            "time": n / 30,
            **{c: v for c, v in w.items() if not c.endswith(("Left", "Right"))},
            "left": {c[:-4]: v for c, v in w.items() if c.endswith("Left")},
            "right": {c[:-5]: v for c, v in w.items() if c.endswith("Right")},
        }
    ),
    "frames by time": dict(rows(lambda n, w: (f"{n / 30:.4f}", w))),
    "frames by milliseconds": dict(rows(lambda n, w: (str(n * 100 // 3), w))),
    "frames by timecode": dict(rows(lambda n, w: (f"01:00:{n // 30:02d}:{n % 30:02d}", w))),
    "frames by number, sorted as texts": {
        "sampleRate": 30,
        "frames": dict(sorted(rows(lambda n, w: (str(n), w)))),
    },
    "an entry per weight": [
        {"time": n / 30, "channel": c, "value": v}
        for n, row in enumerate(ROWS)
        for c, v in zip(NAMES, row, strict=True)
    ],
    "an entry per weight, by channel": {
        "fps": 30,
        "audio": {"sampleRate": 48000},
        "samples": [
            {"name": c, "weight": row[k], "frame": n}
            for k, c in enumerate(NAMES)
            for n, row in enumerate(ROWS)
        ],
    },
}
TEXTS = {name: json.dumps(document) for name, document in LAYOUTS.items()}
TEXTS["a document per line"] = "".join(
    json.dumps(row) + "\n" for row in rows(lambda n, w: {"timestamp": n / 30, "blendshapes": w})
)


@pytest.mark.parametrize("text", TEXTS.values(), ids=TEXTS)
def test_a_layout_opens_and_an_edit_changes_its_number_alone(tmp_path: Path, text: str) -> None:
    path, out = tmp_path / "take.json", tmp_path / "out.json"
    path.write_text(text)
    take = open_take(path)
    assert take.clip.rate == pytest.approx(30)
    assert take.clip.gaps == ()
    assert np.allclose(take.clip.arkit_weights(), WEIGHTS, atol=1e-7)
    write_take(out, take, take.clip.weights)
    assert out.read_text() == text
    edited = take.clip.weights.copy()
    edited[17, 5] = 0.7654
    write_take(out, take, edited)
    assert np.allclose(open_take(out).clip.weights, edited, atol=1e-7)
    before, after = text.split(","), out.read_text().split(",")
    assert sum(a != b for a, b in zip(before, after, strict=True)) == 1


@pytest.mark.parametrize(
    "document", [rows(lambda n, w: w), rows(lambda n, w: {"frame": n, **w}), {"curves": SERIES}]
)
def test_weights_without_times_ask_for_the_rate(tmp_path: Path, document: Any) -> None:
    path = tmp_path / "take.json"
    path.write_text(json.dumps(document))
    with pytest.raises(RateNeeded) as asked:
        open_take(path)
    assert asked.value.frames == len(ROWS)
    assert open_take(path, fps=24).clip.duration == pytest.approx(len(ROWS) / 24)


def test_frames_in_which_the_face_was_lost_are_a_gap(tmp_path: Path) -> None:
    document = rows(lambda n, w: {"time": n / 30, "face": None if n in (0, 9, 10) else w})
    path = tmp_path / "take.json"
    path.write_text(json.dumps(document))
    clip = open_take(path).clip
    assert [(gap.frame, gap.missing) for gap in clip.gaps] == [(7, 2)]


def test_numbers_of_lost_frames_are_gaps_at_the_rate_of_the_file(tmp_path: Path) -> None:
    path = tmp_path / "take.json"
    frames = rows(lambda n, w: {"frame": 2 * n, "weights": w})
    path.write_text(json.dumps({"fps": 30, "frames": frames[:5] + frames[7:]}))
    clip = open_take(path).clip
    assert [(gap.frame, gap.missing) for gap in clip.gaps] == [(4, 2)]


@pytest.mark.parametrize(("flag", "no"), [("FaceFound", False), ("confidence", 0.0)])
def test_frames_that_say_so_have_no_face(tmp_path: Path, flag: str, no: float) -> None:
    path = tmp_path / "take.json"
    document = rows(lambda n, w: {"time": n / 30, flag: no if n == 9 else 1, "weights": w})
    path.write_text(json.dumps(document))
    assert [(gap.frame, gap.missing) for gap in open_take(path).clip.gaps] == [(8, 1)]
    document = rows(lambda n, w: {"time": n / 30, flag: no, "weights": w})
    path.write_text(json.dumps(document))  # the flag is never set
    assert open_take(path).clip.gaps == ()


def test_of_two_faces_the_first_is_read_and_that_is_said(tmp_path: Path) -> None:
    path = tmp_path / "take.json"
    path.write_text(
        json.dumps(
            rows(lambda n, w: {"time": n / 30, "faces": [w, {c: 1 - v for c, v in w.items()}]})
        )
    )
    take = open_take(path)
    assert np.allclose(take.clip.arkit_weights(), WEIGHTS, atol=1e-7)
    assert "a frame has the weights of 2 faces: the first is read" in take.notes


@pytest.mark.parametrize(
    "text",
    [
        '{"version": 1, "edits": [{"channels": ["jawOpen"]}]}',
        '{"meshes": [{"extras": {"targetNames": ["jawOpen"]}}], "bufferViews": []}',
        '{"format": "openfacefx.track", "channels": [{"name": "jawOpen", "keys": [[0, 1]]}]}',
    ],
)
def test_other_files_with_the_names_of_channels_are_no_takes(text: str) -> None:
    assert find_format(text.encode()) is None


HUGE = {
    "names": json.dumps([{"jawOpen": 0.1, **{f"k{n}": 1 for n in range(20_000)}}] * 3),
    "lists": json.dumps({"jawOpen": "x", "l": [{"a": [], "b": {"c": []}}] * 20_000}),
    "depth": "[" * 100_000,
}


@pytest.mark.parametrize("text", HUGE.values(), ids=HUGE)
def test_a_document_with_too_much_of_anything_is_refused(tmp_path: Path, text: str) -> None:
    path = tmp_path / "take.json"
    path.write_text(text)
    with pytest.raises(FileError):
        open_take(path)


@pytest.mark.parametrize(
    "text",
    [
        '{"jawOpen": "open"}',
        '{"time": [0, 1, 2], "jawOpen": [0.1, 0.2, 0.3], "mouthClose": [0.1]}',
        '[{"name": "jawOpen"}]',
        '{"frames": [{"jawOpen": 0.1}, {"mouthClose": 0.1}], "fps": 30}',
        '{"time": 0, "jawOpen": 0.1}\n{"time": 1, "jawOpen"',
        '{"time": 0, "jawOpen": 0.1} {"time": 1, "jawOpen": 0.2}',
        '{"fps": 30, "frames": [{"jawOpen": "0,1"}, {"jawOpen": "0,2"}]}',
        '[{"t": 0, "name": "jawOpen", "value": 1}, {"t": 0, "name": "jawOpen", "value": 2}]',
    ],
)
def test_what_cannot_be_read_is_refused_in_one_line(tmp_path: Path, text: str) -> None:
    path = tmp_path / "take.json"
    path.write_text(text)
    with pytest.raises(FileError) as refused:
        open_take(path)
    assert "\n" not in str(refused.value)
    assert len(str(refused.value)) <= 300
