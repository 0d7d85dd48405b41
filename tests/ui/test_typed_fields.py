"""Typing into the fields of the window: what is wrong stays, with the reason beside it."""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
from pathlib import Path
from typing import Any

import pytest
from PySide6.QtCore import QEvent, QPoint, Qt
from PySide6.QtGui import QFocusEvent, QFontMetricsF
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QDialog, QLineEdit, QWidget
from pytestqt.qtbot import QtBot
from support.films import make_wav
from support.media import with_media
from support.waiting import run_events
from support.windows import Bench, add_edit, editor_of, session_of, trigger

import faceedit_app.ui
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.ui.edits.panel import EditsPanel
from faceedit_app.ui.edits.splice_dialog import SpliceDialog
from faceedit_app.ui.look.number import NumberBox
from faceedit_app.ui.look.refused import reason_in
from faceedit_app.ui.page.live_dialog import LiveDialog, RecordDialog
from faceedit_app.ui.page.rate_dialog import RateDialog

WRONG = "x,,z"


def reason(widget: QWidget) -> str:
    shown = reason_in(widget.window())
    return shown.text() if shown is not None and not shown.isHidden() else ""


def type_wrongly(field: QWidget) -> None:
    field.setFocus()
    if isinstance(field, NumberBox | QLineEdit):
        field.selectAll()
    QTest.keyClicks(field, WRONG)
    QTest.keyClick(field, Qt.Key.Key_Return)


def test_every_number_of_the_window_keeps_what_is_no_number(bench: Bench) -> None:
    window = with_media(bench, make_wav(bench.folder / "sound.wav", 3.0))
    add_edit(window)
    window.actions_["all_channels"].trigger()
    window.timeline.select((0.5, 1.0))
    boxes = [box for box in window.findChildren(NumberBox) if box.isVisible()]
    assert len(boxes) > 5
    session = session_of(window)
    before, states = [box.value() for box in boxes], session.state
    for unit in ("frames", "timecode", "seconds"):
        window.actions_[f"unit_{unit}"].trigger()
        for box in boxes:
            value = box.value()
            type_wrongly(box)
            assert WRONG in box.text(), box.accessibleName()
            assert reason(box).startswith(("Type ", "The take ")), box.accessibleName()
            assert box.accessibleDescription() == reason(box)
            QTest.keyClick(box, Qt.Key.Key_Escape)
            assert (box.value(), reason(box)) == (value, ""), (box.accessibleName(), box.text())
    assert [box.value() for box in boxes] == before
    assert window.timeline.selection == (0.5, 1.0)
    assert session.state == states


def test_what_is_wrong_stays_when_the_field_is_left(bench: Bench) -> None:
    window = bench.editing()
    window.timeline.select((0.5, 1.0))
    start = editor_of(window).curves.fields.start
    start.setFocus()
    start.selectAll()
    QTest.keyClicks(start, "soon")
    window.setFocus()
    assert start.text() == "soon"
    assert reason(start).startswith("Type seconds")
    assert window.timeline.selection == (0.5, 1.0)
    start.setFocus()
    start.selectAll()
    QTest.keyClicks(start, "0.75")
    assert reason(start) == "", "as soon as it is right"
    QTest.keyClick(start, Qt.Key.Key_Return)
    assert window.timeline.selection == (0.75, 1.0)
    window.timeline.select(None)
    start.setFocus()
    start.lineEdit().end(False)
    QTest.keyClicks(start, "0:01.25")  # behind the dash that stands for no time
    QTest.keyClick(start, Qt.Key.Key_Return)
    assert window.timeline.selection == (1.25, 1.25)


def test_what_is_wrong_is_forgotten_when_another_edit_is_chosen(bench: Bench) -> None:
    window = bench.editing()
    session, editor = session_of(window), editor_of(window)
    for start, falloff in ((0.5, 0.1), (1.5, 0.3), (1.5, 0.3)):
        session.add(Edit(("mouth_opening",), Op.OFFSET, start, start + 0.4, falloff, 3.0))
    state, fields = session.state, editor.curves.fields
    for unit, box in product(
        ("seconds", "timecode"), (fields.start, fields.end, fields.fade_in, fields.fade_out)
    ):
        trigger(window, f"unit_{unit}")
        for chosen in (0, 1, 2, None):
            editor.edits.select(chosen)
            shown = box.text()
            assert (reason(box), "x" in shown) == ("", False), (box.accessibleName(), chosen)
            for _ in range(2):
                type_wrongly(box)
                assert box.hasFocus(), "another time is typed"
                assert session.state == state
            QTest.keyClick(box, Qt.Key.Key_Escape)
            assert box.text() == shown
            type_wrongly(box)
        if box is not fields.fade_out:
            continue
        window.timeline.select((0.2, 0.3))
        assert reason(box) == ""


def test_a_number_that_another_window_has_interrupted_is_kept(qtbot: QtBot) -> None:
    box = NumberBox()
    qtbot.addWidget(box)
    for typed, kept in (("5", "5.00"), ("6x", "6x")):
        box.selectAll()
        QTest.keyClicks(box, typed)
        away = QFocusEvent(QEvent.Type.FocusOut, Qt.FocusReason.ActiveWindowFocusReason)
        QApplication.sendEvent(box, away)
        assert box.text() == kept
    box.selectAll()
    QTest.keyClicks(box, "zz")
    QTest.keyClick(box, Qt.Key.Key_Return)
    assert box.value() == 5.0


def test_the_fields_of_the_range_show_all_of_it(bench: Bench) -> None:
    window = bench.editing()
    fields = editor_of(window).curves.fields
    window.timeline.select((1.123, 2.456))
    boxes, sizes = (fields.start, fields.end), set()
    for unit, box in product(("timecode", "seconds", "frames", "timecode"), (*boxes, *boxes)):
        trigger(window, f"unit_{unit}")
        run_events()  # the caption may make room
        line, places = box.lineEdit(), []
        for move in (line.home, line.end):
            move(False)
            line.grab()  # which scrolls to the cursor
            places.append(line.cursorRect().center().x())
        wide = QFontMetricsF(line.font()).horizontalAdvance(line.text())
        assert places[1] - places[0] >= int(wide), "it need not scroll"
        sizes.add((unit, line.font().pointSizeF()))
        type_wrongly(box)  # marked, which sets its font
        QTest.keyClick(box, Qt.Key.Key_Escape)
    assert len(sizes) == 3


def double_click(panel: EditsPanel, row: int, from_right: int) -> QWidget:
    """On a part of a row; returns the field that opens."""
    rect = panel.list.visualRect(panel.model.index(row))
    place = QPoint(rect.right() - from_right, rect.center().y())
    QTest.mouseClick(panel.list.viewport(), Qt.MouseButton.LeftButton, pos=place)
    QTest.mouseDClick(panel.list.viewport(), Qt.MouseButton.LeftButton, pos=place)
    field = QApplication.focusWidget()
    assert field is not None
    return field


def enter(field: QWidget) -> None:
    """Qt commits what was typed once the field has handled the key."""
    QTest.keyClick(field, Qt.Key.Key_Return)
    run_events()


def test_strength_and_range_are_typed_in_the_list(bench: Bench) -> None:
    window = bench.editing()
    add_edit(window, 3.0)
    add_edit(window)
    panel, session = editor_of(window).edits, session_of(window)
    field = double_click(panel, 1, 20)
    assert isinstance(field, NumberBox)
    assert field.lineEdit().width() > field.fontMetrics().horizontalAdvance("150 %"), "to be read"
    field.setValue(60)
    enter(field)
    assert session.edits[1].strength == 0.6
    assert session.undo_name == "Edit strength"
    for typed, expected in (("0.75 - 2", (0.75, 2.0)), ("1", (1, 1))):
        line = double_click(panel, 1, 100)
        assert isinstance(line, QLineEdit)
        line.setText(typed)
        enter(line)
        assert (session.edits[1].start, session.edits[1].end) == expected
    window.actions_["unit_frames"].trigger()
    line = double_click(panel, 1, 100)
    assert isinstance(line, QLineEdit)
    assert line.text() == "61 – 61"
    line.setText("61 – 91")
    enter(line)
    times = session.take.clip.times
    assert (session.edits[1].start, session.edits[1].end) == (times[60], times[90])
    assert session.edits[1].strength == 0.6


def test_the_unit_of_a_strength_may_be_typed(bench: Bench) -> None:
    window = bench.editing()
    add_edit(window)
    for typed, strength in (("50", 0.5), ("60 %", 0.6), ("70%", 0.7), (" 80 ", 0.8)):
        field = double_click(editor_of(window).edits, 0, 20)
        for key in typed:  # each goes to whatever has the focus
            QTest.keyClicks(QApplication.focusWidget() or window, key)
        enter(field)
        assert session_of(window).edits[0].strength == strength
        assert not window.playback.playing


def test_letters_are_those_of_the_field(bench: Bench) -> None:
    window = bench.editing()
    add_edit(window)
    editor, keys = editor_of(window), "abc e bg 1"
    channels = window.actions_["all_channels"]
    for field in (editor.curves.fields.start, editor.curves.fields.fade_in):
        field.setFocus()
        field.selectAll()
        for key in keys:
            QTest.keyClicks(QApplication.focusWidget() or window, key)
        assert field.text().strip() == keys.strip()
        QTest.keyClick(field, Qt.Key.Key_Escape)
    assert not editor.face.shows_tracked
    assert not channels.isChecked()
    assert not window.playback.playing


@pytest.mark.parametrize("across", [20, 100], ids=["strength", "range"])
def test_a_field_in_the_list_of_edits_stays_open(bench: Bench, across: int, qtlog: Any) -> None:
    window = bench.editing()
    add_edit(window)
    add_edit(window, 3.0)
    session = session_of(window)
    field, edits = double_click(editor_of(window).edits, 0, across), session.edits
    assert isinstance(field, NumberBox | QLineEdit)
    type_wrongly(field)
    run_events()
    assert field.isVisible()
    assert WRONG in field.text()
    assert reason(field).startswith("Type ")
    trigger(window, "rename_edit")
    for key in "e b":
        QTest.keyClicks(QApplication.focusWidget() or window, key)
    assert "e b" in field.text()
    QTest.keyClick(field, Qt.Key.Key_Return)
    window.setFocus()
    run_events()
    window.actions_["rename_edit"].trigger()
    assert field.isVisible()
    assert not [line for line in qtlog.records if "editing failed" in line.message]
    field.setFocus()
    QTest.keyClick(field, Qt.Key.Key_Escape)
    run_events()
    assert reason(window) == ""
    assert session.edits == edits
    assert editor_of(window).edits.list.hasFocus()
    for row in (0, 1):  # the click on the other row closes the field
        field = double_click(editor_of(window).edits, row, across)
        assert reason(window) == ""
        type_wrongly(field)
    assert session.edits == edits


DIALOGS: dict[str, Callable[[QWidget], QDialog]] = {
    "rate": lambda parent: RateDialog(parent, "What is its frame rate?", 90, 30.0),
    "live": LiveDialog,
    "record": RecordDialog,
    "splice": lambda parent: SpliceDialog(
        parent, "Insert", "", (0.5, 9.0), ("s", 1.0), (), lambda _seconds, _film: None
    ),
}


@pytest.mark.parametrize("name", DIALOGS)
def test_a_dialog_goes_on_only_with_numbers(name: str, qtbot: QtBot) -> None:
    parent = QWidget()
    qtbot.addWidget(parent)
    dialog = DIALOGS[name](parent)
    dialog.show()
    (box,) = dialog.findChildren(NumberBox)
    for wrong in (WRONG, "999999"):
        box.selectAll()
        QTest.keyClicks(box, wrong)
        dialog.accept()
        assert dialog.isVisible()
        assert wrong in box.text()
        assert " from " in reason(box)
    QTest.keyClick(box, Qt.Key.Key_Escape)
    assert not dialog.isVisible(), "Esc leaves it at once"
    assert dialog.result() == QDialog.DialogCode.Rejected


def test_all_numbers_are_typed_into_such_fields() -> None:
    home = Path(faceedit_app.ui.__file__).parent
    qt_own = ("QSpinBox(", "QDoubleSpinBox(", "QStyledItemDelegate)")
    found = {
        path.name
        for path in home.rglob("*.py")
        if any(name in path.read_text(encoding="utf-8") for name in qt_own)
    }
    assert found <= {"number.py", "problems_list.py", "shape_table.py"}
