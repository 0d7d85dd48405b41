"""Takes with times in seconds, ours and Audio2Face's."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from support.takes import make_plain_csv

from faceedit_app.core.errors import FileError
from faceedit_app.formats.opening import open_take, write_take


def table(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "take.csv"
    path.write_text(text, encoding="utf-8", newline="")
    return path


@pytest.mark.parametrize("rate", [24, 25, 30, 48, 50, 60, 120])
def test_the_rate_comes_from_rounded_times(tmp_path: Path, rate: int) -> None:
    clip = open_take(make_plain_csv(tmp_path / "take.csv", rate=rate)).clip
    assert clip.rate == rate
    assert clip.gaps == ()
    assert clip.timecodes is None
    assert len(clip.channels) == 52


def test_a_broadcast_rate_is_told_from_its_neighbour(tmp_path: Path) -> None:
    path = make_plain_csv(tmp_path / "take.csv", seconds=20, rate=30000 / 1001)
    assert open_take(path).clip.rate == pytest.approx(29.97003)


def test_an_edit_changes_its_cell_in_the_source_s_format(tmp_path: Path) -> None:
    path = make_plain_csv(tmp_path / "take.csv")
    take = open_take(path)
    weights = take.clip.weights.copy()
    weights[10, take.clip.channels.index("jawOpen")] = 0.4321987
    out = tmp_path / "out.csv"
    write_take(out, take, weights)
    before, after = path.read_text().splitlines(), out.read_text().splitlines()
    assert [i for i in range(len(before)) if before[i] != after[i]] == [11]
    changed = set(after[11].split(",")) - set(before[11].split(","))
    assert changed == {"0.43220"}


def test_audio2face_opens_with_its_index_column_and_prefix(tmp_path: Path) -> None:
    rows = "".join(f"{i},{i / 30:.6f},{0.01 * i},0.5\n" for i in range(40))
    path = table(tmp_path, ",timeCode,blendShapes.JawOpen,blendShapes.EyeBlinkLeft\n" + rows)
    take = open_take(path)
    assert take.format == "CSV with times in seconds"
    assert take.clip.channels == ("jawOpen", "eyeBlinkLeft")
    assert take.clip.rate == 30
    assert take.carried == ("(unnamed)",)
    assert take.source.encode(take.clip.weights, take.clip.weights) == path.read_bytes()


@pytest.mark.parametrize("name", ["Timecode", "frame", "time"])
def test_frame_numbers_open_at_an_assumed_rate_that_is_admitted(tmp_path: Path, name: str) -> None:
    rows = "".join(f"{i}.0,68.0,-0.017023563385009766\n" for i in range(100) if i != 50)
    path = table(tmp_path, f"{name},BlendshapeCount,JawOpen\n" + rows)
    take = open_take(path)
    assert take.format == "CSV with frame numbers"
    assert take.clip.rate == 60
    assert take.clip.duration == pytest.approx(100 / 60)
    assert take.notes == (f"{name} counts frames: 60 fps is assumed", "1 gap, 1 frame missing")
    assert take.source.encode(take.clip.weights, take.clip.weights) == path.read_bytes()


def test_times_begin_at_the_first_frame_and_keep_gaps(tmp_path: Path) -> None:
    rows = "".join(f"{5 + i / 25:.2f},0.1\n" for i in range(50) if i not in (20, 21))
    take = open_take(table(tmp_path, "time_s,jawOpen\n" + rows))
    assert take.clip.times[0] == 0
    assert [(gap.frame, gap.missing) for gap in take.clip.gaps] == [(19, 2)]
    assert take.notes == ("1 gap, 2 frames missing",)


def test_an_unusual_rate_is_kept_and_noted(tmp_path: Path) -> None:
    rows = "".join(f"{i / 27.3:.6f},0.1\n" for i in range(50))
    take = open_take(table(tmp_path, "time,jawOpen\n" + rows))
    assert take.clip.rate == pytest.approx(27.3, abs=1e-3)
    assert take.notes == ("27.3 fps is not a usual frame rate",)


def test_a_single_frame_opens(tmp_path: Path) -> None:
    take = open_take(table(tmp_path, "time_s,jawOpen\n2.5,0.1\n"))
    assert np.array_equal(take.clip.times, [0.0])
    assert take.clip.rate == 60


@pytest.mark.parametrize(
    ("text", "line", "says"),
    [
        ("time_s,jawOpen\n0,0\n0.1,0\n0.1,0\n", 4, "0.1 does not come after 0.1"),
        ("time_s,jawOpen\n0,0\n0.1,0\n0.05,0\n", 4, "0.05 does not come after 0.1"),
        ("time_s,jawOpen\n0,0\n1,0\n2,0\n", 3, "cannot be seconds"),
        ("frame,jawOpen\n0,0\n1,0\n1,0\n2,0\n3,0\n", 4, "1 does not come after 1"),
        ("time_s,jawOpen\n0,0\n33,0\n67,0\n", 3, "cannot be seconds"),
        ("time_s,jawOpen\n0,0\n1e-300,0\n", 3, "cannot be seconds"),
        ("time_s,jawOpen\n0,0\nlater,0\n", 3, 'column "time_s" holds "later"'),
        ("time_s,jawOpen\nnan,0\n1,0\n", 2, "not a finite number"),
        ("time_s;jawOpen\n0;0,5\n", 2, "write decimals with a point"),
        ("sample,jawOpen\n0,0\n", 1, "no column with times"),
        ("time_s,jawOpen\n", 1, "no frames"),
    ],
)
def test_a_bad_file_is_told_in_one_line(tmp_path: Path, text: str, line: int, says: str) -> None:
    with pytest.raises(FileError) as caught:
        open_take(table(tmp_path, text))
    assert caught.value.line == line
    assert says in str(caught.value)
