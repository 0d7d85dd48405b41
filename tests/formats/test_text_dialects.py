"""CSV as spreadsheets, engines and scripts write it opens, and an export keeps its dialect."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.errors import FileError
from faceedit_app.formats.opening import open_take, write_take
from faceedit_app.formats.registry import is_take

NAMES = ("jawOpen", "eyeBlink_L", "eyeBlink_R")
RATE, FRAMES = 30, 60
LOST = (20, 21, 22)


def weight(frame: int, k: int) -> float:
    return round(0.3 + 0.25 * float(np.sin(frame / 7 + k)), 4)


def rows(frames: int = FRAMES) -> list[list[str]]:
    return [
        [f"{n / RATE:.4f}", *(f"{weight(n, k):.4f}" for k in range(len(NAMES)))]
        for n in range(frames)
    ]


def text(
    body: list[list[str]] | None = None,
    separator: str = ",",
    before: str = "",
    head: tuple[str, ...] = ("time_s", *NAMES),
) -> str:
    lines = [separator.join(row) for row in [list(head), *(rows() if body is None else body)]]
    return before + "\n".join(lines) + "\n"


def with_comma(body: list[list[str]]) -> list[list[str]]:
    return [[cell.replace(".", ",") for cell in row] for row in body]


CONTENTS: dict[str, bytes] = {
    "decimal comma, semicolons": text(with_comma(rows()), ";").encode(),
    "decimal comma, tabs": text(with_comma(rows()), "\t").encode(),
    "decimal comma in quotes": text(
        [[f'"{cell.replace(".", ",")}"' for cell in row] for row in rows()]
    ).encode(),
    "UTF-16 of a spreadsheet": ("\ufeff" + text(separator="\t")).encode("utf-16-le"),
    "UTF-16, big end first": ("\ufeff" + text()).encode("utf-16-be"),
    "UTF-16 without a mark": text().encode("utf-16-le"),
    "comments before the header": text(before="# recorder 1.2\n# fps: 30\n").encode(),
    "a title before the header": text(before="Take 12,,,\n").encode(),
    "the separator in the first line": text(separator=";", before="sep=;\n").encode(),
    "a row of units": text([["s", "", "", ""], *rows()]).encode(),
    "a row of ranges": text([["seconds", "[0-1]", "[0-1]", "[0-1]"], *rows()]).encode(),
    "a comment at the end": (text() + "# end\n").encode(),
    "sides after a point": text(head=("time_s", "jawOpen", "eyeBlink.L", "eyeBlink.R")).encode(),
    "names in brackets": text(head=("t", *(f"weights[{name}]" for name in NAMES))).encode(),
    "a word after the name": text(head=("t", *(f"{name}_value" for name in NAMES))).encode(),
}


@pytest.mark.parametrize("content", CONTENTS.values(), ids=CONTENTS)
def test_an_edit_changes_one_number_in_the_dialect_of_the_file(
    tmp_path: Path, content: bytes
) -> None:
    path, out = tmp_path / "take.csv", tmp_path / "out.csv"
    path.write_bytes(content)
    assert is_take(path)
    take = open_take(path)
    clip = take.clip
    assert (len(clip), clip.rate, clip.gaps) == (FRAMES, RATE, ())
    assert clip.channels == ("jawOpen", "eyeBlinkLeft", "eyeBlinkRight")
    expected = [[weight(n, k) for k in range(len(NAMES))] for n in range(FRAMES)]
    assert np.allclose(clip.weights, expected, atol=1e-6)

    write_take(out, take, clip.weights)
    assert out.read_bytes() == content
    edited = clip.weights.copy()
    edited[31, 1] = 0.75
    write_take(out, take, edited)
    assert np.allclose(open_take(out).clip.weights, edited, atol=1e-6)
    exported = out.read_bytes()
    assert len(exported) == len(content)
    assert sum(a != b for a, b in zip(exported, content, strict=True)) <= 4


def with_lost_rows(change: Callable[[list[str]], list[str]]) -> list[list[str]]:
    return [change(row) if n in LOST else row for n, row in enumerate(rows())]


def in_place_of(word: str, row: list[str]) -> list[str]:
    return [row[0], *[word] * (len(row) - 1)]


LOST_FACES: dict[str, str] = {
    **{
        f"{word} in place of numbers": text(with_lost_rows(partial(in_place_of, word)))
        for word in ("-", "--", "undefined", "inf", "#VALUE!", "-1")
    },
    "a confidence of 0": text(
        [[*row, "0.0" if n in LOST else "0.93"] for n, row in enumerate(rows())],
        head=("time_s", *NAMES, "confidence"),
    ),
    "no faces": text(
        [[row[0], str(int(n not in LOST)), *row[1:]] for n, row in enumerate(rows())],
        head=("time_s", "num_faces", *NAMES),
    ),
    "not detected": text(
        [
            [row[0], str(n not in LOST), *(["0"] * 3 if n in LOST else row[1:])]
            for n, row in enumerate(rows())
        ],
        head=("time_s", "face_detected", *NAMES),
    ),
}


@pytest.mark.parametrize("content", LOST_FACES.values(), ids=LOST_FACES)
def test_rows_without_a_face_are_a_gap_that_the_export_keeps(tmp_path: Path, content: str) -> None:
    path = tmp_path / "take.csv"
    path.write_text(content, newline="")
    take = open_take(path)
    assert [(gap.frame, gap.missing) for gap in take.clip.gaps] == [(LOST[0] - 1, len(LOST))]
    assert any("the face was lost in 3 rows at 1 place" in note for note in take.notes)
    write_take(tmp_path / "out.csv", take, take.clip.weights)
    assert (tmp_path / "out.csv").read_text() == content


def test_a_column_of_confidence_that_is_never_filled_in_loses_no_face(tmp_path: Path) -> None:
    path = tmp_path / "take.csv"
    path.write_text(text([[*row, "0"] for row in rows()], head=("t", *NAMES, "confidence")))
    assert len(open_take(path).clip) == FRAMES


def test_bytes_are_read_and_written_as_bytes(tmp_path: Path) -> None:
    path, out = tmp_path / "take.csv", tmp_path / "out.csv"
    body = [[row[0], *(f"{round(float(cell) * 400)}" for cell in row[1:])] for row in rows()]
    path.write_text(text(body))
    take = open_take(path)
    assert any("0 to 255" in note for note in take.notes)
    assert take.clip.weights.max() == pytest.approx(220 / 255, abs=0.01)
    edited = take.clip.weights.copy()
    edited[3, 0] = 130 / 255
    write_take(out, take, edited)
    assert out.read_text().splitlines()[4].split(",")[1] == "130"


def test_thousandths_are_read_and_written_as_such(tmp_path: Path) -> None:
    path, out = tmp_path / "take.csv", tmp_path / "out.csv"
    body = [[row[0], *(f"{float(cell) * 1000:.0f}" for cell in row[1:])] for row in rows()]
    path.write_text(text(body))
    take = open_take(path)
    assert any("0 to 1000" in note for note in take.notes)
    assert take.clip.weights[0, 0] == pytest.approx(float(rows()[0][1]), abs=0.001)
    edited = take.clip.weights.copy()
    edited[3, 0] = 0.25
    write_take(out, take, edited)
    assert out.read_text().splitlines()[4].split(",")[1] == "250"


def test_bars_separate_columns_if_nothing_else_does(tmp_path: Path) -> None:
    path = tmp_path / "take.csv"
    path.write_text(text(rows()).replace(",", "|"))
    assert len(open_take(path).clip.channels) == 3


def test_channels_from_0_to_1_among_percent_are_reported(tmp_path: Path) -> None:
    path = tmp_path / "take.csv"
    body = [[row[0], *(f"{float(c) * 100:.2f}" for c in row[1:3]), row[3]] for row in rows()]
    path.write_text(text(body))
    assert any("eyeBlinkRight never passes 1 %" in note for note in open_take(path).notes)


def test_an_infinite_number_among_others_is_named(tmp_path: Path) -> None:
    path = tmp_path / "take.csv"
    body = rows()
    body[7][2] = "inf"
    path.write_text(text(body))
    with pytest.raises(FileError, match=r'line 9: column "eyeBlink_L" holds "inf"'):
        open_take(path)


def test_jitter_of_the_timecode_does_not_change_the_rate(tmp_path: Path) -> None:
    drawn = np.random.default_rng(9).integers(0, 400, 600)
    path = tmp_path / "take.csv"
    lines = [f"01:00:{n // 60:02d}:{n % 60:02d}.{drawn[n]:03d},1,0.1\n" for n in range(600)]
    path.write_text("Timecode,BlendShapeCount,JawOpen\n" + "".join(lines))
    clip = open_take(path).clip
    assert clip.rate == pytest.approx(60, abs=0.1)
    assert clip.gaps == ()


def test_a_line_without_end_is_refused_at_once(tmp_path: Path) -> None:
    path = tmp_path / "take.csv"
    path.write_bytes(b"time_s,jawOpen\n0," + b'"' * 3_000_000 + b"\n")
    with pytest.raises(FileError, match="line 2: has a line of over 2 MB"):
        open_take(path)


def second(n: int) -> str:
    """Seconds and milliseconds of frame n."""
    return f"{n // RATE:02d}.{n % RATE * 1000 // RATE:03d}"


def day_first(n: int) -> str:
    midnight = 2 * RATE
    if n < midnight:
        return f"31.12.2024 23:59:{second(n + 58 * RATE)}"
    return f"01.01.2025 00:00:{second(n - midnight)}"


TIMES: dict[str, Callable[[int], str]] = {
    "minutes and seconds": lambda n: f"01:{second(n)}",
    "frames after a point": lambda n: f"01:02:{n // RATE:02d}.{n % RATE:02d}",
    "universal time": lambda n: f"2024-12-31 23:59:{second(n)} UTC",
    "twelve hours": lambda n: f"12/31/2024 11:58:{second(n)} PM",
    "day first, past midnight": day_first,
}


@pytest.mark.parametrize("time", TIMES.values(), ids=TIMES)
def test_times_are_read_as_they_are_written(tmp_path: Path, time: Callable[[int], str]) -> None:
    path = tmp_path / "take.csv"
    path.write_text(text([[time(n), *row[1:]] for n, row in enumerate(rows(3 * RATE))]))
    clip = open_take(path).clip
    assert (len(clip), clip.rate, clip.gaps) == (3 * RATE, RATE, ())
    assert clip.times[-1] == pytest.approx((3 * RATE - 1) / RATE, abs=1e-3)


PERCENT: dict[str, tuple[str, str]] = {
    "a sign": ("{:.1f}%", ""),
    "a sign after a space": ("{:.1f} %", ""),
    "the names": ("{:.1f}", " [%]"),
    "the names in words": ("{:.1f}", "_percent"),
}


@pytest.mark.parametrize(("cell", "ending"), PERCENT.values(), ids=PERCENT)
def test_percent_that_the_file_names_stay_percent_however_small(
    tmp_path: Path, cell: str, ending: str
) -> None:
    path, out = tmp_path / "take.csv", tmp_path / "out.csv"
    body = [[row[0], *(cell.format(3 * float(value)) for value in row[1:])] for row in rows()]
    path.write_text(text(body, head=("time_s", *(f"{name}{ending}" for name in NAMES))))
    take = open_take(path)
    assert take.clip.weights.max() == pytest.approx(0.0165, abs=6e-4)
    edited = take.clip.weights.copy()
    edited[3, 0] = 0.25
    write_take(out, take, edited)
    before, after = path.read_text().splitlines(), out.read_text().splitlines()
    assert [n for n, (a, b) in enumerate(zip(before, after, strict=True)) if a != b] == [4]
    assert after[4].split(",")[1] == cell.replace("{:.1f}", "25.00")


def test_a_row_of_units_says_that_weights_are_percent(tmp_path: Path) -> None:
    path = tmp_path / "take.csv"
    body = [[row[0], *(f"{3 * float(value):.2f}" for value in row[1:])] for row in rows()]
    path.write_text(text([["s", "%", "%", "%"], *body]))
    assert open_take(path).clip.weights.max() == pytest.approx(0.0165, abs=1e-4)


def test_names_that_say_percent_of_weights_up_to_1_are_not_believed(tmp_path: Path) -> None:
    path = tmp_path / "take.csv"
    path.write_text(text(head=("time_s", *(f"{name} [%]" for name in NAMES))))
    take = open_take(path)
    assert take.clip.weights.max() == pytest.approx(0.55, abs=0.01)
    assert any("the names say percent, but" in note for note in take.notes)


AFFIXES = ("newton {}", "facs_bs_{}", "{}_h", "Curve{}", "score_{}")


@pytest.mark.parametrize("affix", AFFIXES)
def test_a_beginning_or_end_that_all_names_share_is_dropped_and_kept(
    tmp_path: Path, affix: str
) -> None:
    path, out = tmp_path / "take.csv", tmp_path / "out.csv"
    names = ("JawOpen", "EyeBlinkLeft", "EyeBlinkRight", "MouthFunnel")
    body = [[*row, row[1]] for row in rows()]
    path.write_text(text(body, head=("time_s", *(affix.format(name) for name in names))))
    take = open_take(path)
    assert take.clip.channels == ("jawOpen", "eyeBlinkLeft", "eyeBlinkRight", "mouthFunnel")
    assert any("are read as jawOpen and so on" in note for note in take.notes)
    write_take(out, take, take.clip.weights)
    assert out.read_bytes() == path.read_bytes()


def test_two_beginnings_of_the_same_channels_are_not_guessed_between(tmp_path: Path) -> None:
    path = tmp_path / "take.csv"
    names = [f"{start}_{name}" for start in ("raw2", "calm") for name in ("jawOpen", "jawLeft")]
    names += [f"{start}_{n}" for start in ("raw2", "calm") for n in ("mouthLeft", "mouthRight")]
    body = [[row[0], *[row[1]] * len(names)] for row in rows()]
    path.write_text(text(body, head=("time_s", *names)))
    with pytest.raises(FileError, match="holds no ARKit channel"):
        open_take(path)


def test_timecode_with_a_decimal_comma_is_timecode(tmp_path: Path) -> None:
    path, out = tmp_path / "take.csv", tmp_path / "out.csv"
    codes = [f"14:02:{n // RATE:02d}:{2 * (n % RATE):02d}.250" for n in range(FRAMES)]
    body = [[code, *row[1:]] for code, row in zip(codes, rows(), strict=True)]
    path.write_text(text(with_comma(body), ";", head=("Timecode", *NAMES)))
    take = open_take(path)
    assert (take.clip.rate, len(take.clip)) == (RATE, FRAMES)
    write_take(out, take, take.clip.weights)
    assert out.read_bytes() == path.read_bytes()


def test_percent_of_which_most_are_small_is_percent(tmp_path: Path) -> None:
    path = tmp_path / "take.csv"
    still = [name for name in ARKIT_CHANNELS if name not in ("jawOpen", "eyeBlinkLeft")]
    body = [
        [row[0], *(f"{100 * float(cell):.2f}" for cell in row[1:3]), *["1.10"] * len(still)]
        for row in rows()
    ]
    path.write_text(text(body, head=("time_s", "jawOpen", "eyeBlinkLeft", *still)))
    take = open_take(path)
    assert take.clip.weights[:, 0].max() == pytest.approx(0.55, abs=0.01)
    assert any("0 to 100" in note for note in take.notes)


def test_a_few_impossible_weights_are_damage_and_no_percent(tmp_path: Path) -> None:
    path = tmp_path / "take.csv"
    body = rows()
    for n in range(4):
        body[n + 3][1] = body[n + 3][2] = "40.0"
    path.write_text(text(body))
    with pytest.raises(FileError, match="line 5: jawOpen is 40"):
        open_take(path)
