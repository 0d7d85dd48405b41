"""The tracker's confidence stays with its frames, in the take's own file."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from faceedit_app.cli import main
from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.clip import Clip
from faceedit_app.formats import audio2face, csv_take, livelink
from faceedit_app.formats.opening import open_take
from faceedit_app.formats.take import FillableSource

COUNT = 40
SURE = np.linspace(1.0, 0.61, COUNT).astype(np.float32)
STILL = np.zeros((COUNT, 9), np.float32)


def a_clip(confidence: np.ndarray | None = SURE) -> Clip:
    weights = np.full((COUNT, len(ARKIT_CHANNELS)), 0.25, np.float32)
    return Clip(weights, ARKIT_CHANNELS, np.arange(COUNT) / 25.0, 25.0, confidence=confidence)


def named_frames(clip: Clip) -> bytes:
    """JSON as scripts write it, with a frame without a face."""
    columns = [clip.times, np.zeros(COUNT) if clip.confidence is None else clip.confidence]
    rows: list[dict[str, object]] = [
        {"time": time, "confidence": sure, **dict(zip(clip.channels, weights, strict=True))}
        for time, sure, weights in zip(*(c.tolist() for c in (*columns, clip.weights)), strict=True)
    ]
    return json.dumps([*rows, {"time": COUNT / 25.0, "confidence": 0.0}]).encode()


WRITERS = {
    "livelink": livelink.write,
    "csv": csv_take.write,
    "audio2face": audio2face.write,
    "named": named_frames,
}


@pytest.fixture(params=WRITERS)
def take(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    path = tmp_path / ("take.csv" if request.param in ("livelink", "csv") else "take.json")
    path.write_bytes(WRITERS[request.param](a_clip()))
    return path


def test_a_take_says_how_sure_it_is_of_each_frame(take: Path) -> None:
    opened = open_take(take)
    assert opened.clip.confidence == pytest.approx(SURE, abs=6e-4)
    assert not any("header has" in note for note in opened.notes)
    assert [name.lower() for name in opened.carried][-1] == "confidence"
    assert len(opened.clip.channels) == len(ARKIT_CHANNELS)


@pytest.mark.parametrize("rate", [24, 25, 30, 60])
@pytest.mark.parametrize("lost", [(3, 4), (23, 24, 29, 30), range(10, 35), ()])
def test_the_timecode_of_a_tracked_take_is_known(
    rate: int, lost: Sequence[int], tmp_path: Path
) -> None:
    """Also if it is short, or has gaps where its seconds end."""
    clip, kept = a_clip(), np.setdiff1d(np.arange(COUNT), lost)
    times = (np.arange(COUNT) / rate)[kept]
    clip = replace(clip, weights=clip.weights[kept], times=times, confidence=SURE[kept])
    path = tmp_path / "take.csv"
    path.write_bytes(livelink.write(replace(clip, rate=float(rate))))
    opened = open_take(path)
    assert opened.clip.rate == rate
    assert opened.clip.times == pytest.approx(times, abs=1e-4)
    assert not any("assumed" in note for note in opened.notes)


@pytest.mark.parametrize("form", ["livelink", "csv", "audio2face"])
@pytest.mark.parametrize("rate", [25, 60, 12])
def test_it_survives_other_formats_and_frame_rates(
    take: Path, tmp_path: Path, form: str, rate: int, capfd: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    assert main(["convert", str(take), str(out), "--format", form, "--fps", str(rate)]) == 0
    assert "onfidence" not in capfd.readouterr().out  # it is not left out
    clip = open_take(out).clip
    assert clip.rate == rate
    assert clip.confidence is not None
    expected = np.interp(clip.times, np.arange(COUNT) / 25.0, SURE)
    np.testing.assert_allclose(clip.confidence[1:-1], expected[1:-1], atol=0.01)


def test_every_row_of_a_csv_has_a_number_in_every_column() -> None:
    """Unreal's importer stops at the first row that has not."""
    for write in (livelink.write, csv_take.write):
        rows = [line.split(",") for line in write(a_clip()).decode().splitlines()]
        assert {len(row) for row in rows} == {len(rows[0])}
        assert all(all(row) for row in rows)


def test_a_take_without_it_has_no_such_column() -> None:
    for write in (livelink.write, csv_take.write, audio2face.write):
        assert b"onfidence" not in write(a_clip(None))


def test_what_a_format_without_times_fills_in_is_not_called_certain(tmp_path: Path) -> None:
    whole, kept = a_clip(np.ones(COUNT, np.float32)), np.delete(np.arange(COUNT), range(20, 26))
    clip = Clip(
        whole.weights[kept],
        ARKIT_CHANNELS,
        whole.times[kept],
        25.0,
        confidence=np.ones(len(kept), np.float32),
    )
    path, out = tmp_path / "take.csv", tmp_path / "out.json"
    path.write_bytes(csv_take.write(clip))
    assert main(["convert", str(path), str(out), "--format", "audio2face"]) == 0
    sure = open_take(out).clip.confidence
    assert sure is not None
    assert np.flatnonzero(sure < 0.9).tolist() == list(range(20, 26))
    assert sure[20:26].max() == 0.0


@pytest.mark.parametrize(
    "cells", [["high"] * COUNT, ["98"] * COUNT, ["nan"] * COUNT, ["1e300"] * COUNT]
)
def test_a_column_of_other_values_is_only_carried(tmp_path: Path, cells: list[str]) -> None:
    lines = livelink.write(a_clip(None)).decode().splitlines()
    rows = [f"{line},{cell}" for line, cell in zip(lines, ["Confidence", *cells], strict=True)]
    path = tmp_path / "take.csv"
    path.write_text("\n".join(rows) + "\n")
    take = open_take(path)
    assert take.clip.confidence is None
    assert "Confidence" in take.carried


def test_what_is_filled_is_not_called_certain(tmp_path: Path) -> None:
    kept = np.delete(np.arange(COUNT), 20)
    whole = a_clip()
    clip = Clip(whole.weights[kept], ARKIT_CHANNELS, whole.times[kept], 25.0, confidence=SURE[kept])
    path = tmp_path / "take.csv"
    path.write_bytes(livelink.write_with(clip, STILL[kept], whole.times[20:21]))
    take = open_take(path)
    assert isinstance(take.source, FillableSource)
    filled = take.source.with_faces(np.full((1, len(ARKIT_CHANNELS)), 0.5, np.float32))
    path.write_bytes(filled.encode(take.clip.weights, take.clip.weights))
    again = open_take(path).clip
    assert len(again) == COUNT
    assert again.confidence is not None
    assert again.confidence[20] == 0.0
    assert main(["convert", str(path), str(tmp_path / "out.csv"), "--format", "csv"]) == 0
    plain = open_take(tmp_path / "out.csv").clip
    assert len(plain) == COUNT
    assert plain.confidence == pytest.approx(again.confidence, abs=1e-6)
    assert again.confidence[19] == pytest.approx(SURE[19], abs=6e-4)


def test_a_film_whose_pictures_come_unevenly_has_gaps_only_where_the_face_was_lost(
    tmp_path: Path,
) -> None:
    times = np.concatenate([[0.0], np.cumsum([0.060, 0.033, 0.033] * 20)])
    kept = np.delete(np.arange(61), 30)
    clip = Clip(
        np.full((60, 52), 0.25, np.float32),
        ARKIT_CHANNELS,
        times[kept],
        25.0,
        confidence=np.ones(60, np.float32),
    )
    path = tmp_path / "take.csv"
    path.write_bytes(livelink.write_with(clip, np.zeros((60, 9), np.float32), times[[30]]))
    take = open_take(path)
    np.testing.assert_allclose(take.clip.times, times[kept], atol=1e-4)
    assert take.clip.rate == pytest.approx(60 / times[-1])
    assert [gap.frame for gap in take.clip.gaps] == [29]
    assert "the film's pictures come unevenly: 23.81 fps on average" in take.notes
