"""Every dialog: texts can be read, Tab reaches each part and shows it, small screens have room."""

from __future__ import annotations

import importlib
import pkgutil
import re
from pathlib import Path

from PySide6.QtCore import QPoint, QRect, Qt
from PySide6.QtGui import QKeySequence
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QDialog, QFileDialog, QLabel, QMessageBox, QWidget
from support.contrast import unreadable_texts
from support.dialogs import DIALOGS, look_at, questions
from support.waiting import run_events
from support.windows import Bench

from faceedit_app import ui
from faceedit_app.ui.look.texts import Message

SMALL = (960, 500)  # pixels: 1920 x 1080 at twice the size, less a title bar
AROUND = 6  # pixels beside a widget in which its focus may show
NO_STANDARD = QMessageBox.StandardButton.NoButton
MOST = 80  # stops of Tab
LONG = "A message of several lines. " * 10
NAME = re.compile(r"\b(take|talk|film|head|scan)\w*\.[a-z]\w+")  # of a file in these dialogs


def classes() -> set[str]:
    """The names of all dialogs in the `ui` room."""
    for module in pkgutil.walk_packages(ui.__path__, f"{ui.__name__}."):
        importlib.import_module(module.name)
    found, left = set(), [QDialog]
    while left:
        for kind in left.pop().__subclasses__():
            left.append(kind)
            if kind.__module__.startswith(ui.__name__):
                found.add(kind.__name__)
    return found


def test_no_dialog_is_left_out() -> None:
    """A new question or dialog belongs in the table in `tests/support/dialogs.py`."""
    assert questions() - set(DIALOGS) == set()
    plain = {name.split()[0] for name in DIALOGS}
    opened_by_questions = {"RateDialog", "ExportDialog", "FilmDialog", "LiveDialog", "RecordDialog"}
    parents = {"PreviewDialog", "_AddressDialog"}
    assert classes() - plain - opened_by_questions - parents == set()


def stops(dialog: QDialog) -> list[QWidget]:
    """Where Tab stops until it is back."""
    dialog.activateWindow()
    run_events()
    found: list[QWidget] = []
    for _ in range(MOST):
        QTest.keyClick(QApplication.focusWidget() or dialog, Qt.Key.Key_Tab)
        focus = QApplication.focusWidget()
        if focus is None or focus in found:
            break
        found.append(focus)
    return found


def not_reached(dialog: QDialog, reached: list[QWidget]) -> list[QWidget]:
    """What takes the focus by Tab, but is never given it."""
    by_tab = Qt.FocusPolicy.TabFocus
    return [
        widget
        for widget in dialog.findChildren(QWidget)
        if widget.isVisible()
        and widget.isEnabled()
        and widget.window() is dialog
        and widget.focusPolicy() & by_tab == by_tab
        and widget.focusProxy() is None
        and widget not in reached
    ]


def shows_focus(dialog: QDialog, stop: QWidget) -> bool:
    """Whether a part looks different while it has the focus."""
    place = QRect(stop.mapTo(dialog, QPoint()), stop.size())
    around = place.adjusted(-AROUND, -AROUND, AROUND, AROUND) & dialog.rect()
    stop.setFocus(Qt.FocusReason.TabFocusReason)
    run_events()
    lit = dialog.grab(around).toImage()
    stop.clearFocus()
    run_events()
    return lit != dialog.grab(around).toImage()


def without_letter(box: QMessageBox) -> list[str]:
    """The answers of a question that no letter of their own chooses; Esc is Cancel."""
    texts = [b.text() for b in box.buttons() if box.standardButton(b) is NO_STANDARD]
    letters = [QKeySequence.mnemonic(text).toString() for text in texts]
    return [t for t, key in zip(texts, letters, strict=True) if not key or letters.count(key) > 1]


def faults(dialog: QDialog) -> list[str]:
    run_events()
    seen, found = unreadable_texts(dialog)
    if seen < 2:
        found.append("no texts found")
    for label in dialog.findChildren(QLabel):
        if NAME.search(label.text()) and label.textFormat() is not Qt.TextFormat.PlainText:
            found.append(f"a name could be rich text: {label.text()}")
    least = dialog.minimumSizeHint()
    if least.width() > SMALL[0] or least.height() > SMALL[1]:
        found.append(f"needs {least.width()} x {least.height()} pixels")
    if isinstance(dialog, QFileDialog):  # its focus is Qt's affair
        return found
    if isinstance(dialog, QMessageBox):
        found += [f"no letter for {text}" for text in without_letter(dialog)]
    for message in dialog.findChildren(Message):
        message.setText(LONG)
        run_events()
        if message.height() < message.heightForWidth(message.width()):
            found.append("a long message is cut")
    reached = stops(dialog)
    found += [f"Tab does not reach {widget}" for widget in not_reached(dialog, reached)]
    found += [
        f"the focus of {stop} is not seen" for stop in reached if not shows_focus(dialog, stop)
    ]
    return found


def test_every_dialog_can_be_read_and_used_by_keys(bench: Bench, tmp_path: Path) -> None:
    window = bench.editing()
    wrong: dict[str, list[str]] = {}

    def look(dialog: QDialog) -> None:
        if found := faults(dialog):
            wrong[name] = found

    for name in DIALOGS:
        look_at(window, tmp_path, name, look)
    assert wrong == {}
