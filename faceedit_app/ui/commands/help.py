"""The two dialogs of the Help menu."""

from __future__ import annotations

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
from faceedit_app.ui.look.palette import ACCENT, MUTED, TEXT
from faceedit_app.ui.state.actions import help_rows

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


def shortcuts_html() -> str:
    """All shortcuts and gestures as a table."""
    parts = ["<table cellspacing='0' cellpadding='3' width='100%'>"]
    for section, rows in groupby(help_rows(), key=lambda row: row[0]):
        parts.append(
            f"<tr><td colspan='2' style='color:{ACCENT}; padding-top:10px'>"
            f"<b>{escape(section)}</b></td></tr>"
        )
        parts += [
            f"<tr><td width='38%' style='color:{TEXT}'>{escape(keys)}</td>"
            f"<td style='color:{MUTED}'>{escape(text)}</td></tr>"
            for _, keys, text in rows
        ]
    return "".join([*parts, "</table>"])


def shortcuts_dialog(parent: QWidget) -> QDialog:
    """Every shortcut, generated from the table of commands."""
    label = QLabel(shortcuts_html())
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
