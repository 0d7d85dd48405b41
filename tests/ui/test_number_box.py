"""Typing numbers: with a point or a comma, in a system of any language."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from PySide6.QtCore import QLocale, QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QWidget
from pytestqt.qtbot import QtBot

from faceedit_app.ui.edits.splice_dialog import SpliceDialog
from faceedit_app.ui.look.number import NumberBox
from faceedit_app.ui.media.parts import OffsetBox


@pytest.fixture(params=["C", "en_US", "de_DE", "fr_FR", "ar_EG"])
def language(request: pytest.FixtureRequest) -> Iterator[None]:
    before = QLocale()
    QLocale.setDefault(QLocale(request.param))
    yield
    QLocale.setDefault(before)


def type_into(box: NumberBox, text: str) -> float:
    box.selectAll()
    QTest.keyClicks(box, text)
    QTest.keyClick(box, Qt.Key.Key_Return)
    return box.value()


@pytest.mark.usefixtures("language")
@pytest.mark.parametrize(
    ("text", "number"), [("1.5", 1.5), ("1,5", 1.5), ("0,25", 0.25), (",5", 0.5), ("-2,5", -2.5)]
)
def test_point_and_comma_begin_the_decimals(qtbot: QtBot, text: str, number: float) -> None:
    box = NumberBox()
    qtbot.addWidget(box)
    box.setRange(-5000, 5000)
    box.setSuffix(" s")
    assert type_into(box, text) == number
    assert box.text() == f"{number:.2f} s"


@pytest.mark.usefixtures("language")
def test_what_is_no_number_changes_nothing(qtbot: QtBot) -> None:
    box = NumberBox()
    qtbot.addWidget(box)
    box.setValue(1.5)
    for wrong in ("abc", "1.234,5", "1e2", "0x1", "-1", "100"):
        assert type_into(box, wrong) == 1.5
        assert box.text() == wrong, "it stays"
        assert box.property("refused")
    QTest.keyClick(box, Qt.Key.Key_Escape)
    assert (box.text(), box.value()) == ("1.50", 1.5)
    assert not box.property("refused")
    assert type_into(box, "0.126") == 0.13, "more digits are rounded"


@pytest.mark.parametrize(
    ("suffix", "typed"), [(" %", "50 %"), (" %", "50%"), (" mm", "50 mm"), ("°", "50°"), ("", "50")]
)
def test_a_unit_that_is_typed_is_not_shown_twice(qtbot: QtBot, suffix: str, typed: str) -> None:
    box = NumberBox()
    qtbot.addWidget(box)
    box.setRange(0, 500)
    box.setDecimals(0)
    box.setSuffix(suffix)
    box.selectAll()
    QTest.keyClicks(box, typed)
    assert box.text() == f"50{suffix}"
    QTest.keyClick(box, Qt.Key.Key_Backspace)
    assert box.text() == f"5{suffix}", "the number goes on being typed before the unit"
    QTest.keyClicks(box, "1")
    QTest.keyClick(box, Qt.Key.Key_Return)
    assert box.value() == 51


@pytest.mark.parametrize("x", [4, 18])
def test_a_double_click_selects_the_whole_number(qtbot: QtBot, x: int) -> None:
    box = NumberBox()
    qtbot.addWidget(box)
    box.setSuffix(" s")
    box.setValue(0.6)
    QTest.mouseDClick(box.lineEdit(), Qt.MouseButton.LeftButton, pos=QPoint(x, 5))
    assert box.lineEdit().selectedText() == "0.60"
    QTest.keyClicks(box.lineEdit(), "0.1")
    QTest.keyClick(box.lineEdit(), Qt.Key.Key_Return)
    assert box.value() == 0.1


@pytest.mark.usefixtures("language")
def test_an_offset_is_typed_with_either(qtbot: QtBot) -> None:
    box = OffsetBox("sound")
    qtbot.addWidget(box)
    assert type_into(box, "+0,250") == 0.25
    assert type_into(box, "-1.5") == -1.5
    assert box.text() == "-1.500 s"


@pytest.mark.usefixtures("language")
def test_one_and_a_half_seconds_are_inserted(qtbot: QtBot) -> None:
    window = QWidget()
    qtbot.addWidget(window)
    made: list[float] = []
    dialog = SpliceDialog(
        window,
        "Insert",
        "",
        (0.5, 600.0),
        ("s", 1.0),
        (),
        lambda seconds, _film: made.append(seconds),
    )
    assert type_into(dialog.number, "1,5") == 1.5
    dialog.accept()
    assert made == [1.5]
