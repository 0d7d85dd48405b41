"""Valid takes of every format, small enough to be read thousands of times."""

from __future__ import annotations

import json
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import numpy as np

from faceedit_app.characters.scenes import SCENES, scene_content
from faceedit_app.core.clip import Clip
from faceedit_app.core.resources import DEMO_TAKE, shipped
from faceedit_app.formats import azure_speech, csv_take, metahuman
from faceedit_app.formats.opening import encoded_take, open_take
from faceedit_app.formats.registry import writable
from faceedit_app.lab.attacks.reader import Reader, Wrong
from faceedit_app.lab.attacks.valid_characters import small_rig

_ROWS = 12  # enough to tell their times
_EVERY = 4  # of the channels; some of both sides, eyes and mouth
_RATE = 60


def take_readers() -> Iterator[Reader]:
    """The reader of takes, once for each format and dialect."""
    yield Reader("takes", ".csv", small_take(), read_take)
    for form in writable():
        if form.write is not None:
            yield Reader("takes", form.endings[0], form.write(_clip()), read_take)
    for ending, content in (*_tables(), *_documents(), *_recordings(), *_animations()):
        yield Reader("takes", ending, content, read_take)


def small_take() -> bytes:
    """The beginning of the demo take."""
    lines = shipped(DEMO_TAKE).read_bytes().splitlines(keepends=True)
    return b"".join(lines[: _ROWS + 1])


def read_take(path: Path) -> None:
    """Open a take; unchanged, it must be written as the same bytes."""
    take = open_take(path)
    weights, times = take.clip.weights, take.clip.times
    if not (np.isfinite(weights).all() and np.isfinite(times).all()):
        raise Wrong("a weight or a time is not finite")
    if len(times) > 1 and not (np.diff(times) > 0).all():
        raise Wrong("the times do not run forward")
    if encoded_take(path, take, weights) != path.read_bytes():
        raise Wrong("the unchanged take is not written as the same bytes")
    encoded_take(path, take, np.where(weights > 0.5, weights - 0.25, weights + 0.25))


@cache
def _clip() -> Clip:
    clip = open_take(shipped(DEMO_TAKE)).clip
    names = dict.fromkeys(("jawOpen", "mouthClose", *clip.channels[::_EVERY]))
    columns = [clip.channels.index(name) for name in names]
    return Clip(clip.weights[:_ROWS, columns], tuple(names), clip.times[:_ROWS], float(_RATE))


def _rows() -> list[dict[str, float]]:
    """The weights of each frame, by channel."""
    clip = _clip()
    weights = np.round(clip.weights.astype(float), 4).tolist()
    return [dict(zip(clip.channels, row, strict=True)) for row in weights]


def _tables() -> Iterator[tuple[str, bytes]]:
    """Dialects of CSV and TSV."""
    plain, rows = csv_take.write(_clip()), _rows()
    yield ".csv", ("\ufeff" + plain.decode()).encode("utf-16-le")
    yield ".csv", b"# units: s\n" + plain.replace(b",", b";").replace(b".", b",")
    yield ".tsv", plain.replace(b",", b"\t")
    controls = ["time_s", *(f"CTRL_expressions_{metahuman.CONTROLS[c][0]}" for c in rows[0])]
    yield ".csv", ",".join(controls).encode() + plain[plain.index(b"\n") :]
    entries = (f"{n / _RATE:.4f},{c},{w}" for n, row in enumerate(rows) for c, w in row.items())
    yield ".csv", "\n".join(["time,name,value", *entries]).encode()
    lists = ([c, *(str(row[c]) for row in rows)] for c in rows[0])
    turned = [["time_s", *(f"{n / _RATE:.4f}" for n in range(len(rows)))], *lists]
    yield ".csv", "\n".join(map(",".join, turned)).encode()
    stamps = [f"9,{n * 10**9 // _RATE},{1000 * n / _RATE:.1f}" for n in range(len(rows))]
    clocks = ["stamp.secs,stamp.nsecs,video_ms", *stamps]
    with_clocks = map(",".join, zip(clocks, plain.decode().splitlines(), strict=True))
    yield ".csv", "\n".join(with_clocks).replace("time_s,", "time,").encode()
    quoted = ('"' + line.replace(",", '","') + '"' for line in plain.decode().splitlines())
    yield ".csv", "\r\n".join(quoted).encode()


def _documents() -> Iterator[tuple[str, bytes]]:
    """Layouts of JSON."""
    rows = _rows()
    columns = {c: [row[c] for row in rows] for c in rows[0]}
    times = [round(n / _RATE, 4) for n in range(len(rows))]
    yield ".json", _json([{"time": t, **row} for t, row in zip(times, rows, strict=True)])
    yield ".json", _json({"fps": _RATE, "curves": columns})
    entries = [(t, c, w) for t, row in zip(times, rows, strict=True) for c, w in row.items()]
    yield ".json", _json([dict(zip("tkv", entry, strict=True)) for entry in entries])
    texts = [{"fps": "60", "weights": {c: str(w) for c, w in row.items()}} for row in rows]
    yield ".jsonl", b"\n".join(map(_json, texts))
    keys = {c: [list(key) for key in zip(times, ws, strict=True)] for c, ws in columns.items()}
    yield ".json", _json(keys)
    nested = [{"jaw": {"open": row["jawOpen"]}, "eye": {"blink": {"left": 0.5}}} for row in rows]
    yield ".json", _json({"video": {"r_frame_rate": "60/1"}, "frames": nested})
    frames = [
        {"weights": list(row.values()), "time": t, "rotation": []}
        for t, row in zip(times, rows, strict=True)
    ]
    yield ".json", _json({"names": list(rows[0]), "metadata": {"fps": 60.0}, "frames": frames})
    named = {f"CTRL_expressions_{metahuman.CONTROLS[c][0]}": ws for c, ws in columns.items()}
    yield ".json", _json({"fps": _RATE, "curves": named})


def _recordings() -> Iterator[tuple[str, bytes]]:
    """What trackers and services write."""
    rows = _rows()
    seen = [
        {
            "timestamp": 1_700_000_000_000 + 1000 * n // _RATE,
            "blendshapes": [{"name": c, "score": w} for c, w in row.items()],
        }
        for n, row in enumerate(rows)
    ]
    yield ".json", _json(seen)
    said = [[row.get(name, 0.0) for name in azure_speech.NAMES] for row in rows]
    half = len(said) // 2
    parts = ((0, said[:half]), (half, said[half:]))
    yield ".jsonl", b"\n".join(_json({"FrameIndex": n, "BlendShapes": part}) for n, part in parts)
    frames = ("|".join(f"{c}-{100 * w:.0f}" for c, w in row.items()) for row in rows)
    tail = "=head#-21.4,-6.1,-1.5,0.05,-0.13,-0.47|rightEye#6.0,3.1,0.2|leftEye#6.0,2.9,-0.3|"
    stream = [f"{n / _RATE:.4f}|{text}|{tail}" for n, text in enumerate(frames)]
    yield ".txt", "\n".join(stream).encode()
    lines = ["info,facecap,1", "bs," + ",".join(rows[0]) + ","]
    for n, row in enumerate(rows):
        cells = [1000 * n // _RATE, *(0.5,) * 10, *row.values()]
        lines.append(f"k,{','.join(map(str, cells))},")
    yield ".txt", "\n".join(lines).encode()


def _animations() -> Iterator[tuple[str, bytes]]:
    """Animations of 3D programs."""
    for form in SCENES:
        if form.key in ("glb", "usd"):
            yield form.ending, scene_content(form, _clip(), small_rig(), "talk")
    curves = "".join(
        _unity_curve(c, [row[c] for row in _rows()]) for c in ("jawOpen", "mouthClose")
    )
    head = "%YAML 1.1\n%TAG !u! tag:unity3d.com,2011:\n--- !u!74 &7400000\nAnimationClip:\n"
    both = "".join(f"  {part}:\n{curves}" for part in ("m_FloatCurves", "m_EditorCurves"))
    yield ".anim", f"{head}  m_Name: face\n{both}  m_SampleRate: 60\n".encode()


def _unity_curve(channel: str, weights: list[float]) -> str:
    keys = "".join(
        "      - serializedVersion: 3\n"
        f"        time: {np.float32(n / _RATE)}\n        value: {100 * weight:g}\n"
        "        inSlope: 0\n        outSlope: Infinity\n"
        for n, weight in enumerate(weights)
    )
    return (
        f"  - curve:\n      serializedVersion: 2\n      m_Curve:\n{keys}      m_PreInfinity: 2\n"
        f"    attribute: blendShape.{channel}\n    path: Head\n    classID: 137\n"
    )


def _json(document: object) -> bytes:
    return json.dumps(document).encode()
