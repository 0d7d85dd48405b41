"""The first steps: shown once, three of them, by mouse and by keyboard."""

from __future__ import annotations

from PySide6.QtCore import QPoint, QRect, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QAbstractButton, QWidget
from support.waiting import run_events
from support.windows import Bench, drag_curve, editor_of, session_of, trigger

from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.ui.page.first_steps import CLICKED
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


SIZES = (960, 520), (1000, 600), (1280, 720), (1440, 900), (1920, 1080)


def test_the_card_covers_neither_what_it_explains_nor_what_can_be_clicked(bench: Bench) -> None:
    """Also where there is hardly room beside it: 1920 x 1080 at twice the size are 960 x 540."""
    window = bench.editing()
    page = editor_of(window)
    hints = page.hints
    for size in SIZES:
        window.resize(*size)
        run_events()
        trigger(window, "first_steps")
        while hints.isVisible():
            card = hints.card.geometry()
            assert hints.rect().contains(card)
            for part in (hints._hole(), hints._shown()):
                both = card & part
                least = 0.05 * part.width() * part.height()
                assert both.width() * both.height() <= least, (size, hints.step)
            for widget in page.findChildren(QWidget):
                if isinstance(widget, CLICKED) and widget.isVisible() and widget.isEnabled():
                    place = QRect(widget.mapTo(page, QPoint()), widget.size())
                    is_own = hints.isAncestorOf(widget)
                    assert is_own or not place.intersects(card), (size, hints.step, widget)
            assert "Esc: end the tour" in hints._count.text()
            hints.forward()


def under(window: QWidget, target: QWidget) -> QWidget | None:
    """What a press in the middle of a widget reaches."""
    return window.childAt(target.mapTo(window, target.rect().center()))


def button_of(bar: QWidget, text: str) -> QAbstractButton:
    """The button with a text."""
    return next(b for b in bar.findChildren(QAbstractButton) if b.text().strip() == text)


def test_what_a_card_explains_can_be_used_and_brings_the_next(bench: Bench) -> None:
    window = bench.editing()
    trigger(window, "first_steps")
    page = editor_of(window)
    hints, plot, blink = page.hints, page.curves.plots[0], button_of(page.tool_bar, "Blink")
    window.grab()
    assert under(window, plot) is plot.viewport()
    assert under(window, page.face.viewport) is page.face.viewport, "the face that follows is lit"
    assert under(window, blink) is hints
    trigger(window, "deselect")
    assert not hints.isVisible()
    trigger(window, "first_steps")
    drag_curve(window, 0, 1.5, 12)
    assert len(session_of(window).edits) == 1
    assert hints.title.text().startswith("2")
    trigger(window, "undo")  # as the first card says
    assert session_of(window).edits == ()
    assert hints.title.text().startswith("2")
    assert under(window, page.curves.plots[7]) is hints
    assert under(window, blink) is blink
    blink.click()
    assert session_of(window).edits
    assert hints.title.text().startswith("3")
    drag_curve(window, 0, 1.5, 12)
    assert hints.isVisible(), "the last card is to be read"


def test_a_proposal_under_the_second_card_can_be_answered(bench: Bench) -> None:
    window = bench.editing()
    page, session = editor_of(window), session_of(window)
    trigger(window, "first_steps")
    page.hints.forward()
    page.proposal.offer(
        "A proposal", [Edit(("mouth_opening",), Op.OFFSET, 1.0, 1.4, 0.2, 3.0)], "Fix"
    )
    run_events()
    accept = button_of(page.proposal, "Accept")
    assert under(window, accept) is accept
    accept.click()
    assert len(session.edits) == 1
    assert page.hints.title.text().startswith("3")
