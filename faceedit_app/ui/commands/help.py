"""The Help menu: the first steps, the list of shortcuts, and About."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from html import escape
from itertools import groupby

from PySide6.QtCore import Qt
from PySide6.QtWidgets import (
    QDialog,
    QDialogButtonBox,
    QLabel,
    QScrollArea,
    QVBoxLayout,
    QWidget,
)

from faceedit_app import __version__
from faceedit_app.ui.commands.workspace import Workspace
from faceedit_app.ui.look.palette import ACCENT, MUTED, TEXT
from faceedit_app.ui.look.widgets import resize_on_screen
from faceedit_app.ui.state.actions import Command, Menu

Rows = Iterable[tuple[str, str, str]]  # section, keys or gesture, effect

ABOUT = (
    "Edit tracked facial animation by dragging eight plain curves.",
    "After “A Robust Interactive Facial Animation Editing System”"
    " (Berson, Soladié, Barrielle, Stoiber; MIG 2019).",
)
LICENCE = (
    "FaceEdit is free software under the MIT licence. It uses the libraries below, each under its"
    " own licence; some contain others, such as PySide6 (Qt) and av (FFmpeg)."
)


class HelpCommands:
    """Shows how to use FaceEdit, and what it is.

    Args:
        rows: all shortcuts and gestures.
    """

    def __init__(self, workspace: Workspace, rows: Callable[[], Rows]) -> None:
        self._workspace, self._rows = workspace, rows

    def first_steps(self) -> None:
        """Show the main parts of the window and what they are for."""
        if self._workspace.page is not None:
            self._workspace.page.hints.begin()

    def shortcuts(self) -> None:
        """List all shortcuts and gestures."""
        shortcuts_dialog(self._workspace.window, self._rows()).show()

    def about(self) -> None:
        """Show version, credits and licences."""
        rig = self._workspace.rig
        about_dialog(self._workspace.window, rig.attribution if rig is not None else "").show()


def shortcuts_html(rows: Rows) -> str:
    """Shortcuts and gestures as a table."""
    parts = ["<table cellspacing='0' cellpadding='3' width='100%'>"]
    for section, some in groupby(rows, key=lambda row: row[0]):
        parts.append(
            f"<tr><td colspan='2' style='color:{ACCENT}; padding-top:10px'>"
            f"<b>{escape(section)}</b></td></tr>"
        )
        parts += [
            f"<tr><td width='38%' style='color:{TEXT}'>{escape(keys)}</td>"
            f"<td style='color:{MUTED}'>{escape(text)}</td></tr>"
            for _, keys, text in some
        ]
    return "".join([*parts, "</table>"])


def shortcuts_dialog(parent: QWidget, rows: Rows) -> QDialog:
    """Every shortcut, from the tables of commands."""
    return _dialog(parent, "Shortcuts", shortcuts_html(rows), (660, 640))


def about_html(attribution: str) -> str:
    """What this is, whose work is in it, and under which licences."""
    from faceedit_app.core.licences import (  # brings the standard e-mail parser
        libraries,
        texts_file,
    )

    texts = texts_file()
    paragraphs = [
        f"<span style='font-size:18pt; font-weight:600'>FaceEdit</span> {escape(__version__)}",
        *map(escape, ABOUT),
        f"<b>Character.</b> {escape(attribution)}" if attribution else "",
        f"<b>Licences.</b> {escape(LICENCE)}",
        f"The licence texts are in {escape(str(texts))}." if texts is not None else "",
    ]
    rows = [
        f"<tr><td style='color:{TEXT}'>{escape(library.name)} {escape(library.version)}</td>"
        f"<td style='color:{MUTED}'>{escape(library.licence)}</td></tr>"
        for library in libraries()
    ]
    table = "".join(["<table cellspacing='0' cellpadding='2' width='100%'>", *rows, "</table>"])
    return "".join(f"<p>{paragraph}</p>" for paragraph in paragraphs if paragraph) + table


def about_dialog(parent: QWidget, attribution: str) -> QDialog:
    """The dialog About FaceEdit."""
    return _dialog(parent, "About FaceEdit", about_html(attribution), (580, 520))


def _dialog(parent: QWidget, title: str, html: str, size: tuple[int, int]) -> QDialog:
    """A dialog with text that can be scrolled and copied."""
    label = QLabel(html)
    label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
    label.setWordWrap(True)
    label.setContentsMargins(8, 0, 8, 8)
    label.setAlignment(Qt.AlignmentFlag.AlignTop)
    area = QScrollArea()
    area.setWidget(label)
    area.setWidgetResizable(True)
    area.setFrameShape(QScrollArea.Shape.NoFrame)
    dialog = QDialog(parent)
    dialog.setWindowTitle(title)
    dialog.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
    buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Close)
    buttons.rejected.connect(dialog.reject)
    column = QVBoxLayout(dialog)
    column.addWidget(area, 1)
    column.addWidget(buttons)
    resize_on_screen(dialog, *size)
    return dialog


# fmt: off
MENU: Menu[HelpCommands] = Menu("&Help", (
    Command("first_steps", "&First steps", HelpCommands.first_steps, (),
            "Show the main parts of the window and what they are for"),
    Command("shortcuts", "&Shortcuts", HelpCommands.shortcuts, ("F1",), needs_take=False),
    Command("about", "&About FaceEdit", HelpCommands.about, needs_take=False),
))
# fmt: on
