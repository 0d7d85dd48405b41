"""Problems in the real window: proposals, the list, marks, and all at once."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import QEvent, QModelIndex, QObject, QPoint, QRect, Qt
from PySide6.QtGui import QPaintEvent, QRegion
from PySide6.QtTest import QTest
from PySide6.QtWidgets import (
    QLabel,
    QMenu,
    QStyle,
    QStyledItemDelegate,
    QStyleOptionViewItem,
    QToolButton,
    QWidget,
)
from support.waiting import run_events
from support.windows import (
    Bench,
    await_trial,
    editor_of,
    session_of,
    trigger_enabled,
    with_problems,
)

from faceedit_app.core.controls import CONTROL_INDEX
from faceedit_app.editing.help.problems import Kind, Problem
from faceedit_app.ui.page.problems_bar import ProblemsHead
from faceedit_app.ui.page.problems_model import KIND
from faceedit_app.ui.start.window import MainWindow

LEFT_EYE, OPENING = CONTROL_INDEX["left_eyelid"], CONTROL_INDEX["mouth_opening"]


@pytest.fixture
def window(bench: Bench, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> MainWindow:
    return with_problems(bench, monkeypatch, tmp_path)


def accept_tried(bench: Bench, window: MainWindow) -> None:
    """Accept the proposal for all, and wait until it is made."""
    trigger_enabled(window, "accept_fix")
    await_trial(bench, window)


# --- problems ----------------------------------------------------------------------------------


def test_down_goes_to_the_problem_and_the_fix_is_shown_before_it_is_made(
    window: MainWindow,
) -> None:
    editor, session = editor_of(window), session_of(window)
    count = len(editor.problems.problems)
    QTest.keyClick(window, Qt.Key.Key_Down)
    problem = editor.problems.problems[0]
    assert problem.start <= window.timeline.time <= problem.end
    assert editor.problems.current == 0
    QTest.keyClick(window, Qt.Key.Key_P)
    assert editor.proposal.isVisible()
    assert session.edits == ()
    assert not np.array_equal(session.asked, session.tracked)
    trigger_enabled(window, "deselect")  # Esc
    assert not editor.proposal.isVisible()
    np.testing.assert_array_equal(session.asked, session.tracked)
    trigger_enabled(window, "fix_problem", "accept_fix")
    assert not editor.proposal.isVisible()
    assert session.edits == problem.fix
    assert len(editor.problems.problems) == count - 1
    trigger_enabled(window, "undo")
    assert session.edits == ()


def test_accept_goes_on_to_the_next_problem(window: MainWindow) -> None:
    editor, session = editor_of(window), session_of(window)
    first, second = editor.problems.problems
    trigger_enabled(window, "next_problem", "fix_problem", "accept_fix")
    assert session.edits == first.fix
    assert editor.problems.current_problem == second
    assert editor.edits.current is None, "the handles of the first are out of sight"
    assert window.timeline.time == pytest.approx(second.time, abs=1e-3)
    assert window.status.currentMessage() == second.message
    window.timeline.visit(0.0)
    assert window.status.currentMessage() == "", "one is elsewhere"
    window.timeline.visit(second.time)
    trigger_enabled(window, "fix_problem", "accept_fix")
    assert session.edits == (*first.fix, *second.fix)
    assert "no more problems" in window.status.currentMessage()


def test_a_problem_of_any_kind_is_marked_and_listed(window: MainWindow) -> None:
    editor = editor_of(window)
    found = [Problem(kind, i, i + 0.5, i, (), "x", "1 mm", 0.5, ()) for i, kind in enumerate(Kind)]
    editor.problems.problems = tuple(found)
    editor.problems.found.emit()
    assert len(set(texts(window))) == len(Kind)
    assert editor.problem_list.kinds.count() == len(Kind) + 1
    assert not editor.problems.grab().isNull()


def test_a_search_that_finds_nothing_ends_in_the_list_too(window: MainWindow) -> None:
    editor = editor_of(window)
    for is_searched, text in ((False, "Looking for problems…"), (True, "No problems found")):
        editor.problems.problems, editor.problems.is_searched = (), is_searched
        editor.problems.found.emit()
        shown = [label.text() for label in editor.problem_list.findChildren(QLabel)]
        assert text in shown


def test_a_preset_pressed_beside_the_problems_shows_its_edit(window: MainWindow) -> None:
    editor = editor_of(window)
    editor.list_problems()
    trigger_enabled(window, "fix_smile")
    assert editor.lists.currentWidget() is editor.edits
    assert editor.edits.strength.isVisible()
    editor.lists.setCurrentWidget(editor.expressions)
    trigger_enabled(window, "fix_smile")
    assert editor.lists.currentWidget() is editor.expressions


def test_a_problem_that_edits_cannot_fix_says_so(window: MainWindow) -> None:
    editor = editor_of(window)
    lost = Problem(Kind.DROPPED, 1.0, 1.1, 1.0, (), "1 frame is missing", "1 frame", 0.1, ())
    editor.problems.problems = (lost, *editor.problems.problems)
    window.commands.fix.go_to(0)
    assert window.status.currentMessage() == "1 frame is missing; edits cannot help here"
    window.commands.fix.go_to(1)
    assert "cannot" not in window.status.currentMessage()
    editor.problem_list.sync()
    row = editor.problem_list.model.index(0, KIND)
    assert row.data() == "Lost frames (no fix)"
    rows, lefts = editor.problem_list.rows, []
    delegate = rows.itemDelegateForColumn(KIND)
    assert isinstance(delegate, QStyledItemDelegate)
    for number in range(2):
        option = QStyleOptionViewItem()
        option.initFrom(rows)
        option.widget, option.rect = rows, QRect(0, 0, 300, 24)
        index = editor.problem_list.model.index(number, KIND)
        delegate.initStyleOption(option, index)
        text = QStyle.SubElement.SE_ItemViewItemText
        lefts.append(rows.style().subElementRect(text, option, rows).left())
    assert lefts[0] == lefts[1] > 14, "names are in line, with a box or without"
    assert row.data(Qt.ItemDataRole.ToolTipRole).endswith("No fix: edits cannot help here")


def test_a_problem_is_shown_where_it_is_worst_and_large_enough_to_judge(
    window: MainWindow,
) -> None:
    editor, session, line = editor_of(window), session_of(window), window.timeline
    problem = editor.problems.problems[-1]
    assert line.view[1] - line.view[0] > 9
    window.commands.fix.go_to(len(editor.problems.problems) - 1)
    frame = session.take.clip.frame_at(problem.time)
    assert line.frame == frame
    first, last = line.view
    assert first < problem.start < problem.end < last
    assert (last - first) < 6 * (problem.end - problem.start) or last - first < 2.1
    assert editor.curves.headers[OPENING].value == problem.amount
    assert problem.message.endswith(problem.amount)
    view = line.view
    window.commands.fix.go_to(len(editor.problems.problems) - 1)
    assert line.view == view


# --- the list of problems ------------------------------------------------------------------------


def cells(window: MainWindow, column: int = 0) -> list[QModelIndex]:
    """The cells of the list in one column, from top to bottom."""
    model = editor_of(window).problem_list.model
    return [model.index(row, column) for row in range(model.rowCount())]


def texts(window: MainWindow, column: int = 0) -> list[str]:
    return [cell.data() for cell in cells(window, column)]


def test_the_list_says_what_when_and_how_bad(window: MainWindow) -> None:
    editor, session = editor_of(window), session_of(window)
    trigger_enabled(window, "list_problems")
    assert editor.problem_list.isVisible()
    assert editor.lists.tabText(1) == "Problems  2"
    assert texts(window) == ["Half blink", "Lips stay open"]
    problems = editor.problems.problems
    assert texts(window, 2) == [problem.amount for problem in problems]
    assert texts(window, 1)[0] == f"{problems[0].time:.3f} s"
    trigger_enabled(window, "unit_frames")
    assert texts(window, 1)[0] == str(session.take.clip.frame_at(problems[0].time) + 1)
    tree = editor.problem_list.rows
    place = tree.visualRect(cells(window)[1]).center()
    QTest.mouseClick(tree.viewport(), Qt.MouseButton.LeftButton, pos=place)
    assert window.timeline.time == pytest.approx(problems[1].time, abs=1e-3)
    assert tree.selectionModel().selectedRows() == [cells(window)[1]]


def test_the_list_is_sorted_and_filtered(bench: Bench, window: MainWindow) -> None:
    editor = editor_of(window)
    found, tree = editor.problem_list, editor.problem_list.rows
    lips = editor.problems.problems[1]
    trigger_enabled(window, "list_problems")
    head = tree.header()
    place = QPoint(head.sectionViewportPosition(2) + head.sectionSize(2) // 2, head.height() // 2)
    QTest.mouseClick(head.viewport(), Qt.MouseButton.LeftButton, pos=place)
    severities = [problem.severity for problem in editor.problems.problems]
    assert severities[1] > severities[0]
    assert texts(window)[0] == "Lips stay open"
    fix = found.findChildren(QToolButton)[0]
    trigger_enabled(window, "next_problem")
    assert editor.problems.current == 0
    for kind, is_shown in ((0, True), (1, False)):
        found.kinds.setCurrentIndex(kind)
        window.actions_.refresh()
        assert fix.isEnabled() == is_shown, "it fixes what the list highlights"
        assert ("of another kind" in fix.toolTip()) != is_shown
    assert texts(window) == ["Lips stay open"]
    trigger_enabled(window, "fix_all")
    accept_tried(bench, window)
    assert session_of(window).edits == lips.fix
    assert [problem.kind for problem in editor.problems.problems] == ["blink"]


def test_what_is_unticked_is_left_alone(bench: Bench, window: MainWindow) -> None:
    editor, session = editor_of(window), session_of(window)
    blink, lips = editor.problems.problems
    trigger_enabled(window, "fix_all")
    assert editor.problem_list.isVisible()
    assert "2 problems" in editor.proposal.text.text()
    tick = Qt.ItemDataRole.CheckStateRole
    editor.problem_list.model.setData(cells(window)[0], Qt.CheckState.Unchecked, tick)
    assert "1 problem " in editor.proposal.text.text()
    frame = session.take.clip.frame_at(blink.time)
    assert session.asked[frame, LEFT_EYE] == session.tracked[frame, LEFT_EYE]
    accept_tried(bench, window)
    assert session.edits == lips.fix
    assert cells(window)[0].data(tick) is Qt.CheckState.Unchecked, "it stays unticked"
    assert not window.actions_["fix_all"].isEnabled()


def test_the_playhead_moves_on_in_the_bar_of_problems(window: MainWindow, bench: Bench) -> None:
    bar, painted = editor_of(window).problems, QRegion()
    window.timeline.go_to_time(2.0)
    run_events()

    class Watch(QObject):
        def eventFilter(self, watched: QObject, event: QEvent) -> bool:
            nonlocal painted
            if isinstance(event, QPaintEvent):
                painted += event.region()
            return super().eventFilter(watched, event)

    watch = Watch()
    bar.installEventFilter(watch)
    window.timeline.go_to_time(3.0)
    run_events()
    width = bar.width() / window.timeline.duration
    for seconds in (2.0, 3.0):
        assert painted.contains(QPoint(round(seconds * width), 1)), seconds
    assert not painted.contains(QPoint(round(1.0 * width), 1))


def _left_of_text(button: QWidget) -> int:
    """Pixels left of what is written on a button."""
    picture = button.grab().toImage()
    columns, rows = range(picture.width()), range(picture.height())
    empty = picture.pixelColor(0, 0)
    return next(x for x in columns if any(picture.pixelColor(x, y) != empty for y in rows))


def test_the_number_of_problems_fits_its_place_from_its_left_edge(window: MainWindow) -> None:
    editor = editor_of(window)
    head = editor.findChild(ProblemsHead)
    assert head is not None
    left: set[int] = set()
    for count, shown in ((35, "35 problems"), (3, "3 problems"), (333_333, "333333")):
        editor.problems.problems = editor.problems.problems[:1] * count
        head.sync()
        assert head.count.text() == shown
        assert head.count.sizeHint().width() <= head.count.width()
        left.add(_left_of_text(head.count))
    assert max(left) - min(left) <= 1, "numbers and names begin at the same place"


def test_before_it_has_looked_it_does_not_say_that_all_is_well(bench: Bench) -> None:
    window = bench.editing()
    editor = editor_of(window)
    editor.problems.restart()
    head = editor.findChild(ProblemsHead)
    assert head is not None
    assert head.count.text() == "Looking…"
    bench.qtbot.waitUntil(lambda: head.count.text() != "Looking…")


def test_a_mark_is_clicked(window: MainWindow) -> None:
    bar = editor_of(window).problems
    last = len(bar.problems) - 1
    QTest.mouseClick(bar, Qt.MouseButton.LeftButton, pos=bar.place_of(last).toPoint())
    assert bar.current == last
    assert bar.problems[last].message in window.status.currentMessage()


def test_all_problems_at_once(bench: Bench, window: MainWindow) -> None:
    editor = editor_of(window)
    trigger_enabled(window, "fix_all")
    accept_tried(bench, window)
    assert len(session_of(window).edits) >= len(editor.problems.problems)
    trigger_enabled(window, "undo")
    assert session_of(window).edits == ()


def test_a_list_of_thousands_makes_the_texts_of_what_is_in_view(
    window: MainWindow, monkeypatch: pytest.MonkeyPatch
) -> None:
    editor = editor_of(window)
    trigger_enabled(window, "list_problems")
    asked: list[float] = []

    def shown_time(seconds: float) -> str:
        asked.append(seconds)
        return "1 s"

    monkeypatch.setattr(editor.problem_list.model, "_shown_time", shown_time)
    editor.problems.problems = tuple(
        Problem(Kind.JITTER, i, i / 60, i / 60, (), "x", "1 mm", 0.5, ()) for i in range(5000)
    )
    editor.problems.found.emit()
    editor.problem_list.grab()
    assert 0 < len(asked) < 500


def press_on_list(window: MainWindow, key: Qt.Key) -> None:
    QTest.keyClick(editor_of(window).problem_list.rows, key)


def test_the_arrows_go_through_the_list(window: MainWindow) -> None:
    """As they go from mark to mark elsewhere; the fix can be shown at once."""
    editor = editor_of(window)
    blink, lips = editor.problems.problems
    trigger_enabled(window, "list_problems")
    press_on_list(window, Qt.Key.Key_Down)
    assert window.timeline.time == pytest.approx(blink.time, abs=1e-3), "none is skipped"
    press_on_list(window, Qt.Key.Key_Down)
    assert window.timeline.time == pytest.approx(lips.time, abs=1e-3)
    trigger_enabled(window, "fix_problem")
    assert editor.proposal.problem == lips
    press_on_list(window, Qt.Key.Key_Up)
    assert window.timeline.time == pytest.approx(blink.time, abs=1e-3)
    assert not editor.proposal.is_open, "the fix of another problem"


def test_each_of_all_fixes_can_be_looked_at(bench: Bench, window: MainWindow) -> None:
    """Going to a problem leaves the proposal for all of them; keys untick and tick it."""
    editor, session = editor_of(window), session_of(window)
    blink, lips = editor.problems.problems
    trigger_enabled(window, "fix_all", "list_problems")
    tree = editor.problem_list.rows
    for problem, cell in zip((blink, lips), cells(window), strict=True):
        place = tree.visualRect(cell).center()
        QTest.mouseClick(tree.viewport(), Qt.MouseButton.LeftButton, pos=place)
        assert window.timeline.time == pytest.approx(problem.time, abs=1e-3)
        assert editor.proposal.is_open
    trigger_enabled(window, "tick_problem")
    assert not window.actions_["tick_problem"].isChecked()
    trigger_enabled(window, "previous_problem")
    assert window.actions_["tick_problem"].isChecked()
    accept_tried(bench, window)
    assert session.edits == blink.fix


def test_what_is_unticked_last_is_not_fixed_either(bench: Bench, window: MainWindow) -> None:
    editor, session = editor_of(window), session_of(window)
    blink, _lips = editor.problems.problems
    trigger_enabled(window, "fix_all", "untick_all")
    assert not editor.proposal.is_open
    np.testing.assert_array_equal(session.asked, session.tracked)
    assert not window.actions_["fix_all"].isEnabled()
    trigger_enabled(window, "next_problem", "tick_problem", "fix_all")
    accept_tried(bench, window)
    assert session.edits == blink.fix
    assert not window.actions_["fix_all"].isEnabled()
    trigger_enabled(window, "tick_all", "fix_all")


def test_a_right_click_on_a_row_goes_to_it_and_shows_its_menu(window: MainWindow) -> None:
    editor = editor_of(window)
    lips = editor.problems.problems[1]
    trigger_enabled(window, "list_problems")
    tree = editor.problem_list.rows
    tree.customContextMenuRequested.emit(tree.visualRect(cells(window)[1]).center())
    assert window.timeline.time == pytest.approx(lips.time, abs=1e-3)
    (menu,) = [menu for menu in editor.problem_list.findChildren(QMenu) if menu.isVisible()]
    (tick,) = [action for action in menu.actions() if action.text().startswith("&Tick this")]
    assert tick.isChecked()
    tick.trigger()
    menu.close()
    assert editor.problem_list.chosen == editor.problems.problems[:1]
