"""Lines are split as Python's csv module splits them, or refused; lost rows are no frames."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.takes import make_livelink_csv

from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.errors import FileError
from faceedit_app.formats.csv_table import split_line
from faceedit_app.formats.opening import open_take, write_take
from faceedit_app.formats.weights import scale_of

STEADY = settings(deadline=None, derandomize=True)
LINE = st.text(st.sampled_from('",; ab1\t'), max_size=30)


def table(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "take.csv"
    path.write_bytes(text.encode())
    return path


def export(path: Path, **weights: tuple[int, float]) -> str:
    """The file after setting `channel=(frame, weight)`."""
    take = open_take(path)
    edited = take.clip.weights.copy()
    for channel, (frame, value) in weights.items():
        edited[frame, take.clip.channels.index(channel)] = value
    write_take(path.with_name("out.csv"), take, edited)
    return path.with_name("out.csv").read_bytes().decode()


# --- splitting -----------------------------------------------------------------------------------


@STEADY
@given(LINE, st.sampled_from([",", ";", "\t"]))
def test_lines_are_split_as_the_csv_module_does(line: str, delimiter: str) -> None:
    cells = split_line(line.encode(), delimiter.encode())
    # The second line belongs to the first where a quote is left open.
    rows = list(csv.reader([line + "\n", "\n"], delimiter=delimiter))
    if cells is None:
        assert "\n" in rows[0][-1]
        return
    assert delimiter.encode().join(cells) == line.encode()
    assert len(cells) == max(len(rows[0]), 1)
    for cell, text in zip(cells, rows[0], strict=False):
        assert text.replace('"', "") == cell.decode().replace('"', "")


def test_doubled_quotes_do_not_shift_the_cells_behind_them(tmp_path: Path) -> None:
    rows = "".join(f'{n / 30:.4f},"a ""b"", c",{0.01 * n:.3f}\n' for n in range(30))
    path = table(tmp_path, 'time_s,"note ""x"", y",jawOpen\n' + rows)
    assert open_take(path).clip.weights[20, 0] == np.float32(0.2)
    lines = export(path, jawOpen=(20, 0.5)).splitlines()
    assert lines[21] == '0.6667,"a ""b"", c",0.5000'


@pytest.mark.parametrize("where", [0, 5])
def test_a_cell_over_two_lines_is_refused(tmp_path: Path, where: int) -> None:
    lines = ["time_s,note,jawOpen", *(f"{n / 30:.4f},x,0.1" for n in range(9))]
    lines[where] = lines[where].replace("note", '"no').replace(",x,", ',"x,')
    with pytest.raises(FileError):
        open_take(table(tmp_path, "\n".join(lines) + "\n"))


# --- rows without a face -------------------------------------------------------------------------

LOST = "the face was lost in {} at {}: no frames there, the rows are kept"


@pytest.mark.parametrize(
    "row", ["{},nan,nan", "{},,", "{}, , ", "{},NaN,N/A", '{},"",""', "{}", "{},null,null"]
)
def test_rows_without_numbers_are_gaps_that_the_export_keeps(tmp_path: Path, row: str) -> None:
    lines = ["time_s,jawOpen,mouthClose"]
    for n in range(40):
        time = f"{n / 30:.4f}"
        lines.append(row.format(time) if 20 <= n < 25 or n == 30 else f"{time},0.100,0.000")
    path = table(tmp_path, "\n".join(lines) + "\n")
    take = open_take(path)
    assert len(take.clip) == 34
    assert [(gap.frame, gap.missing) for gap in take.clip.gaps] == [(19, 5), (24, 1)]
    assert LOST.format("6 rows", "2 places") in take.notes
    lines[21 + 5] = lines[21 + 5].replace("0.100", "0.5000")
    assert export(path, jawOpen=(20, 0.5)) == "\n".join(lines) + "\n"


def test_a_last_row_of_time_only_is_kept_wherever_its_time_lies(tmp_path: Path) -> None:
    rows = "".join(f"{n / 30 + 7200:.4f},0.1\n" for n in range(30))
    path = table(tmp_path, f"time_s,jawOpen\n{rows}12.5,\n")
    take = open_take(path)
    assert (len(take.clip), take.clip.rate, take.clip.gaps) == (30, 30, ())
    assert LOST.format("1 row", "1 place") in take.notes
    assert export(path) == path.read_text()


def test_a_count_of_0_means_a_lost_face_whatever_follows(tmp_path: Path) -> None:
    path = make_livelink_csv(tmp_path / "take.csv", rate=30)
    lines = path.read_text().splitlines()
    for k in range(20, 25):
        cells = lines[k].split(",")
        lines[k] = ",".join([cells[0], "0", *["0.0"] * (len(cells) - 2)])
    path.write_text("\n".join(lines) + "\n")
    take = open_take(path)
    assert len(take.clip) == 55
    assert [(gap.frame, gap.missing) for gap in take.clip.gaps] == [(18, 5)]
    assert LOST.format("5 rows", "1 place") in take.notes
    assert export(path) == path.read_text()


def test_a_count_that_no_row_fills_in_means_nothing(tmp_path: Path) -> None:
    path = make_livelink_csv(tmp_path / "take.csv", rate=30)
    path.write_text(path.read_text().replace(",61,", ",0,"))
    assert len(open_take(path).clip) == 60


def test_a_row_that_lacks_some_numbers_is_refused_and_all_are_counted(tmp_path: Path) -> None:
    rows = "".join(f"{n / 30:.4f},0.1,{'' if n > 20 else 0.2}\n" for n in range(30))
    with pytest.raises(FileError, match=r'"mouthClose" is empty \(there are 8 more like it\)'):
        open_take(table(tmp_path, "time_s,jawOpen,mouthClose\n" + rows))


def test_a_column_that_is_never_filled_is_no_channel(tmp_path: Path) -> None:
    rows = "".join(f"{n / 30:.4f},0.1,\n" for n in range(30))
    take = open_take(table(tmp_path, "time_s,jawOpen,tongueOut\n" + rows))
    assert take.clip.channels == ("jawOpen",)
    assert take.carried == ("tongueOut",)
    assert take.notes == ("no row has a number for tongueOut: carried",)


# --- names and scale -----------------------------------------------------------------------------


def test_channels_with_short_sides_are_found_and_exported_under_their_names(tmp_path: Path) -> None:
    names = [n.replace("Left", "_L").replace("Right", "_R") for n in ARKIT_CHANNELS]
    names = [{"jaw_L": "jawLeft", "mouth_R": "mouthRight"}.get(name, name) for name in names]
    rows = "".join(f"{n / 30:.4f},{','.join(['0.10'] * 52)}\n" for n in range(30))
    path = table(tmp_path, f"time_s,{','.join(names)}\n{rows}")
    take = open_take(path)
    assert take.clip.channels == ARKIT_CHANNELS
    out = export(path, eyeBlinkLeft=(3, 0.75)).splitlines()
    assert out[0] == path.read_text().splitlines()[0]
    assert out[4].split(",")[1 + names.index("eyeBlink_L")] == "0.7500"


@pytest.mark.parametrize(("decimals", "wanted"), [(0, "61.32"), (1, "61.32"), (4, "61.3217")])
def test_percent_is_seen_said_and_written(tmp_path: Path, decimals: int, wanted: str) -> None:
    rows = "".join(
        f"{n / 30:.4f},{50 + 40 * np.sin(n / 5):.{decimals}f},{0:.{decimals}f},{3:.{decimals}f}\n"
        for n in range(60)
    )
    path = table(tmp_path, "time_s,jawOpen,mouthClose,browInnerUp\n" + rows)
    take = open_take(path)
    assert take.clip.weights.max() == pytest.approx(0.9, abs=0.01)
    assert any("percent" in note for note in take.notes)
    before, after = path.read_text().splitlines(), export(path, jawOpen=(9, 0.613217)).splitlines()
    assert after[10].split(",")[1] == wanted
    assert [k for k in range(61) if before[k] != after[k]] == [10]


@STEADY
@given(st.integers(0, 999), st.floats(0.06, 0.9), st.floats(0.3, 1.0))
def test_a_face_is_known_by_its_scale_however_calm_it_is(
    seed: int, size: float, kept: float
) -> None:
    random = np.random.default_rng(seed)
    weights = size * random.random((200, 20)) * (random.random(20) < kept)
    weights[:, 0] = size * random.random(200)
    assert scale_of(weights) == 1
    assert scale_of(weights * 100) == 100


@pytest.mark.parametrize("value", ["12.5", "1e30", "-3e38", "1000"])
def test_a_weight_that_cannot_be_is_named_with_its_place(tmp_path: Path, value: str) -> None:
    rows = "".join(f"{n / 30:.4f},0.1,{value if n == 17 else 0.3}\n" for n in range(30))
    with pytest.raises(FileError, match="mouthClose") as caught:
        open_take(table(tmp_path, "time_s,jawOpen,mouthClose\n" + rows))
    assert caught.value.line == 19


def test_a_weight_beyond_1_is_kept(tmp_path: Path) -> None:
    rows = "".join(f"{n / 30:.4f},{1.0 + 0.02 * (n % 5):.3f}\n" for n in range(30))
    take = open_take(table(tmp_path, "time_s,jawOpen\n" + rows))
    assert take.clip.weights.max() == np.float32(1.08)
    assert take.notes == ()
