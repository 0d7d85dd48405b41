"""Of several faces in one file, one is read; where nothing tells them apart, the file is refused.

A single face whose times come twice is read as before.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from support import recordings

from faceedit_app.cli import main
from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.errors import FileError
from faceedit_app.formats.opening import open_take, write_take

FRAMES = 40
NAMES = ARKIT_CHANNELS[:12]
FIRST, SECOND = recordings.face(FRAMES, channels=12), 0.1 + 0.7 * recordings.face(FRAMES, 12)[::-1]
TIMES = {
    "time_s": [f"{k / 30:.4f}" for k in range(FRAMES)],
    "Timecode": [f"01:00:{k // 30:02d}:{k % 30:02d}" for k in range(FRAMES)],
    "frame": [str(k) for k in range(FRAMES)],
}


def table(
    path: Path,
    clock: str,
    faces: Sequence[np.ndarray],
    column: str = "",
    labels: Sequence[str] = ("0", "1"),
) -> Path:
    """Rows of faces in turn, each time once for each of them."""
    lines = [",".join([clock, *([column] if column else []), *NAMES])]
    for k, time in enumerate(TIMES[clock]):
        for label, face in zip(labels, faces, strict=False):
            cells = [time, *([label] if column else []), *(f"{v:.5f}" for v in face[k])]
            lines.append(",".join(cells))
    path.write_text("\n".join(lines) + "\n")
    return path


@pytest.mark.parametrize("clock", ["time_s", "Timecode"])
@pytest.mark.parametrize(
    ("column", "labels"),
    [
        ("face_id", ("0", "1")),
        ("Subject", ("0", "1")),
        ("id", ("7", "9")),
        ("track_id", ("0", "1")),
        ("Performer name", ("Anna", "Bob")),
        ("k", ("0", "1")),
    ],
)
def test_a_column_tells_the_faces_apart_by_its_name_or_its_labels(
    tmp_path: Path, clock: str, column: str, labels: tuple[str, str]
) -> None:
    path = table(tmp_path / "take.csv", clock, (FIRST, SECOND), column, labels)
    take, out = open_take(path), tmp_path / "out.csv"
    assert (len(take.clip), take.clip.rate, take.clip.gaps) == (FRAMES, 30, ())
    np.testing.assert_allclose(take.clip.weights, FIRST, atol=1e-5)
    assert f"has rows of 2 faces: those with {labels[0]} as {column} are read" in take.notes
    write_take(out, take, take.clip.weights)
    assert out.read_bytes() == path.read_bytes()


@pytest.mark.parametrize("clock", ["time_s", "frame"])
def test_the_number_of_the_face_is_no_time_where_it_stands_first(
    tmp_path: Path, clock: str
) -> None:
    path = table(tmp_path / "take.csv", clock, (FIRST, SECOND), "face_index")
    cells = [line.split(",") for line in path.read_text().splitlines()]
    path.write_text("".join(",".join([row[1], row[0], *row[2:]]) + "\n" for row in cells))
    take = open_take(path, 30)
    np.testing.assert_allclose(take.clip.weights, FIRST, atol=1e-5)
    assert take.unread == ("has rows of 2 faces: those with 0 as face_index are read",)


@pytest.mark.parametrize("rate", ["30", "60"])
def test_a_file_that_has_only_the_face_that_was_read_says_so(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], rate: str
) -> None:
    path = table(tmp_path / "take.csv", "time_s", (FIRST, SECOND), "face_id")
    said = "has rows of 2 faces: those with 0 as face_id are read; the rest is left out"
    assert main(["convert", str(path), str(tmp_path / "out.csv"), "--fps", rate]) == 0
    is_whole = rate == "30"  # the take's own file with both faces
    assert (said not in capfd.readouterr().out) is is_whole
    assert ((tmp_path / "out.csv").read_bytes() == path.read_bytes()) is is_whole
    frames = [
        {"time": k / 30, "face": which, "weights": dict(zip(NAMES, face[k].tolist(), strict=True))}
        for k in range(FRAMES)
        for which, face in enumerate((FIRST, SECOND))
    ]
    (tmp_path / "take.json").write_text(json.dumps(frames))
    assert main(["convert", str(tmp_path / "take.json"), str(tmp_path / "json.csv")]) == 0
    said = "has frames of 2 faces: those of the first are read; the rest is left out"
    assert said in capfd.readouterr().out


@pytest.mark.parametrize(("clock", "count"), [("time_s", 2), ("Timecode", 3), ("frame", 2)])
def test_faces_that_nothing_tells_apart_are_refused_with_the_line(
    tmp_path: Path, clock: str, count: int
) -> None:
    faces = (FIRST, SECOND, 0.5 + 0.0 * FIRST)[:count]
    path = table(tmp_path / "take.csv", clock, faces, labels="abc")
    with pytest.raises(FileError, match=rf"line 3: the time .* for one of {count} faces") as error:
        open_take(path)
    assert "face_id" in error.value.remedy
    assert len(str(error.value)) - len(str(path)) < 300


def test_faces_in_another_order_each_time_are_refused(tmp_path: Path) -> None:
    mixed = np.arange(FRAMES)[:, None] % 3 > 0
    faces = np.where(mixed, FIRST, SECOND), np.where(mixed, SECOND, FIRST)
    with pytest.raises(FileError, match="one of 2 faces"):
        open_take(table(tmp_path / "take.csv", "time_s", faces))


@pytest.mark.parametrize("column", ["", "subframe", "device_time", "Subject"])
@pytest.mark.parametrize("noise", [0.0, 0.01])
def test_one_face_at_twice_the_rate_of_its_timecode_stays_one(
    tmp_path: Path, column: str, noise: float
) -> None:
    face = recordings.face(2 * FRAMES, channels=12)
    face += noise * np.random.default_rng(3).standard_normal(face.shape)
    halves = face[::2], face[1::2]
    labels = ("me", "me") if column == "Subject" else ("0", "1")
    path = table(tmp_path / "take.csv", "Timecode", halves, column, labels)
    take = open_take(path)
    assert (len(take.clip), take.clip.rate) == (2 * FRAMES, 60)
    assert not any("faces" in note for note in take.notes)


@pytest.mark.parametrize("column", ["", "faceId"])
def test_faces_in_turn_in_json_are_told_apart_or_refused(tmp_path: Path, column: str) -> None:
    frames = [
        {"time": k / 30, "blendshapes": dict(zip(NAMES, face[k].tolist(), strict=True))}
        | ({column: n} if column else {})
        for k in range(FRAMES)
        for n, face in enumerate((FIRST, SECOND))
    ]
    path = tmp_path / "take.json"
    path.write_text(json.dumps(frames))
    if not column:
        with pytest.raises(FileError, match="frames 1 and 2 have the same time, of 2 faces"):
            open_take(path)
        return
    take = open_take(path)
    np.testing.assert_allclose(take.clip.weights, FIRST, atol=1e-5)
    assert (take.clip.rate, take.notes) == (
        30,
        ("has frames of 2 faces: those of the first are read",),
    )
