"""Rows without a face outside of what is cut come out as they went in, at their new times."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from support.takes import livelink_names, speech_like, timecode

from faceedit_app.cli import main
from faceedit_app.formats.faceless import lost_places
from faceedit_app.formats.opening import open_take

FRAMES, RATE = 90, 30
# Before the first face, in two gaps, and after the last face.
LOST = frozenset((0, 1, *range(22, 27), *range(60, 64), 88, 89))
# In seconds from the first face, row 2: from row 17, which has a face, into the first gap.
CUT, GONE = "0.5-0.76", range(17, 25)
BLENDED = 3  # frames on each side of a cut


@dataclass(frozen=True)
class Layout:
    """A table that loses the face.

    Attributes:
        times: the titles of the first columns; the first one has the times.
        names: the channels.
        scale: of the weights.
        first: the cells before the weights, of a row with a face; the time is filled in.
        lost: those of a row without one.
        weight: the text of a weight in such a row; None if the row ends before the weights.
        separator, end: of the lines.
        encoding: of the file.
        seconds: whether times are seconds; if not, they are timecodes.
    """

    times: tuple[str, ...]
    names: list[str]
    first: tuple[str, ...] = ("",)
    lost: tuple[str, ...] = ("",)
    weight: str | None = ""
    scale: float = 1.0
    separator: str = ","
    end: str = "\n"
    encoding: str = "utf-8"
    seconds: bool = False

    def time(self, row: int) -> str:
        """The time in a row, with jitter if it is a timecode."""
        if self.seconds:
            return f"{row / RATE:.6f}"
        return timecode(12 * 3600 * 60 + 2 * row + 0.123 + 0.001 * (row % 3))

    def text(self) -> str:
        values = speech_like(FRAMES, RATE, self.names) * self.scale
        lines = [[*self.times, *self.names]]
        for row, weights in enumerate(values.tolist()):
            first = self.lost if row in LOST else self.first
            cells = [self.time(row), *first[1:]]
            if row not in LOST:
                cells += [f"{weight:.7f}" for weight in weights]
            elif self.weight is not None:
                cells += [self.weight] * len(self.names)
            if self.separator == ";":
                cells = [cell.replace(".", ",") for cell in cells]
            lines.append(cells)
        return "".join(self.separator.join(cells) + self.end for cells in lines)

    def write(self, path: Path) -> Path:
        path.write_bytes(self.text().encode(self.encoding))
        return path

    def cells(self, path: Path) -> list[list[str]]:
        lines = path.read_bytes().decode(self.encoding).splitlines()
        return [line.split(self.separator) for line in lines]


_PHONE = ("Timecode", "BlendshapeCount")
_FEW = ["jawOpen", "mouthClose", "mouthFunnel", "eyeBlinkLeft", "eyeBlinkRight"]
LAYOUTS = {
    "a count of 0": Layout(_PHONE, livelink_names(), ("", "52"), ("", "0"), None),
    "empty cells": Layout(_PHONE, livelink_names(), ("", "52"), ("", "0")),
    "-1": Layout(_PHONE, livelink_names(), ("", "52"), ("", "52"), "-1"),
    "nan in percent": Layout(
        ("Time",), _FEW, weight="nan", scale=100.0, separator=";", end="\r\n", seconds=True
    ),
    "a flag": Layout(
        ("Time", "tracked"), _FEW, ("", "true"), ("", "false"), "0.25", seconds=True
    ),
    "confidence in UTF-16": Layout(
        ("Time", "confidence"), _FEW, ("", "0.9"), ("", "0"), "0.5", separator="\t",
        encoding="utf-16", seconds=True,
    ),
}  # fmt: skip


def said_by(command: list[object], capfd: pytest.CaptureFixture[str]) -> str:
    assert main([str(one) for one in command]) == 0
    return capfd.readouterr().out


@pytest.mark.parametrize("layout", LAYOUTS.values(), ids=LAYOUTS)
def test_a_cut_leaves_all_other_rows_as_they_are(
    layout: Layout, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    take, out = layout.write(tmp_path / "take.csv"), tmp_path / "out.csv"
    said = said_by(["retime", take, "--cut", CUT, "-o", out], capfd)
    assert "without a face" not in said
    assert "left out" not in said
    (head, *old), (new_head, *new) = layout.cells(take), layout.cells(out)
    assert new_head == head
    kept = [row for row in range(FRAMES) if row not in GONE]
    assert len(new) == len(kept)
    for number, row in enumerate(kept):
        if row in LOST or abs(row - GONE.start) > BLENDED:
            assert new[number][1:] == old[row][1:], row
        later = row - number  # a jitter of some thousandths moves along
        assert new[number][0][:-3] == old[number][0][:-3], row
        if not later:
            assert new[number][0] == old[row][0]
    before, after = open_take(take), open_take(out)
    assert [gap.missing for gap in after.clip.gaps] == [2, 4]
    assert after.lead == before.lead == 2 / RATE
    assert before.faceless is not None
    assert after.faceless is not None
    there = np.delete(before.faceless.times, slice(2, 5))
    there[2:] -= len(GONE) / RATE
    np.testing.assert_allclose(after.faceless.times, there, atol=1e-4)


@pytest.mark.parametrize(
    ("insert", "rows", "gaps"),
    [("0.75+0.2", (2, 11, 4, 2), [11, 4]), ("1.5+0.2", (2, 5, 4, 2), [5, 4])],
    ids=["in a gap", "beside it"],
)
@pytest.mark.parametrize("layout", [LAYOUTS["empty cells"], LAYOUTS["a flag"]], ids=["tc", "s"])
def test_inserted_time_keeps_all_rows_and_repeats_them_where_the_face_is_lost(
    layout: Layout,
    insert: str,
    rows: tuple[int, ...],
    gaps: list[int],
    tmp_path: Path,
    capfd: pytest.CaptureFixture[str],
) -> None:
    take, out = layout.write(tmp_path / "take.csv"), tmp_path / "out.csv"
    said_by(["retime", take, "--insert", insert, "-o", out], capfd)
    (_, *old), (_, *new) = layout.cells(take), layout.cells(out)
    assert len(new) == FRAMES + 6
    own = {tuple(cells[1:]) for k, cells in enumerate(old) if k in LOST}
    is_lost = [tuple(cells[1:]) in own for cells in new]
    edges = [k for k, (a, b) in enumerate(pairwise([False, *is_lost, False])) if a != b]
    assert tuple(b - a for a, b in zip(edges[::2], edges[1::2], strict=True)) == rows
    assert [gap.missing for gap in open_take(out).clip.gaps] == gaps


@pytest.mark.parametrize(("fps", "trailing"), [(60, 3), (15, 2)])
def test_at_another_rate_gaps_have_rows_without_a_face(
    fps: int, trailing: int, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    layout = LAYOUTS["a flag"]
    take, out = layout.write(tmp_path / "take.csv"), tmp_path / "out.csv"
    said_by(["convert", take, out, "--fps", fps], capfd)
    found = open_take(out)
    assert found.faceless is not None
    assert found.lead == 2 / RATE
    missing = [gap.missing for gap in found.clip.gaps]
    assert len(found.faceless) == found.lead * fps + sum(missing) + trailing
    assert missing == pytest.approx([5 * fps / RATE, 4 * fps / RATE], abs=1)
    times = [float(cells[0]) for cells in layout.cells(out)[1:]]
    np.testing.assert_allclose(np.diff(times), 1 / fps, atol=2e-6)


@pytest.mark.parametrize(
    ("name", "options", "says"),
    [
        (
            "out.csv",
            ("--format", "livelink"),
            "13 rows without a face are left out: other programs need a number in every cell",
        ),
        (
            "out.json",
            (),
            "9 rows without a face get weights between those around them, 4 rows without a face "
            "are left out: Audio2Face JSON has no times",
        ),
        (
            "out.glb",
            (),
            "13 rows without a face are left out: the face moves on evenly there",
        ),
    ],
)
def test_what_cannot_have_them_says_how_many_and_why(
    name: str,
    options: tuple[str, ...],
    says: str,
    tmp_path: Path,
    capfd: pytest.CaptureFixture[str],
) -> None:
    take = LAYOUTS["empty cells"].write(tmp_path / "take.csv")
    assert f"  {says}\n" in said_by(["convert", take, tmp_path / name, *options], capfd)


def test_a_new_take_of_another_format_counts_only_what_was_not_cut_out(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    take = LAYOUTS["-1"].write(tmp_path / "take.csv")
    said = said_by(["retime", take, "--cut", CUT, "-o", tmp_path / "out.json"], capfd)
    assert "6 rows without a face get weights between those around them, 4 rows" in said


def test_rows_lie_where_their_times_say_or_else_evenly() -> None:
    lost = np.array([1, 0, 1, 1, 0, 0, 1], bool)
    np.testing.assert_allclose(lost_places(lost), [-1, 1 / 3, 2 / 3, 3])
    told = np.array([0, 1, 2, 3, 11, 12, 13.0])  # rows 4 to 10 are not in the file
    np.testing.assert_allclose(lost_places(lost, told), [-1, 0.1, 0.2, 3])
    told[2] = 0.5  # before the frame that it follows
    np.testing.assert_allclose(lost_places(lost, told), lost_places(lost))


def test_a_row_keeps_its_own_time_in_a_gap_that_lacks_others(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    layout = LAYOUTS["a count of 0"]
    lines = layout.text().splitlines(keepends=True)
    take, out = tmp_path / "take.csv", tmp_path / "out.csv"
    take.write_text("".join(line for row, line in enumerate(lines, -1) if row not in (24, 25)))
    said_by(["retime", take, "--cut", "1-1.2", "-o", out], capfd)
    assert out.read_text().splitlines()[:27] == take.read_text().splitlines()[:27]
