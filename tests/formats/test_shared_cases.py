"""Small inputs in the layouts of twelve tools, where they are at hand, and what each must give."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from support.places import SHARED

from faceedit_app.core.errors import FileError
from faceedit_app.formats.opening import open_take, write_take
from faceedit_app.formats.registry import is_take
from faceedit_app.formats.timing import RateNeeded

CASES = SHARED / "cases"
HOSTILE = sorted((CASES / "hostile").glob("*.csv")) + sorted((CASES / "hostile").glob("*.glb"))

pytestmark = pytest.mark.skipif(
    not CASES.exists(), reason="no cases here; FACEEDIT_SHARED may name their folder"
)

# File: frames, frames per second, seconds, missing frames, words that some remark must have.
KNOWN: dict[str, tuple[int, float, float, int, str]] = {
    "tc_frame_counter_24fps.csv": (50, 24, 2.083, 0, "number the frames"),
    "tc_frame_counter_30fps.csv": (64, 30, 2.133, 0, "number the frames"),
    "tc_frame_counter_60fps.csv": (125, 60, 2.083, 0, "number the frames"),
    "tc_milliseconds_25fps.csv": (55, 25, 2.200, 0, "milliseconds"),
    "tc_milliseconds_30fps.csv": (64, 30, 2.133, 0, "milliseconds"),
    "tc_frame_and_ms_of_second_25fps.csv": (55, 25, 2.200, 0, "milliseconds of the second"),
    "tc_frame_and_ms_of_second_30fps.csv": (65, 30, 2.167, 0, "milliseconds of the second"),
    "tc_frame_and_ms_of_second_60fps.csv": (125, 60, 2.083, 0, "milliseconds of the second"),
    "tc_rounded_up_to_base.csv": (64, 30, 2.133, 0, "30 fps: the timecode counts 60"),
    "tc_dot_milliseconds_30fps.csv": (64, 30, 2.133, 0, ""),
    "frame_and_timestamp_ms.csv": (64, 30, 2.133, 0, ""),
    "frame_and_timestamp_s.csv": (64, 30, 2.133, 0, ""),
    "timestamp_s.csv": (64, 30, 2.133, 0, ""),
    "timestamp_ms.csv": (64, 30, 2.133, 0, ""),
    "time_ms.csv": (64, 30, 2.133, 0, "milliseconds"),
    "timestamp_iso.csv": (64, 60, 1.067, 0, ""),
    "timestamp_epoch_ms.csv": (64, 60, 1.067, 0, ""),
    "names_suffix_LR.csv": (64, 30, 2.133, 0, ""),
    "livelink_names_suffix_LR.csv": (64, 30, 2.133, 0, ""),
    "scale_0_to_100.csv": (64, 30, 2.133, 0, "percent"),
    "lost_face_nan.csv": (59, 30, 2.133, 5, "lost in 5 rows at 1 place"),
    "lost_face_empty_cells.csv": (59, 30, 2.133, 5, "lost in 5 rows at 1 place"),
    "last_row_time_only.csv": (63, 30, 2.100, 0, "lost in 1 row at 1 place"),
    "livelink_count_0_zero_filled.csv": (59, 30, 2.133, 5, "lost in 5 rows at 1 place"),
    "audio2face_export.json": (30, 60, 0.5, 0, ""),
    "audio2face_export_one_line.json": (30, 60, 0.5, 0, ""),
    "beat_lam_frames.json": (30, 30, 1.0, 0, ""),
    "mediapipe_categories.json": (30, 60, 0.5, 0, ""),
    "facecap_recording.txt": (40, 30, 1.333, 0, ""),
    "morph_animation.glb": (40, 30, 1.333, 0, ""),
    "hostile/time_2_decimals_60fps.csv": (500, 60, 8.333, 0, "rounded to 0.01 s"),
    "hostile/first_row_0_then_unix_time.csv": (101, 60, 1.683, 0, "more than an hour"),
    "hostile/gap_1e5s.csv": (102, 60, 1.700, 0, "more than an hour"),
    "hostile/gap_3e6s.csv": (102, 60, 1.700, 0, "more than an hour"),
}
# File: the likely rate.
ASKING = {
    "tc_one_second_per_row.csv": 60,
    "no_time_column.csv": 60,
    "hostile/timecode_flips_over_midnight.csv": 60,
}


def case(name: str) -> Path:
    path = CASES / name
    if not path.exists():
        pytest.skip(f"{name} is kept elsewhere")
    return path


@pytest.mark.parametrize("name", KNOWN)
def test_a_case_opens_with_its_time_and_exports_the_same_bytes(name: str, tmp_path: Path) -> None:
    path = case(name)
    frames, rate, seconds, missing, remark = KNOWN[name]
    take = open_take(path)
    assert len(take.clip) == frames
    assert take.clip.rate == rate
    assert take.clip.duration == pytest.approx(seconds, abs=1e-3)
    assert sum(gap.missing for gap in take.clip.gaps) == missing
    assert remark in " ".join(take.notes)
    write_take(tmp_path / "out", take, take.clip.weights)
    assert (tmp_path / "out").read_bytes() == path.read_bytes()
    assert is_take(path)


@pytest.mark.parametrize("name", ASKING)
def test_a_case_without_usable_times_asks(name: str) -> None:
    path = case(name)
    with pytest.raises(RateNeeded) as asked:
        open_take(path)
    assert asked.value.rate == ASKING[name]
    take = open_take(path, fps=asked.value.rate)
    assert take.clip.duration == pytest.approx(asked.value.frames / asked.value.rate)


def test_short_sides_are_the_right_ones() -> None:
    clip = open_take(case("names_suffix_LR.csv")).clip
    assert len(clip.channels) == 25
    peaks = dict(zip(clip.channels, clip.weights.max(axis=0), strict=True))
    assert peaks["eyeBlinkLeft"] == pytest.approx(0.8, abs=0.02)
    assert peaks["eyeBlinkRight"] == pytest.approx(0.7, abs=0.02)
    assert np.isclose(clip.weights[:, clip.channels.index("mouthSmileLeft")], 0.3).all()
    assert {"jawLeft", "jawRight", "mouthLeft", "mouthRight"} <= {*clip.channels}


def test_percent_is_the_same_face() -> None:
    percent = open_take(case("scale_0_to_100.csv")).clip
    parts = open_take(case("names_suffix_LR.csv")).clip
    assert percent.channels == parts.channels
    assert np.allclose(percent.weights, parts.weights, atol=1e-4)


@pytest.mark.parametrize("path", HOSTILE, ids=lambda path: path.name)
def test_a_hostile_file_opens_or_is_refused_in_one_line(path: Path) -> None:
    try:
        take = open_take(path)
    except FileError:  # which is one line by construction
        return
    assert take.source.encode(take.clip.weights, take.clip.weights) == path.read_bytes()
