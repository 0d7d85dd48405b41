"""Typing where to go, in seconds, frames or timecode; what is no time moves nothing."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from support.faces import talking_clip
from support.windows import Bench

from faceedit_app.core.clip import Clip
from faceedit_app.ui.look.refused import reason_in
from faceedit_app.ui.page.time_entry import TimeEntry
from faceedit_app.ui.start.window import MainWindow
from faceedit_app.ui.state.time_display import Unit, label, times
from faceedit_app.ui.state.typed_time import typed_frame, typed_range

COUNT = 4000  # frames at 60 a second: more than a minute


def clip(codes: bool = True, start: int = 12 * 3600) -> Clip:
    def code(frame: int) -> str:
        seconds = (start + frame // 60) % (24 * 3600)
        hours, minutes = seconds // 3600, seconds // 60 % 60
        return f"{hours:02d}:{minutes:02d}:{seconds % 60:02d}:{frame % 60:02d}.250"

    plain = replace(talking_clip(COUNT), timecodes=None)
    return replace(plain, timecodes=tuple(map(code, range(COUNT)))) if codes else plain


TAKE = clip()


@given(st.integers(0, COUNT - 1), st.sampled_from(Unit), st.integers(0, COUNT - 1))
def test_what_the_clock_shows_can_be_typed(frame: int, unit: Unit, now: int) -> None:
    shown = dict(zip((Unit.TIMECODE, Unit.SECONDS, Unit.FRAMES), times(TAKE, frame), strict=True))
    assert typed_frame(TAKE, shown[unit], unit, now) == frame


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
    assert typed_frame(TAKE, text, unit, 100) == frame


def test_hours_and_minutes_are_those_of_the_playhead() -> None:
    assert typed_frame(TAKE, "3:00", Unit.TIMECODE, 3700) == 3780


def test_past_midnight_is_after_the_beginning() -> None:
    night = clip(start=24 * 3600 - 10)
    assert typed_frame(night, "00:00:05:00", Unit.TIMECODE, 0) == 900


def test_a_take_without_timecode_tells_seconds() -> None:
    assert typed_frame(clip(codes=False), "0:02", Unit.TIMECODE, 0) == 120


@pytest.mark.parametrize("fraction", ["", ".999"])
def test_the_label_of_a_frame_can_be_typed(fraction: str) -> None:
    codes = tuple(code.replace(".250", fraction) for code in TAKE.timecodes or ())
    take = replace(TAKE, timecodes=codes)
    for frame in (0, 1, 150, COUNT - 1):
        shown = label(take, float(take.times[frame]), Unit.TIMECODE)
        assert typed_frame(take, shown, Unit.TIMECODE, 0) == frame


def test_the_clock_shows_whole_timecodes() -> None:
    """At 25 fps, a timecode that counts 60 frames a second steps by 2.4 of them."""
    codes = "12:00:00:26.400", "12:00:00:28.800", "12:00:00:31,200"
    take = replace(TAKE, timecodes=codes + (TAKE.timecodes or ())[3:])
    shown = [times(take, frame)[0] for frame in range(3)]
    assert shown == ["12:00:00:26", "12:00:00:28", "12:00:00:31"]


def test_where_two_frames_share_a_timecode_enter_alone_goes_nowhere() -> None:
    """At 60 fps, a timecode that counts 30 frames a second has halves, which are not shown."""
    codes = tuple(f"12:00:{n // 60:02d}:{n % 60 // 2:02d}.{n % 2 * 5}00" for n in range(COUNT // 2))
    take = replace(talking_clip(COUNT // 2), timecodes=codes)
    for frame in (0, 31, 32, 151, COUNT // 2 - 1):
        shown = times(take, frame)[0]
        assert typed_frame(take, shown, Unit.TIMECODE, frame) == frame
        assert times(take, typed_frame(take, shown, Unit.TIMECODE, 0))[0] == shown


@pytest.mark.parametrize(
    ("text", "unit", "range_"),
    [
        ("1.25 – 3", Unit.SECONDS, (1.25, 3.0)),
        ("1,25-3,5 s", Unit.SECONDS, (1.25, 3.5)),
        ("3 s to 1 s", Unit.SECONDS, (1.0, 3.0)),
        ("2.5", Unit.SECONDS, (2.5, 2.5)),
        ("0:01 1:99999", Unit.SECONDS, (1.0, TAKE.duration)),
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
        typed_frame(TAKE, text, unit, 0)


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
    QTest.keyClick(entry, Qt.Key.Key_Return)
    assert window.timeline.frame == frame
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
