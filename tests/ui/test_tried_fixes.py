"""A fix that would make another problem is shown with it in the list, and is not ticked."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from PySide6.QtCore import Qt
from support.windows import (
    Bench,
    await_trial,
    editor_of,
    session_of,
    trigger_enabled,
    with_problems,
)

from faceedit_app.core.controls import LIP_OPENING
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.help.problems import Kind, Problem
from faceedit_app.ui.page.problems_model import KIND
from faceedit_app.ui.start.window import MainWindow
from faceedit_app.ui.state.time_display import shown_time
from faceedit_app.ui.state.timed_rows import TimedRows

SHAKING = tuple((frame / 60, 2.5 * (-1) ** frame) for frame in range(312, 336))


@pytest.fixture
def window(bench: Bench, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> MainWindow:
    """Its first problem has a fix that makes the mouth shake at 5.4 s."""
    window = with_problems(bench, monkeypatch, tmp_path)
    bar = editor_of(window).problems
    blink, lips = bar.problems
    shaking = Edit((LIP_OPENING,), Op.ADD, 5.2, 5.6, 0.1, points=SHAKING)
    bar.problems = (replace(blink, fix=(*blink.fix, shaking)), lips)
    bar.found.emit()
    return window


def test_a_fix_that_would_make_another_problem_says_so_and_is_not_ticked(
    bench: Bench, window: MainWindow
) -> None:
    editor, session = editor_of(window), session_of(window)
    blink, lips = editor.problems.problems
    rows = editor.problem_list
    trigger_enabled(window, "list_problems")
    await_trial(bench, window)
    assert rows.chosen == (lips,)
    first = rows.model.index(0, KIND)
    made = rows.model._brought[blink]
    when = shown_time(TimedRows.of(session.take.clip), made.time, window.timeline.display.unit)
    for role in (Qt.ItemDataRole.DisplayRole, Qt.ItemDataRole.ToolTipRole):
        assert f"makes shaking {made.amount} at {when}" in first.data(role)
    trigger_enabled(window, "next_problem", "fix_problem")
    assert "The fix makes shaking" in editor.proposal.text.toolTip()
    trigger_enabled(window, "fix_all")
    assert "1 problem " in editor.proposal.text.text()
    assert (
        "1 more is not ticked, as the fix would make another problem"
        in editor.proposal.text.toolTip()
    )
    trigger_enabled(window, "accept_fix")
    assert session.edits == lips.fix


def test_what_the_user_ticks_is_fixed_all_the_same(bench: Bench, window: MainWindow) -> None:
    editor = editor_of(window)
    blink, lips = editor.problems.problems
    trigger_enabled(window, "list_problems")
    await_trial(bench, window)
    trigger_enabled(window, "next_problem", "tick_problem", "fix_all")
    assert editor.problem_list.chosen == (blink, lips)
    trigger_enabled(window, "accept_fix")
    assert session_of(window).edits == (*blink.fix, *lips.fix)


def test_what_is_accepted_while_the_fixes_are_tried_is_made_after_that(
    bench: Bench, window: MainWindow
) -> None:
    """A fix that would make another problem is unticked by then."""
    editor, session = editor_of(window), session_of(window)
    blink, lips = editor.problems.problems
    trigger_enabled(window, "fix_all")
    assert "trying" in editor.proposal.text.toolTip()
    assert editor.problem_list.chosen == (blink, lips)
    trigger_enabled(window, "accept_fix", "accept_fix")
    assert editor.proposal.text.text().startswith("Trying the fixes…")
    assert session.edits == ()
    await_trial(bench, window)
    assert session.edits == lips.fix
    assert not editor.proposal.is_open
    assert session.undo_name == "Fix 1 problem"


def test_esc_takes_back_what_was_accepted_while_the_fixes_are_tried(
    bench: Bench, window: MainWindow
) -> None:
    editor, session = editor_of(window), session_of(window)
    trigger_enabled(window, "fix_all", "accept_fix", "discard_fix", "fix_all")
    await_trial(bench, window)
    assert session.edits == ()
    assert editor.proposal.is_open
    assert editor.proposal.text.text().startswith("Fixes for 1 problem")


def test_nothing_is_made_of_fixes_that_all_make_another_problem(
    bench: Bench, window: MainWindow
) -> None:
    editor = editor_of(window)
    editor.problems.problems = editor.problems.problems[:1]
    editor.problems.found.emit()
    trigger_enabled(window, "fix_all", "accept_fix")
    await_trial(bench, window)
    assert session_of(window).edits == ()
    assert not editor.proposal.is_open
    assert "each fix would make another problem" in window.status.currentMessage()


def test_a_gesture_ends_the_trial_and_its_end_begins_another(
    bench: Bench, window: MainWindow
) -> None:
    editor, session = editor_of(window), session_of(window)
    trigger_enabled(window, "list_problems")
    await_trial(bench, window)
    edit = Edit((LIP_OPENING,), Op.OFFSET, 1.0, 1.4, 0.2, 1.0)
    session.preview(edit)
    assert not editor.trials._tried
    session.commit()
    with bench.qtbot.waitSignal(editor.trials.tried):
        editor.problems.search()
    assert editor.problem_list.chosen == editor.problems.problems


def test_the_proposal_counts_what_is_not_ticked_and_why(
    window: MainWindow, monkeypatch: pytest.MonkeyPatch
) -> None:
    editor, kinds = editor_of(window), (Kind.BLINK, Kind.LIPS, Kind.JITTER, Kind.DROPPED)
    fix = editor.problems.problems[0].fix
    found = [
        Problem(kind, i, i + 0.5, i, (), "x", "1 mm", 0.5, fix) for i, kind in enumerate(kinds)
    ]
    editor.problems.problems = tuple(found)
    editor.problems.found.emit()
    monkeypatch.setattr(editor.trials, "begin", editor.trials.stop)
    trigger_enabled(window, "fix_all")
    model, rows = editor.problem_list.model, editor.problem_list
    model.show_brought({found[0]: found[3]})
    why = "as the fix would make another problem"
    for unticked, advice in (
        ((), f"1 more is not ticked, {why}"),
        (found[1:2], f"2 more are not ticked, 1 of them {why}"),
        (found[2:3], f"3 more are not ticked, 1 of them {why}"),
    ):
        model.tick(unticked, False)
        count = len(rows.chosen)
        assert editor.proposal.text.text().startswith(f"Fixes for {count} problem")
        assert editor.proposal.text.text().endswith(f"; {advice}.")
        assert editor.proposal.text.short == f"Fixes shown; {4 - count} not ticked: see the list"
    model.tick(found, True)
    assert "untick those" in editor.proposal.text.text()
    model.tick(found[:2], False)
    model.show_brought({})
    assert editor.proposal.text.text().endswith("; 2 more are not ticked.")


def test_a_problem_of_an_edit_is_still_unticked_when_the_edit_comes_back(
    window: MainWindow,
) -> None:
    editor, session = editor_of(window), session_of(window)
    known = editor.problems.problems
    session.add(Edit((LIP_OPENING,), Op.ADD, 5.2, 5.6, 0.1, points=SHAKING))
    editor.problems.search()
    made = next(p for p in editor.problems.problems if p.fix and not any(map(p.is_as, known)))
    model = editor.problem_list.model
    model.tick((made, known[1]), False)
    for step in ("undo", "redo"):
        trigger_enabled(window, step)
        editor.problems.search()
        assert not model.is_ticked(known[1])
    assert made in editor.problems.problems
    assert not model.is_ticked(made)
    editor.problems.restart()
    editor.problems.search()
    assert model.is_ticked(made), "another take begins with its own"
