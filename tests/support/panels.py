"""A curves panel that an earlier test has left, made as new: opening one takes four times as long.

It is used again only if nothing that `facts_below` sees tells it from a new one; else it is closed.
"""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot
from shiboken6 import isValid

from faceedit_app.ui.curves import CurvesPanel
from support.curves import new_panel, show_session
from support.facts import Facts, facts_below
from support.renewal import choose_as_at_first, forget_drags, forget_mouse, release_mouse
from support.rigs import tiny_session


class PanelShelf:
    """Keeps a panel from one test to the next of this process."""

    def __init__(self) -> None:
        self._panel: CurvesPanel | None = None
        self._wanted: Facts = {}  # of a new panel

    def take(self, qtbot: QtBot) -> CurvesPanel:
        """A panel on the screen that shows a session of its own."""
        panel, self._panel = self._panel, None
        if panel is not None:
            show_session(qtbot, panel, tiny_session())
            QApplication.setActiveWindow(panel)
            if facts_below(panel) == self._wanted:
                return panel
            _close(panel)
        panel = new_panel()
        show_session(qtbot, panel, tiny_session())
        self._wanted = facts_below(panel)
        return panel

    def put(self, panel: CurvesPanel) -> None:
        """Empty a panel and keep it."""
        if isValid(panel) and panel.isVisible() and QApplication.activePopupWidget() is None:
            _empty(panel)
            self._panel = panel

    def close(self) -> None:
        """Close the panel that is kept."""
        if self._panel is not None:
            _close(self._panel)


def _empty(panel: CurvesPanel) -> None:
    """Take everything from a panel that its test has left on it."""
    release_mouse(panel)
    line, session = panel.timeline, panel.session
    panel.cancel_drag()
    if session is not None:
        session.previewed.disconnect(panel.refresh)
        session.changed.disconnect(panel.refresh)
    panel.set_session(None)
    if (focused := panel.focusWidget()) is not None:
        focused.clearFocus()  # so that the first one gets it, as in a new panel
    panel.hide()
    line.leave_edit()
    line.restore_falloffs()
    choose_as_at_first(panel)
    forget_drags(panel)
    forget_mouse(panel)


def _close(panel: CurvesPanel) -> None:
    panel.close()
    panel.deleteLater()


@pytest.fixture(scope="session")
def panels(qapp: QApplication) -> Iterator[PanelShelf]:
    """The panel of the last test."""
    shelf = PanelShelf()
    yield shelf
    shelf.close()


@pytest.fixture
def panel(qtbot: QtBot, panels: PanelShelf) -> Iterator[CurvesPanel]:
    """A curves panel on the screen with a take of its own."""
    panel = panels.take(qtbot)
    yield panel
    panels.put(panel)
