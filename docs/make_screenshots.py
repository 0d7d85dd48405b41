"""Writes the pictures of docs/guide.md, and docs/shortcuts.md, from the real window.

    python docs/make_screenshots.py

Needs no display: the window is drawn offscreen, on the demo take, and driven as a user would.
"""

from __future__ import annotations

import os
import tempfile
import time
from itertools import groupby
from pathlib import Path

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")

from PySide6.QtCore import QPoint, QSettings, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QWidget

from faceedit_app.ui.actions import help_rows
from faceedit_app.ui.app import application
from faceedit_app.ui.editor import Editor
from faceedit_app.ui.store import Store
from faceedit_app.ui.window import MainWindow

DOCS = Path(__file__).parent
PICTURES = DOCS / "images"
SIZE = (1440, 900)
LEFT = Qt.MouseButton.LeftButton


def main() -> None:
    """Walk through the guide."""
    PICTURES.mkdir(exist_ok=True)
    (DOCS / "shortcuts.md").write_text(shortcuts(), encoding="utf-8")
    application()
    with tempfile.TemporaryDirectory() as folder:
        settings = QSettings(str(Path(folder) / "s.ini"), QSettings.Format.IniFormat)
        window = MainWindow(Store(settings))
        window.resize(*SIZE)
        window.show()
        picture(window, "guide_start")
        window.open_demo_now()
        walk(window)
        window.leave()


def walk(window: MainWindow) -> None:
    """From opening a take to exporting it."""
    editor, line = window.editor, window.timeline
    assert editor is not None
    wait(0.6)  # problems are looked for
    picture(window, "guide_open")
    do(window, "first_steps")
    picture(window, "guide_steps")
    do(window, "deselect")

    line.show_range(4.6, 8.2)
    opening = editor.curves.plots[0].viewport()
    at = QPoint(round(editor.curves.plots[0].current_scale.x_of(6.1)), 40)
    drag(opening, at, QPoint(0, -16), release=False)
    picture(window, "guide_drag")
    QTest.mouseRelease(opening, LEFT, pos=at + QPoint(0, -16))
    QTest.mouseMove(editor.face, QPoint(40, 200))

    line.select((6.2, 6.8))
    line.set_falloffs(0.2, 0.35)
    line.go_to_time(6.4)
    picture(window, "guide_selection")

    line.show_range(0.0, line.duration)
    line.select(None)
    go_to(window, editor, "blink")
    do(window, "fix_problem")
    picture(window, "guide_blink")
    do(window, "accept_fix")
    go_to(window, editor, "lips")
    do(window, "fix_problem")
    picture(window, "guide_lips")
    do(window, "accept_fix")

    line.go_to_time(5.2)
    do(window, "fix_smile")
    editor.edits.strength.setValue(70)
    editor.edits.settle()
    do(window, "show_both")
    picture(window, "guide_smile")
    do(window, "show_difference")
    picture(window, "guide_difference")
    do(window, "show_difference")
    do(window, "show_edited")


def go_to(window: MainWindow, editor: Editor, kind: str) -> None:
    """The first problem of a kind."""
    editor.problems.search()
    kinds = [problem.kind.value for problem in editor.problems.problems]
    window.fixes.go_to(kinds.index(kind))


def do(window: MainWindow, command: str) -> None:
    """As the menu would."""
    window.actions_[command].trigger()


def drag(widget: QWidget, start: QPoint, by: QPoint, release: bool = True) -> None:
    """Press, move, and let go."""
    QTest.mouseMove(widget, start)
    QTest.mousePress(widget, LEFT, pos=start)
    for step in range(1, 6):
        QTest.mouseMove(widget, start + by * step / 5)
        wait(0.03)
    if release:
        QTest.mouseRelease(widget, LEFT, pos=start + by)


def wait(seconds: float) -> None:
    """Let the window do its work."""
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        QApplication.processEvents()
        time.sleep(0.01)


def picture(window: MainWindow, name: str) -> None:
    """The window as it is now."""
    wait(0.5)
    window.grab().save(str(PICTURES / f"{name}.png"))


def shortcuts() -> str:
    """All shortcuts and gestures, from the table that the menus and the help are made of."""
    parts = [
        "# Shortcuts\n",
        "Written by `docs/make_screenshots.py` from the table in `faceedit_app/ui/actions.py`;"
        " the same list is in the window under Help > Shortcuts (F1).\n",
    ]
    for section, rows in groupby(help_rows(), key=lambda row: row[0]):
        parts += [f"## {section}\n", "| keys or mouse | what it does |", "|---|---|"]
        parts += [f"| {keys.replace('|', '&#124;')} | {text} |" for _, keys, text in rows]
        parts.append("")
    return "\n".join(parts)


if __name__ == "__main__":
    main()
