"""JSON that nests names, has keys for each channel, or gives its rate somewhere below, opens."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support import recordings

from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.errors import FileError
from faceedit_app.formats.opening import open_take, write_take
from faceedit_app.formats.timing import RateNeeded

NAMES = ("jawOpen", "jawLeft", "eyeBlinkLeft", "eyeBlinkRight", "mouthFunnel")
ROWS = [[round(float(v), 4) for v in row] for row in recordings.face()[:40]]
ROWS = [[row[ARKIT_CHANNELS.index(name)] for name in NAMES] for row in ROWS]
FRAMES = [dict(zip(NAMES, row, strict=True)) for row in ROWS]
TIMES = [round(n / 30, 5) for n in range(len(ROWS))]


def nested(frame: dict[str, float]) -> dict[str, Any]:
    blink = {"left": frame["eyeBlinkLeft"], "right": frame["eyeBlinkRight"]}
    jaw = {"open": frame["jawOpen"], "left": frame["jawLeft"]}
    return {"jaw": jaw, "eye": {"blink": blink}, "mouth": {"funnel": frame["mouthFunnel"]}}


def sides(frame: dict[str, float]) -> dict[str, Any]:
    blink = {"L": frame["eyeBlinkLeft"], "R": frame["eyeBlinkRight"]}
    others = {name: frame[name] for name in ("jawOpen", "jawLeft", "mouthFunnel")}
    return {"eyeBlink": blink, **others}


def lines(*entries: Any) -> str:
    return "".join(json.dumps(entry) + "\n" for entry in entries)


def columns(of: Any) -> dict[str, Any]:
    return {name: of([row[k] for row in ROWS]) for k, name in enumerate(NAMES)}


def pairs(values: list[float]) -> list[list[float]]:
    return [list(pair) for pair in zip(TIMES, values, strict=True)]


def keys(values: list[float]) -> list[dict[str, float]]:
    return [{"time": t, "value": v} for t, v in zip(TIMES, values, strict=True)]


# All are at 30 fps.
LAYOUTS: dict[str, Any] = {
    "nested names": {"fps": 30, "frames": [nested(frame) for frame in FRAMES]},
    "nested names below others": [
        {"time": t, "blendshapes": nested(frame)} for t, frame in zip(TIMES, FRAMES, strict=True)
    ],
    "sides below a name": {"fps": 30, "frames": [sides(frame) for frame in FRAMES]},
    "pairs for each channel": columns(pairs),
    "keys for each channel": {"FrameRate": 30, "Curves": columns(keys)},
    "curves with keys": {"curves": [{"name": n, "keys": k} for n, k in columns(keys).items()]},
    "curves of Blender": {
        "fps": 30,
        "fcurves": [
            {
                "data_path": f'key_blocks["{name}"].value',
                "keyframe_points": [[n + 1, row[k]] for n, row in enumerate(ROWS)],
            }
            for k, name in enumerate(NAMES)
        ],
    },
    "frames by name": {"fps": 30, "data": {f"frame_{n}": f for n, f in enumerate(FRAMES)}},
    "places of names": {"fps": 30, "names": dict(zip(NAMES, range(5), strict=True)), "w": ROWS},
    "one list of numbers": {
        "tracks": [{"times": TIMES, "values": [value for row in ROWS for value in row]}],
        "morphTargetDictionary": {name: k for k, name in enumerate(NAMES)},
    },
    "times beside the frames": {"timestamps": TIMES, "frames": FRAMES},
    "two faces": {"fps": 30, "faces": [{"id": k, "frames": FRAMES} for k in range(2)]},
    "one subject": {"fps": 30, "subjects": [{"name": "A", "frames": FRAMES}]},
    "the rate of the film": {"video": {"stream": {"r_frame_rate": "30/1"}}, "frames": FRAMES},
    "a fraction": {"frameRate": {"num": 30, "den": 1}, "frames": FRAMES},
    "the length of a frame": {"frameDuration": 0.033333, "frames": FRAMES},
    "milliseconds of a frame": {"meta": {"frame_time_ms": 33.3333}, "frames": FRAMES},
}
TEXTS = {
    **{name: json.dumps(document) for name, document in LAYOUTS.items()},
    "lines after their names": lines({"names": NAMES, "fps": 30}, *ROWS),
    "lines after a header": lines({"device": "phone", "frameRate": 30}, *FRAMES),
    "a stream of NVIDIA ACE": lines(
        {"animation_data_stream_header": {"skel_animation_header": {"blend_shapes": NAMES}}},
        *(
            {"animation_data": {"blend_shape_weights": [{"time_code": t, "values": row}]}}
            for t, row in zip(TIMES, ROWS, strict=True)
        ),
    ),
}


@pytest.mark.parametrize("text", TEXTS.values(), ids=TEXTS)
def test_a_layout_opens_and_an_edit_changes_its_number_alone(tmp_path: Path, text: str) -> None:
    path, out = tmp_path / "take.json", tmp_path / "out.json"
    path.write_text(text)
    take = open_take(path)
    assert (take.clip.rate, take.clip.gaps) == (pytest.approx(30), ())
    order = [take.clip.channels.index(name) for name in NAMES]
    np.testing.assert_allclose(take.clip.weights[:, order], ROWS, atol=1e-6)
    assert not any("lost" in note for note in take.notes)
    write_take(out, take, take.clip.weights)
    assert out.read_text() == text
    edited = take.clip.weights.copy()
    edited[20, order[0]] = 0.87654
    write_take(out, take, edited)
    assert out.read_text().count("0.87654") == 1
    np.testing.assert_allclose(open_take(out).clip.weights, edited, atol=1e-6)


def test_frames_of_a_second_face_are_mentioned(tmp_path: Path) -> None:
    path = tmp_path / "take.json"
    path.write_text(TEXTS["two faces"])
    assert "holds the frames of 2 faces or takes: the first are read" in open_take(path).notes


@pytest.mark.parametrize("between", ["", " ", "\n"])
def test_objects_one_after_the_other_are_frames(tmp_path: Path, between: str) -> None:
    path, out = tmp_path / "take.json", tmp_path / "out.json"
    frames = [
        json.dumps({"time": n / 30, "jawOpen": n / 50, "eyeBlinkLeft": 0.1}) for n in range(9)
    ]
    path.write_text(between.join(frames))
    take = open_take(path)
    assert (len(take.clip), take.clip.rate, take.notes) == (9, 30, ())
    write_take(out, take, take.clip.weights)
    assert out.read_bytes() == path.read_bytes()
    path.write_text(between.join(frames) + " 7")
    with pytest.raises(FileError):
        open_take(path)


def test_a_rate_that_a_text_mentions_is_proposed(tmp_path: Path) -> None:
    path = tmp_path / "take.json"
    path.write_text(json.dumps({"info": "fps: 25", "frames": FRAMES}))
    with pytest.raises(RateNeeded) as asked:
        open_take(path)
    assert asked.value.rate == 25


def test_channels_that_do_not_move_may_have_a_single_key(tmp_path: Path) -> None:
    path = tmp_path / "take.json"
    path.write_text(json.dumps({**columns(pairs), "tongueOut": [[0.0, 0.0]]}))
    take = open_take(path)
    assert len(take.clip.channels) == len(NAMES)
    assert "1 of 6 channels have no key in most frames: carried" in take.notes


def test_keys_at_times_of_their_own_are_refused_in_one_line(tmp_path: Path) -> None:
    path = tmp_path / "take.json"
    document = columns(pairs)
    document["jawLeft"] = document["jawLeft"][::3]
    path.write_text(json.dumps(document))
    with pytest.raises(FileError, match="keys at other times for jawLeft than for jawOpen"):
        open_take(path)


def test_frames_of_minus_1_or_with_a_state_lost_the_face(tmp_path: Path) -> None:
    path = tmp_path / "take.json"
    frames: list[dict[str, Any]] = [dict(frame, state="tracking") for frame in FRAMES]
    frames[10] = dict.fromkeys(NAMES, -1)
    frames[20]["state"] = "notTracking"
    path.write_text(json.dumps({"fps": 30, "frames": frames}))
    assert [(gap.frame, gap.missing) for gap in open_take(path).clip.gaps] == [(9, 1), (18, 1)]
