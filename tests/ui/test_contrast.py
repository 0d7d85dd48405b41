"""Every text has a contrast of at least 4.5:1 (WCAG 2.1, 1.4.3) with what is behind it."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from PySide6.QtGui import QPalette
from PySide6.QtWidgets import QApplication, QMenu
from support.contrast import LEAST, contrast, unreadable_entries, unreadable_texts
from support.waiting import run_events
from support.windows import Bench, add_edit, session_of

from faceedit_app.core.controls import CONTROLS
from faceedit_app.ui.curves import style
from faceedit_app.ui.look import palette
from faceedit_app.ui.look.theme import window_palette
from faceedit_app.ui.start.window import MainWindow


def test_contrast_is_that_of_the_standard() -> None:
    assert contrast("#000000", "#ffffff") == pytest.approx(21)
    assert contrast("#767676", "#ffffff") == pytest.approx(4.54, abs=0.01)


# What is painted by hand: a text and all that can be behind it.
PAINTED: dict[str, tuple[str, tuple[str, ...]]] = {
    "name of a curve": (style.LABEL, (style.PLOT, style.PLOT_ACTIVE)),
    "value": (style.TEXT, (style.PLOT, style.PLOT_ACTIVE)),
    "share and note": (style.MUTED, (style.PLOT, style.PLOT_ACTIVE)),
    "numbers of an axis": (style.MUTED, (style.PLOT, style.PLOT_ACTIVE, style.BACKGROUND)),
    "hint": (style.MUTED, (style.BACKGROUND, style.PLOT)),
    "number on a curve": (style.TEXT, (style.TAG,)),
    "row of an edit": (palette.TEXT, (palette.BACKGROUND, palette.RAISED, palette.ACCENT_DEEP)),
    "details of an edit": (palette.MUTED, (palette.BACKGROUND, palette.RAISED)),
    "edit that is off": (palette.DISABLED, (palette.BACKGROUND,)),
    "edit that is off, hovered": (palette.MUTED, (palette.RAISED,)),
    "edit that is off, selected": (palette.LABEL, (palette.ACCENT_DEEP,)),
    "name of a face": (palette.TEXT, (palette.BACKGROUND,)),
    "accept": (palette.TEXT, (palette.ACCENT_DEEP, palette.ACCENT_HOVER)),
}


@pytest.mark.parametrize("what", PAINTED)
def test_what_is_painted_can_be_read(what: str) -> None:
    text, behind = PAINTED[what]
    for color in behind:
        assert contrast(text, color) >= LEAST, color


def test_the_palette_can_be_read() -> None:
    """Also where it is disabled, for widgets without a style sheet."""
    look, role = window_palette(), QPalette.ColorRole
    pairs = [
        (role.WindowText, role.Window),
        (role.Text, role.Base),
        (role.ButtonText, role.Button),
        (role.PlaceholderText, role.Base),
        (role.HighlightedText, role.Highlight),
        (role.ToolTipText, role.ToolTipBase),
        (role.Link, role.Window),
    ]
    for text, behind in pairs:
        assert contrast(look.color(text), look.color(behind)) >= LEAST, text


def test_the_colours_of_the_curves_stand_out() -> None:
    for control in CONTROLS:
        assert contrast(control.color, style.PLOT) >= LEAST


def with_edit(window: MainWindow) -> None:
    add_edit(window)
    assert window.editor is not None
    window.editor.edits.select(0)


def with_proposal(window: MainWindow) -> None:
    assert window.editor is not None
    window.editor.problems.search()
    window.editor.list_problems()
    session = session_of(window)
    add_edit(window)
    window.editor.proposal.offer("A proposal", session.edits, "Fix")


@pytest.mark.parametrize("state", [lambda _window: None, with_edit, with_proposal])
def test_every_text_in_the_window_can_be_read(
    bench: Bench, state: Callable[[MainWindow], None]
) -> None:
    window = bench.editing()
    window.banner.show_message("Something that one should know")
    window.status.showMessage("Done")
    state(window)
    run_events()
    QApplication.processEvents()
    seen, bad = unreadable_texts(window)
    assert bad == []
    assert seen > 30
    if state is not with_edit:
        return
    menus = [menu for menu in window.menuBar().findChildren(QMenu) if menu.actions()]
    assert len(menus) >= 8
    for menu in menus:
        menu.aboutToShow.emit()
        assert unreadable_entries(menu) == [], menu.title()
