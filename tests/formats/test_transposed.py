"""Tables with a line for each channel open, and an edit changes one number alone."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from support import recordings

from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.errors import FileError
from faceedit_app.formats.opening import open_take, write_take
from faceedit_app.formats.timing import RateNeeded

FACE = recordings.face()[:40]
FRAMES = len(FACE)


def lines(separator: str = ",", number: Callable[[float], str] = str) -> list[str]:
    return [
        separator.join([name, *(number(round(float(v), 5)) for v in FACE[:, k])])
        for k, name in enumerate(ARKIT_CHANNELS)
    ]


def row(name: str, cell: Callable[[int], str], separator: str = ",") -> str:
    return separator.join([name, *map(cell, range(FRAMES))])


def comma(value: float) -> str:
    return f"{value:.5f}".replace(".", ",")


HEAD = row("head x", lambda n: f"0.{n:02d}")
# All are at 30 fps.
TABLES: dict[str, list[str]] = {
    "times in a line": [row("", str), row("timestamp", lambda n: f"{n / 30:.5f}"), *lines(), HEAD],
    "times as titles": [row("channel", lambda n: f"{n / 30:.5f}"), *lines()],
    "milliseconds": [*lines(), row("time_ms", lambda n: f"{n * 100 / 3:.2f}")],
    "timecode": [row("Timecode", lambda n: f"10:00:{n // 30:02d}:{n % 30:02d}"), *lines()],
    "semicolons and decimal commas": [
        row("Zeit", lambda n: comma(n / 30), ";"),
        *lines(";", comma),
    ],
    "a rate before it": ["# fps: 30", row("name", lambda n: f"frame_{n}"), *lines()],
}


@pytest.mark.parametrize("table", TABLES.values(), ids=TABLES)
def test_a_table_opens_and_an_edit_changes_its_number_alone(
    tmp_path: Path, table: list[str]
) -> None:
    path, out = tmp_path / "weights.csv", tmp_path / "out.csv"
    path.write_text("\n".join(table) + "\n")
    take = open_take(path)
    assert (take.clip.rate, take.clip.gaps) == (30, ())
    assert np.allclose(take.clip.arkit_weights(), FACE, atol=1e-5)
    write_take(out, take, take.clip.weights)
    assert out.read_bytes() == path.read_bytes()
    edited = take.clip.weights.copy()
    edited[20, 7] = 0.87654
    write_take(out, take, edited)
    before, after = path.read_text().splitlines(), out.read_text().splitlines()
    assert sum(a != b for a, b in zip(before, after, strict=True)) == 1
    assert np.allclose(open_take(out).clip.weights, edited, atol=1e-6)


def test_frames_without_numbers_are_a_gap(tmp_path: Path) -> None:
    path = tmp_path / "weights.csv"
    cells = [line.split(",") for line in TABLES["times as titles"]]
    for line in cells[1:]:
        line[11:14] = ["nan", "", "nan"]
    path.write_text("\n".join(",".join(line) for line in cells))
    assert [(gap.frame, gap.missing) for gap in open_take(path).clip.gaps] == [(9, 3)]


def test_without_times_the_rate_is_asked_for(tmp_path: Path) -> None:
    path = tmp_path / "weights.csv"
    path.write_text("\n".join([row("channel", str), *lines()]))
    with pytest.raises(RateNeeded) as asked:
        open_take(path)
    assert (asked.value.rate, asked.value.frames) == (30, FRAMES)
    assert open_take(path, fps=50).clip.rate == 50


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda lines: [*lines[:4], lines[4] + ",0.1", *lines[5:]], "line 5: has 41 numbers where"),
        (lambda lines: [*lines[:4], lines[4][:-3] + "xyz", *lines[5:]], "line 5: .*not a number"),
        (lambda lines: [*lines, lines[3]], 'line 54: the channel "eyeLookInLeft" has two lines'),
        (lambda lines: [lines[0] + ",9", *lines[1:]], "line 1: has 41 times for 40 frames"),
    ],
)
def test_damage_is_refused_at_its_line(
    tmp_path: Path, change: Callable[[list[str]], list[str]], says: str
) -> None:
    path = tmp_path / "weights.csv"
    path.write_text("\n".join(change(TABLES["times as titles"])))
    with pytest.raises(FileError, match=says):
        open_take(path)
