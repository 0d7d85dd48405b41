"""Typing where to go, in seconds, frames or timecode; what is no time moves nothing."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from support.faces import talking_clip
from support.windows import Bench

from faceedit_app.core.clip import Clip
from faceedit_app.formats.take import LostRows
from faceedit_app.ui.look.refused import reason_in
from faceedit_app.ui.page.time_entry import TimeEntry
from faceedit_app.ui.start.window import MainWindow
from faceedit_app.ui.state.time_display import Unit, label, times
from faceedit_app.ui.state.timed_rows import TimedRows
from faceedit_app.ui.state.typed_time import typed_range, typed_row

COUNT = 4000  # frames at 60 a second: more than a minute


def take_of(codes: bool = True, start: int = 12 * 3600) -> TimedRows:
    def code(frame: int) -> str:
        seconds = (start + frame // 60) % (24 * 3600)
        hours, minutes = seconds // 3600, seconds // 60 % 60
        return f"{hours:02d}:{minutes:02d}:{seconds % 60:02d}:{frame % 60:02d}.250"

    plain = replace(talking_clip(COUNT), timecodes=None)
    return TimedRows.of(with_codes(plain, map(code, range(COUNT))) if codes else plain)


def with_codes(clip: Clip, codes: Iterable[str]) -> Clip:
    return replace(clip, timecodes=tuple(codes))


TAKE = take_of()


@given(st.integers(0, COUNT - 1), st.sampled_from(Unit), st.integers(0, COUNT - 1))
def test_what_the_clock_shows_can_be_typed(frame: int, unit: Unit, now: int) -> None:
    shown = dict(zip((Unit.TIMECODE, Unit.SECONDS, Unit.FRAMES), times(TAKE, frame), strict=True))
    assert typed_row(TAKE, shown[unit], unit, now) == frame


@pytest.mark.parametrize(
    ("text", "unit", "frame"),
    [
        ("0", Unit.SECONDS, 0),
        (" 4.5 s ", Unit.SECONDS, 270),
        ("4,5", Unit.SECONDS, 270),
        (".5", Unit.SECONDS, 30),
        ("1:05", Unit.SECONDS, 3900),
        ("0:01:05.5", Unit.SECONDS, 3930),
        ("1", Unit.FRAMES, 0),
        ("4000", Unit.FRAMES, 3999),
        ("Frame 7", Unit.FRAMES, 6),
        ("12:00:02:30", Unit.TIMECODE, 150),
        ("12:00:02;30.250", Unit.TIMECODE, 150),
        ("7:15", Unit.TIMECODE, 7 * 60 + 15),
        ("01:02:15", Unit.TIMECODE, 62 * 60 + 15),
        ("12:00:00:00", Unit.TIMECODE, 0),
    ],
)
def test_other_ways_to_say_it(text: str, unit: Unit, frame: int) -> None:
    assert typed_row(TAKE, text, unit, 100) == frame


def test_hours_and_minutes_are_those_of_the_playhead() -> None:
    assert typed_row(TAKE, "3:00", Unit.TIMECODE, 3700) == 3780


def test_past_midnight_is_after_the_beginning() -> None:
    night = take_of(start=24 * 3600 - 10)
    assert typed_row(night, "00:00:05:00", Unit.TIMECODE, 0) == 900


def test_a_take_without_timecode_tells_seconds() -> None:
    assert typed_row(take_of(codes=False), "0:02", Unit.TIMECODE, 0) == 120


@pytest.mark.parametrize("fraction", ["", ".999"])
def test_the_label_of_a_frame_can_be_typed(fraction: str) -> None:
    codes = tuple(code.replace(".250", fraction) for code in TAKE.timecodes or ())
    take = TimedRows.of(with_codes(TAKE.clip, codes))
    for frame in (0, 1, 150, COUNT - 1):
        shown = label(take, float(take.times[frame]), Unit.TIMECODE)
        assert typed_row(take, shown, Unit.TIMECODE, 0) == frame


def test_the_clock_shows_whole_timecodes() -> None:
    """At 25 fps, a timecode that counts 60 frames a second steps by 2.4 of them."""
    codes = "12:00:00:26.400", "12:00:00:28.800", "12:00:00:31,200"
    take = TimedRows.of(with_codes(TAKE.clip, codes + (TAKE.timecodes or ())[3:]))
    shown = [times(take, frame)[0] for frame in range(3)]
    assert shown == ["12:00:00:26", "12:00:00:28", "12:00:00:31"]


def test_where_two_frames_share_a_timecode_enter_alone_goes_nowhere() -> None:
    """At 60 fps, a timecode that counts 30 frames a second has halves, which are not shown."""
    codes = tuple(f"12:00:{n // 60:02d}:{n % 60 // 2:02d}.{n % 2 * 5}00" for n in range(COUNT // 2))
    take = TimedRows.of(with_codes(talking_clip(COUNT // 2), codes))
    for frame in (0, 31, 32, 151, COUNT // 2 - 1):
        shown = times(take, frame)[0]
        assert typed_row(take, shown, Unit.TIMECODE, frame) == frame
        assert times(take, typed_row(take, shown, Unit.TIMECODE, 0))[0] == shown


@pytest.mark.parametrize(
    ("text", "unit", "range_"),
    [
        ("1.25 – 3", Unit.SECONDS, (1.25, 3.0)),
        ("1,25-3,5 s", Unit.SECONDS, (1.25, 3.5)),
        ("3 s to 1 s", Unit.SECONDS, (1.0, 3.0)),
        ("2.5", Unit.SECONDS, (2.5, 2.5)),
        ("0:01 1:99999", Unit.SECONDS, (1.0, TAKE.clip.duration)),
        ("61 – 121", Unit.FRAMES, (1.0, 2.0)),
        ("frames 0 to 99999", Unit.FRAMES, (0.0, (COUNT - 1) / 60)),
        ("12:00:01:00 – 12:01:02:30", Unit.TIMECODE, (1.0, 62.5)),
        ("12:00:01:00 – 3:00", Unit.TIMECODE, (1.0, 3.0)),
        ("01:02:00-03:30", Unit.TIMECODE, (62.0, 63.5)),
    ],
)
def test_a_range_is_typed_in_the_same_way(
    text: str, unit: Unit, range_: tuple[float, float]
) -> None:
    assert typed_range(TAKE, text, unit, 0) == pytest.approx(range_)


@pytest.mark.parametrize("text", ["", "1 2 3", "x – 3", "12:00:00:00 – 13:00:00:00"])
def test_what_is_no_range_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match=r"[A-Z].{8}"):
        typed_range(TAKE, text, Unit.TIMECODE, 0)


def with_lost(codes: tuple[str, ...] = ()) -> TimedRows:
    """The take without the faces of rows 150 to 158, which have these timecodes."""
    kept, positions = np.r_[:150, 159:COUNT], tuple(149 + n / 10 for n in range(1, 10))
    clip = replace(TAKE.clip, weights=TAKE.clip.weights[kept], times=TAKE.clip.times[kept])
    all_codes = TAKE.timecodes or ()
    return TimedRows.of(with_codes(clip, (all_codes[k] for k in kept)), LostRows(positions, codes))


def test_rows_without_a_face_are_shown_and_typed_by_their_own_timecodes() -> None:
    """Other frames keep the numbers that they have without these rows."""
    rows = with_lost((*(TAKE.timecodes or ())[150:156], "", *(TAKE.timecodes or ())[157:159]))
    for row in (*range(148, 162), COUNT - 1):
        frame = row if row < 150 else row - 9
        number = f"150+{row - 149}" if 150 <= row < 159 else str(frame + 1)
        code = "12:00:02:29+7" if row == 156 else label(TAKE, row / 60, Unit.TIMECODE)
        assert label(rows, row / 60, Unit.FRAMES) == number
        assert label(rows, row / 60, Unit.TIMECODE) == code
        for unit, text in ((Unit.FRAMES, number), (Unit.TIMECODE, code)):
            assert typed_row(rows, text, unit, 0) == row
            assert typed_range(rows, f"{text} – {text}", unit, 0) == (rows.times[row],) * 2
    assert times(rows, 153)[2] == f"frame 150+4 / {COUNT - 9}, filled"
    for wrong in ("150+10", "151+1", "+3"):
        with pytest.raises(ValueError, match=r"(face|frame number, 1 to 3991)$"):
            typed_row(rows, wrong, Unit.FRAMES, 0)


def test_rows_without_a_face_and_any_timecode_count_on_from_the_frame() -> None:
    rows = with_lost()
    assert label(rows, 153 / 60, Unit.TIMECODE) == "12:00:02:29+4"
    assert typed_row(rows, "12:00:02:29 + 4", Unit.TIMECODE, 0) == 153


@pytest.mark.parametrize("point", [";", ":"])
def test_a_number_that_drop_frame_leaves_out_means_the_next_one(point: str) -> None:
    """Also where the file writes drop-frame with a colon, and an hour into the take."""
    count = 30 * 60 * 25

    def code(frame: int) -> str:
        tens, rest = divmod(frame, 17_982)
        number = frame + 18 * tens + 2 * max(0, (rest - 2) // 1798)
        seconds = number // 30
        return f"10:{seconds // 60:02d}:{seconds % 60:02d}{point}{number % 30:02d}"

    plain = replace(talking_clip(3), times=np.arange(count) * 1001 / 30_000, rate=30 / 1.001)
    rows = TimedRows.of(with_codes(plain, map(code, range(count))))
    for minute in (1, 9, 11, 24):
        for frame in "00", "01", "02":
            row = typed_row(rows, f"10:{minute:02d}:00{point}{frame}", Unit.TIMECODE, 0)
            assert rows.timecode(row) == f"10:{minute:02d}:00{point}02"
    row = typed_row(rows, f"10:10:00{point}00", Unit.TIMECODE, 0)
    assert rows.timecode(row) == f"10:10:00{point}00", "each tenth minute has all"


BAD = [
    *((text, unit) for text in ("", "x", "-1", "1e3", "nan", "4..5", "٣") for unit in Unit),
    ("67", Unit.SECONDS),
    ("0:99:99:99", Unit.SECONDS),
    ("0", Unit.FRAMES),
    ("4001", Unit.FRAMES),
    ("2.5", Unit.FRAMES),
    ("9" * 400, Unit.SECONDS),
    ("9" * 400, Unit.FRAMES),
    ("11:59:50:00", Unit.TIMECODE),
    ("13:00:00:00", Unit.TIMECODE),
    ("12:00:00:00:00", Unit.TIMECODE),
    ("12:61:00:00", Unit.TIMECODE),
    ("30", Unit.TIMECODE),
]


@pytest.mark.parametrize(("text", "unit"), BAD)
def test_what_is_no_time_is_reported_in_a_line(text: str, unit: Unit) -> None:
    with pytest.raises(ValueError, match=r"^(Type|The take) [^\n]{5,90}$"):
        typed_row(TAKE, text, unit, 0)


# --- in the window -------------------------------------------------------------------------------


@pytest.fixture
def window(bench: Bench) -> MainWindow:
    window = bench.editing()
    window.activateWindow()
    bench.qtbot.waitActive(window)
    return window


def entry_of(window: MainWindow) -> TimeEntry:
    assert window.editor is not None
    return window.editor.transport.entry


@pytest.mark.parametrize(
    ("unit", "text", "frame"),
    [("seconds", "1.5", 90), ("frames", "31", 30), ("timecode", "12:00:02:00", 120)],
)
def test_g_a_time_and_enter_go_there(window: MainWindow, unit: str, text: str, frame: int) -> None:
    window.actions_[f"unit_{unit}"].trigger()
    entry = entry_of(window)
    QTest.keyClick(window, Qt.Key.Key_G)
    assert entry.hasFocus()
    QTest.keyClicks(entry, text)  # over what stood there; digits are no shortcuts meanwhile
    assert entry.text() == text
    assert window.timeline.frame == 0
    window.timeline.show_range(0.0, 0.4)
    QTest.keyClick(entry, Qt.Key.Key_Return)
    assert window.timeline.frame == frame
    assert sum(window.timeline.view) / 2 == pytest.approx(window.timeline.time)
    assert not entry.isVisible()
    QTest.keyClick(window.focusWidget(), Qt.Key.Key_Right)
    assert window.timeline.frame == frame + 1


def test_a_second_click_on_the_clock_is_for_typing(window: MainWindow) -> None:
    assert window.editor is not None
    label = window.editor.transport.frame
    QTest.mouseClick(label, Qt.MouseButton.LeftButton)
    assert not entry_of(window).isVisible()
    QTest.mouseClick(label, Qt.MouseButton.LeftButton)
    assert entry_of(window).hasFocus()
    assert entry_of(window).selectedText() == "1"


def test_bad_input_is_refused_and_can_be_corrected(window: MainWindow) -> None:
    window.timeline.go_to_frame(42)
    window.timeline.select((0.5, 1.0))
    entry = entry_of(window)
    for bad in ("soon", "99"):
        window.actions_["go_to"].trigger()
        QTest.keyClicks(entry, bad)
        QTest.keyClick(entry, Qt.Key.Key_Return)
        assert window.timeline.frame == 42
        assert entry.isVisible()
        assert entry.property("refused")
        reason = reason_in(window)
        assert reason is not None
        assert entry.accessibleDescription() == reason.text()
        assert reason.text().startswith(("Type seconds", "The take ends at"))
        QTest.keyClick(entry, Qt.Key.Key_Escape)
        assert not entry.isVisible()
        assert window.timeline.selection == (0.5, 1.0), "Esc was the field's"
    window.actions_["go_to"].trigger()
    assert not entry.property("refused")
    QTest.keyClicks(entry, "x")
    QTest.keyClick(entry, Qt.Key.Key_Return)
    QTest.keyClicks(entry, "2")
    assert not entry.property("refused")
    QTest.keyClick(entry, Qt.Key.Key_Return)
    assert window.timeline.time == pytest.approx(2.0, abs=0.01)


def test_space_plays_until_a_time_is_typed(window: MainWindow) -> None:
    window.actions_["go_to"].trigger()
    QTest.keyClick(entry_of(window), Qt.Key.Key_Space)
    assert window.playback.playing
    QTest.keyClick(entry_of(window), Qt.Key.Key_Space)
    assert not window.playback.playing
    QTest.keyClicks(entry_of(window), "1 s")
    assert not window.playback.playing
    assert entry_of(window).text() == "1 s"


def test_going_elsewhere_gives_it_up(window: MainWindow) -> None:
    window.actions_["go_to"].trigger()
    QTest.keyClicks(entry_of(window), "1")
    assert window.editor is not None
    window.editor.curves.setFocus()
    assert not entry_of(window).isVisible()
    assert window.timeline.frame == 0
