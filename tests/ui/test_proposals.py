"""The bar that proposes fixes: it keeps its place, and every other gesture drops what it shows."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from PySide6.QtCore import QRect, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QToolButton
from support.waiting import run_events
from support.windows import (
    Bench,
    await_trial,
    editor_of,
    session_of,
    trigger_enabled,
    with_problems,
)

from faceedit_app.ui.page import problems_bar
from faceedit_app.ui.start.window import MainWindow


@pytest.fixture
def window(bench: Bench, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> MainWindow:
    return with_problems(bench, monkeypatch, tmp_path)


def test_a_proposal_pushes_nothing_about(window: MainWindow, bench: Bench) -> None:
    """One goes from mark to mark and looks: curves and face stay where they are."""
    editor = editor_of(window)

    def places() -> list[QRect]:
        run_events()  # layouts come to rest
        return [part.geometry() for part in (editor.panes, editor.tool_bar, editor.transport)]

    trigger_enabled(window, "next_problem")
    before = places()
    trigger_enabled(window, "fix_problem")
    assert places() == before
    bar = editor.proposal
    assert bar.geometry() == editor.curves.legend.geometry()
    trigger_enabled(window, "discard_fix")
    assert not bar.isVisible()


@pytest.mark.parametrize("button", ["Accept", "Discard"])
def test_a_double_click_on_a_proposal_is_one_click(
    bench: Bench, window: MainWindow, button: str
) -> None:
    """Nothing else lies where the second click falls, whether the bar is gone by then or not."""
    editor, session = editor_of(window), session_of(window)
    trigger_enabled(window, "next_problem", "fix_all")
    await_trial(bench, window)
    run_events()
    (on,) = [b for b in editor.proposal.findChildren(QToolButton) if b.text().strip() == button]
    place = on.mapTo(window, on.rect().center())
    wanted = (
        session.edits
        if button == "Discard"
        else tuple(edit for problem in editor.problem_list.chosen for edit in problem.fix)
    )
    for click in (QTest.mouseClick, QTest.mouseDClick):
        run_events()
        under = window.childAt(place)
        assert under is not None
        click(under, Qt.MouseButton.LeftButton, pos=under.mapFrom(window, place))
    assert session.edits == wanted
    assert window.childAt(place) is editor.curves.legend


def test_another_gesture_drops_a_proposal(window: MainWindow) -> None:
    editor, session = editor_of(window), session_of(window)
    trigger_enabled(window, "next_problem", "fix_problem", "fix_calm_down")
    assert not editor.proposal.isVisible()
    assert all(edit.name.startswith("Calm down") for edit in session.edits)


def test_a_fix_that_makes_another_problem_says_so(
    bench: Bench, window: MainWindow, monkeypatch: pytest.MonkeyPatch
) -> None:
    blink, lips = editor_of(window).problems.problems
    trigger_enabled(window, "fix_all")
    await_trial(bench, window)
    made = replace(blink, start=1.0, end=1.2, time=1.1)
    monkeypatch.setattr(problems_bar, "find_problems", lambda _session: [made, lips])
    trigger_enabled(window, "accept_fix")
    assert "A new problem at 1.1 s: the blink stops" in window.status.currentMessage()
