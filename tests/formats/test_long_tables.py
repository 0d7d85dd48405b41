"""Tables with a line for each weight open as frames, and an export changes one number alone."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest
from support import recordings

from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.errors import FileError
from faceedit_app.formats.opening import open_take, write_take
from faceedit_app.formats.timing import RateNeeded

FACE = recordings.face()
Line = Callable[[int, str, float], str]


def lines(line: Line, by_channel: bool = False, frames: int = len(FACE)) -> list[str]:
    places = [(n, k) for n in range(frames) for k in range(len(ARKIT_CHANNELS))]
    if by_channel:
        places.sort(key=lambda place: (place[1], place[0]))
    return [line(n, ARKIT_CHANNELS[k], float(FACE[n, k])) for n, k in places]


def table(head: str, line: Line, by_channel: bool = False) -> str:
    return "\n".join([head, *lines(line, by_channel)]) + "\n"


def unity(name: str) -> str:
    return f"blendShape1.{name.replace('Left', '_L').replace('Right', '_R')}"


# All are at 30 fps.
TABLES = {
    "by frame": table("time,channel,value", lambda n, name, v: f"{n / 30:.4f},{name},{v}"),
    "by channel": table("time,channel,value", lambda n, name, v: f"{n / 30:.4f},{name},{v}", True),
    "ms": table("timestamp_ms,blendshape,score", lambda n, name, v: f"{n * 100 // 3},{name},{v}"),
    "frame and time": table(
        "frame,time,shape,weight", lambda n, name, v: f"{n},{n / 30:.4f},{name},{v}"
    ),
    "values first, and a face": table(
        "value;name;face;time", lambda n, name, v: f"{v};{unity(name)};Anna;{n / 30:.4f}"
    ),
    "decimal commas": table(
        "time;name;value", lambda n, name, v: f"{n / 30:.4f};{name};{v}".replace(".", ",")
    ),
    "percent": table("time,name,weight", lambda n, name, v: f"{n / 30:.4f},{name},{100 * v:.2f}"),
    "timecode, quotes, a title": "Take 3\n"
    + table(
        '"Timecode","Curve","Value"',
        lambda n, name, v: f'"10:00:{n // 30:02d}:{n % 30:02d}","{name}","{v}"',
    ),
    "channels by number too": table(
        "frame,time,index,score,name",
        lambda n, name, v: f"{n},{n / 30:.4f},{ARKIT_CHANNELS.index(name)},{v},{name}",
    ),
    "German": table(
        "Zeit;Name;Wert", lambda n, name, v: f"{n / 30:.4f};{name};{v}".replace(".", ",")
    ),
    "a rate before the header": "# fps: 30\n"
    + table("frame,name,value", lambda n, name, v: f"{n},{name},{v}"),
    "a column with the rate": table(
        "frame,fps,name,value", lambda n, name, v: f"{n},30,{name},{v}"
    ),
    "others among them": table(
        "time,name,value",
        lambda n, name, v: (
            f"{n / 30:.4f},{name},{v}" + (f"\n{n / 30:.4f},headYaw,3" if name == "jawOpen" else "")
        ),
    ),
}


@pytest.mark.parametrize("text", TABLES.values(), ids=TABLES)
def test_a_table_opens_and_an_edit_changes_its_number_alone(tmp_path: Path, text: str) -> None:
    path, out = tmp_path / "take.csv", tmp_path / "out.csv"
    path.write_text(text)
    take = open_take(path)
    assert take.clip.rate == pytest.approx(30)
    assert take.clip.gaps == ()
    assert np.allclose(take.clip.arkit_weights(), FACE, atol=1e-7)
    assert (take.clip.timecodes is not None) == ("Timecode" in text)
    write_take(out, take, take.clip.weights)
    assert out.read_text() == text
    edited = take.clip.weights.copy()
    edited[17, 5] = 0.7654
    write_take(out, take, edited)
    assert np.allclose(open_take(out).clip.weights, edited, atol=1e-6)
    before, after = text.splitlines(), out.read_text().splitlines()
    assert sum(a != b for a, b in zip(before, after, strict=True)) == 1


def test_frame_numbers_or_no_times_ask_for_the_rate(tmp_path: Path) -> None:
    path = tmp_path / "take.csv"
    for text in (
        table("frame,name,weight", lambda n, name, v: f"{n},{name},{v}"),
        table("name,weight", lambda n, name, v: f"{name},{v}"),
        table("name,weight", lambda n, name, v: f"{name},{v}", by_channel=True),
    ):
        path.write_text(text)
        with pytest.raises(RateNeeded) as asked:
            open_take(path)
        assert asked.value.frames == len(FACE)
        clip = open_take(path, fps=24).clip
        assert clip.duration == pytest.approx(len(FACE) / 24)
        assert np.allclose(clip.arkit_weights(), FACE, atol=1e-7)


def test_frames_without_lines_and_without_numbers_are_gaps(tmp_path: Path) -> None:
    def line(n: int, name: str, value: float) -> str:
        return f"{n / 30:.4f},{name},{'' if n == 20 else value}"

    path = tmp_path / "take.csv"
    kept = [text for text in lines(line) if not text.startswith(f"{10 / 30:.4f},")]
    path.write_text("\n".join(["time,name,value", *kept]) + "\n")
    take = open_take(path)
    assert [(gap.frame, gap.missing) for gap in take.clip.gaps] == [(9, 1), (18, 1)]
    assert any("lost in 1 row" in note for note in take.notes)


@pytest.mark.parametrize("rate", [None, 24])
@pytest.mark.parametrize("first", ["_neutral", "_neutral\n{time},headYaw"])
@pytest.mark.parametrize("clock", ["time_s", "Timecode"])
def test_names_that_are_no_channels_may_come_first(
    tmp_path: Path, rate: float | None, first: str, clock: str
) -> None:
    def line(n: int, name: str, value: float) -> str:
        time = f"{n / 30:.4f}" if clock == "time_s" else f"10:00:{n // 30:02d}:{n % 30:02d}"
        before = "\n".join(f"{time},{other},0.00001" for other in first.split("\n{time},"))
        return (f"{before}\n" if name == ARKIT_CHANNELS[0] else "") + f"{time},{name},{value}"

    path = tmp_path / "take.csv"
    kept = [text for n, text in enumerate(lines(line)) if n // len(ARKIT_CHANNELS) != 10]
    path.write_text("\n".join([f"{clock},category_name,score", *kept]) + "\n")
    take = open_take(path, rate)
    assert take.clip.rate == pytest.approx(rate or 30)
    assert [(gap.frame, gap.missing) for gap in take.clip.gaps] == [(9, 1)]
    assert len(take.carried) == 1 + first.count("\n")
    path.write_text("\n".join(kept) + "\n")
    with pytest.raises(FileError, match="no line with the names of its columns"):
        open_take(path, rate)


@pytest.mark.parametrize("rate", [None, 24])
@pytest.mark.parametrize("by_frame", [False, True])
def test_times_may_stand_among_the_weights_by_their_name(
    tmp_path: Path, rate: float | None, by_frame: bool
) -> None:
    path, out = tmp_path / "take.csv", tmp_path / "out.csv"
    frames = [n for n in range(len(FACE)) if n != 10]
    rows = [(n, f"time,{n / 30:.4f}") for n in frames]
    rows += [(n, f"{c},{FACE[n, k]}") for k, c in enumerate(ARKIT_CHANNELS) for n in frames]
    if by_frame:
        rows.sort(key=lambda row: row[0])
    path.write_text("\n".join(["variable,value", *(row for _, row in rows)]) + "\n")
    take = open_take(path, rate)
    assert take.clip.rate == pytest.approx(rate or 30)
    assert [(gap.frame, gap.missing) for gap in take.clip.gaps] == [(9, 1)]
    write_take(out, take, take.clip.weights)
    assert out.read_bytes() == path.read_bytes()


@pytest.mark.parametrize("rate", [None, 30])
@pytest.mark.parametrize("first", [ARKIT_CHANNELS[0], "_neutral"])
@pytest.mark.parametrize(
    ("head", "labels", "by_face"),
    [
        ("frame,time_s,face_index", "01", False),
        ("frame,time_s,face_index", "01", True),
        ("face_index,frame,time_s", "01", False),
        ("time_s,Person", ("Anna", "Bob"), False),
        ("time_s,Person", ("Anna", "Bob"), True),
        ("time_s,id", "79", False),
    ],
)
def test_of_several_faces_the_first_is_read(
    tmp_path: Path,
    head: str,
    labels: Sequence[str],
    by_face: bool,
    first: str,
    rate: float | None,
) -> None:
    rows = []
    for n, label in itertools.product(range(len(FACE)), labels):
        face = FACE if label == labels[0] else FACE[::-1]
        cells = {"frame": str(n), "time_s": f"{n / 30:.4f}"}
        start = ",".join(cells.get(column, label) for column in head.split(","))
        weights = dict(zip(ARKIT_CHANNELS, face[n].tolist(), strict=True))
        if first not in weights:
            weights = {first: 0.0, **weights}
        rows += [(label, f"{start},{name},{value}") for name, value in weights.items()]
    if by_face:
        rows.sort(key=lambda row: row[0])
    path, out = tmp_path / "take.csv", tmp_path / "out.csv"
    path.write_text("\n".join([f"{head},name,score", *(row for _, row in rows)]) + "\n")
    take = open_take(path, rate)
    assert take.clip.rate == pytest.approx(30)
    assert np.allclose(take.clip.arkit_weights(), FACE, atol=1e-7)
    column = next(c for c in head.split(",") if c not in ("frame", "time_s"))
    note = f"has rows of 2 faces: those with {labels[0]} as {column} are read"
    assert take.unread == (note,)
    write_take(out, take, take.clip.weights)
    assert out.read_bytes() == path.read_bytes()


def test_a_face_that_gets_another_number_stays_one(tmp_path: Path) -> None:
    path = tmp_path / "take.csv"
    text = table("time,face_id,name,value", lambda n, name, v: f"{n / 30:.4f},{n // 20},{name},{v}")
    path.write_text(text)
    take = open_take(path)
    assert (len(take.clip), take.clip.gaps, take.unread) == (len(FACE), (), ())


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda rows: [*rows[:9], *rows[8:]], 'line 11: gives "eyeLookDownRight" twice'),
        (lambda rows: [*rows[:9], *rows[10:]], "line 52: a frame has no eyeLookInRight"),
        (lambda rows: [*rows[:9], rows[9].rpartition(",")[0], *rows[10:]], "line 11: the row is"),
        (lambda rows: [*rows[:9], rows[9][:-1] + "x", *rows[10:]], 'line 11: column "value" hol'),
        (lambda rows: [*rows[:9], rows[9] + "e60", *rows[10:]], "line 11: eyeLookInRight is"),
        (lambda rows: rows[52:104] + rows[:52] + rows[104:], "does not come after"),
    ],
)
def test_damage_is_refused_at_its_line(
    tmp_path: Path, change: Callable[[list[str]], list[str]], says: str
) -> None:
    path = tmp_path / "take.csv"
    rows = change(lines(lambda n, name, v: f"{n / 30:.4f},{name},{v:.4f}"))
    path.write_text("\n".join(["time,channel,value", *rows]) + "\n")
    with pytest.raises(FileError) as refused:
        open_take(path)
    assert says in str(refused.value)


def test_a_row_that_ends_before_names_beyond_the_header_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "take.csv"
    rows = lines(lambda n, name, v: f"{n / 30:.4f},{v:.4f},{name}")
    path.write_text("\n".join(["time,value", *rows[:99], "0.0000,0.1", *rows[99:]]) + "\n")
    with pytest.raises(FileError, match="line 101: the row is too short: 2 of 3 cells; delete"):
        open_take(path)


def test_lines_that_cannot_be_split_are_refused_in_one_line(tmp_path: Path) -> None:
    path = tmp_path / "take.csv"
    path.write_text("time,data\n" + '"0.1, "jawOpen\n' * 20)
    with pytest.raises(FileError) as caught:
        open_take(path)
    assert len(str(caught.value).replace(str(path), "")) < 300
