"""Words in the real window: typed, found, shown, dragged, searched, and used to fix lips."""

from __future__ import annotations

from pathlib import Path
from threading import Event
from typing import Any

import pytest
from PySide6.QtCore import QEvent, QPoint, QPointF, Qt
from PySide6.QtGui import QMouseEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QMenu
from support.films import make_wav
from support.media import FakeOutput, settle, with_media
from support.speech import SENTENCE, mumbling_take, needs_espeak, said, speak
from support.takes import make_livelink_csv
from support.waiting import PATIENCE, run_events, wait_for_background
from support.windows import Bench, add_edit, editor_of, session_of, trigger

from faceedit_app.editing.help.spoken import closures_of
from faceedit_app.formats.opening import open_take
from faceedit_app.media import sound
from faceedit_app.ui.commands import dialogs
from faceedit_app.ui.edits.slider_dialog import SliderDialog
from faceedit_app.ui.media.words_dialog import WordsDialog
from faceedit_app.ui.media.words_strip import HEIGHT, WordsStrip
from faceedit_app.ui.page.problems_model import KIND
from faceedit_app.ui.start.window import MainWindow
from faceedit_app.words import aligning
from faceedit_app.words.denoising import Stopped
from faceedit_app.words.files import read_words
from faceedit_app.words.transcript import Transcript

WORDS = said(("bob", "B AA B"), ("sees", "S IY Z"), ("map", "M AE P"))
LEFT, NONE = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier


def with_words(bench: Bench, words: Transcript = WORDS) -> MainWindow:
    """A window with the usual take, and words that came from a file."""
    window = bench.editing()
    session_of(window).say(words)
    run_events()
    return window


def strip_of(window: MainWindow) -> WordsStrip:
    return editor_of(window).words.strip


def dialog_of(window: MainWindow) -> WordsDialog:
    trigger(window, "words")
    return window.findChildren(WordsDialog)[-1]


def at(strip: WordsStrip, seconds: float, y: int) -> QPoint:
    return QPoint(round(strip.current_scale.x_of(seconds)), y)


def move(strip: WordsStrip, to: QPoint) -> None:
    view = strip.viewport()
    place = QPointF(view.mapToGlobal(to))
    kind = QEvent.Type.MouseMove
    QApplication.sendEvent(view, QMouseEvent(kind, QPointF(to), place, LEFT, LEFT, NONE))


def test_nothing_of_it_is_seen_without_words(bench: Bench) -> None:
    window = bench.editing()
    assert not editor_of(window).words.isVisible()
    for command in ("find_word", "remove_words", "close_on_words", "shape_on_words", "say_clearly"):
        assert not window.actions_[command].isEnabled(), command
    session_of(window).say(WORDS)
    assert editor_of(window).words.isVisible()
    assert window.actions_["close_on_words"].isEnabled()
    trigger(window, "remove_words")
    assert not editor_of(window).words.isVisible()
    trigger(window, "undo")
    assert editor_of(window).words.isVisible()


@pytest.mark.parametrize("width", [1280, 1777])
def test_the_strip_is_under_the_plots_to_the_pixel(bench: Bench, width: int) -> None:
    window = with_words(bench)
    window.resize(width, 760)
    run_events()
    window.timeline.show_range(0.31, 1.57)
    plot, strip = editor_of(window).curves.plots[0], strip_of(window)
    left = plot.viewport().mapTo(window, QPoint(0, 0)).x() + plot.view.pos().x()
    assert strip.viewport().mapTo(window, QPoint(0, 0)).x() == left
    for seconds in (0.31, 0.8, 1.57):
        there = plot.current_scale.x_of(seconds)
        assert strip.current_scale.x_of(seconds) == pytest.approx(there, abs=0.01)


def test_a_click_goes_there_and_a_double_click_selects_a_word(bench: Bench) -> None:
    window = with_words(bench)
    strip = strip_of(window)
    QTest.mouseClick(strip.viewport(), LEFT, pos=at(strip, 2.0, 30))
    assert window.timeline.time == pytest.approx(2.0, abs=0.02)
    QTest.mouseDClick(strip.viewport(), LEFT, pos=at(strip, 0.9, 10))
    word, selection = WORDS.words[1], window.timeline.selection
    assert selection is not None
    assert selection == pytest.approx((word.start, word.end), abs=0.01)
    assert window.timeline.time == pytest.approx(word.start, abs=0.01)
    QTest.mouseDClick(strip.viewport(), LEFT, pos=at(strip, 2.5, 10))
    assert window.timeline.selection is None


def test_a_right_click_selects_a_word_and_opens_the_menu(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    window = with_words(bench)
    strip, opened = strip_of(window), []
    monkeypatch.setattr(QMenu, "popup", lambda menu, _place: opened.append(menu))
    QTest.mouseClick(strip.viewport(), Qt.MouseButton.RightButton, pos=at(strip, 0.9, 10))
    assert window.timeline.selection is not None
    (menu,) = opened
    assert window.actions_["loop"] in menu.actions()
    assert window.actions_["close_on_words"] in menu.actions()


def test_what_shuts_the_lips_is_marked_but_not_like_a_problem(bench: Bench) -> None:
    strip = strip_of(with_words(bench))
    picture, sounds = strip.grab().toImage(), WORDS.words[0].phonemes
    places = [at(strip, (sound.start + sound.end) / 2, HEIGHT - 4) for sound in sounds]
    b, vowel, _ = (picture.pixelColor(place) for place in places)
    assert b.lightness() > vowel.lightness() + 60
    assert b.red() < b.blue(), "orange is for problems"


def test_the_search_is_offered_in_a_selection_not_in_the_range_of_an_edit(bench: Bench) -> None:
    window = with_words(bench)
    add_edit(window)
    editor_of(window).edits.select(0)
    assert window.timeline.selection is not None
    dialog = dialog_of(window)
    assert not dialog.in_selection.isVisible()
    dialog.reject()
    window.timeline.select((0.5, 1.0))
    again = dialog_of(window)
    assert again.in_selection.isVisible()
    again.reject()


def test_dragging_an_edge_is_one_step_that_esc_cancels(bench: Bench) -> None:
    window = with_words(bench)
    window.timeline.show_range(0.3, 1.6)
    run_events()
    strip, session = strip_of(window), session_of(window)
    edge = WORDS.words[0].end
    press, there = at(strip, edge, 10), at(strip, edge + 0.05, 10)
    QTest.mousePress(strip.viewport(), LEFT, pos=press)
    move(strip, there)
    assert session.words is not None
    assert session.words.words[0].end == pytest.approx(edge + 0.05, abs=0.005)
    QTest.keyClick(strip, Qt.Key.Key_Escape)
    assert session.words == WORDS
    QTest.mouseRelease(strip.viewport(), LEFT, pos=there)
    assert session.words == WORDS
    QTest.mousePress(strip.viewport(), LEFT, pos=press)
    move(strip, there)
    QTest.mouseRelease(strip.viewport(), LEFT, pos=there)
    assert session.words.words[1].start == pytest.approx(edge + 0.05, abs=0.005)
    assert session.undo_name == "Move edge of a word"
    trigger(window, "undo")
    assert session.words == WORDS


def test_a_word_is_searched_again_and_again(bench: Bench) -> None:
    window = with_words(bench, said(("map", "M AE P"), ("bob", "B AA B"), ("Mad", "M AE D")))
    trigger(window, "find_word")
    search = editor_of(window).words.search
    assert search.hasFocus()
    starts = []
    QTest.keyClicks(search, "ma")
    for _ in range(3):
        QTest.keyClick(search, Qt.Key.Key_Return)
        assert window.timeline.selection is not None
        starts.append(window.timeline.selection[0])
    assert starts == pytest.approx([0.4, 1.12, 0.4], abs=0.01)
    search.setText("zebra")
    QTest.keyClick(search, Qt.Key.Key_Return)
    assert search.accessibleDescription() == "No word begins with “zebra”"
    QTest.keyClick(search, Qt.Key.Key_Escape)
    assert not search.hasFocus()
    assert not search.accessibleDescription(), "and what was shown is gone"


@needs_espeak
def test_from_typed_words_to_an_export_with_closed_lips(
    bench: Bench, devices: list[FakeOutput], tmp_path: Path
) -> None:
    take, words = mumbling_take(tmp_path)
    window = bench.window(take)
    settle(bench, window)
    dialog = dialog_of(window)
    dialog.text.setPlainText(SENTENCE)
    dialog.search.click()
    wait_for_background(window.workspace.background)
    session, editor = session_of(window), editor_of(window)
    assert session.words is not None
    assert session.words.text == SENTENCE
    assert session.words.words[3].start == pytest.approx(words.words[3].start, abs=0.01)
    editor.problems.search()
    found = [p.message for p in editor.problems.problems if p.kind == "lips"]
    assert len(found) == 6
    assert found[0].startswith("The m of “my” is open by")
    model = editor.problem_list.model
    rows = [model.index(row, KIND).data() for row in range(model.rowCount())]
    assert "Lips stay open: b of “bowl”" in rows
    trigger(window, "close_on_words")
    assert session.undo_name == "6 closures"
    assert len(session.edits) == 6
    assert max(closure.gap for closure in closures_of(session)) <= 0.5
    editor.problems.search()
    assert not [p for p in editor.problems.problems if p.kind == "lips"]
    trigger(window, "play")
    assert devices[0].plays
    trigger(window, "play")
    bench.answers["export"] = tmp_path / "fixed.csv"
    trigger(window, "export")
    assert (open_take(tmp_path / "fixed.csv").clip.weights != session.take.clip.weights).any()
    trigger(window, "undo")
    assert session.edits == ()


@needs_espeak
def test_unknown_and_wrong_words_are_asked_for(
    bench: Bench, devices: list[FakeOutput], tmp_path: Path
) -> None:
    take, _ = mumbling_take(tmp_path)
    window = bench.window(take)
    settle(bench, window)
    dialog = dialog_of(window)
    dialog.text.setPlainText(SENTENCE.replace("soup", "zoop"))
    dialog.search.click()
    (field,) = dialog._asked.values()
    for spelling, says in (("qqq", "not in the dictionary"), ("", "Not in the dictionary")):
        field.setText(spelling)
        dialog.search.click()
        assert says in dialog.message.text()
        (field,) = dialog._asked.values()
    field.setText("soup")
    dialog.search.click()
    wait_for_background(window.workspace.background)
    session = session_of(window)
    assert session.words is not None
    assert session.words.sounds_like == (("zoop", "soup"),)
    again = dialog_of(window)
    assert again.text.toPlainText().endswith("zoop")
    again.text.setPlainText("set white in nine again")
    again.search.click()
    wait_for_background(window.workspace.background)
    assert "do not fit" in again.message.text()
    assert again.search.isEnabled()
    again.reject()
    assert session.words.text.endswith("zoop")


def test_numbers_are_suggested_and_other_languages_noticed(
    bench: Bench, devices: list[FakeOutput], tmp_path: Path
) -> None:
    window = with_media(bench, make_wav(tmp_path / "voice.wav"))
    dialog = dialog_of(window)
    dialog.text.setPlainText("We met in 1984 for $5")
    dialog.search.click()
    assert [field.text() for field in dialog._asked.values()] == [
        "nineteen eighty four",
        "five dollars",
    ]
    assert "language" not in dialog.message.text()
    dialog.text.setPlainText("Привет, мир")
    dialog.search.click()
    assert "For a language other than English" in dialog.message.text()
    dialog.reject()


def test_the_search_can_be_cancelled(
    bench: Bench, devices: list[FakeOutput], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    going, shares = Event(), []

    def search(*given: Any) -> Transcript:
        going.wait(PATIENCE)
        shares.append(given[-1](0.5))
        raise Stopped("Cancelled")

    monkeypatch.setattr(aligning, "align_part", search)
    window = with_media(bench, make_wav(tmp_path / "voice.wav"))
    dialog = dialog_of(window)
    dialog.text.setPlainText(SENTENCE)
    dialog.search.click()
    assert not dialog.search.isEnabled()
    dialog.stop.click()
    going.set()
    wait_for_background(window.workspace.background)
    assert shares == [False]
    assert dialog.message.text() == "Cancelled."
    assert session_of(window).words is None
    dialog.stop.click()
    assert not dialog.isVisible()


def test_a_file_with_times_needs_no_sound(
    bench: Bench, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    window = with_words(bench)
    path = tmp_path / "words.TextGrid"
    monkeypatch.setattr(dialogs, "ask_save_words", lambda *_: path)
    monkeypatch.setattr(dialogs, "ask_words", lambda *_: path)
    dialog = dialog_of(window)
    dialog.export.click()
    dialog.reject()
    assert read_words(path).transcript == WORDS
    trigger(window, "remove_words")
    dialog = dialog_of(window)
    dialog.open_file.click()
    assert dialog.text.toPlainText() == "bob sees map"
    dialog.search.click()
    assert session_of(window).words == WORDS
    path.write_text("junk")
    dialog = dialog_of(window)
    dialog.open_file.click()
    assert "is not a TextGrid" in dialog.message.text()
    dialog.reject()


def test_typed_words_need_a_sound_and_can_be_corrected_by_keyboard(bench: Bench) -> None:
    window = bench.editing()
    dialog = dialog_of(window)
    dialog.text.setPlainText("hello")
    dialog.activateWindow()
    bench.qtbot.waitUntil(dialog.isActiveWindow)
    dialog.search.setFocus()
    QTest.keyClick(dialog.text, Qt.Key.Key_Return, Qt.KeyboardModifier.ControlModifier)
    wait_for_background(window.workspace.background)
    assert "no sound" in dialog.message.text()
    assert dialog.text.toPlainText() == "hello"
    assert dialog.focusWidget() is dialog.text
    dialog.reject()


def test_the_dialog_waits_for_a_sound_that_is_still_being_read(
    bench: Bench, devices: list[FakeOutput], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    going, read = Event(), sound.read_sound

    def slowly(*given: Any) -> sound.Sound | None:
        going.wait(PATIENCE)
        return read(*given)

    monkeypatch.setattr(sound, "read_sound", slowly)
    make_wav(tmp_path / "take.wav")
    window = bench.window(make_livelink_csv(tmp_path / "take.csv"))
    dialog = dialog_of(window)
    dialog.text.setPlainText("my mother made apple")
    dialog.search.click()
    assert "still being read" in dialog.message.text()
    going.set()
    settle(bench, window)
    dialog.search.click()
    wait_for_background(window.workspace.background)
    assert "do not fit" in dialog.message.text()
    dialog.reject()


def test_saying_it_clearly_is_previewed_and_made(bench: Bench) -> None:
    window = with_words(bench)
    session = session_of(window)
    trigger(window, "say_clearly")
    dialog = window.findChildren(SliderDialog)[-1]
    dialog.slider.setValue(80)
    assert dialog.words.text() == "80 % clearer"
    dialog.preview()
    assert session.is_previewing
    dialog.accept()
    assert {edit.strength for edit in session.edits} == {0.8}
    assert session.undo_name == "Say it clearly"
    trigger(window, "undo")
    trigger(window, "say_clearly")
    dialog = window.findChildren(SliderDialog)[-1]
    dialog.slider.setValue(-50)
    assert dialog.words.text() == "50 % mumbled"
    dialog.reject()
    assert session.edits == ()
    assert not session.is_previewing


@needs_espeak
def test_words_move_with_the_sound(bench: Bench, devices: list[FakeOutput], tmp_path: Path) -> None:
    window = bench.editing()
    window.media.add(speak(tmp_path / "voice.wav"))
    settle(bench, window)
    window.commands.take.words._set(WORDS)
    window.media.move_sound(0.25)
    window.media.acted.emit()
    assert session_of(window).words == WORDS.shifted(0.25)
    trigger(window, "undo")
    assert session_of(window).words == WORDS
