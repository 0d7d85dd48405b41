"""Commands, shortcuts, and which widget a key belongs to."""

from __future__ import annotations

import re
from collections import Counter
from importlib.metadata import version
from typing import Any

import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QAccessible, QKeySequence
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QDialog, QLabel, QToolButton, QWidget
from support.windows import Bench, trigger

from faceedit_app.ui.commands.help import about_dialog, shortcuts_dialog
from faceedit_app.ui.commands.menus import MENUS, help_rows
from faceedit_app.ui.start.window import MainWindow
from faceedit_app.ui.state.actions import Menu, shown_keys

LETTER = re.compile("&(.)")
COMMANDS = [command for menu in MENUS for command in menu.commands]


def words_of(dialog: QDialog) -> str:
    label = dialog.findChild(QLabel)
    assert isinstance(label, QLabel)
    return label.text()


def press(window: MainWindow, key: Qt.Key, shift: bool = False) -> None:
    """A key press where the focus is."""
    modifiers = Qt.KeyboardModifier.ShiftModifier if shift else Qt.KeyboardModifier.NoModifier
    QTest.keyClick(QApplication.focusWidget() or window, key, modifiers)


@pytest.fixture
def window(bench: Bench) -> MainWindow:
    window = bench.editing()
    window.activateWindow()
    bench.qtbot.waitUntil(lambda: QApplication.focusWidget() is not None)
    return window


def test_the_table_is_sound() -> None:
    assert max(Counter(command.id for command in COMMANDS).values()) == 1
    keys = Counter(QKeySequence(k).toString() for command in COMMANDS for k in command.keys)
    assert [key for key, count in keys.items() if count > 1] == []
    for command in COMMANDS:
        assert (command.run is None) is (command.fills is not None), command.id


def test_the_help_names_every_shortcut(bench: Bench, window: MainWindow) -> None:
    shown = " ".join(keys for _, keys, _ in help_rows())
    for command in COMMANDS:
        for keys in command.keys:
            assert shown_keys(keys) in shown
    dialog = shortcuts_dialog(window, help_rows())
    text = words_of(dialog)
    assert "Ctrl+Z" in text
    assert "Hold B" in text
    dialog.close()


def test_about_cites_the_paper_and_lists_the_libraries_that_are_installed(
    window: MainWindow,
) -> None:
    trigger(window, "about")
    text = words_of(next(d for d in window.findChildren(QDialog) if d.isVisible()))
    assert "A Robust Interactive Facial Animation Editing System" in text
    assert "Barrielle" in text
    for name in ("numpy", "PySide6_Essentials", "av"):
        assert f"{name} {version(name)}" in text
    for name in ("pytest", "torch", "ruff"):  # for those who work on FaceEdit
        assert f">{name} " not in text


def test_about_names_whose_work_the_character_is(window: MainWindow) -> None:
    dialog = about_dialog(window, "Somebody, CC0")
    assert "Somebody, CC0" in words_of(dialog)
    dialog.close()


def focusable(window: MainWindow) -> list[QWidget]:
    """Every widget of the window that can have the focus."""
    return [
        widget
        for widget in window.findChildren(QWidget)
        if widget.focusPolicy() != Qt.FocusPolicy.NoFocus
        and widget.isVisible()
        and widget.isEnabled()
        and widget.window() is window
    ]


def test_space_plays_whatever_has_the_focus(bench: Bench, window: MainWindow) -> None:
    widgets = focusable(window)
    assert len(widgets) > 8
    for widget in widgets:
        widget.setFocus(Qt.FocusReason.TabFocusReason)
        was_playing = window.playback.playing
        press(window, Qt.Key.Key_Space)
        assert window.playback.playing != was_playing, widget
    window.playback.pause()


def spoken(widget: QWidget) -> str:
    """What a screen reader says when the widget has the focus."""
    return QAccessible.queryAccessibleInterface(widget).text(QAccessible.Text.Name)


def test_every_focusable_widget_has_a_name_for_screen_readers(window: MainWindow) -> None:
    """Those too that come only when they are needed; what has a proxy never has the focus."""
    trigger(window, "go_to")  # the field for a time is named when it comes
    widgets = [
        widget
        for widget in window.findChildren(QWidget)
        if widget.focusPolicy() & Qt.FocusPolicy.TabFocus
        and widget.focusProxy() is None
        and widget.window() is window
    ]
    assert set(widgets) > {w for w in focusable(window) if w.focusProxy() is None} - {window}
    nameless = [widget for widget in widgets if not spoken(widget).strip()]
    assert not nameless


def test_arrows_move_the_playhead(window: MainWindow) -> None:
    press(window, Qt.Key.Key_Right)
    press(window, Qt.Key.Key_Right)
    press(window, Qt.Key.Key_Left)
    assert window.timeline.frame == 1
    press(window, Qt.Key.Key_Right, shift=True)
    assert window.timeline.frame == 61
    press(window, Qt.Key.Key_Left, shift=True)
    assert window.timeline.frame == 1
    press(window, Qt.Key.Key_End)
    assert window.timeline.frame == window.timeline.frames - 1
    press(window, Qt.Key.Key_Home)
    assert window.timeline.frame == 0


def test_arrows_move_a_slider_that_has_the_focus(window: MainWindow) -> None:
    assert window.editor is not None
    slider = window.editor.settings_bar.exactness
    slider.setFocus(Qt.FocusReason.TabFocusReason)
    press(window, Qt.Key.Key_Left)
    assert slider.value() == 49
    assert window.timeline.frame == 0
    press(window, Qt.Key.Key_Escape)
    assert not slider.hasFocus()


def test_digits_typed_into_the_falloff_are_no_shortcuts(window: MainWindow) -> None:
    assert window.editor is not None
    box = window.editor.curves.fields.fade_in
    box.setFocus()
    box.selectAll()
    QTest.keyClicks(box, "0.50")
    press(window, Qt.Key.Key_Return)
    assert window.timeline.falloff == pytest.approx(0.5)
    assert not box.hasFocus()
    window.timeline.set_falloffs(1.25, 1.25)
    assert box.value() == 1.25


def test_selection_is_marked_at_the_playhead(window: MainWindow) -> None:
    window.timeline.go_to_time(1.0)
    press(window, Qt.Key.Key_I)
    window.timeline.go_to_time(2.0)
    press(window, Qt.Key.Key_O)
    assert window.timeline.selection == pytest.approx((1.0, 2.0), abs=0.01)
    press(window, Qt.Key.Key_F)
    assert window.timeline.view == pytest.approx((0.9, 2.1), abs=0.02)
    press(window, Qt.Key.Key_F)
    assert window.timeline.view == pytest.approx((0.0, 3.0), abs=0.02)
    press(window, Qt.Key.Key_Escape)
    assert window.timeline.selection is None


def test_loop_and_speed(window: MainWindow) -> None:
    assert window.editor is not None
    window.actions_["loop"].trigger()
    assert window.playback.loop
    assert window.actions_["loop"].isChecked()
    window.actions_["loop"].trigger()
    assert not window.actions_["loop"].isChecked()
    window.editor.transport.speed.setCurrentIndex(0)
    assert window.playback.speed == 0.25
    for command, said in (
        ("fast_forward", "Playing forwards at 0.25×"),
        ("fast_forward", "Playing forwards at 0.5×"),
        ("rewind", "Playing backwards at 0.25×"),
    ):
        window.timeline.go_to_time(1.0)
        window.actions_[command].trigger()
        assert window.status.currentMessage() == said
    window.playback.pause()


def test_b_is_held_for_a_glance_at_the_tracked_face(window: MainWindow) -> None:
    assert window.editor is not None
    face = window.editor.face
    widget = QApplication.focusWidget()
    assert widget is not None
    QTest.keyPress(widget, Qt.Key.Key_B)
    assert face.shows_tracked
    assert window.actions_["show_tracked"].isChecked()
    QTest.keyRelease(widget, Qt.Key.Key_B)
    assert not face.shows_tracked
    press(window, Qt.Key.Key_T)
    assert face.shows_tracked
    window.actions_["show_edited"].trigger()
    assert not face.shows_tracked
    assert window.actions_["show_edited"].isChecked()


def test_the_clock_shows_the_takes_own_timecode(window: MainWindow) -> None:
    assert window.editor is not None
    transport = window.editor.transport
    assert transport.clock.text().startswith("12:00:00:00")
    window.timeline.go_to_frame(30)
    assert transport.frame.text() == "frame 31 / 180"
    assert transport.seconds.text().startswith("0:00.500 / ")


def test_the_time_is_shown_in_the_unit_that_was_clicked(window: MainWindow) -> None:
    assert window.editor is not None
    transport, ruler = window.editor.transport, window.editor.curves.ruler
    pictures = {bytes(ruler.grab().toImage().constBits())}
    for unit, label in (("frames", transport.frame), ("timecode", transport.clock)):
        QTest.mouseClick(label, Qt.MouseButton.LeftButton)
        assert window.timeline.display.unit == unit
        assert window.actions_[f"unit_{unit}"].isChecked()
        assert label.objectName() == "clock"
        pictures.add(bytes(ruler.grab().toImage().constBits()))
    assert len(pictures) == 3
    window.actions_["unit_seconds"].trigger()
    assert transport.frame.objectName() == "caption"


def test_j_k_and_l(window: MainWindow) -> None:
    window.timeline.go_to_time(1.5)
    press(window, Qt.Key.Key_L)
    assert window.playback.playing
    assert window.playback.pace == 1
    press(window, Qt.Key.Key_L)
    assert window.playback.pace == 2
    press(window, Qt.Key.Key_J)
    assert window.playback.pace == -1
    press(window, Qt.Key.Key_K)
    assert not window.playback.playing
    press(window, Qt.Key.Key_Slash)
    assert window.playback.playing
    window.playback.pause()


def test_both_faces_beside_each_other(bench: Bench, window: MainWindow) -> None:
    assert window.editor is not None
    face, viewport = window.editor.face, window.editor.face.viewport
    window.grab()
    whole, drawn = bench.renderers[-1].size[0], len(bench.renderers[-1].calls)
    QTest.mouseClick(
        next(b for b in face.findChildren(QToolButton) if b.text() == "Both"),
        Qt.MouseButton.LeftButton,
    )
    assert face.shows_both
    window.grab()
    assert bench.renderers[-1].size[0] == whole // 2
    assert len(bench.renderers[-1].calls) >= drawn + 2
    widget = QApplication.focusWidget() or window
    QTest.keyPress(widget, Qt.Key.Key_B)
    assert face.shows_tracked
    assert not face.shows_both
    QTest.keyRelease(widget, Qt.Key.Key_B)
    assert face.shows_both
    window.actions_["show_edited"].trigger()
    assert not face.shows_both
    viewport.reset_camera()


def test_alt_and_a_letter_opens_one_menu() -> None:
    letters = [LETTER.findall(menu.title.lower()) for menu in MENUS]
    assert all(len(found) == 1 for found in letters)
    assert len({found[0] for found in letters}) == len(MENUS)


@pytest.mark.parametrize("menu", MENUS, ids=lambda menu: menu.name)
def test_in_a_menu_a_letter_belongs_to_one_entry(menu: Menu[Any]) -> None:
    entries: dict[str, list[str]] = {"": []}
    for command in menu.commands:
        if command.submenu and command.submenu not in entries:
            entries[""].append(command.submenu)
        entries.setdefault(command.submenu, []).append(command.text)
    for submenu, texts in entries.items():
        letters = Counter(letter for text in texts for letter in LETTER.findall(text.lower()))
        twice = {
            letter: [text for text in texts if f"&{letter}" in text.lower()]
            for letter, count in letters.items()
            if count > 1
        }
        assert twice == {}, submenu or menu.name
