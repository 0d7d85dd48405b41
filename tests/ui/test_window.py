"""The window with a take open: edit, undo, export, close."""

from __future__ import annotations

import re

import numpy as np
import pytest
from PySide6.QtCore import QPoint
from support import curves
from support.curves import place
from support.takes import make_livelink_csv
from support.waiting import wait_for_timers
from support.windows import (
    Bench,
    add_edit,
    drag_curve,
    drop,
    editor_of,
    open_path,
    session_of,
    trigger,
)

from faceedit_app.core.controls import CONTROL_INDEX
from faceedit_app.editing.edits.edit import Op
from faceedit_app.editing.edits.media import MediaFile, Placement
from faceedit_app.editing.files.edits_file import read_edits
from faceedit_app.formats.opening import open_take
from faceedit_app.ui.commands import dialogs
from faceedit_app.ui.commands.dialogs import Changed, Unsaved
from faceedit_app.ui.commands.unsaved import may_be_exported, question_about
from faceedit_app.ui.start.window import MainWindow
from faceedit_app.words.transcript import Transcript, Word

OPENING = CONTROL_INDEX["mouth_opening"]


# --- edit ------------------------------------------------------------------------------------


def test_a_drag_with_the_mouse_changes_the_exported_file(bench: Bench) -> None:
    window = bench.editing()
    before = bench.take.read_bytes()
    drag_curve(window, OPENING, 1.5, 25)
    session = window.document.session
    assert session is not None
    assert len(session.edits) == 1
    assert window.isWindowModified()
    bench.answers["export"] = bench.folder / "out.csv"
    trigger(window, "export")
    after = (bench.folder / "out.csv").read_bytes()
    assert after != before
    assert len(after.splitlines()) == len(before.splitlines())
    assert "Exported" in window.status.currentMessage()


def test_a_drag_during_playback_stops_it_where_the_hand_pressed(bench: Bench) -> None:
    window = bench.editing()
    line, plot = window.timeline, editor_of(window).curves.plots[0]
    window.playback.play()
    at = place(plot, 1.5)
    pressed = line.snap(plot.current_scale.time_at(plot.view.mapFromScene(plot.mapToScene(at)).x()))
    curves.drag(plot, at, at - QPoint(0, 12), release=False)
    assert not window.playback.playing
    assert line.time == pressed
    curves.let_go(plot, at - QPoint(0, 12))
    assert session_of(window).edits[0].start == line.time == pressed


def test_what_is_exported_opens_as_what_was_on_screen(bench: Bench) -> None:
    window = bench.editing()
    add_edit(window)
    session = window.document.session
    assert session is not None
    shown = session.clip_weights()
    bench.answers["export"] = bench.folder / "out.csv"
    trigger(window, "export")
    again = open_take(bench.folder / "out.csv")
    np.testing.assert_allclose(again.clip.weights, shown, atol=1e-6)
    assert again.clip.channels == session.take.clip.channels


def test_undo_redo_and_reset(bench: Bench) -> None:
    window = bench.editing()
    session = window.document.session
    assert session is not None
    tracked = session.weights.copy()
    add_edit(window)
    edited = session.weights.copy()
    assert not np.array_equal(edited, tracked)
    trigger(window, "undo")
    np.testing.assert_array_equal(session.weights, tracked)
    assert not window.isWindowModified()
    assert not window.actions_["undo"].isEnabled()
    trigger(window, "redo")
    np.testing.assert_array_equal(session.weights, edited)
    trigger(window, "select_all")
    trigger(window, "reset_range")
    np.testing.assert_array_equal(session.weights, tracked)
    trigger(window, "undo")
    np.testing.assert_array_equal(session.weights, edited)


def test_reset_without_a_selection_acts_around_the_playhead(bench: Bench) -> None:
    window = bench.editing()
    add_edit(window)
    window.timeline.go_to_time(1.2)
    window.timeline.set_falloffs(0.3, 0.3)
    trigger(window, "reset_range")
    session = window.document.session
    assert session is not None
    reset = session.edits[-1]
    assert reset.op is Op.RESET
    assert reset.falloff == 0.3
    assert (reset.start, reset.end) == pytest.approx((0.9, 1.5), abs=0.02)


def test_reset_of_one_curve(bench: Bench) -> None:
    window = bench.editing()
    drag_curve(window, OPENING, 1.0, 20)
    trigger(window, "reset_curve")
    session = window.document.session
    assert session is not None
    assert session.edits[-1].controls == ("mouth_opening",)
    assert session.edits[-1].op is Op.RESET


def test_natural_to_exact_is_one_undo_step_per_gesture(bench: Bench) -> None:
    window = bench.editing()
    add_edit(window)
    session, editor = window.document.session, window.editor
    assert session is not None
    assert editor is not None
    slider = editor.settings_bar.exactness
    slider.setSliderDown(True)
    for value in (80, 60, 40):
        slider.setSliderPosition(value)
        wait_for_timers(editor.settings_bar)
    slider.setSliderDown(False)
    assert session.settings.exactness == pytest.approx(0.4)
    trigger(window, "undo")
    assert session.settings.reach == 1.0
    assert slider.value() == 50
    assert len(session.edits) == 1


def test_a_slow_answer_waits_for_the_end_of_the_gesture(bench: Bench) -> None:
    window = bench.editing()
    add_edit(window)
    session, editor = window.document.session, window.editor
    assert session is not None
    assert editor is not None
    editor.settings_bar.setting.cost = 1.0
    slider = editor.settings_bar.exactness
    slider.setSliderDown(True)
    slider.setSliderPosition(30)
    wait_for_timers(editor.settings_bar)
    assert session.settings.reach == 1.0
    slider.setSliderDown(False)
    assert session.settings.exactness == pytest.approx(0.3)
    trigger(window, "undo")
    assert session.settings.reach == 1.0


def test_mode_is_chosen_by_its_two_buttons(bench: Bench) -> None:
    window = bench.editing()
    trigger(window, "resynthesize")
    assert window.actions_["resynthesize"].isChecked()
    assert not window.actions_["preserve"].isChecked()
    trigger(window, "undo")
    assert window.actions_["preserve"].isChecked()
    trigger(window, "preserve")
    assert window.actions_["preserve"].isChecked()


def test_edits_are_saved_and_loaded(bench: Bench) -> None:
    window = bench.editing()
    add_edit(window)
    session = window.document.session
    assert session is not None
    file = bench.folder / "edits.json"
    bench.answers["save_edits"] = file
    trigger(window, "save_edits")
    assert read_edits(file) == session.edits
    assert window.isWindowModified()
    trigger(window, "undo")
    drop(window, file)
    assert session.edits == read_edits(file)


def test_a_failed_export_says_so_and_keeps_the_edits(bench: Bench) -> None:
    window = bench.editing()
    add_edit(window)
    bench.answers["export"] = bench.folder / "nowhere" / "out.csv"
    trigger(window, "export")
    assert len(bench.errors) == 1
    assert window.isWindowModified()


# --- close -----------------------------------------------------------------------------------


def test_closing_asks_about_edits(bench: Bench) -> None:
    window = bench.editing()
    assert window.document.session is not None
    add_edit(window)
    bench.answers["unsaved"] = Unsaved.CANCEL
    assert not window.close()
    assert window.isVisible()
    bench.answers |= {"unsaved": Unsaved.EXPORT, "export": None}
    assert not window.close()
    bench.answers |= {"unsaved": Unsaved.SAVE, "save_project": bench.folder / "p.faceedit"}
    assert window.close()
    assert (bench.folder / "p.faceedit").exists()


def test_the_window_stays_if_it_cannot_ask(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    window = bench.editing()
    add_edit(window)
    with monkeypatch.context() as patched:
        patched.setattr(dialogs, "ask_unsaved", lambda: Unsaved.DISCARD)  # fails in C code
        with pytest.raises(TypeError):
            window.close()
    assert window.isVisible()
    bench.answers["unsaved"] = Unsaved.DISCARD
    assert window.close()


def test_an_export_is_not_a_saved_project(bench: Bench) -> None:
    window = bench.editing()
    add_edit(window)
    bench.answers["export"] = bench.folder / "out.csv"
    window.actions_["export"].trigger()
    assert window.isWindowModified()
    bench.answers["unsaved"] = Unsaved.CANCEL
    assert not window.close()
    # Exporting while closing asks again: the edits themselves are still in no file.
    answers = [Unsaved.EXPORT, Unsaved.CANCEL]
    asked: list[str] = []

    def ask(_parent: object, _message: str, more: str, **_buttons: bool) -> Unsaved:
        asked.append(more)
        bench.answers["export"] = bench.folder / "again.csv"
        return answers[len(asked) - 1]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(dialogs, "ask_unsaved", ask)
        assert not window.close()
    assert asked[0].startswith("out.csv holds the edited take")
    assert asked[1].startswith("again.csv holds the edited take")


def test_what_is_lost_by_closing_is_said_exactly(bench: Bench) -> None:
    window = bench.editing()
    document, session = window.document, session_of(window)
    session.say(Transcript((Word("blue", 0.1, 0.4),)))
    assert question_about(document) == (
        "Your words of take.csv are not saved in a project.",
        "If you discard them, they are lost.",
    )
    assert not may_be_exported(document), "an export does not hold words"
    session.undo()
    sound = MediaFile(bench.folder / "other.wav", 0.5)
    for media, said in {
        Placement(sound): "The sound of take.csv is not saved in a project.",
        Placement(film=sound): "The film of take.csv is not saved in a project.",
        Placement(sound, sound): "Your sound and film of take.csv are not saved in a project.",
    }.items():
        session.place(media)
        message, more = question_about(document)
        assert message == said
        assert re.search(
            "FaceEdit forgets which files? (it is|they are); the files? stays?.$", more
        )
        session.place(Placement())
        assert document.is_clean, "it was added and removed"
        session.travel(-2)
    beside, session.beside = session.beside, lambda: Placement(sound, sound)
    session.place(Placement(film=sound))
    removed = "You removed the sound of take.csv; that is not saved in a project."
    assert question_about(document) == (removed, "If you discard that, it comes back.")
    session.undo()
    session.place(Placement())
    removed = "You removed the sound and film of take.csv; that is not saved in a project."
    assert question_about(document) == (removed, "If you discard that, they come back.")
    session.undo()
    session.say(Transcript((Word("blue", 0.1, 0.4),)), Placement(sound, sound))
    assert question_about(document)[0] == "Your words of take.csv are not saved in a project."
    add_edit(window)
    session.place(Placement())
    message, more = question_about(document)
    assert message.startswith("Your edits, removed sound, removed film and")
    assert more == "If you discard them, they are lost.", "no file is"
    session.travel(-3)
    session.beside = beside
    session.say(Transcript((Word("blue", 0.1, 0.4),)))
    session.place(Placement(sound))
    add_edit(window)
    message, more = question_about(document)
    assert message.startswith("Your edits, sound and words of take.csv")
    assert more == "If you discard them, they are lost; the sound file stays."
    for _ in range(3):
        trigger(window, "undo")
    add_edit(window)
    bench.answers["export"] = bench.folder / "out.csv"
    trigger(window, "export")
    add_edit(window, -2.0)
    assert "out.csv holds the take as you exported it, not as" in question_about(document)[1]
    trigger(window, "undo")
    assert "out.csv holds the edited take" in question_about(document)[1]
    bench.answers["save_project"] = bench.folder / "scene.faceedit"
    trigger(window, "save")
    trigger(window, "undo")
    message, more = question_about(document)
    assert message == "Your latest changes to take.csv are not saved in scene.faceedit."
    assert "not as it is now" in more


def test_the_recording_is_overwritten_only_after_a_second_step(bench: Bench) -> None:
    recording = bench.take.read_bytes()
    window = bench.editing()
    add_edit(window)
    answers = [bench.take, bench.folder / "other.csv"]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(dialogs, "ask_export", lambda *_: answers.pop(0))
        bench.answers["overwrite"] = Changed.ELSEWHERE
        window.actions_["export"].trigger()
    assert bench.take.read_bytes() == recording
    assert (bench.folder / "other.csv").read_bytes() != recording
    bench.answers |= {"export": bench.take, "overwrite": Changed.REPLACE}
    window.actions_["export"].trigger()
    assert bench.take.read_bytes() == (bench.folder / "other.csv").read_bytes()
    assert (bench.folder / "take.csv.bak").read_bytes() == recording


def test_opening_another_take_asks_about_edits(bench: Bench) -> None:
    window = bench.editing()
    add_edit(window)
    other = make_livelink_csv(bench.folder / "other.csv")
    bench.answers["unsaved"] = Unsaved.CANCEL
    drop(window, other)
    assert open_path(window) == bench.take
    bench.answers["unsaved"] = Unsaved.DISCARD
    drop(window, other)
    bench.qtbot.waitUntil(lambda: open_path(window) == other)
    assert not window.isWindowModified()


def test_without_edits_nothing_is_asked(bench: Bench) -> None:
    window = bench.editing()
    assert window.close()


def test_the_layout_is_remembered(bench: Bench) -> None:
    window = bench.editing()
    assert window.editor is not None
    window.editor.panes.setSizes([400, 880])
    sizes = window.editor.panes.sizes()
    window.resize(1280, 700)
    assert window.close()
    again = bench.window(bench.take)
    assert again.editor is not None
    assert again.editor.panes.sizes()[0] == pytest.approx(sizes[0], abs=4)


def test_the_first_window_fits_on_the_screen_with_its_title_bar(bench: Bench) -> None:
    window = MainWindow(bench.preferences())  # as it comes, nothing resized it
    bench.qtbot.addWidget(window)
    room = window.screen().availableGeometry()
    assert 600 <= window.height() < room.height()
    assert window.width() <= max(room.width(), window.minimumWidth())


def test_in_a_narrow_window_a_count_is_shortened_not_cut_in_half_a_letter(bench: Bench) -> None:
    window = bench.editing()
    assert window.editor is not None
    label = window.editor.settings_bar.edits
    drag_curve(window, 0, 1.0, 20)
    window.resize(1600, 720)
    assert label.shown == label.text()
    window.resize(1000, 660)
    label.setText(3 * label.text())
    bench.qtbot.waitUntil(lambda: label.shown == "1 edit")
    label.short = ""
    label.repaint()
    assert label.shown.endswith("…")
    assert label.text().startswith(label.shown[:-1])
