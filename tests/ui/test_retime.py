"""Retime in the real window: the tool's drags, the dialogs, and matching another sound."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QCoreApplication, QEvent, QPoint, Qt
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot
from support.curves import CTRL, drag, let_go, place
from support.speech import SENTENCE, needs_espeak, said, speak
from support.waiting import run_events
from support.windows import Bench, session_of, trigger

from faceedit_app.core.resources import shipped
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.ui.commands import dialogs
from faceedit_app.ui.curves.plot import CurvePlot
from faceedit_app.ui.edits.retime_dialog import RetimeDialog
from faceedit_app.ui.media.words_dialog import WordsDialog
from faceedit_app.ui.page.editor import Editor
from faceedit_app.ui.start.window import MainWindow
from faceedit_app.ui.state.tools import Tool
from faceedit_app.words.files import write_words


@pytest.fixture
def window(bench: Bench) -> MainWindow:
    return bench.editing(shipped("assets/demo_take.csv"))


def editor_of(window: MainWindow) -> Editor:
    assert window.editor is not None
    return window.editor


def plot_of(window: MainWindow) -> CurvePlot:
    return editor_of(window).curves.plots[0]


def only_edit(window: MainWindow) -> Edit:
    (edit,) = session_of(window).edits
    return edit


def edits_of(window: MainWindow) -> tuple[Edit, ...]:
    return session_of(window).edits


def dialog_of(window: MainWindow) -> RetimeDialog:
    (dialog,) = (d for d in window.findChildren(RetimeDialog) if d.isVisible())
    return dialog


def begin(window: MainWindow) -> CurvePlot:
    """Choose the tool, with a selection."""
    trigger(window, "tool_retime")
    assert window.workspace.tools.tool is Tool.RETIME
    window.timeline.select((4.0, 5.0))
    run_events()
    return plot_of(window)


# --- the tool --------------------------------------------------------------------------------


def test_a_drag_moves_the_selection_in_time_and_nothing_beyond(window: MainWindow) -> None:
    session, plot = session_of(window), begin(window)
    before = session.weights.copy()
    drag(plot, place(plot, 4.5), place(plot, 4.7), previews=True)
    edit = only_edit(window)
    assert edit.op is Op.RETIME
    (was, now), (then_was, then_now) = edit.pins
    assert (was, then_was) == (4.0, 5.0)
    assert now - was == pytest.approx(0.2, abs=0.02)
    assert then_now - then_was == pytest.approx(now - was, abs=1e-3)
    times = session.take.clip.times
    outside = (times <= edit.start) | (times >= edit.end)
    assert np.array_equal(session.weights[outside], before[outside])
    assert not np.array_equal(session.weights, before)
    assert session.undo_name == f"Move in time +{now - was:.2f} s"
    trigger(window, "undo")
    assert np.array_equal(session.weights, before)


def test_the_face_is_shown_while_it_is_dragged_and_esc_brings_it_back(window: MainWindow) -> None:
    session, plot = session_of(window), begin(window)
    before, at = session.weights.copy(), window.timeline.frame
    drag(plot, place(plot, 4.5), place(plot, 4.8), release=False, previews=True)
    assert not np.array_equal(session.weights, before)
    assert window.timeline.time == pytest.approx(4.8, abs=0.03)
    QTest.keyClick(window, Qt.Key.Key_Escape)
    let_go(plot, place(plot, 4.8))
    assert session.edits == ()
    assert np.array_equal(session.weights, before)
    assert window.timeline.frame == at


def test_an_end_of_the_selection_is_dragged_to_stretch_it(window: MainWindow) -> None:
    plot = begin(window)
    drag(plot, place(plot, 5.0), place(plot, 5.3))
    (was, now), (then_was, then_now) = only_edit(window).pins
    assert (was, now, then_was) == (4.0, 4.0, 5.0)
    assert then_now == pytest.approx(5.3, abs=0.02)
    assert session_of(window).undo_name == f"Stretch to {100 * (then_now - 4.0):.0f} %"


def test_a_second_drag_goes_on_with_the_chosen_retime(window: MainWindow) -> None:
    plot = begin(window)
    drag(plot, place(plot, 4.5), place(plot, 4.7))
    drag(plot, place(plot, 4.7), place(plot, 4.6))
    (was, now), _ = only_edit(window).pins
    assert now - was == pytest.approx(0.1, abs=0.03)
    trigger(window, "undo")
    (was, now), _ = only_edit(window).pins
    assert now - was == pytest.approx(0.2, abs=0.02)
    trigger(window, "undo")
    assert window.timeline.selection == (4.0, 5.0), "what was selected before the first drag"


@pytest.mark.parametrize("beyond", [0.0, 3.0])
def test_a_selection_that_ends_after_the_last_frame_is_dragged_as_far_as_the_take_goes(
    window: MainWindow, beyond: float
) -> None:
    """As one from a project, or up to the take's whole length, which is a frame longer."""
    session, plot = session_of(window), begin(window)
    last = float(session.take.clip.times[-1])
    window.timeline.select((8.0, session.take.clip.duration + beyond))
    drag(plot, place(plot, 9.0), place(plot, 8.6), previews=True)
    edit = only_edit(window)
    assert edit.end <= last
    assert edit.pins[0] == pytest.approx((8.0, 7.6), abs=0.03)
    trigger(window, "undo")
    window.timeline.go_to_time(6.0)
    trigger(window, "deselect")
    trigger(window, "mark_start")
    assert window.timeline.selection == pytest.approx((6.0, last), abs=0.02)


def test_without_a_selection_the_moment_under_the_pointer_moves(window: MainWindow) -> None:
    trigger(window, "tool_retime")
    plot = plot_of(window)
    drag(plot, place(plot, 4.5), place(plot, 4.6), CTRL)
    ((was, now),) = only_edit(window).pins
    times = session_of(window).take.clip.times
    assert np.abs(times - now).min() < 1e-4
    assert now - was == pytest.approx(0.1, abs=0.02)


def test_a_click_still_moves_the_playhead(window: MainWindow) -> None:
    plot = begin(window)
    QTest.mouseClick(plot.viewport(), Qt.MouseButton.LeftButton, pos=place(plot, 4.5))
    assert window.timeline.time == pytest.approx(4.5, abs=0.03)
    assert session_of(window).edits == ()


def test_a_wild_drag_stops_where_the_take_has_no_room(window: MainWindow) -> None:
    plot = begin(window)
    start = place(plot, 4.5)
    said_: list[str] = []
    for pixels in (20, 3000):
        drag(plot, start, start + QPoint(pixels, 0), release=False, previews=True)
        assert plot.handle is not None
        said_.append(plot.handle.text[0])
    let_go(plot, start + QPoint(3000, 0))
    assert ["no more room" in amount for amount in said_] == [False, True]
    edit = only_edit(window)
    pins = np.array([(edit.start,) * 2, *edit.pins, (edit.end,) * 2])
    was, now = np.diff(pins, axis=0).T
    assert (was / now).min() > 0.49
    assert (was / now).max() < 2.01


def test_the_range_of_a_chosen_retime_is_changed_by_its_handles(window: MainWindow) -> None:
    plot = begin(window)
    drag(plot, place(plot, 4.5), place(plot, 4.6))
    edit, bar = only_edit(window), editor_of(window).curves.range_bar
    trigger(window, "tool_move")
    run_events()
    drag(bar, place(bar, edit.end, bar.height() / 2), place(bar, edit.end + 1.0, bar.height() / 2))
    wider = only_edit(window)
    assert (wider.start, wider.falloff, wider.pins) == (edit.start, 0.0, edit.pins)
    assert wider.end == pytest.approx(edit.end + 1.0, abs=0.05)
    assert window.timeline.selection == pytest.approx((wider.start, wider.end))


def test_a_hand_on_the_face_makes_an_edit_of_its_own(window: MainWindow) -> None:
    plot = begin(window)
    drag(plot, place(plot, 4.5), place(plot, 4.6))
    retime = only_edit(window)
    curves = editor_of(window).curves
    assert curves.hand.grab("mouth_opening", False)
    curves.hand.pull(3.0, False)
    curves.hand.let_go()
    assert [edit.op for edit in edits_of(window)] == [Op.RETIME, Op.OFFSET]
    assert edits_of(window)[0] == retime


# --- the menu --------------------------------------------------------------------------------


def test_a_typed_factor_is_previewed_and_made_as_one_step(window: MainWindow) -> None:
    session = session_of(window)
    before = session.weights.copy()
    window.timeline.select((4.0, 5.0))
    trigger(window, "stretch_time")
    dialog = dialog_of(window)
    assert not dialog.ok.isEnabled()
    dialog.number.setValue(130.0)
    assert not np.array_equal(session.weights, before)
    assert session.edits == ()
    assert "keeps its time" in dialog.message.text()
    dialog.accept()
    assert session.undo_name == "Stretch to 130 %"
    assert len(session.history[0]) == 1


def test_lengths_are_typed_in_frames_where_times_are_shown_as_frames(window: MainWindow) -> None:
    begin(window)
    trigger(window, "unit_frames")
    rate = session_of(window).take.clip.rate
    trigger(window, "move_time")
    number = dialog_of(window).number
    assert (number.suffix(), number.singleStep()) == (" frames", 1.0)
    number.setValue(6.0)
    dialog_of(window).accept()
    edit = only_edit(window)
    assert edit.pins[0][1] - edit.pins[0][0] == pytest.approx(6.0 / rate)
    trigger(window, "undo")
    trigger(window, "insert_pause")
    dialog_of(window).number.setValue(12.0)
    dialog_of(window).accept()
    (_, start), (_, end) = only_edit(window).pins[:2]
    assert end - start == pytest.approx(12.0 / rate)


def test_cancel_leaves_the_take_as_it_was(window: MainWindow) -> None:
    session = session_of(window)
    before = session.weights.copy()
    window.timeline.select((4.0, 5.0))
    trigger(window, "move_time")
    dialog = dialog_of(window)
    dialog.number.setValue(0.2)
    assert not np.array_equal(session.weights, before)
    dialog.reject()
    assert np.array_equal(session.weights, before)
    assert not session.can_undo


def test_what_has_no_room_is_said_in_the_dialog(window: MainWindow) -> None:
    window.timeline.select((0.0, 9.9))
    trigger(window, "move_time")
    dialog = dialog_of(window)
    dialog.number.setValue(3.0)
    refusal = dialog.message.text()
    assert "no room" in refusal
    assert not dialog.ok.isEnabled()
    for typed, shown in (("x", ""), ("3", refusal)):
        dialog.number.selectAll()
        QTest.keyClicks(dialog.number, typed)
        assert dialog.message.text() == shown
    dialog.reject()


def test_cut_and_pause(window: MainWindow) -> None:
    session = session_of(window)
    assert not window.actions_["cut_time"].isEnabled()
    window.timeline.select((4.0, 4.5))
    trigger(window, "cut_time")
    assert session.undo_name == "Cut 0.50 s"
    trigger(window, "undo")
    window.timeline.go_to_time(3.0)
    trigger(window, "insert_pause")
    dialog = dialog_of(window)
    dialog.option.setChecked(True)
    dialog.number.setValue(0.6)
    dialog.accept()
    retime, fill = edits_of(window)
    assert (retime.op, fill.op) == (Op.RETIME, Op.FILL)
    assert (fill.start, fill.end) == pytest.approx((3.0, 3.6), abs=0.02)
    assert session.undo_name == "Pause 0.60 s"
    trigger(window, "undo")
    assert session.edits == ()


def test_one_dialog_at_a_time(window: MainWindow) -> None:
    window.timeline.select((4.0, 5.0))
    trigger(window, "stretch_time")
    dialog_of(window).number.setValue(130.0)
    trigger(window, "insert_pause")
    assert dialog_of(window).windowTitle() == "Insert a pause"
    trigger(window, "levels")
    assert not [d for d in window.findChildren(RetimeDialog) if d.isVisible()]
    assert not session_of(window).can_undo


def test_a_retime_of_one_take_is_never_made_on_the_next(window: MainWindow) -> None:
    window.timeline.select((4.0, 5.0))
    trigger(window, "stretch_time")
    dialog = dialog_of(window)
    dialog.number.setValue(130.0)
    before = session_of(window)
    window.open_demo_now()
    assert session_of(window) is not before
    assert not dialog.isVisible()
    assert edits_of(window) == ()


def test_what_another_edit_replaced_is_shown_again_in_the_dialog(window: MainWindow) -> None:
    session, plot = session_of(window), plot_of(window)
    window.timeline.select((4.0, 5.0))
    trigger(window, "stretch_time")
    dialog = dialog_of(window)
    dialog.number.setValue(130.0)
    stretched = session.weights.copy()
    window.timeline.select(None)
    drag(plot, place(plot, 1.0), place(plot, 1.0) - QPoint(0, 20))
    trigger(window, "undo")
    assert not np.array_equal(session.weights, stretched)
    QCoreApplication.sendEvent(dialog, QEvent(QEvent.Type.WindowActivate))
    assert np.array_equal(session.weights, stretched)
    dialog.accept()
    assert only_edit(window).op is Op.RETIME


# --- another sound -----------------------------------------------------------------------------


WORDS = (("map", "M AE P"), ("boom", "B UW M"), ("fish", "F IH SH"))


def test_words_of_another_file_retime_the_take(
    window: MainWindow, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    session = session_of(window)
    assert not window.actions_["match_sound"].isEnabled()
    session.say(said(*WORDS, start=2.0))
    theirs = tmp_path / "theirs.TextGrid"
    write_words(theirs, said(*WORDS, start=0.5, each=0.15), 5.0)
    monkeypatch.setattr(dialogs, "ask_match", lambda *_: theirs)
    trigger(window, "match_sound")
    edit = only_edit(window)
    assert edit.op is Op.RETIME
    assert len(edit.pins) == 10
    assert session.words is not None
    assert session.words.words[0].start == pytest.approx(edit.pins[0][1], abs=1e-3)
    trigger(window, "undo")
    assert session.edits == ()
    assert session.words == said(*WORDS, start=2.0)


def test_words_that_do_not_match_are_refused(
    window: MainWindow, bench: Bench, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    session_of(window).say(said(*WORDS, start=2.0))
    theirs = tmp_path / "theirs.TextGrid"
    write_words(theirs, said(("sky", "S K AY"), ("green", "G R IY N")), 5.0)
    monkeypatch.setattr(dialogs, "ask_match", lambda *_: theirs)
    trigger(window, "match_sound")
    assert session_of(window).edits == ()
    assert "same words" in bench.errors[-1]


@needs_espeak
def test_another_sound_is_heard_with_the_take_from_then_on(
    window: MainWindow, qtbot: QtBot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    session = session_of(window)
    from faceedit_app.media.sound import read_sound
    from faceedit_app.words.aligning import TextLine, align

    sound = read_sound(speak(tmp_path / "first.wav"))
    assert sound is not None
    session.say(align(sound.samples, sound.rate, [TextLine(SENTENCE)]).shifted(1.0))
    dub = speak(tmp_path / "dub.wav", SENTENCE, pace=120)
    monkeypatch.setattr(dialogs, "ask_match", lambda *_: dub)
    trigger(window, "match_sound")
    qtbot.waitUntil(lambda: bool(window.findChildren(WordsDialog)), timeout=15_000)
    (dialog,) = window.findChildren(WordsDialog)
    assert dialog.text.toPlainText() == SENTENCE
    dialog.search.click()
    qtbot.waitUntil(lambda: bool(session.edits), timeout=60_000)
    assert only_edit(window).op is Op.RETIME
    assert session.state.media is not None
    assert session.state.media.sound is not None
    assert session.state.media.sound.path == dub
    media = window.workspace.media
    qtbot.waitUntil(lambda: media.sound is not None, timeout=15_000)
    trigger(window, "undo")
    assert session.edits == ()
    qtbot.waitUntil(lambda: media.sound is None, timeout=15_000)
