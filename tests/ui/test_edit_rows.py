"""The rows of the list of edits: what has room in them, and how they are painted."""

from __future__ import annotations

from dataclasses import replace

import pytest
from PySide6.QtCore import QRect, QRectF
from PySide6.QtGui import QColor, QImage, QPainter
from PySide6.QtWidgets import QLineEdit, QStyle, QStyleOptionViewItem
from support.windows import Bench, drag_curve, editor_of, session_of, trigger

from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.ui.edits.delegate import EditsDelegate, RowField, cells, range_width
from faceedit_app.ui.edits.model import COLUMNS, columns
from faceedit_app.ui.edits.panel import EditsPanel
from faceedit_app.ui.look.palette import ACCENT_DEEP, BACKGROUND
from faceedit_app.ui.start.window import MainWindow


@pytest.fixture
def window(bench: Bench) -> MainWindow:
    window = bench.editing()
    session_of(window).add(Edit(("mouth_opening",), Op.OFFSET, 0.5, 0.8, 0.1, 4.0, name="first"))
    return window


def panel_of(window: MainWindow) -> EditsPanel:
    return editor_of(window).edits


def test_a_name_that_says_its_curve_has_room_to_say_how_much(window: MainWindow) -> None:
    panel, row = panel_of(window), QRectF(0, 0, 516, 25)
    drag_curve(window, 0, 1.0, 20)
    edit = session_of(window).edits[-1]
    name = panel.model.data(panel.model.index(1))
    assert name.startswith("Mouth opening +")
    (_, room), *others = cells(row, name, *columns(edit))
    assert panel.list.fontMetrics().horizontalAdvance(name) < room.width()
    assert columns(edit)[0].count("–") == 0  # one frame is not a range
    (_, named), *more = cells(row, "mine", *columns(edit))
    assert len(more) == len(others) + 1
    assert named.right() < min(place.left() for _, place in more)


def test_a_range_beyond_the_take_is_shown_to_its_end(window: MainWindow) -> None:
    line, panel = window.timeline, panel_of(window)
    session_of(window).add(Edit(("mouth_opening",), Op.OFFSET, 2.5, 3.4, 0.1, 4.0))
    last = f"{line.duration:.3f}"
    assert panel.model.index(1).data(COLUMNS)[0] == f"2.500 – {last} s"
    assert panel.model.ends(session_of(window).edits[1]) == f"2.500 – {last}"
    assert panel.model.typed_range(f"2.4 – {last}", session_of(window).edits[1]) == (2.4, 3.4)


def test_a_range_in_timecode_is_not_cut(window: MainWindow) -> None:
    trigger(window, "unit_timecode")
    panel = panel_of(window)
    index, metrics = panel.model.index(0), panel.list.fontMetrics()
    when, *others = index.data(COLUMNS)
    assert when == "12:00:00:30 – 12:00:00:48"
    for width in (403, 900):
        row = QRectF(0, 0, width, 25)
        ranged = range_width(row, metrics, when)
        found = cells(row, "Exaggerate", when, *others, ranged=ranged)
        for text in ("Exaggerate", when):
            room = next(place for said, place in found if said == text)
            assert metrics.horizontalAdvance(text) < room.width(), (width, text)
    session_of(window).add(Edit(("mouth_opening",), Op.OFFSET, 0.5, 0.5, 0.1, 4.0))
    delegate, option, field = EditsDelegate(), QStyleOptionViewItem(), QLineEdit()
    delegate.edits, option.fontMetrics, option.rect = RowField.RANGE, metrics, QRect(0, 0, 403, 25)
    delegate.updateEditorGeometry(field, option, panel.model.index(1))
    assert panel.model.index(1).data(COLUMNS)[0] == "12:00:00:30"
    assert metrics.horizontalAdvance("12:00:00:30 – 12:00:00:30") + 12 < field.width()


def test_the_name_of_an_edit_is_more_than_its_first_letters(window: MainWindow) -> None:
    panel = panel_of(window)
    index = panel.model.index(0)
    for width in (320, 403, 469, 470, 900):
        (_, room), *_ = cells(QRectF(0, 0, width, 25), "Exaggerate", *index.data(COLUMNS))
        assert panel.list.fontMetrics().horizontalAdvance("Exaggerate") < room.width(), width


def test_a_long_name_takes_what_its_curve_leaves(window: MainWindow) -> None:
    """As beside the curves of a window 1440 pixels wide."""
    row, metrics = QRectF(0, 0, 584, 25), panel_of(window).list.fontMetrics()
    texts = "1.000 – 2.000 s", "Mouth opening", "100 %"
    for name, is_moved in (("Smile", False), ("Wider for the vowel of the word", True)):
        (_, room), *others = cells(row, name, *texts, metrics=metrics)
        assert metrics.horizontalAdvance(name) < room.width(), name
        for text, place in others:
            assert metrics.horizontalAdvance(text) < place.width(), text
        usual = cells(row, name, *texts)
        assert (usual[-1][1] != others[-1][1]) is is_moved, "columns are in line otherwise"
    (_, room), *others = cells(row, "Longer than there is room for" * 3, *texts, metrics=metrics)
    assert room.right() < others[-1][1].left()
    assert metrics.horizontalAdvance(texts[1]) < others[-1][1].width()


def test_a_row_between_two_pixels_leaves_no_line_behind(window: MainWindow) -> None:
    """At 150 % every other row begins in the middle of a pixel."""
    panel = panel_of(window)
    picture = QImage(300, 120, QImage.Format.Format_RGB32)
    picture.setDevicePixelRatio(1.5)
    picture.fill(QColor(BACKGROUND))
    option = QStyleOptionViewItem()
    option.rect = QRect(0, 25, 200, 25)
    option.state |= QStyle.StateFlag.State_Selected
    with QPainter(picture) as painter:
        panel.list.itemDelegate().paint(painter, option, panel.model.index(0))
    colors = {picture.pixelColor(4, y).name() for y in range(picture.height())}
    assert colors == {BACKGROUND, ACCENT_DEEP}


def test_no_edit_is_said_to_begin_before_the_take() -> None:
    edit = Edit(("mouth_opening",), Op.OFFSET, -0.03, 0.03, 0.1, 4.0)
    assert columns(edit)[0] == "0.000 – 0.030 s"


def test_all_ranges_have_the_decimals_of_the_transport() -> None:
    edit = Edit(("left_eyelid",), Op.SCALE, 1.195, 1.205, 0.04, 1.0)
    assert columns(edit)[0] == "1.195 – 1.205 s"
    assert columns(replace(edit, end=1.195))[0] == "1.195 s"
    assert columns(replace(edit, end=1.3))[0] == "1.195 – 1.300 s"
