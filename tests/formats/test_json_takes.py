"""JSON takes of every layout open, and an export changes the edited numbers and no other byte."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from support import recordings

from faceedit_app.core.errors import FileError
from faceedit_app.formats.opening import open_take, write_take
from faceedit_app.formats.take import Take
from faceedit_app.formats.timing import RateNeeded

WEIGHTS = recordings.face()
# The text, and its frame rate.
LAYOUTS: dict[str, tuple[str, float]] = {
    "Audio2Face, indented": (recordings.audio2face(WEIGHTS), 60),
    "Audio2Face, on one line": (recordings.audio2face(WEIGHTS, 24, indent=None), 24),
    "LAM": (recordings.named_frames(WEIGHTS, 30), 30),
    "BEAT": (recordings.named_frames(WEIGHTS, 60, "BEAT"), 60),
    "plain lists": (recordings.named_frames(WEIGHTS, 25, "plain lists"), 25),
    "MediaPipe": (recordings.mediapipe(WEIGHTS, 60), 60),
    "MediaPipe, dates": (recordings.mediapipe(WEIGHTS, 30, "dates"), 30),
}


@pytest.fixture
def opened(tmp_path: Path) -> Callable[[str], Take]:
    def open_text(text: str) -> Take:
        path = tmp_path / "take.json"
        path.write_bytes(text.encode())
        return open_take(path)

    return open_text


def export(take: Take, *edits: tuple[int, str, float]) -> str:
    weights = take.clip.weights.copy()
    for frame, channel, value in edits:
        weights[frame, take.clip.channels.index(channel)] = value
    out = take.path.with_name("out.json")
    write_take(out, take, weights)
    return out.read_bytes().decode()


@pytest.mark.parametrize("layout", LAYOUTS)
def test_every_layout_opens_with_its_rate_and_all_channels(
    layout: str, opened: Callable[[str], Take]
) -> None:
    text, rate = LAYOUTS[layout]
    take = opened(text)
    assert take.clip.rate == rate
    assert len(take.clip.channels) == 52
    assert np.allclose(take.clip.arkit_weights(), WEIGHTS, atol=1e-7)
    assert take.clip.times[-1] == pytest.approx(39 / rate, abs=1e-3)
    assert take.clip.gaps == ()


@pytest.mark.parametrize("layout", LAYOUTS)
def test_without_an_edit_all_bytes_are_the_same(layout: str, opened: Callable[[str], Take]) -> None:
    text = LAYOUTS[layout][0]
    assert export(opened(text)) == text
    assert export(opened("\ufeff" + text)) == "\ufeff" + text


@settings(
    deadline=None,
    derandomize=True,
    max_examples=60,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(
    layout=st.sampled_from([*LAYOUTS]),
    frame=st.integers(0, 39),
    k=st.integers(0, 51),
    value=st.floats(-0.5, 1.5, width=32),
)
def test_an_edit_changes_its_number_and_no_other_byte(
    layout: str, frame: int, k: int, value: float, opened: Callable[[str], Take]
) -> None:
    text = LAYOUTS[layout][0]
    take = opened(text)
    out = export(take, (frame, take.clip.channels[k], value))
    again = opened(out).clip.weights
    assert again[frame, k] == pytest.approx(value, abs=6e-7)
    numbers = re.compile(r'-?\d[\d.eE+-]*|"(?:[^"\\]|\\.)*"|[^-\d"]+')
    before, after = numbers.findall(text), numbers.findall(out)
    assert len(before) == len(after)
    assert sum(a != b for a, b in zip(before, after, strict=True)) <= 1


def test_what_is_no_channel_is_carried(opened: Callable[[str], Take]) -> None:
    assert opened(LAYOUTS["MediaPipe"][0]).carried == ("_neutral",)


@pytest.mark.parametrize("nothing", ["[]", "null", f"[{', '.join(['NaN'] * 52)}]"])
def test_frames_without_a_face_are_gaps(nothing: str, opened: Callable[[str], Take]) -> None:
    rows = [json.dumps(row) for row in WEIGHTS.tolist()]
    rows[10:13] = [nothing] * 3
    names = json.loads(LAYOUTS["LAM"][0])["names"]
    text = f'{{"names": {json.dumps(names)}, "fps": 30, "frames": [{", ".join(rows)}]}}'
    take = opened(text)
    assert len(take.clip) == 37
    assert [(gap.frame, gap.missing) for gap in take.clip.gaps] == [(9, 3)]
    assert any("the face was lost in 3 rows at 1 place" in note for note in take.notes)
    assert export(take) == text


def test_percent_is_written_as_percent(opened: Callable[[str], Take]) -> None:
    text = recordings.audio2face(np.round(WEIGHTS * 100, 2))
    take = opened(text)
    assert np.allclose(take.clip.arkit_weights(), WEIGHTS, atol=1e-6)
    out = json.loads(export(take, (3, "jawOpen", 0.5)))
    assert out["weightMat"][3][out["facsNames"].index("jawOpen")] == 50


@pytest.mark.parametrize(
    "text",
    [recordings.audio2face(WEIGHTS, None), recordings.named_frames(WEIGHTS, variant="values")],
    ids=["Audio2Face", "names and values"],
)
def test_a_file_without_a_rate_asks_for_it(text: str, opened: Callable[[str], Take]) -> None:
    with pytest.raises(RateNeeded) as asked:
        opened(text)
    assert asked.value.frames == 40
    assert open_take(asked.value.path, fps=48).clip.duration == pytest.approx(40 / 48)


def changed(text: str, old: str, new: str) -> str:
    assert old in text
    return text.replace(old, new, 1)


A2F = recordings.audio2face(np.full((4, 52), 0.25), indent=1)


@pytest.mark.parametrize(
    ("text", "line", "says"),
    [
        (A2F[:-40], 309, "is damaged"),
        (changed(A2F, '"jawOpen"', '"jawLeft"'), None, 'names the channel "jawLeft" twice'),
        (changed(A2F, "   0.25,\n", ""), 62, "frame 1 has 51 weights, there are 52 names"),
        (changed(A2F, "0.25", '"x"'), None, "has a weight that is not a number"),
        (changed(A2F, "0.25", "1e30"), 62, "is 1e+30, where 1 is a full blendshape"),
        (
            changed(A2F, "0.25", "null"),
            None,
            "frame 1 has no eyeBlinkLeft, which other frames have",
        ),
        (changed(A2F, '"weightMat"', '"weightMat": [], "x"'), None, "no row with a tracked face"),
        (re.sub('"facsNames": .*?]', '"facsNames": []', A2F, flags=re.DOTALL), None, "no ARKit"),
        ("[" * 99_999 + '"facsNames" "weightMat"', None, "nested too deeply"),
    ],
)
def test_a_damaged_file_is_refused_in_one_line(
    text: str, line: int | None, says: str, opened: Callable[[str], Take]
) -> None:
    with pytest.raises(FileError) as caught:
        opened(text)
    assert says in str(caught.value)
    assert caught.value.line == line
    assert str(caught.value).isprintable()


def test_frames_out_of_order_are_named(opened: Callable[[str], Take]) -> None:
    document = json.loads(recordings.named_frames(WEIGHTS))
    document["frames"][20]["time"] = 0.01
    with pytest.raises(FileError, match="the time of frame 21 does not come after"):
        opened(json.dumps(document))


@settings(
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(
    layout=st.sampled_from([*LAYOUTS]),
    position=st.floats(0, 1),
    junk=st.text(st.sampled_from('0{}[]",:x-.'), max_size=4),
    cut=st.booleans(),
)
def test_damage_anywhere_opens_or_is_refused(
    layout: str, position: float, junk: str, cut: bool, opened: Callable[[str], Take]
) -> None:
    whole = LAYOUTS[layout][0]
    place = int(position * len(whole))
    text = whole[:place] + junk + ("" if cut else whole[place:])
    try:
        take = opened(text)
    except FileError:
        return
    assert export(take) == text
