"""Rows that lost the face are gaps in whatever way the file says so, and stay as they are."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.errors import FileError
from faceedit_app.formats.opening import open_take, write_take

NAMES = ("jawOpen", "eyeBlinkLeft", "eyeBlinkRight", "mouthFunnel")
FRAMES, LOST = 40, (20, 21, 22)


def row(n: int) -> list[str]:
    weights = (f"{0.3 + 0.2 * np.sin(n / 5 + k):.4f}" for k in range(len(NAMES)))
    return [f"{n / 30:.4f}", *weights]


def table(head: list[str], rows: list[list[str]]) -> str:
    return "\n".join(",".join(cells) for cells in [head, *rows]) + "\n"


def in_all_cells(word: str) -> str:
    lost = {n: [f"{n / 30:.4f}", *[word] * len(NAMES)] for n in LOST}
    return table(["time_s", *NAMES], [lost.get(n, row(n)) for n in range(FRAMES)])


def flagged(name: str, seen: str, lost: str) -> str:
    rows = [[*row(n), lost if n in LOST else seen] for n in range(FRAMES)]
    return table(["time_s", *NAMES, name], rows)


CONTENTS = {
    **{
        f"{word} in all cells": in_all_cells(word)
        for word in ("?", "<NA>", "\\N", "1.#QNAN", "#NUM!", "lost", "no face", "-999", "99999")
    },
    "a word in one cell": table(
        ["time_s", *NAMES],
        [[row(n)[0], "no face", "", "", ""] if n in LOST else row(n) for n in range(FRAMES)],
    ),
    "a state": flagged("trackingState", "normal", "notTracking"),
    "a status": flagged("status", "OK", "lost"),
    "lost is true": flagged("Lost", "False", "True"),
    "lost is 1": flagged("face_lost", "0", "1"),
    "not tracked": flagged("isTracking", "1", "0"),
}


@pytest.mark.parametrize("content", CONTENTS.values(), ids=CONTENTS)
def test_rows_that_lost_the_face_are_one_gap(tmp_path: Path, content: str) -> None:
    path, out = tmp_path / "take.csv", tmp_path / "out.csv"
    path.write_text(content)
    take = open_take(path)
    assert [(gap.frame, gap.missing) for gap in take.clip.gaps] == [(19, 3)]
    assert any("the face was lost in 3 rows at 1 place" in note for note in take.notes)
    edited = take.clip.weights.copy()
    edited[5, 0] = 0.75
    write_take(out, take, edited)
    before, after = content.splitlines(), out.read_text().splitlines()
    assert [n for n, (a, b) in enumerate(zip(before, after, strict=True)) if a != b] == [6]


@pytest.mark.parametrize("name", ["status", "state"])
def test_numbers_of_a_state_say_nothing(tmp_path: Path, name: str) -> None:
    path = tmp_path / "take.csv"
    path.write_text(flagged(name, "1", "0"))
    assert len(open_take(path).clip) == FRAMES


def test_a_row_of_several_words_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "take.csv"
    rows = [row(n) for n in range(FRAMES)]
    path.write_text(table(["time_s", *NAMES], [*rows[:20], ["time_s", *NAMES[::-1]], *rows[20:]]))
    with pytest.raises(FileError, match="line 22"):
        open_take(path)


def blank(lost: tuple[int, ...], fade: float = 1.0) -> str:
    """A take whose weights are 0 in some rows, and otherwise a share of what they are."""
    rows = [
        [f"{n / 30:.4f}", *(f"{0 if n in lost else fade * 0.2:.3f}" for _ in ARKIT_CHANNELS)]
        for n in range(FRAMES)
    ]
    return table(["time_s", *ARKIT_CHANNELS], rows)


def test_weights_that_drop_to_0_together_are_reported_but_kept(tmp_path: Path) -> None:
    path = tmp_path / "take.csv"
    path.write_text(blank(LOST))
    take = open_take(path)
    assert len(take.clip) == FRAMES
    assert "all weights are 0 in 3 frames at 1 place: the face may have been lost there" in (
        take.notes
    )


def test_a_neutral_face_that_comes_gradually_is_not_reported(tmp_path: Path) -> None:
    path = tmp_path / "take.csv"
    path.write_text(blank(LOST, fade=0.1))
    assert not any("all weights are 0" in note for note in open_take(path).notes)


def two_faces() -> str:
    """Rows of two faces in turn, at the same times."""
    rows = [
        [f"{n / 30:.4f}", str(face), *(f"0.{face + 1}{n:02d}" for _ in NAMES)]
        for n in range(FRAMES)
        for face in (0, 1)
    ]
    return table(["time_s", "face_id", *NAMES], rows)


def test_of_two_faces_the_first_is_read_and_the_other_kept(tmp_path: Path) -> None:
    path, out = tmp_path / "take.csv", tmp_path / "out.csv"
    path.write_text(two_faces())
    take = open_take(path)
    assert (len(take.clip), take.clip.rate, take.clip.gaps) == (FRAMES, 30, ())
    assert take.clip.weights[:, 0].max() < 0.2
    assert any("rows of 2 faces" in note for note in take.notes)
    edited = take.clip.weights.copy()
    edited[3, 0] = 0.9
    write_take(out, take, edited)
    before, after = path.read_text().splitlines(), out.read_text().splitlines()
    assert [n for n, (a, b) in enumerate(zip(before, after, strict=True)) if a != b] == [7]


def test_a_face_that_was_found_again_under_another_number_is_one_face(tmp_path: Path) -> None:
    path = tmp_path / "take.csv"
    rows = [[row(n)[0], "0" if n < 20 else "1", *row(n)[1:]] for n in range(FRAMES)]
    path.write_text(table(["time_s", "face_id", *NAMES], rows))
    assert len(open_take(path).clip) == FRAMES
