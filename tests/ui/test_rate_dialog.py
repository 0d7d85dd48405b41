"""The question for a frame rate: common rates at hand, any other by typing, the length in sight."""

from __future__ import annotations

import pytest
from PySide6.QtCore import Qt
from pytestqt.qtbot import QtBot

from faceedit_app.ui.look.refused import reason_in
from faceedit_app.ui.page.rate_dialog import RateDialog


@pytest.fixture
def dialog(qtbot: QtBot) -> RateDialog:
    dialog = RateDialog(None, "a<b>.csv has no column with times.", 64, 60.0)
    qtbot.addWidget(dialog)
    return dialog


def chosen(dialog: RateDialog) -> list[str]:
    return [button.text() for button in dialog.group.buttons() if button.isChecked()]


def test_the_likely_rate_is_chosen_and_its_length_shown(dialog: RateDialog) -> None:
    assert dialog.rate == 60
    assert chosen(dialog) == ["60"]
    assert dialog.length.text() == "At 60 fps the take lasts 0:01.067."


@pytest.mark.parametrize(
    ("name", "rate"), [("24", 24), ("29.97", 30000 / 1001), ("59.94", 60000 / 1001), ("50", 50)]
)
def test_a_common_rate_is_one_click(
    dialog: RateDialog, qtbot: QtBot, name: str, rate: float
) -> None:
    button = next(b for b in dialog.group.buttons() if b.text() == name)
    qtbot.mouseClick(button, Qt.MouseButton.LeftButton)
    assert dialog.rate == pytest.approx(rate, rel=1e-9)
    assert chosen(dialog) == [name]
    assert f"{64 / rate:.3f}" in dialog.length.text()


def test_any_other_rate_can_be_typed(dialog: RateDialog, qtbot: QtBot) -> None:
    dialog.spin.selectAll()
    qtbot.keyClicks(dialog.spin, "27.5")
    assert dialog.rate == 27.5
    assert chosen(dialog) == []
    assert dialog.length.text() == "At 27.5 fps the take lasts 0:02.327."


def test_nothing_is_said_of_a_rate_while_none_is_typed(dialog: RateDialog, qtbot: QtBot) -> None:
    dialog.show()
    shown = dialog.length.text()
    for wrong in ("abc", "0", "2000"):
        dialog.spin.selectAll()
        qtbot.keyClicks(dialog.spin, wrong)
        hint = reason_in(dialog)
        assert hint is not None
        assert hint.isVisible()
        assert hint.text() == "Type a number from 1 to 1000"
        assert (dialog.length.text(), chosen(dialog)) == ("", [])
        qtbot.mouseClick(dialog.group.buttons()[-1], Qt.MouseButton.LeftButton)
        assert (dialog.length.text(), chosen(dialog)) == (shown, ["60"])
        assert reason_in(dialog) is None
    dialog.spin.selectAll()
    qtbot.keyClicks(dialog.spin, "x")
    qtbot.keyClick(dialog.spin, Qt.Key.Key_Escape)
    assert not dialog.isVisible(), "Esc leaves the dialog at once"


def test_enter_takes_the_rate_and_escape_does_not(dialog: RateDialog, qtbot: QtBot) -> None:
    dialog.show()
    qtbot.keyClick(dialog.spin, Qt.Key.Key_Return)
    assert dialog.result() == RateDialog.DialogCode.Accepted
    dialog.show()
    qtbot.keyClick(dialog.spin, Qt.Key.Key_Escape)
    assert dialog.result() == RateDialog.DialogCode.Rejected
