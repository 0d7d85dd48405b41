"""The first steps: shown once, three of them, by mouse and by keyboard."""

from __future__ import annotations

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from support.waiting import run_events
from support.windows import Bench, editor_of, trigger

from faceedit_app.ui.state.preferences import Preferences


def test_they_are_shown_once(bench: Bench) -> None:
    settings = bench.preferences()._settings
    settings.remove("hints_seen")
    settings.sync()
    window = bench.editing()
    assert window.editor is not None
    hints = window.editor.hints
    bench.qtbot.waitUntil(hints.isVisible)
    assert hints.title.text().startswith("1")
    window.grab()
    QTest.mouseClick(hints.next_button, Qt.MouseButton.LeftButton)
    assert hints.title.text().startswith("2")
    QTest.mouseClick(hints, Qt.MouseButton.LeftButton, pos=QPoint(5, 5))
    assert hints.title.text().startswith("3")
    assert hints.rect().contains(hints.card.geometry())
    assert not hints.skip_button.isVisible()
    hints.next_button.click()
    assert not hints.isVisible()
    assert not Preferences(settings).hints_wanted()


def test_esc_skips_and_the_menu_brings_them_back(bench: Bench) -> None:
    window = bench.editing()
    assert window.editor is not None
    hints = window.editor.hints
    assert not hints.isVisible()
    window.actions_["first_steps"].trigger()
    assert hints.isVisible()
    window.resize(1100, 700)
    window.actions_["deselect"].trigger()
    assert not hints.isVisible()
    assert hints.accessibleName()
    for button in (hints.next_button, hints.skip_button):
        assert button.text()


@pytest.mark.parametrize("size", [(960, 520), (1000, 600), (1280, 720), (1920, 1080)])
def test_the_card_leaves_what_it_explains_free(bench: Bench, size: tuple[int, int]) -> None:
    """Also where there is hardly room beside it: 1920 x 1080 at twice the size are 960 x 540."""
    window = bench.editing()
    window.resize(*size)
    run_events()
    trigger(window, "first_steps")
    hints = editor_of(window).hints
    while hints.isVisible():
        card, hole = hints.card.geometry(), hints._hole()
        both = card & hole
        assert hints.rect().contains(card)
        assert both.width() * both.height() <= 0.05 * hole.width() * hole.height(), hints.step
        hints.forward()
