"""Fill in the real window: a proposal with variations."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from support.takes import make_livelink_csv
from support.windows import Bench, editor_of, session_of, trigger

from faceedit_app.core.resources import shipped
from faceedit_app.editing.edits.edit import Op
from faceedit_app.editing.help.problems import Kind
from faceedit_app.ui.start.window import MainWindow


@pytest.fixture
def window(bench: Bench) -> MainWindow:
    return bench.editing(shipped("assets/demo_take.csv"))


def test_fill_proposes_a_variation_and_accept_keeps_the_one_on_screen(window: MainWindow) -> None:
    session, bar = session_of(window), editor_of(window).proposal
    window.timeline.select((4.0, 5.0))
    QTest.keyClick(window, Qt.Key.Key_I, Qt.KeyboardModifier.ControlModifier)
    assert bar.is_open
    assert bar.count.text() == "1 of 4"
    first = session.weights.copy()
    trigger(window, "next_variation")
    assert bar.count.text() == "2 of 4"
    assert not np.array_equal(session.weights, first)
    second = session.weights.copy()
    trigger(window, "accept_fix")
    assert not bar.is_open
    assert [(edit.op, edit.seed) for edit in session.edits] == [(Op.FILL, 1)]
    assert np.array_equal(session.weights, second)
    assert session.undo_name == "Fill"
    trigger(window, "undo")
    assert session.edits == ()


def test_variations_go_round_in_both_directions(window: MainWindow) -> None:
    session, bar = session_of(window), editor_of(window).proposal
    window.timeline.select((4.0, 5.0))
    trigger(window, "fill")
    first = session.weights.copy()
    trigger(window, "previous_variation")
    assert bar.count.text() == "4 of 4"
    trigger(window, "next_variation")
    assert np.array_equal(session.weights, first)
    window.workspace.cancel_gesture()
    assert not bar.is_open
    assert session.changed_frames() == 0


def test_other_proposals_have_no_variations(window: MainWindow) -> None:
    editor_of(window).problems.search()
    trigger(window, "next_problem")
    trigger(window, "fix_problem")
    assert editor_of(window).proposal.is_open
    assert not window.actions_["next_variation"].isEnabled()
    assert not editor_of(window).proposal.count.isVisibleTo(editor_of(window))


def test_rows_without_a_face_are_filled_in_variations(bench: Bench, tmp_path: Path) -> None:
    take = make_livelink_csv(tmp_path / "take.csv", 8.0, untracked=range(200, 216))
    window = bench.window(take)
    bar, session = editor_of(window).proposal, session_of(window)
    editor_of(window).problems.search()
    gap = next(p for p in editor_of(window).problems.problems if p.kind is Kind.DROPPED)
    window.timeline.go_to_time(gap.time)
    trigger(window, "fix_problem")
    said = bar.text.toolTip()
    assert said.startswith("16 rows without a face get one, as shown in the gap.")
    assert bar.count.text() == "1 of 4"
    trigger(window, "next_variation")
    trigger(window, "accept_fix")
    assert session.changed_frames() == 16
    assert [(edit.op, edit.seed) for edit in session.edits] == [(Op.FILL, 1)]
