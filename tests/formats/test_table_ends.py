"""What stands around the rows of a table is no frame, no column and no lost face."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from support import recordings

from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.errors import FileError
from faceedit_app.formats.opening import open_take, write_take
from faceedit_app.formats.timing import RateNeeded
from faceedit_app.formats.weights import says_percent

NAMES = ARKIT_CHANNELS[:8]
FACE = recordings.face(30, channels=8)
HEAD = ",".join(["time_s", *NAMES])


def rows(scale: float = 1.0) -> list[str]:
    return [
        ",".join([f"{n / 30:.4f}", *(f"{scale * v:.5f}" for v in row)])
        for n, row in enumerate(FACE.tolist())
    ]


def long_rows(scale: float = 1.0) -> list[str]:
    return [
        f"{n / 30:.4f},{name},{scale * v:.5f}"
        for n, row in enumerate(FACE.tolist())
        for name, v in zip(NAMES, row, strict=True)
    ]


@pytest.mark.parametrize("end", [",", ",,", ',""'])
@pytest.mark.parametrize("is_long", [False, True])
def test_a_comma_at_the_end_of_the_header_alone_is_no_column(
    tmp_path: Path, end: str, is_long: bool
) -> None:
    path, out = tmp_path / "take.csv", tmp_path / "out.csv"
    head, body = ("time_s,name,value", long_rows()) if is_long else (HEAD, rows())
    path.write_text("\n".join([head + end, *body]) + "\n")
    take = open_take(path)
    assert take.carried == ()
    np.testing.assert_allclose(take.clip.weights, FACE, atol=1e-5)
    write_take(out, take, take.clip.weights)
    assert out.read_bytes() == path.read_bytes()
    edited = take.clip.weights.copy()
    edited[4, 2] = 0.5
    write_take(out, take, edited)
    assert np.allclose(open_take(out).clip.weights, edited, atol=1e-5)


def test_a_cell_without_a_name_in_one_row_is_still_a_column(tmp_path: Path) -> None:
    path = tmp_path / "take.csv"
    first, *others = rows()
    path.write_text("\n".join([f"{HEAD},", f"{first},7", *(f"{row}," for row in others)]) + "\n")
    assert open_take(path).carried == ("(unnamed)",)
    path.write_text("\n".join([f"{HEAD},", f"{first},7", *others]) + "\n")
    with pytest.raises(FileError, match="line 3: the row is too short"):
        open_take(path)


@pytest.mark.parametrize(
    "footer",
    [
        "Total frames: 30",
        "\nTotal frames: 30\nDuration: 3.0 s",
        "END",
        "30 frames",
        "end 3",
    ],
)
def test_text_after_the_last_row_is_no_lost_face(tmp_path: Path, footer: str) -> None:
    path, out = tmp_path / "take.csv", tmp_path / "out.csv"
    path.write_text("\n".join([HEAD, *rows(), footer]) + "\n")
    take = open_take(path)
    assert (len(take.clip), take.notes, take.faceless) == (30, (), None)
    write_take(out, take, take.clip.weights)
    assert out.read_bytes() == path.read_bytes()


@pytest.mark.parametrize("last", ["1.0000", "1.0000,lost", "1.0000,,,,,,,,", "nan"])
def test_a_last_row_without_a_face_is_still_one(tmp_path: Path, last: str) -> None:
    path = tmp_path / "take.csv"
    last = last if last != "1.0000,lost" else ",".join(["1.0000", *["lost"] * 8])
    path.write_text("\n".join([HEAD, *rows(), last]) + "\n")
    lost = any("the face was lost in 1 row" in note for note in open_take(path).notes)
    assert lost is (last != "nan")


@pytest.mark.parametrize("rate", [None, 30.0])
@pytest.mark.parametrize("often", [2, 3])
@pytest.mark.parametrize("index", ["", ",row"])
def test_a_table_with_each_row_several_times_is_refused(
    tmp_path: Path, rate: float | None, often: int, index: str
) -> None:
    path = tmp_path / "take.csv"
    body = [row for row in rows() for _ in range(often)]
    body = [f"{row},{n}" for n, row in enumerate(body)] if index else body
    path.write_text("\n".join([HEAD + index, *body]) + "\n")
    said = "twice" if often == 2 else "3 times"
    with pytest.raises(FileError, match=f"line 3: has each row {said}, with the same time"):
        open_take(path, rate)


@pytest.mark.parametrize("still", [False, True])
def test_times_that_repeat_for_other_weights_or_a_still_face_only_ask(
    tmp_path: Path, still: bool
) -> None:
    path = tmp_path / "take.csv"
    weights = [row.partition(",")[2] for row in rows()]
    weights = [weights[0]] * 30 if still else weights
    lines = [f"{n // 2 / 15:.4f},{row}" for n, row in enumerate(weights)]
    path.write_text("\n".join([HEAD, *lines]) + "\n")
    with pytest.raises(RateNeeded):
        open_take(path)
    assert len(open_take(path, 30).clip) == 30


@pytest.mark.parametrize(
    ("text", "is_percent"),
    [
        ("# weights in percent (0-100)", True),
        ("# Blendshape values range from 0 to 100", True),
        ("values: 0..100", True),
        ("# percent weights", True),
        ("# weights are 0-1, not percent", False),
        ("# weights from 0.0 to 1.0 (100 %)", False),
        ("# values of frames 0-100", False),
        ("# frames 0-100, 52 blendshapes", False),
        ("# confidence in percent, weights as tracked", False),
        ("# weights smoothed by 50%", False),
        ("# fps: 30", False),
    ],
)
@pytest.mark.parametrize("is_long", [False, True])
def test_a_line_before_the_header_says_the_scale(
    tmp_path: Path, text: str, is_percent: bool, is_long: bool
) -> None:
    assert says_percent(text) is is_percent
    path = tmp_path / "take.csv"
    quiet = 2.0 / FACE.max()  # on a scale of 100; no number shows the scale
    head, body = ("time_s,name,value", long_rows) if is_long else (HEAD, rows)
    path.write_text("\n".join([text, head, *body(quiet)]) + "\n")
    largest = open_take(path).clip.weights.max()
    assert largest == pytest.approx(0.02 if is_percent else 2.0, rel=1e-3)


def test_a_line_that_says_percent_of_weights_up_to_1_is_mentioned(tmp_path: Path) -> None:
    path = tmp_path / "take.csv"
    path.write_text("\n".join(["# weights in percent", HEAD, *rows()]) + "\n")
    take = open_take(path)
    np.testing.assert_allclose(take.clip.weights, FACE, atol=1e-5)
    note = "a line before the header says percent, but the weights run from 0 to 1: read as such"
    assert note in take.notes
