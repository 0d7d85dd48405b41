"""Live Link Face takes: every layout opens, and an export changes only what was edited."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from support.takes import livelink_names, make_livelink_csv, make_plain_csv

from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.clip import Clip
from faceedit_app.core.errors import FileError
from faceedit_app.formats import livelink
from faceedit_app.formats.opening import open_take, write_take
from faceedit_app.formats.summary import summarize, summary_text

HEADER = b"Timecode,BlendshapeCount,JawOpen,EyeBlinkLeft\n"
# Files are written over and over in one folder, on machines that may be busy.
STEADY = settings(
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
ROWS = b"".join(b"01:02:03:%02d.000,2,0.1000,0.2000\n" % i for i in range(5))


def table(tmp_path: Path, content: bytes, name: str = "take.csv") -> Path:
    path = tmp_path / name
    path.write_bytes(content)
    return path


def exported(path: Path, **changes: tuple[int, float]) -> bytes:
    """The file after setting `channel=(frame, weight)`."""
    take = open_take(path)
    weights = take.clip.weights.copy()
    for channel, (frame, value) in changes.items():
        weights[frame, take.clip.channels.index(channel)] = value
    out = path.with_name("out.csv")
    write_take(out, take, weights)
    return out.read_bytes()


def test_the_application_layout_opens_with_all_channels_and_carries_the_rest(
    tmp_path: Path,
) -> None:
    take = open_take(make_livelink_csv(tmp_path / "take.csv", seconds=2.5))
    assert len(take.clip) == 150
    assert take.clip.rate == 60
    assert set(take.clip.channels) == set(ARKIT_CHANNELS)
    assert take.clip.channels.index("jawRight") < take.clip.channels.index("jawLeft")
    assert take.carried[0] == "HeadYaw"
    assert len(take.carried) == 9
    assert take.clip.timecodes is not None
    assert take.clip.timecodes[0] == "12:00:00:00.169"
    assert take.notes == ()


@pytest.mark.parametrize(
    "spelled",
    [
        list(ARKIT_CHANNELS),
        [name.upper() for name in ARKIT_CHANNELS],
        [f"blendShapes.{name}" for name in reversed(ARKIT_CHANNELS)],
    ],
    ids=["camel case", "upper case", "prefixed and reversed"],
)
def test_channels_are_found_by_name_in_any_order_and_spelling(
    tmp_path: Path, spelled: list[str]
) -> None:
    weights = np.tile(np.linspace(0, 1, 52), (70, 1))
    path = make_livelink_csv(
        tmp_path / "take.csv", names=spelled, weights=weights, count_name="BlendshapeCount"
    )
    clip = open_take(path).clip
    assert [name.lower() for name in clip.channels] == [n.split(".")[-1].lower() for n in spelled]
    assert np.allclose(clip.weights, weights)


def test_extra_columns_and_a_wrong_count_are_kept_and_noted(tmp_path: Path) -> None:
    path = make_livelink_csv(tmp_path / "take.csv", extra={"Angry": "x", "Happy": "n/a"})
    path.write_bytes(path.read_bytes().replace(b",63,", b",61,"))
    take = open_take(path)
    assert take.carried[-2:] == ("Angry", "Happy")
    assert take.notes == ("BlendShapeCount says 61, the header has 63 values",)


def test_rows_without_a_face_are_a_gap_that_the_export_keeps(tmp_path: Path) -> None:
    path = make_livelink_csv(
        tmp_path / "take.csv", rate=30, seconds=4, untracked=range(40, 50), dropped=[80]
    )
    take = open_take(path)
    assert len(take.clip) == 120 - 11
    assert [(gap.frame, gap.missing) for gap in take.clip.gaps] == [(39, 10), (69, 1)]
    assert "the face was lost in 10 rows at 1 place" in " ".join(take.notes)
    assert "2 gaps, 11 frames missing" in take.notes
    before = path.read_bytes().splitlines()
    after = exported(path, jawOpen=(40, 0.5)).splitlines()
    assert [i for i in range(len(before)) if before[i] != after[i]] == [51]


def test_rows_without_a_face_may_be_filled_up_by_a_spreadsheet(tmp_path: Path) -> None:
    path = table(tmp_path, HEADER + ROWS + b"01:02:03:05.000,0,,\n01:02:03:06.000,2,0.1,0.2\n")
    take = open_take(path)
    assert [(gap.frame, gap.missing) for gap in take.clip.gaps] == [(4, 1)]


@pytest.mark.parametrize(
    "content",
    [
        HEADER + ROWS,
        (HEADER + ROWS).replace(b"\n", b"\r\n"),
        b"\xef\xbb\xbf" + HEADER + ROWS,
        HEADER + ROWS.rstrip(b"\n"),
        HEADER + ROWS + b"\n\r\n  \n",
        HEADER + ROWS.replace(b"\n", b"\r\n", 2),
        (HEADER + ROWS).replace(b",", b" , "),
        (HEADER + ROWS).replace(b"0.1000", b'"0.1000"').replace(b"Timecode", b'"Timecode"'),
        (HEADER + ROWS).replace(b",", b";"),
        (HEADER + ROWS).replace(b"\n", b",\n").replace(HEADER[:-1] + b",", HEADER[:-1]),
        (HEADER + ROWS).replace(b"\n", b',"a, ""b""\xc3\xa4"\n'),
    ],
    ids=[
        *("lf", "crlf", "bom", "no last newline", "blank lines", "mixed line ends", "spaces"),
        *("quotes", "semicolons", "surplus delimiters", "quoted delimiters"),
    ],
)
def test_a_file_keeps_its_bytes_but_for_the_edited_cell(tmp_path: Path, content: bytes) -> None:
    path = table(tmp_path, content)
    assert exported(path) == content
    head, found, tail = content.partition(b"03.000")
    wanted = head + found + tail.replace(b"0.1000", b"0.3457", 1)
    assert exported(path, jawOpen=(3, 0.34567)) == wanted


@pytest.mark.parametrize(
    ("number", "value", "wanted"),
    [
        (b"0.1000000000", 0.25, b"0.2500000000"),
        (b"0.10000", 0.25, b"0.25000"),
        (b"0.10000", -1e-9, b"0.00000"),
        (b"0.10", 0.123456, b"0.1235"),
        (b"0.1", 0.123456, b"0.123456"),
        (b"1", 0.5, b"0.5"),
        (b"1.000000e-01", 0.25, b"2.500000e-01"),
        (b"1.000000E-01", 0.25, b"2.500000E-01"),
        (b"0.10000000149011612", 0.25, b"0.25000000000000000"),
    ],
)
def test_edited_numbers_look_like_the_source_s(
    tmp_path: Path, number: bytes, value: float, wanted: bytes
) -> None:
    rows = b"".join(b"01:02:03:%02d,1,%b\n" % (i, number) for i in range(5))
    path = table(tmp_path, b"Timecode,BlendShapeCount,JawOpen\n" + rows)
    line = exported(path, jawOpen=(2, value)).splitlines()[3]
    assert line == b"01:02:03:02,1," + wanted


def test_a_negative_zero_is_no_edit(tmp_path: Path) -> None:
    path = table(tmp_path, HEADER + ROWS.replace(b"0.1000", b"-0.000"))
    assert exported(path, jawOpen=(1, 0.0)) == path.read_bytes()


NAMES = [*livelink_names()[:6], "JawOpen", "MouthClose"]


@settings(STEADY, max_examples=60)
@given(data=st.data(), decimals=st.integers(4, 10), crlf=st.booleans())
def test_random_edits_change_their_cells_and_no_other(
    tmp_path: Path, data: st.DataObject, decimals: int, crlf: bool
) -> None:
    weights = np.random.default_rng(data.draw(st.integers(0, 99))).random((20, len(NAMES)))
    path = make_livelink_csv(
        tmp_path / "take.csv",
        names=NAMES,
        weights=weights,
        decimals=decimals,
        untracked=data.draw(st.sets(st.integers(0, 18), max_size=4)),
        newline="\r\n" if crlf else "\n",
    )
    take = open_take(path)
    edited = take.clip.weights.copy()
    cells = st.tuples(st.integers(0, len(edited) - 1), st.integers(0, len(NAMES) - 1))
    for cell, value in data.draw(
        st.dictionaries(cells, st.floats(-0.5, 1.5, width=32), max_size=20)
    ).items():
        edited[cell] = value
    out = tmp_path / "out.csv"
    write_take(out, take, edited)
    again = open_take(out).clip.weights
    assert np.allclose(again, edited, rtol=0, atol=0.51 * 10.0**-decimals + 1e-7)
    before = [line.split(b",") for line in path.read_bytes().splitlines(keepends=True)]
    after = [line.split(b",") for line in out.read_bytes().splitlines(keepends=True)]
    assert [len(line) for line in before] == [len(line) for line in after]
    tracked = [i for i, line in enumerate(before) if i and len(line) > 2]
    for row, line in enumerate(tracked):
        same = [True, True, *(edited[row] == take.clip.weights[row]), *[True] * 9]
        for old, new, kept in zip(before[line], after[line], same, strict=True):
            assert new == old or not kept
    untouched = set(range(len(before))) - set(tracked)
    assert all(before[i] == after[i] for i in untouched)


@pytest.mark.parametrize(
    ("content", "line", "says"),
    [
        (b"", None, "is empty"),
        (b"\xef\xbb\xbf\r\n \n", None, "is empty"),
        (HEADER, 1, "no frames"),
        (HEADER + b"\n\n", 1, "no frames"),
        (HEADER + ROWS + b"01:02:03:05.000,2,0.1", 7, "last row is cut off: 3 of 4 cells"),
        (HEADER + ROWS + b"01:0", 7, "last row is cut off"),
        (HEADER + ROWS + b"01:02:03:05.000,2", 7, "last row is cut off"),
        (HEADER + b"01:02:03:00.000,2,0.1\n" + ROWS, 2, "the row is too short"),
        (HEADER + b"01:02:03:00.000,2,0.1,0.2,0.3\n" + ROWS, 2, "has 5 cells"),
        (HEADER + ROWS.replace(b"0.2000", b"o.2", 1), 2, 'column "EyeBlinkLeft" holds "o.2"'),
        (HEADER + ROWS.replace(b"0.2000", b"0_2", 1), 2, 'column "EyeBlinkLeft" holds "0_2"'),
        (HEADER + ROWS.replace(b"0.2000", b"-inf", 1), 2, 'holds "-inf", not a finite number'),
        (HEADER + ROWS.replace(b"0.2000", b"1e300", 1), 2, 'holds "1e300", not a finite'),
        (HEADER + ROWS.replace(b"0.2000", b"9" * 1_000_000, 1), 2, "99…"),
        (HEADER + ROWS.replace(b"01:02:03:02", b"01:02:93:02"), 4, "is not a timecode"),
        (
            HEADER + ROWS.replace(b"01:02:03:00.000", b"now"),
            2,
            'holds "now", which is not a timecode',
        ),
        (HEADER + b"01:02:03:00.000,0\n", None, "no row with a tracked face"),
        (HEADER.replace(b"EyeBlinkLeft", b"jawOpen") + ROWS, 1, "has two columns (3 and 4)"),
        (b"Timecode,BlendShapeCount,a\n01:02:03:04,1,2\n", 1, "no ARKit channel"),
        (b'{"jaw":\n[1]}\n', 1, "no ARKit channel"),
        (b"jawOpen\n0.5\n0.6\n", None, "no column with times"),
        (b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR", None, "is a picture, not a take or a film"),
        (b"\0\1\2\3" * 9, None, "not a text file but binary"),
        (b"\xff\xd8\xff\xe0JFIF", None, "is a picture, not a take or a film"),
        (b"\xff\xfb\x90\x44sound", None, "is a sound, not a take"),
        ((HEADER + ROWS).decode().encode("utf-16") + b"x", None, "UTF-16"),
        ((HEADER + ROWS).decode().encode("utf-16-be") + b"x", None, "binary"),
        (HEADER + ROWS * 40 + b"\0" * 99, 202, "zero bytes"),
        (HEADER + b'"' + b"1," * 50_000 + b"\n", 2, "a quoted cell does not end on its line"),
        (
            HEADER + ROWS.replace(b"0.2000", b"12.5", 1),
            2,
            "eyeBlinkLeft is 12.5, where 1 is a full",
        ),
    ],
)
def test_a_bad_file_is_reported_in_one_line_with_a_remedy(
    tmp_path: Path, content: bytes, line: int | None, says: str
) -> None:
    path = table(tmp_path, content)
    with pytest.raises(FileError) as caught:
        open_take(path)
    text = str(caught.value)
    assert caught.value.line == line
    assert text.startswith(str(path) + (f", line {line}: " if line else ": "))
    assert says in text
    assert "; " in text
    assert text.isprintable()
    assert len(text) < len(str(path)) + 200


def test_what_is_no_file_is_reported_too(tmp_path: Path) -> None:
    with pytest.raises(FileError, match="is a folder"):
        open_take(tmp_path)
    with pytest.raises(FileError, match="does not exist"):
        open_take(tmp_path / "none.csv")
    with pytest.raises(FileError, match="cannot be read"):
        open_take(tmp_path / ("x" * 400))


def test_a_file_that_may_not_be_read_is_reported(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(path: Path) -> bytes:
        raise PermissionError(13, "Permission denied", str(path))

    path = make_livelink_csv(tmp_path / "take.csv")
    monkeypatch.setattr(Path, "read_bytes", refuse)  # whoever runs the tests may be root
    with pytest.raises(FileError, match=r"cannot be read \(permission denied\); check"):
        open_take(path)


@settings(STEADY, max_examples=80)
@given(position=st.integers(0, 800), junk=st.binary(max_size=12), cut=st.booleans())
def test_damage_anywhere_opens_or_is_reported_and_never_crashes(
    tmp_path: Path, position: int, junk: bytes, cut: bool
) -> None:
    whole = HEADER + ROWS * 3
    path = table(tmp_path, whole[:position] + junk + (b"" if cut else whole[position:]))
    try:
        take = open_take(path)
    except FileError:
        return
    assert take.source.encode(take.clip.weights, take.clip.weights) == path.read_bytes()
    assert np.all(np.diff(take.clip.times) > 0)


def test_a_take_of_one_frame_opens(tmp_path: Path) -> None:
    take = open_take(table(tmp_path, HEADER + ROWS.splitlines(keepends=True)[0]))
    assert len(take.clip) == 1
    assert take.clip.rate == 60
    assert "a single frame: 60 fps is assumed" in take.notes
    assert summarize(take)["duration_s"] == pytest.approx(1 / 60, abs=1e-6)


def test_an_export_that_is_no_number_is_refused_and_nothing_is_written(tmp_path: Path) -> None:
    take = open_take(make_livelink_csv(tmp_path / "take.csv"))
    weights = take.clip.weights.copy()
    weights[7, take.clip.channels.index("jawOpen")] = np.nan
    with pytest.raises(FileError, match="jawOpen at frame 7 is not a number"):
        write_take(tmp_path / "out.csv", take, weights)
    assert not (tmp_path / "out.csv").exists()


def test_an_export_into_no_folder_is_refused(tmp_path: Path) -> None:
    take = open_take(make_livelink_csv(tmp_path / "take.csv"))
    with pytest.raises(FileError, match="cannot be written"):
        write_take(tmp_path / "none" / "out.csv", take, take.clip.weights)


def test_exporting_over_the_source_is_safe(tmp_path: Path) -> None:
    path = make_livelink_csv(tmp_path / "take.csv")
    take = open_take(path)
    for value in (0.5, 0.25):
        weights = take.clip.weights.copy()
        weights[3] = value
        write_take(path, take, weights)
        assert np.all(open_take(path).clip.weights[3] == np.float32(value))
    write_take(path, take, take.clip.weights)
    assert path.read_bytes() == make_livelink_csv(tmp_path / "again.csv").read_bytes()


def test_the_summary_tells_what_a_user_asks_about_a_take(tmp_path: Path) -> None:
    names = [name for name in livelink_names() if name != "BrowInnerUp"]
    path = make_livelink_csv(tmp_path / "take.csv", rate=30, seconds=3, names=names, dropped=[45])
    summary = summarize(open_take(path))
    assert summary["frames"] == 89
    assert summary["rate"] == 30
    assert summary["duration_s"] == pytest.approx(3, abs=1e-3)
    assert summary["missing_channels"] == ["browInnerUp"]
    assert summary["gaps"] == [
        {
            "frame": 44,
            "time_s": pytest.approx(44 / 30, abs=1e-4),
            "timecode": "12:00:01:28.169",
            "missing": 1,
        }
    ]
    text = summary_text(summary)
    assert "89 at 30 fps" in text
    assert "edits cannot move browInnerUp" in text
    assert "1 frame after 0:01.467" in text
    assert "30 fps: the timecode counts 60 frames a second" in text


def test_the_format_is_recognised_by_content(tmp_path: Path) -> None:
    assert open_take(make_livelink_csv(tmp_path / "a.csv")).format == "Live Link Face CSV"
    assert open_take(make_plain_csv(tmp_path / "b.csv")).format == "CSV with times in seconds"


def test_rotations_and_lost_frames_are_written(tmp_path: Path) -> None:
    times = np.arange(14) / 25.0
    lost = np.array([0, 6])
    kept = np.delete(np.arange(14), lost)
    weights = np.full((12, len(ARKIT_CHANNELS)), 0.25, np.float32)
    clip = Clip(weights, ARKIT_CHANNELS, times[kept], 25.0)
    rotations = (np.arange(12 * 9.0).reshape(12, 9) / 100).astype(np.float32)
    path = tmp_path / "take.csv"
    path.write_bytes(livelink.write_with(clip, rotations, times[lost]))
    rows = [row.split(",") for row in path.read_text().splitlines()[1:]]
    assert [number for number, row in enumerate(rows) if row[1] == "0"] == [0, 6]
    assert rows[-1][-9:] == [f"{value:.10f}" for value in rotations[-1]]
    take = open_take(path)
    assert [(gap.frame, gap.missing) for gap in take.clip.gaps] == [(4, 1)]
    assert "RightEyeRoll" in take.carried


@pytest.mark.parametrize("steps", [(1, 2), (1, 2, 4), (2, 3)])
def test_uneven_times_of_whole_frames_stay_as_they_are(
    tmp_path: Path, steps: tuple[int, ...]
) -> None:
    """A film may have a varying number of pictures a second, all of them on a grid of 60."""
    frames = np.random.default_rng(1).choice(steps, 60)
    times = np.concatenate([[0.0], np.cumsum(frames)[:-1]]) / 60.0
    path = tmp_path / "take.csv"
    path.write_bytes(
        livelink.write(Clip(np.zeros((60, 52), np.float32), ARKIT_CHANNELS, times, 30.0))
    )
    np.testing.assert_allclose(open_take(path).clip.times, times, atol=1e-4)
