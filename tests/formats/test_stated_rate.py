"""A frame rate that a file states beside its frames is used; one that it mentions is proposed."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

import pytest

from faceedit_app.formats.opening import open_take, write_take
from faceedit_app.formats.timing import RateNeeded

FRAMES = 40
NUMBERED = "frame,jawOpen,mouthClose\n" + "".join(f"{n},0.{n:02d}1,0.1\n" for n in range(FRAMES))
BARE = "jawOpen,mouthClose\n" + "".join(f"0.{n:02d}1,0.1\n" for n in range(FRAMES))

STATED = {
    "a comment": ("# fps: 25\n" + NUMBERED, 25.0),
    "a comment in words": ("# recorded with a phone\n# frame rate = 24\n" + NUMBERED, 24.0),
    "a comment of C": ("// FPS 50\n" + BARE, 50.0),
    "the whole comment": ("# 48 fps\n" + BARE, 48.0),
    "JSON in a comment": ('# {"subject": "A", "fps": 25}\n' + NUMBERED, 25.0),
    "lines before the header": ("Subject,A\nFrames,40\nFPS,29.97\n\n" + NUMBERED, 30000 / 1001),
    "a fraction": ("# r_frame_rate=24000/1001\n" + NUMBERED, 24000 / 1001),
    "a decimal comma": (("Bildrate;x\nFPS;23,976\n" + NUMBERED.replace(",", ";")), 24000 / 1001),
    "a decimal comma in a comment": ("# fps: 23,976\n" + NUMBERED, 24000 / 1001),
    "a decimal comma alone": ("# 59,94 fps\n" + NUMBERED, 60000 / 1001),
    "a decimal comma in German": ("Bildrate: 29,97\n" + NUMBERED, 30000 / 1001),
    "a decimal comma beside semicolons": ("# fps: 12,5\n" + NUMBERED.replace(",", ";"), 12.5),
    "words in German": ("Bilder pro Sekunde: 25\n" + NUMBERED, 25.0),
    "a comma before something else": ("# fps: 30, stride: 2\n" + NUMBERED, 30.0),
    "numbers between commas": ("fps,30,60\n" + NUMBERED, 30.0),
    "a column": (NUMBERED.replace("\n", ",24\n").replace("mouthClose,24", "mouthClose,fps"), 24.0),
}
MENTIONED = {
    "prose": ("# from a camera of 50 fps, by hand\n" + NUMBERED, 50.0),
    "a rate of something": ("Rate,25\n" + NUMBERED, 25.0),
    "two numbers, or a decimal comma": ("# fps: 30,60\n" + NUMBERED, 30.0),
}
UNCLEAR = {
    "two rates": ("# fps: 60\n# fps: 30\n" + BARE, 60.0),
    "a rate as measured": (
        "fps,jawOpen\n" + "".join(f"{29 + n / 20},0.1\n" for n in range(FRAMES)),
        60.0,
    ),
    "the rate of the sound": ("# sample rate: 48000\n" + BARE, 60.0),
}


@pytest.mark.parametrize(("text", "rate"), STATED.values(), ids=STATED)
def test_a_stated_rate_is_used_and_said(tmp_path: Path, text: str, rate: float) -> None:
    path = tmp_path / "take.csv"
    path.write_text(text, newline="")
    take = open_take(path)
    assert take.clip.rate == rate
    assert take.clip.times[-1] == pytest.approx((FRAMES - 1) / rate)
    assert any("because the file says" in note for note in take.notes)
    write_take(tmp_path / "out.csv", take, take.clip.weights)
    assert (tmp_path / "out.csv").read_text() == text


@pytest.mark.parametrize(("text", "rate"), MENTIONED.values(), ids=MENTIONED)
def test_a_mentioned_rate_is_proposed(tmp_path: Path, text: str, rate: float) -> None:
    path = tmp_path / "take.csv"
    path.write_text(text)
    with pytest.raises(RateNeeded) as asked:
        open_take(path)
    assert asked.value.rate == rate


@pytest.mark.parametrize(("text", "rate"), UNCLEAR.values(), ids=UNCLEAR)
def test_an_unclear_rate_is_asked_for(tmp_path: Path, text: str, rate: float) -> None:
    path = tmp_path / "take.csv"
    path.write_text(text)
    with pytest.raises(RateNeeded) as asked:
        open_take(path)
    assert asked.value.rate == rate


def test_times_count_more_than_a_stated_rate(tmp_path: Path) -> None:
    path = tmp_path / "take.csv"
    rows = "".join(f"{n / 30:.4f},0.1\n" for n in range(FRAMES))
    path.write_text("# fps: 60\ntime_s,jawOpen\n" + rows)
    assert open_take(path).clip.rate == 30


def test_a_rate_that_the_user_gives_counts_more(tmp_path: Path) -> None:
    path = tmp_path / "take.csv"
    path.write_text("# fps: 25\n" + NUMBERED)
    assert open_take(path, fps=50).clip.rate == 50


def test_numbers_of_lost_frames_are_gaps_at_the_stated_rate(tmp_path: Path) -> None:
    path = tmp_path / "take.csv"
    lines = NUMBERED.splitlines(keepends=True)
    path.write_text("# fps: 25\n" + "".join(lines[:11] + lines[13:]))
    clip = open_take(path).clip
    assert [(gap.frame, gap.missing) for gap in clip.gaps] == [(9, 2)]


def test_the_length_that_is_asked_about_counts_lost_frames(tmp_path: Path) -> None:
    path = tmp_path / "take.csv"
    lines = NUMBERED.splitlines(keepends=True)
    path.write_text("".join(lines[:11] + lines[13:]))
    with pytest.raises(RateNeeded) as asked:
        open_take(path)
    assert asked.value.frames == FRAMES
    clip = open_take(path, asked.value.rate).clip
    assert clip.duration == pytest.approx(asked.value.frames / asked.value.rate)


@pytest.mark.parametrize(("stated", "is_noted"), [("25", True), ("23.976", True), ("24", False)])
def test_times_that_contradict_a_stated_rate_count_and_are_noted(
    tmp_path: Path, stated: str, is_noted: bool
) -> None:
    path = tmp_path / "take.csv"
    rows = "".join(f"{n / 24:.6f},0.{n:02d}1\n" for n in range(FRAMES))
    path.write_text(f"# fps: {stated}\ntime_s,jawOpen\n{rows}")
    take = open_take(path)
    assert take.clip.rate == 24.0
    note = f'24 fps by its times, although the file says "fps: {stated}"'
    assert any(one.startswith(f"{note}; if the file is right") for one in take.notes) == is_noted
    assert not any(note in one for one in open_take(path, fps=30).notes), "the user knows"


COUNTED = {
    "every 2nd": (range(0, 80, 2), 60, 30.0, 2),
    "every 3rd": (range(1000, 1120, 3), 60, 20.0, 3),
    "every 2nd of a broadcast film": (range(0, 80, 2), 59.94, 30000 / 1001, 2),
    "every 2.4th": ([round(2.4 * n) for n in range(FRAMES + 1)], 60, 25.0, 2.4),
    "every 5.5th": ([5 * n + n // 2 for n in range(FRAMES)], 60, 60 / 5.487, 5.49),
}


def counted(folder: Path, numbers: Sequence[int], comment: str = "") -> Path:
    """A CSV with these frame numbers, after a comment."""
    path = folder / "take.csv"
    rows = "".join(f"{n},0.{n % 7}\n" for n in numbers)
    path.write_text(f"{comment}frame,jawOpen\n{rows}")
    return path


@pytest.mark.parametrize(("numbers", "stated", "rate", "step"), COUNTED.values(), ids=COUNTED)
@pytest.mark.parametrize("layout", ["comment", "column", "JSON"])
def test_a_stated_rate_is_that_of_the_frame_numbers(
    tmp_path: Path, numbers: Sequence[int], stated: float, rate: float, step: float, layout: str
) -> None:
    path = tmp_path / "take.csv"
    if layout == "JSON":
        frames = [{"frame": n, "blendshapes": {"jawOpen": n % 7 / 10}} for n in numbers]
        path.write_text(json.dumps({"fps": stated, "frames": frames}))
    elif layout == "column":
        rows = "".join(f"{n},{stated},0.{n % 7}\n" for n in numbers)
        path.write_text(f"frame,fps,jawOpen\n{rows}")
    else:
        counted(tmp_path, numbers, f"# video fps: {stated}, stride: 2\n")
    take = open_take(path)
    assert take.clip.rate == pytest.approx(rate, rel=1e-4)
    exact = 60000 / 1001 if stated == 59.94 else stated
    assert take.clip.times == pytest.approx([(n - numbers[0]) / exact for n in numbers])
    assert not take.clip.gaps
    (note,) = take.notes
    by = f"{step}" if isinstance(step, int) else f"about {step}"
    assert "because the file says" in note
    assert f"its frame numbers step by {by}" in note


def test_frame_numbers_that_lack_some_of_every_second_are_gaps(tmp_path: Path) -> None:
    numbers = [n for n in range(0, 80, 2) if n not in (40, 42)]
    clip = open_take(counted(tmp_path, numbers, "# fps: 60\n")).clip
    assert clip.rate == 30
    assert [(gap.frame, gap.missing) for gap in clip.gaps] == [(19, 2)]


def test_a_rate_for_every_second_frame_number_is_that_of_the_rows(tmp_path: Path) -> None:
    path = counted(tmp_path, range(0, 80, 2))
    with pytest.raises(RateNeeded, match="step by 2 and does not say how many rows"):
        open_take(path)
    take = open_take(path, fps=30)
    assert take.clip.times[-1] == pytest.approx(39 / 30)
    assert "its frame numbers step by 2: 30 fps is the rate of its rows" in take.notes


def test_a_stated_rate_that_leaves_less_than_a_row_a_second_is_asked_about(tmp_path: Path) -> None:
    path = counted(tmp_path, range(0, 600, 15), "# fps: 15\n")
    with pytest.raises(RateNeeded, match='has a row in 1 s, because the file says "fps: 15"'):
        open_take(path)
