"""The application as it looks to its users."""

from __future__ import annotations

from PySide6.QtWidgets import QApplication

from faceedit_app.ui.look.theme import apply_theme


def themed() -> QApplication:
    """The application with its style, colours and font.

    They are applied once: Qt visits all widgets each time, also those of the last test.
    """
    app = QApplication.instance()
    assert isinstance(app, QApplication)
    if not app.styleSheet():
        apply_theme(app)
    return app
