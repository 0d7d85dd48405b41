"""The blend shapes of Azure's text to speech: numbers without names, in a documented order."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support import recordings

from faceedit_app.core.errors import FileError
from faceedit_app.formats.azure_speech import NAMES
from faceedit_app.formats.opening import open_take, write_take

FACE = recordings.face(channels=55)


def events(size: int = 12) -> list[dict[str, Any]]:
    parts = range(0, len(FACE), size)
    return [{"FrameIndex": n, "BlendShapes": FACE[n : n + size].tolist()} for n in parts]


def test_the_order_is_the_documented_one() -> None:
    assert NAMES[14:18] == ("jawForward", "jawLeft", "jawRight", "jawOpen")
    assert NAMES[21:25] == ("mouthLeft", "mouthRight", "mouthSmileLeft", "mouthSmileRight")
    assert NAMES[51:] == ("tongueOut", "headRoll", "leftEyeRoll", "rightEyeRoll")


@pytest.mark.parametrize(
    "text",
    [
        json.dumps(events()),
        json.dumps(events(100)[0], indent=1),
        "\n".join(map(json.dumps, events())),
        json.dumps({"text": "hello", "animation": events()}),
        json.dumps([{"offset": 500, "animation": event} for event in events()]),
    ],
)
def test_events_are_one_take_at_60_frames_a_second(tmp_path: Path, text: str) -> None:
    path, out = tmp_path / "speech.json", tmp_path / "out.json"
    path.write_text(text)
    take = open_take(path)
    assert (take.clip.rate, take.clip.gaps, len(take.clip)) == (60, (), len(FACE))
    jaw = take.clip.weights[:, take.clip.channels.index("jawOpen")]
    assert np.allclose(jaw, FACE[:, 17], atol=1e-7)
    assert take.carried == ("headRoll", "leftEyeRoll", "rightEyeRoll")
    edited = take.clip.weights.copy()
    edited[7, take.clip.channels.index("jawLeft")] = 0.1234
    write_take(out, take, edited)
    before, after = text.split(","), out.read_text().split(",")
    assert [b.strip() for a, b in zip(before, after, strict=True) if a != b] == ["0.1234"]


def test_events_that_were_lost_are_a_gap_and_sentences_follow_one_another(tmp_path: Path) -> None:
    path = tmp_path / "speech.json"
    first, second, *others = events()
    path.write_text(json.dumps([first, *others]))
    assert [(gap.frame, gap.missing) for gap in open_take(path).clip.gaps] == [(11, 12)]
    path.write_text(json.dumps([first, second, first]))
    assert (len(open_take(path).clip), open_take(path).clip.gaps) == (36, ())


def test_a_frame_that_is_cut_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "speech.json"
    damaged = events()
    damaged[1]["BlendShapes"][2].pop()
    path.write_text(json.dumps(damaged))
    with pytest.raises(FileError, match="frame 15 has 54 weights, there are 55 names"):
        open_take(path)
