"""After the mouse or Enter, the keys are the curves' again; Tab leaves them where it goes."""

from __future__ import annotations

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import (
    QAbstractItemView,
    QAbstractSlider,
    QAbstractSpinBox,
    QApplication,
    QComboBox,
    QDialog,
    QLineEdit,
    QScrollBar,
    QWidget,
)
from support.films import make_wav
from support.media import FakeOutput, with_media
from support.waiting import run_events
from support.windows import Bench, add_edit, editor_of, session_of, trigger

from faceedit_app.ui.page.keys_back import KeysBack
from faceedit_app.ui.start.window import MainWindow

LEFT = Qt.MouseButton.LeftButton
Taking = QAbstractSlider | QAbstractSpinBox | QComboBox | QLineEdit | QAbstractItemView


@pytest.fixture
def window(bench: Bench, devices: list[FakeOutput]) -> MainWindow:
    """With all that can take keys: an edit, a sound, the channels, the Smooth tool."""
    window = with_media(bench, make_wav(bench.folder / "voice.wav"))
    add_edit(window)
    editor_of(window).edits.select(0)
    trigger(window, "tool_smooth")
    trigger(window, "all_channels")
    window.activateWindow()
    run_events()
    return window


def all_taking(window: MainWindow) -> list[QWidget]:
    """What would keep keys to itself if it had the focus."""
    return [
        widget
        for widget in window.findChildren(QWidget)
        if isinstance(widget, Taking)
        and not isinstance(widget, QScrollBar)
        and widget.focusPolicy() != Qt.FocusPolicy.NoFocus
        and widget.focusProxy() is None
        and widget.isVisible()
        and widget.isEnabled()
        and widget.window() is window
    ]


def home_has_keys(window: MainWindow) -> bool:
    return QApplication.focusWidget() is editor_of(window).curves


def test_the_mouse_leaves_the_keys_to_the_curves(window: MainWindow) -> None:
    face, found = editor_of(window).face.viewport, all_taking(window)
    kinds = {kind for kind in Taking.__args__ if any(isinstance(each, kind) for each in found)}
    assert kinds == set(Taking.__args__), "each kind is there"
    for widget in found:
        widget.setFocus(Qt.FocusReason.TabFocusReason)
        assert widget.hasFocus(), widget
        QTest.mouseClick(face, LEFT, pos=QPoint(60, 90))
        assert home_has_keys(window), (widget, widget.accessibleName())
    used = [w for w in found if isinstance(w, QAbstractSlider | QAbstractSpinBox)]
    assert len(used) > 5
    for widget in used:
        is_slider = isinstance(widget, QAbstractSlider)
        place = widget.rect().center() if is_slider else QPoint(widget.width() - 5, 5)
        for before in (editor_of(window).curves, widget):
            before.setFocus(Qt.FocusReason.TabFocusReason)
            QTest.mouseClick(widget, LEFT, pos=place)
            assert home_has_keys(window), (widget, widget.accessibleName())


def test_enter_in_a_number_field_takes_the_number_and_leaves_it(window: MainWindow) -> None:
    fields = [widget for widget in all_taking(window) if isinstance(widget, QAbstractSpinBox)]
    assert len(fields) > 4
    for field in fields:
        field.setFocus(Qt.FocusReason.TabFocusReason)
        QTest.keyClick(field, Qt.Key.Key_Up)
        assert field.hasFocus()
        QTest.keyClick(field, Qt.Key.Key_Return)
        assert home_has_keys(window), field.accessibleName()
    fade = editor_of(window).curves.fields.fade_in
    fade.setFocus()
    fade.selectAll()
    QTest.keyClicks(fade, "0.4")
    QTest.keyClick(fade, Qt.Key.Key_Enter)
    assert window.timeline.falloff == pytest.approx(0.4)
    session, count = session_of(window), len(session_of(window).edits)
    editor_of(window).proposal.offer("A proposal", [session.edits[0]], "Fix")
    fade.setFocus()
    QTest.keyClick(fade, Qt.Key.Key_Return)
    assert len(session.edits) == count, "it is no answer to a proposal"


def test_who_goes_by_tab_keeps_the_keys_and_a_click_into_a_text_is_meant(
    window: MainWindow,
) -> None:
    slider = editor_of(window).settings_bar.exactness
    slider.setFocus(Qt.FocusReason.TabFocusReason)
    for _ in range(3):
        QTest.keyClick(slider, Qt.Key.Key_Left)
        assert slider.hasFocus()
    assert slider.value() == 47
    editor = editor_of(window)
    assert editor.channels is not None
    search, rows = editor.channels.search, editor.channels.list
    for widget, pressed in ((search, search), (rows, rows.viewport())):
        QTest.mouseClick(pressed, LEFT, pos=pressed.rect().center())
        assert widget.hasFocus(), QApplication.focusWidget()


def test_what_is_hidden_or_disabled_gives_the_keys_back(window: MainWindow) -> None:
    editor, found = editor_of(window), all_taking(window)
    for widget in found:
        for gone in (QWidget.setVisible, QWidget.setEnabled):
            widget.setFocus(Qt.FocusReason.TabFocusReason)
            gone(widget, False)
            assert home_has_keys(window), (widget, QApplication.focusWidget())
            gone(widget, True)
    search = editor.channels.search if editor.channels is not None else None
    assert search is not None
    search.setFocus()
    trigger(window, "all_channels")
    assert home_has_keys(window)


def test_what_hands_the_keys_to_the_curves_by_itself_is_forgotten(bench: Bench) -> None:
    around = QWidget()
    home, field = QWidget(around), QLineEdit(around)
    home.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
    KeysBack(around).home = home
    bench.qtbot.addWidget(around)
    around.show()
    around.activateWindow()
    run_events()
    field.setFocus()
    field.hide()  # Qt gives them to what Tab reaches next
    assert home.hasFocus()
    field.deleteLater()
    run_events()
    QTest.mouseClick(home, LEFT)
    assert home.hasFocus()


def test_what_is_hidden_behind_a_dialog_gives_the_keys_back(window: MainWindow) -> None:
    rows, dialog = editor_of(window).edits.list, QDialog(window)
    for goes in (True, False):
        rows.setFocus(Qt.FocusReason.TabFocusReason)
        dialog.show()
        dialog.activateWindow()
        run_events()
        assert QApplication.activeWindow() is dialog
        rows.setVisible(not goes)
        dialog.hide()
        window.activateWindow()
        run_events()
        assert home_has_keys(window) == goes, QApplication.focusWidget()
        assert rows.hasFocus() != goes
        rows.show()


def test_a_list_that_takes_the_place_of_another_does_not_take_its_keys(
    window: MainWindow,
) -> None:
    editor = editor_of(window)
    for page, field, turn in (
        (editor.edits, editor.edits.list, editor.list_problems),
        (editor.problem_list, editor.problem_list.kinds, editor.list_edits),
    ):
        editor.lists.setCurrentWidget(page)
        field.setFocus(Qt.FocusReason.TabFocusReason)
        assert field.hasFocus()
        turn()
        assert editor.lists.currentWidget() is not page
        assert home_has_keys(window), QApplication.focusWidget()
