"""The Help menu: the first steps, the list of shortcuts, and whose work FaceEdit is."""

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
from faceedit_app.ui.state.actions import Command, Menu

Rows = Iterable[tuple[str, str, str]]  # section, keys or gesture, what it does

ABOUT = (
    "Edit tracked facial animation by dragging eight plain curves.",
    "After “Intuitive Facial Animation Editing Based On A Generative RNN Framework”"
    " (Berson, Soladié, Stoiber, 2020).",
)
LICENCES = (
    "FaceEdit is free software under the MIT licence. It stands on PySide6 (LGPL-3.0),"
    " pyqtgraph (MIT), NumPy and SciPy (BSD-3-Clause), PyAV (BSD-3-Clause) with FFmpeg (GPL-2.0),"
    " pyrender (MIT), PyOpenGL (BSD), trimesh (MIT), pygltflib (MIT), safetensors (Apache-2.0)"
    " and platformdirs (MIT)."
)


class HelpCommands:
    """Shows how FaceEdit is used, and what it is.

    Args:
        rows: all shortcuts and gestures.
    """

    def __init__(self, workspace: Workspace, rows: Callable[[], Rows]) -> None:
        self._workspace, self._rows = workspace, rows

    def first_steps(self) -> None:
        """Show where things are and what they are for."""
        if self._workspace.page is not None:
            self._workspace.page.hints.begin()

    def shortcuts(self) -> None:
        """List all shortcuts and gestures."""
        shortcuts_dialog(self._workspace.window, self._rows()).show()

    def about(self) -> None:
        """Say what this is, and whose work is in it."""
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
    label = QLabel(shortcuts_html(rows))
    label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
    label.setWordWrap(True)
    label.setContentsMargins(8, 0, 8, 8)
    label.setAlignment(Qt.AlignmentFlag.AlignTop)
    area = QScrollArea()
    area.setWidget(label)
    area.setWidgetResizable(True)
    area.setFrameShape(QScrollArea.Shape.NoFrame)
    return _dialog(parent, "Shortcuts", area, (660, 640))


def about_dialog(parent: QWidget, attribution: str) -> QDialog:
    """What this is, whose work is in it, and under which licences."""
    paragraphs = [
        f"<span style='font-size:18pt; font-weight:600'>FaceEdit</span> {escape(__version__)}",
        *map(escape, ABOUT),
        f"<b>Character.</b> {escape(attribution)}" if attribution else "",
        f"<b>Licences.</b> {escape(LICENCES)}",
    ]
    label = QLabel("".join(f"<p>{p}</p>" for p in paragraphs if p))
    label.setWordWrap(True)
    label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
    label.setContentsMargins(8, 0, 8, 8)
    label.setAlignment(Qt.AlignmentFlag.AlignTop)
    return _dialog(parent, "About FaceEdit", label, (540, 340))


def _dialog(parent: QWidget, title: str, content: QWidget, size: tuple[int, int]) -> QDialog:
    dialog = QDialog(parent)
    dialog.setWindowTitle(title)
    dialog.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
    buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Close)
    buttons.rejected.connect(dialog.reject)
    column = QVBoxLayout(dialog)
    column.addWidget(content, 1)
    column.addWidget(buttons)
    dialog.resize(*size)
    return dialog


# fmt: off
MENU: Menu[HelpCommands] = Menu("Help", (
    Command("first_steps", "&First steps", HelpCommands.first_steps, (),
            "Show where things are and what they are for"),
    Command("shortcuts", "&Shortcuts", HelpCommands.shortcuts, ("F1",), needs_take=False),
    Command("about", "&About FaceEdit", HelpCommands.about, needs_take=False),
))
# fmt: on
