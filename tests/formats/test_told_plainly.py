"""What a file says about itself wrongly or ambiguously is said, and is written plainly."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from support import recordings

from faceedit_app.cli import main
from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.formats.opening import open_take

FACE = recordings.face(12).tolist()


@pytest.mark.parametrize("odd", ["nan", "٠.١", "1e-1"])
def test_a_plain_csv_has_plain_numbers_in_every_channel(tmp_path: Path, odd: str) -> None:
    path, out = tmp_path / "take.csv", tmp_path / "out.csv"
    rows = "".join(f"{k / 30:.6f},0.{k},{odd}\n" for k in range(9))
    path.write_text(f"time_s,jawOpen,mouthClose\n{rows}", encoding="utf-8")
    assert main(["convert", str(path), str(out), "--format", "csv"]) == 0
    written = out.read_bytes()
    assert (written == path.read_bytes()) is (odd == "1e-1")
    assert written.isascii()
    assert b"nan" not in written
    assert open_take(out).clip.weights[:, 0].tolist() == pytest.approx([k / 10 for k in range(9)])


@pytest.mark.parametrize("said", [3, 120])
def test_a_count_of_frames_that_is_wrong_is_said_and_written_right(
    tmp_path: Path, said: int
) -> None:
    path, out = tmp_path / "take.json", tmp_path / "out.json"
    document: dict[str, object] = {"exportFps": 30, "numPoses": 52, "numFrames": said}
    document |= {"facsNames": list(ARKIT_CHANNELS), "weightMat": FACE}
    path.write_text(json.dumps(document))
    assert f"numFrames says {said}, there are 12" in open_take(path).notes
    assert main(["convert", str(path), str(out), "--format", "audio2face"]) == 0
    assert json.loads(out.read_text())["numFrames"] == 12
    assert open_take(out).notes == ()


def test_of_two_lists_of_people_the_one_that_is_read_is_named(tmp_path: Path) -> None:
    path = tmp_path / "take.json"
    frames = [{"time": k / 30, "jawOpen": 0.1 * k} for k in range(9)]
    path.write_text(json.dumps({"pose": frames[:1], "left": frames, "right": frames}))
    says = "of several faces or takes"
    assert [note for note in open_take(path).notes if says in note]
    path.write_text(json.dumps({"left": frames, "right": frames}))
    assert 'holds 2 lists of frames, of several faces or takes: "left" is read' in (
        open_take(path).notes
    )
    path.write_text(json.dumps({"left": frames, "events": [{"time": 0}, {"time": 1}]}))
    assert open_take(path).notes == ()


@pytest.mark.parametrize(
    ("row", "frames"), [("s,-,-", 9), ("[ms],%,-", 9), ("0.0,-,-", 9), ("lost,-,-", 9)]
)
def test_a_row_of_units_is_no_lost_face_and_the_reverse(
    tmp_path: Path, row: str, frames: int
) -> None:
    path = tmp_path / "take.csv"
    rows = "".join(f"{(k + 1) / 30:.6f},0.{k},0.2\n" for k in range(9))
    path.write_text(f"time_s,jawOpen,mouthClose\n{row}\n{rows}")
    take = open_take(path)
    assert len(take.clip) == frames
    is_lost = row[0] in "0l"
    assert any("the face was lost" in note for note in take.notes) is is_lost


@pytest.mark.parametrize(("rate", "name"), [(15 / 1.001, "14.985 fps"), (15, "15 fps")])
def test_half_a_broadcast_rate_has_its_true_name(
    tmp_path: Path, rate: float, name: str, capfd: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "take.csv"
    rows = "".join(f"{k / rate:.6f},0.{k % 10}\n" for k in range(200))
    path.write_text(f"time_s,jawOpen\n{rows}")
    assert main(["info", str(path)]) == 0
    assert f"200 at {name}" in capfd.readouterr().out
