"""One meaning of a chosen edit: its handles show; Range, Falloff, Strength and curves act on it."""

from __future__ import annotations

from dataclasses import replace

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from support.curves import drag, place, turn
from support.windows import (
    Bench,
    drag_curve,
    editor_of,
    press_key,
    session_of,
    trigger,
    trigger_enabled,
)

from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.ui.curves import CurvesPanel
from faceedit_app.ui.edits.model import RANGE
from faceedit_app.ui.start.window import MainWindow


@pytest.fixture
def window(bench: Bench) -> MainWindow:
    return bench.editing()


def curves_of(window: MainWindow) -> CurvesPanel:
    return editor_of(window).curves


def drag_on_bar(window: MainWindow, start: float, stop: float) -> None:
    bar = curves_of(window).range_bar
    first, last = (QPoint(round(bar.current_scale.x_of(t)), 8) for t in (start, stop))
    drag(bar, first, last)


def test_a_fix_of_the_whole_take_is_limited_afterwards(window: MainWindow) -> None:
    """Smile, then only from 1 to 2 s: by typing, and by its handles at the ends of the take."""
    session, line = session_of(window), window.timeline
    trigger(window, "fix_smile")
    assert line.selection == pytest.approx((0.0, line.duration), abs=0.02)
    fields = curves_of(window).fields
    fields.start.setValue(1.0)
    drag_on_bar(window, line.duration - 0.01, 2.0)  # a few pixels inside: its end is the bar's
    (edit,) = session.edits
    assert (edit.start, edit.end) == pytest.approx((1.0, 2.0), abs=0.02)
    assert edit.name == "Smile"
    fields.fade_in.setValue(0.3)
    assert session.edits[0].falloff == pytest.approx(0.3)
    QTest.keyClick(window, Qt.Key.Key_Escape)
    assert line.selection is None
    assert editor_of(window).edits.current is None
    assert not editor_of(window).edits.strength.isEnabled()


def test_an_edit_of_the_whole_take_fades_where_it_is_limited(window: MainWindow) -> None:
    """Without a falloff, the face would jump into the smile and out of it."""
    session, line = session_of(window), window.timeline
    line.set_falloffs(0.15, 0.25)
    trigger(window, "fix_smile")
    assert (session.edits[0].falloff, session.edits[0].fade_out) == (0, 0)
    curves_of(window).fields.start.setValue(1.0)
    assert (session.edits[0].falloff, session.edits[0].fade_out) == (0.15, 0)
    drag_on_bar(window, line.duration - 0.01, 2.0)
    assert (session.edits[0].falloff, session.edits[0].fade_out) == (0.15, 0.25)
    curves_of(window).fields.fade_out.setValue(0.0)
    drag_on_bar(window, 2.0, 1.8)
    assert session.edits[0].fade_out == 0, "as the user wants it"
    QTest.keyClick(window, Qt.Key.Key_Escape)
    line.set_falloffs(0.15, 0.25)
    trigger(window, "fix_smile")
    list_ = editor_of(window).edits.model
    assert list_.setData(list_.index(len(session.edits) - 1), (1.0, 2.0), RANGE)
    assert (session.edits[-1].falloff, session.edits[-1].fade_out) == (0.15, 0.25)


def test_the_next_edit_keeps_its_falloff_when_a_fresh_one_is_limited(window: MainWindow) -> None:
    line = window.timeline
    line.set_falloffs(0.3, 0.3)
    trigger(window, "fix_smile")
    curves_of(window).fields.end.setValue(1.5)
    QTest.keyClick(window, Qt.Key.Key_Escape)
    assert (line.falloff, line.falloff_out) == (0.3, 0.3)


def test_all_edits_of_a_fix_are_limited_together(window: MainWindow) -> None:
    trigger(window, "fix_sad_mouth")
    curves_of(window).fields.end.setValue(1.5)
    assert len(session_of(window).edits) == 2
    assert {edit.end for edit in session_of(window).edits} == {1.5}


def test_a_fresh_drag_is_chosen_and_its_numbers_can_be_typed(window: MainWindow) -> None:
    session, line, fields = session_of(window), window.timeline, curves_of(window).fields
    drag_curve(window, 0, 1.0, 15)
    (edit,) = session.edits
    assert editor_of(window).edits.chosen_edit == (0, edit)
    assert line.selection == (edit.start, edit.end)
    fields.end.setValue(1.5)
    fields.fade_out.setValue(0.4)
    (edit,) = session.edits
    assert (edit.start, edit.end, edit.fade_out) == pytest.approx((1.0, 1.5, 0.4), abs=0.02)
    assert line.own_falloffs[1] == pytest.approx(0.4), "as the next edit's"
    editor_of(window).edits.strength.setValue(50)
    assert session.edits[0].strength == 0.5


def test_the_curve_of_the_chosen_edit_changes_it(window: MainWindow) -> None:
    session = session_of(window)
    drag_curve(window, 0, 1.0, 15)
    before = session.edits[0].value
    frame = session.take.clip.frame_at(session.edits[0].start)
    drag_curve(window, 0, session.edits[0].start, 10)
    (edit,) = session.edits
    assert edit.value > before
    assert session.asked[frame, 0] == pytest.approx(session.tracked[frame, 0] + edit.value)
    assert window.timeline.shows_edit
    trigger(window, "undo")
    assert session.edits[0].value == before
    trigger(window, "undo")
    assert session.edits == ()
    assert window.timeline.selection is None, "its handles go with it"
    trigger(window, "redo")
    (first,) = session_of(window).edits
    assert editor_of(window).edits.chosen_edit == (0, first)
    assert window.timeline.shows_edit, "they come back with it"
    trigger(window, "redo")
    assert editor_of(window).edits.chosen_edit == (0, edit)


def test_redo_chooses_what_was_chosen_when_it_was_undone(window: MainWindow) -> None:
    """Not an edit that was there all the while, nor one instead of what was chosen meanwhile."""
    panel, session = editor_of(window).edits, session_of(window)
    trigger_enabled(window, "fix_smile")
    panel.leave()
    trigger_enabled(window, "fix_sad_mouth")
    trigger_enabled(window, "undo", "undo", "redo")
    assert (len(session.edits), panel.rows) == (1, [])
    trigger_enabled(window, "redo")
    assert panel.rows == [1, 2]
    assert window.timeline.shows_edit
    trigger_enabled(window, "undo")
    panel.select(0)
    trigger_enabled(window, "redo")
    assert panel.rows == [0]
    panel.select(2)
    trigger_enabled(window, "delete_edit", "undo")
    assert panel.rows == [1], "the next one had been chosen"


@pytest.mark.parametrize(("row", "seconds"), [(0, 2.0), (0, 1.1), (1, 1.0)])
def test_a_drag_elsewhere_makes_an_edit_of_its_own(
    window: MainWindow, row: int, seconds: float
) -> None:
    session, line = session_of(window), window.timeline
    line.set_falloffs(0.2, 0.2)
    drag_curve(window, 0, 1.0, 15)
    curves_of(window).fields.fade_in.setValue(0.15)
    drag_curve(window, row, seconds, 10)
    assert len(session.edits) == 2
    assert session.edits[1].start == pytest.approx(seconds, abs=0.02)
    assert session.edits[0].start == pytest.approx(1.0, abs=0.02)
    assert editor_of(window).edits.current == 1


def test_a_drag_after_a_fix_of_the_whole_take_changes_one_moment(window: MainWindow) -> None:
    session = session_of(window)
    trigger(window, "fix_smile")
    drag_curve(window, 2, 1.5, 12)
    assert len(session.edits) == 2
    assert session.edits[1].start == session.edits[1].end == pytest.approx(1.5, abs=0.02)
    assert session.edits[0].span[1] > 2.5


def test_a_selection_that_the_user_made_stays_one(window: MainWindow) -> None:
    """A fix, then a drag, both in the same selection."""
    session, line = session_of(window), window.timeline
    line.select((1.0, 2.0))
    trigger(window, "fix_smile")
    assert line.shows_edit
    drag_curve(window, 0, 1.5, 12)
    assert [(edit.start, edit.end) for edit in session.edits] == [(1.0, 2.0)] * 2
    QTest.keyClick(window, Qt.Key.Key_Escape)
    assert line.selection is None


def test_an_edit_is_moved_in_time_by_its_middle_and_by_the_wheel_made_softer(
    window: MainWindow,
) -> None:
    session = session_of(window)
    session.add(Edit(("mouth_opening",), Op.OFFSET, 1.0, 1.6, 0.1, 4.0))
    editor_of(window).edits.select(0)
    drag_on_bar(window, 1.3, 1.8)
    (edit,) = session.edits
    assert (edit.start, edit.end) == pytest.approx((1.5, 2.1), abs=0.02)
    bar = curves_of(window).range_bar
    middle = QPoint(round(bar.current_scale.x_of(1.8)), 8)
    turn(bar, middle, 1)
    turn(bar, middle, 1)
    assert session.edits[0].falloff == pytest.approx(0.1 * 1.2**2)
    trigger(window, "undo")
    assert session.edits[0].falloff == pytest.approx(0.1), "a run of the wheel is one step"
    press_key(window, Qt.Key.Key_Escape)
    drag_curve(window, 0, 1.0, 15)
    drag_on_bar(window, 1.0, 0.7)
    edit = session.edits[-1]
    assert (edit.start, edit.end) == pytest.approx((0.7, 0.7), abs=0.02), "an edit of one moment"


def test_the_way_to_leave_is_visible(window: MainWindow) -> None:
    edits = editor_of(window).edits
    assert not edits.done.isVisible()
    drag_curve(window, 0, 1.0, 15)
    assert edits.done.isVisible()
    QTest.mouseClick(edits.done, Qt.MouseButton.LeftButton)
    assert not edits.done.isVisible()
    assert window.timeline.selection is None
    assert len(session_of(window).edits) == 1


def test_the_edge_of_a_short_edit_does_not_catch_a_drag_of_the_curve(window: MainWindow) -> None:
    session = session_of(window)
    drag_curve(window, 0, 1.0, 15)
    edge = session.edits[0].span[1]
    plot = curves_of(window).plots[0]
    start = place(plot, edge, plot.height() / 2)
    drag(plot, start, start - QPoint(0, 10))
    assert len(session.edits) == 2


def test_with_time_as_frames_everything_is_in_frames(window: MainWindow) -> None:
    session, fields = session_of(window), curves_of(window).fields
    times = session.take.clip.times
    trigger(window, "unit_frames")
    window.timeline.set_falloffs(0.2, 0.2)
    session.add(Edit(("mouth_opening",), Op.OFFSET, float(times[60]), float(times[96]), 0.1, 4.0))
    edits = editor_of(window).edits
    edits.select(0)
    assert (fields.start.text(), fields.end.text()) == ("61", "97")
    assert fields.fade_in.value() == pytest.approx(0.1 * session.take.clip.rate)
    fields.start.setValue(71)
    fields.fade_out.setValue(9)
    (edit,) = session.edits
    assert edit.start == times[70]
    assert edit.end == times[96]
    assert edit.fade_out == pytest.approx(9 / session.take.clip.rate)
    assert edits.model.columns(edit)[0] == "71 – 97"
    QTest.keyClick(window, Qt.Key.Key_Escape)
    assert fields.start.text() == "–"
    fields.end.setValue(100)
    assert window.timeline.selection == (times[99], times[99])
    trigger(window, "fix_smile")
    assert "frames 100 to 100" in window.status.currentMessage()


def test_with_time_as_timecode_ranges_are_shown_and_typed_as_timecode(window: MainWindow) -> None:
    session, fields = session_of(window), curves_of(window).fields
    times = session.take.clip.times
    session.add(Edit(("mouth_opening",), Op.OFFSET, float(times[60]), float(times[96]), 0.1, 4.0))
    edits = editor_of(window).edits
    edits.select(0)
    trigger(window, "unit_timecode")
    assert (fields.start.text(), fields.end.text()) == ("12:00:01:00", "12:00:01:36")
    layout = fields.layout()
    assert layout is not None
    layout.activate()
    for box in (fields.start, fields.end):
        text = box.lineEdit()
        assert text.fontMetrics().horizontalAdvance(text.text()) < text.width() - 8, "it is cut"
    assert fields.fade_in.value() == pytest.approx(6.0)  # frames
    fields.start.setFocus()
    fields.start.selectAll()
    QTest.keyClicks(fields.start, "1:10")
    QTest.keyClick(fields.start, Qt.Key.Key_Return)
    assert (session.edits[0].start, session.edits[0].end) == (times[70], times[96])
    press_key(fields.end, Qt.Key.Key_Up)
    assert (session.edits[0].start, session.edits[0].end) == (times[70], times[97])
    index = edits.model.index(0)
    assert edits.model.ends(session.edits[0]) == "12:00:01:10 – 12:00:01:37"
    assert edits.model.setData(
        index, edits.model.typed_range("12:00:01:10 – 2:00", session.edits[0]), RANGE
    )
    assert (session.edits[0].start, session.edits[0].end) == (times[70], times[120])
    QTest.keyClick(window, Qt.Key.Key_Escape)
    assert fields.start.text() == "–"


def test_a_take_without_timecode_is_shown_in_seconds(window: MainWindow) -> None:
    line = window.timeline
    trigger(window, "unit_timecode")
    assert line.clip is not None
    with_code = line.clip
    line.open(replace(with_code, timecodes=None))
    line.select((0.5, 1.0))
    assert curves_of(window).fields.start.text() == "0.500"
    line.open(with_code)
    line.select((0.5, 1.0))
    assert curves_of(window).fields.start.text() == "12:00:00:30"


def test_a_typed_start_does_not_round_the_end(window: MainWindow) -> None:
    session, fields = session_of(window), curves_of(window).fields
    session.add(Edit(("mouth_opening",), Op.OFFSET, 0.5, 1.23456, 0.1, 4.0))
    editor_of(window).edits.select(0)
    fields.start.setValue(0.612)
    assert (session.edits[0].start, session.edits[0].end) == (0.612, 1.23456)
    assert fields.end.text() == "1.235"


def test_a_new_selection_leaves_the_edit_as_it_is(window: MainWindow) -> None:
    session = session_of(window)
    drag_curve(window, 0, 1.0, 15)
    before = session.edits
    drag_on_bar(window, 2.0, 2.5)
    assert session.edits == before
    assert window.timeline.own_selection == pytest.approx((2.0, 2.5), abs=0.02)
    assert editor_of(window).edits.current is None
