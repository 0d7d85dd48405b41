"""Frames that a fill gives to a gap are shown as they will be exported; it stays marked."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from support.curves import LEFT, NONE, SHIFT, drag, let_go, place, surface
from support.takes import make_livelink_csv
from support.windows import Bench, editor_of, session_of, trigger, trigger_enabled

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.controls import CONTROL_INDEX, LIP_OPENING
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.exporting import changed_frames
from faceedit_app.formats.opening import open_take
from faceedit_app.ui.start.window import MainWindow
from faceedit_app.ui.state.gap_frames import edited_at

LOST = range(100, 112)
OPENING = CONTROL_INDEX[LIP_OPENING]


@pytest.fixture
def window(bench: Bench) -> MainWindow:
    """With a take that lost twelve rows."""
    take = make_livelink_csv(bench.folder / "gap.csv", 4.0, 60, untracked=LOST)
    window = bench.editing(take)
    editor_of(window).problems.search()
    return window


def face_line(window: MainWindow, beside: float) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """The seconds of the points of the mouth opening that are drawn within the gap."""
    (gap,) = session_of(window).take.clip.gap_times
    curves = editor_of(window).curves._curves
    assert curves is not None
    x = np.asarray(curves.lines(OPENING).face.x, np.float64)
    return x[(x > gap[0] + beside) & (x < gap[1] - beside)]


def test_what_is_shown_in_a_gap_is_what_the_export_writes(
    window: MainWindow, tmp_path: Path
) -> None:
    editor, session, line = editor_of(window), session_of(window), window.timeline
    (gap,) = session.take.clip.gap_times
    trigger(window, "all_channels")
    channels = editor.channels
    assert channels is not None
    channels.choose("jawOpen", "headYaw")
    assert not len(face_line(window, 0.001))
    trigger_enabled(window, "next_problem", "fix_problem")
    assert len(face_line(window, 0.001)) == len(LOST), "the proposal is shown"
    editor.settings_bar.sync()
    assert editor.settings_bar.edits.text() == "No edits", "nor the frames that it would change"
    trigger_enabled(window, "discard_fix")
    assert not len(face_line(window, 0.001))
    trigger_enabled(window, "fix_problem", "accept_fix")
    assert session.take.clip.gap_times == [gap], "the gap is still marked"
    counted = editor.settings_bar.edits.text()
    session.export(tmp_path / "out.csv")
    changed = changed_frames(session, tmp_path / "out.csv")
    assert changed == session.changed_frames() >= len(LOST)
    assert counted == f"1 edit · {changed} frames changed"
    exported = open_take(tmp_path / "out.csv").clip
    rig = session.rig
    jaw = exported.arkit_weights()[:, ARKIT_INDEX["jawOpen"]]
    plots = [plot._edited.getOriginalDataset() for plot in channels.plots]
    np.testing.assert_allclose(plots[0][0], exported.times, atol=1e-6)
    np.testing.assert_allclose(plots[0][1], jaw, atol=1e-6)
    assert len(plots[1][0]) == len(session.take.clip), "a fill does not turn the head"
    for row in LOST:
        line.go_to_time(row / 60)
        assert line.time == pytest.approx(row / 60, abs=1e-3)
        shown = editor.face._shown[0]
        np.testing.assert_allclose(shown, rig.from_arkit(exported.arkit_weights()[row]), atol=2e-5)
        opening = float(rig.arkit_distances.measure(exported.arkit_weights()[[row]])[0, OPENING])
        assert editor.curves.headers[OPENING].value == f"{opening:.1f} mm"
        assert channels.plots[0].shown == f"jawOpen  {jaw[row]:.2f}"


def test_the_playhead_steps_and_plays_through_filled_frames(window: MainWindow) -> None:
    session, line = session_of(window), window.timeline
    trigger_enabled(window, "next_problem", "fix_problem", "accept_fix")
    line.go_to_frame(99)
    for row in (*LOST, LOST.stop):
        QTest.keyClick(window, Qt.Key.Key_Right)
        assert line.time == pytest.approx(row / 60, abs=1e-3)
    assert (line.frame, line.filled) == (100, None)
    QTest.keyClick(window, Qt.Key.Key_Left)
    assert line.filled == len(LOST) - 1
    trigger(window, "undo")
    assert line.filled is None, "it stands on a frame of the take again"
    assert line.frame in (99, 100)
    assert session.edits == ()


def test_filled_frames_are_reached_by_mouse_and_typed_times(window: MainWindow) -> None:
    editor, line = editor_of(window), window.timeline
    trigger_enabled(window, "next_problem", "fix_problem", "accept_fix")
    line.show_range(1.4, 2.2)
    plot, ruler, transport = editor.curves.plots[OPENING], editor.curves.ruler, editor.transport
    for row, strip in ((104, plot), (106, ruler)):
        QTest.mouseClick(surface(strip), LEFT, NONE, place(strip, row / 60, 10.0))
        assert line.filled == row - LOST.start
    drag(ruler, place(ruler, 90 / 60, 10.0), place(ruler, 108 / 60, 10.0))
    assert line.filled == 108 - LOST.start
    assert transport.clock.text() == "12:00:01:48", "its row has a timecode in the file"
    assert transport.seconds.text().startswith("0:01.800 / ")
    assert transport.frame.text() == f"frame {LOST.start}+9 / {240 - len(LOST)}, filled"
    for unit, text in (("seconds", "1.7667"), ("timecode", "1:46"), ("frames", "100+7")):
        trigger(window, f"unit_{unit}")
        line.go_to_frame(0)
        QTest.keyClick(window, Qt.Key.Key_G)
        transport.entry.setText(text)
        QTest.keyClick(transport.entry, Qt.Key.Key_Return)
        assert line.filled == 106 - LOST.start, unit
    QTest.keyClick(window, Qt.Key.Key_G)
    assert transport.entry.text() == "100+7"
    QTest.keyClick(transport.entry, Qt.Key.Key_Return)
    assert line.filled == 106 - LOST.start, "what is shown can be typed"
    trigger(window, "unit_timecode")
    line.select((90 / 60, 103 / 60))
    fields = editor.curves.fields
    assert (fields.start.text(), fields.end.text()) == ("12:00:01:30", "12:00:01:43")
    fields.end.lineEdit().setText("12:00:01:45")
    QTest.keyClick(fields.end, Qt.Key.Key_Return)
    assert line.selection == pytest.approx((90 / 60, 105 / 60), abs=1e-3)
    trigger(window, "unit_frames")
    fields.end.stepUp()
    assert (fields.start.text(), fields.end.text()) == ("91", "100+7")
    assert line.selection == pytest.approx((90 / 60, 106 / 60), abs=1e-3)


def test_a_drag_within_a_filled_gap_edits_the_frame_under_it(window: MainWindow) -> None:
    editor, session, line = editor_of(window), session_of(window), window.timeline
    trigger_enabled(window, "next_problem", "fix_problem", "accept_fix")
    line.show_range(1.4, 2.2)
    line.go_to_time(103 / 60)
    assert line.filled_frames is not None
    before, stop = line.filled_frames.controls, line.stop
    plot = editor.curves.plots[OPENING]
    held = place(plot, 106 / 60, plot.height() / 2)
    drag(plot, held, held - QPoint(0, 20), release=False)
    assert line.filled == 106 - LOST.start
    QTest.keyClick(plot, Qt.Key.Key_Escape)
    assert line.stop == stop
    let_go(plot, held)
    drag(plot, held, held - QPoint(0, 20))
    edit = session.edits[-1]
    assert edit.start == edit.end == line.filled_frames.times[106 - LOST.start]
    moved = (line.filled_frames.controls - before)[:, OPENING]
    assert moved.argmax() == 106 - LOST.start
    assert moved.max() == pytest.approx(edit.value, abs=0.1)


def test_a_gap_can_be_selected_and_filled_in_parts(window: MainWindow) -> None:
    """Its rows are there, without a face: an end of a selection may lie at each of them."""
    editor, session, line = editor_of(window), session_of(window), window.timeline
    line.show_range(1.4, 2.2)
    bar, ruler = editor.curves.range_bar, editor.curves.ruler
    found = np.zeros(len(LOST), bool)
    for strip, keys, first, last in ((bar, NONE, 100, 105), (ruler, SHIFT, 106, 111)):
        line.select(None)
        drag(strip, place(strip, first / 60, 8.0), place(strip, last / 60, 8.0), keys)
        assert line.selection == pytest.approx((first / 60, last / 60), abs=1e-3)
        trigger_enabled(window, "fill")
        assert "6 rows without a face get one" in editor.proposal.text.text()
        trigger_enabled(window, "accept_fix")
        found[first - LOST.start : last + 1 - LOST.start] = True
        rows = session.filled_rows()
        assert rows is not None
        assert np.array_equal(np.isfinite(rows).all(axis=1), found)


def test_other_edits_and_the_tracked_face_are_shown_in_a_gap_too(window: MainWindow) -> None:
    editor, session, line = editor_of(window), session_of(window), window.timeline
    trigger_enabled(window, "next_problem", "fix_problem", "accept_fix")
    line.go_to_time(LOST[4] / 60)
    before = line.filled_frames
    assert before is not None
    session.add(Edit((LIP_OPENING,), Op.OFFSET, 1.4, 2.2, 0.2, 6.0))
    assert line.filled_frames is not None
    assert (line.filled_frames.controls[:, OPENING] > before.controls[:, OPENING] + 2).all()
    curves, (gap,) = editor.curves._curves, session.take.clip.gap_times
    assert curves is not None
    asked = curves.lines(OPENING).asked
    inside = (asked.x > gap[0]) & (asked.x < gap[1])
    np.testing.assert_array_equal(asked.y[inside], line.filled_frames.asked[:, OPENING])
    wanted = before.asked[:, OPENING] + 6.0, asked.y[inside]
    np.testing.assert_allclose(*wanted, atol=0.01)
    assert edited_at(session, line)[0][OPENING] == line.filled_frames.asked[4, OPENING]
    edited = editor.face._shown[0]
    trigger(window, "show_tracked")
    tracked = editor.face._tracked_pose(session)
    frames = session.rig.from_arkit(session.tracked_weights[99:101])
    assert (tracked >= frames.min(axis=0) - 1e-6).all()
    assert (tracked <= frames.max(axis=0) + 1e-6).all()
    assert not np.array_equal(tracked, edited)


def test_the_face_in_a_gap_is_copied_mirrored_and_made_neutral(window: MainWindow) -> None:
    session, line, said = session_of(window), window.timeline, window.status.currentMessage
    line.select((LOST[2] / 60, LOST[8] / 60))
    for name in ("copy", "mirror"):
        trigger_enabled(window, name)
        assert said() == f"There is no frame in the selection to {name}; select a longer range"
    trigger_enabled(window, "next_problem", "fix_problem", "accept_fix")
    line.select((LOST[2] / 60, LOST[8] / 60))
    assert line.filled_frames is not None
    filled = line.filled_frames.controls[2:9, OPENING]
    for name in ("copy", "copy_changes"):
        trigger_enabled(window, name)
        assert said().startswith("Copied 0.10 s of ")
    trigger_enabled(window, "copy")
    line.go_to_frame(40)
    trigger_enabled(window, "paste")
    np.testing.assert_allclose(session.asked[40:47, OPENING], filled, atol=0.1)
    trigger_enabled(window, "undo", "mirror")
    assert [edit.name for edit in session.edits[-1:]] == ["Mirrored"]
    trigger_enabled(window, "undo")
    line.select(None)
    line.go_to_time(LOST[4] / 60)
    trigger_enabled(window, "neutral_frame")
    assert line.filled == 4
    jaw = ARKIT_INDEX["jawOpen"]
    assert line.filled_frames.weights[4, jaw] < 1e-3 < session.weights[:, jaw].max()


def test_another_take_has_no_filled_frames(bench: Bench, window: MainWindow) -> None:
    trigger_enabled(window, "next_problem", "fix_problem", "accept_fix")
    window.timeline.go_to_time(LOST[4] / 60)
    window.document.adopt(type(session_of(window))(open_take(bench.take), session_of(window).rig))
    assert window.timeline.filled_frames is None
    assert window.timeline.filled is None


def test_many_gaps_are_filled_in_slices(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    """So that the window does not stand still meanwhile; they are shown when all are found."""
    lost = [row for first in range(30, 210, 20) for row in (first, first + 1)]
    window = bench.editing(make_livelink_csv(bench.folder / "gaps.csv", 4.0, 60, untracked=lost))
    editor, session, line = editor_of(window), session_of(window), window.timeline
    calls = []
    find = session.find_filled

    def find_one(_seconds: float) -> bool:
        calls.append(find(0.0))
        return calls[-1]

    monkeypatch.setattr(session, "find_filled", find_one)
    editor.problems.search()
    session.add(*(edit for problem in editor.problems.problems for edit in problem.fix))
    assert line.filled_frames is None
    with bench.qtbot.waitSignal(editor.gap_frames.changed):
        pass
    assert len(calls) > 5
    assert line.filled_frames is not None
    assert len(line.filled_frames) == len(lost)
    rows = session.filled_rows()
    assert rows is not None
    columns = [ARKIT_INDEX[channel] for channel in session.take.clip.channels]
    np.testing.assert_array_equal(line.filled_frames.weights[:, columns], rows)
