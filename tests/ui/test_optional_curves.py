"""The curves of brows and jaw: folded away until the user wants them."""

from __future__ import annotations

import pytest
from PySide6.QtCore import QPoint, QRect, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication
from support.curves import LEFT, drag, let_go, place
from support.windows import Bench, bench, drag_curve

from faceedit_app.core.controls import CONTROL_INDEX, MAIN_CONTROLS, OPTIONAL_CONTROLS
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.session import EditSession
from faceedit_app.ui.curves import CurvesPanel
from faceedit_app.ui.start.window import MainWindow

__all__ = ["bench"]

BROW, _, JAW = OPTIONAL_CONTROLS


@pytest.fixture
def window(bench: Bench) -> MainWindow:
    return bench.editing()


@pytest.fixture
def panel(window: MainWindow) -> CurvesPanel:
    assert window.editor is not None
    return window.editor.curves


@pytest.fixture
def session(window: MainWindow) -> EditSession:
    assert window.document.session is not None
    return window.document.session


def visible(panel: CurvesPanel) -> list[str]:
    return [plot.control.id for plot in panel.plots if plot.isVisible()]


def test_a_click_on_the_head_shows_them_and_another_folds_them_away(panel: CurvesPanel) -> None:
    assert visible(panel) == list(MAIN_CONTROLS)
    QTest.mouseClick(panel.group_head, LEFT)
    assert visible(panel) == [*MAIN_CONTROLS, *OPTIONAL_CONTROLS]
    QTest.mouseClick(panel.group_head, LEFT)
    assert visible(panel) == list(MAIN_CONTROLS)


def test_keys_show_them(window: MainWindow, panel: CurvesPanel) -> None:
    panel.group_head.setFocus()
    QTest.keyClick(panel.group_head, Qt.Key.Key_Return)
    assert panel.plots[CONTROL_INDEX[BROW]].isVisible()
    command = window.actions_["unfold_curves"]
    assert command.isChecked()
    command.trigger()
    assert visible(panel) == list(MAIN_CONTROLS)
    assert not command.isChecked()


def test_the_choice_is_remembered(bench: Bench, panel: CurvesPanel) -> None:
    QTest.mouseClick(panel.group_head, LEFT)
    editor = bench.editing().editor
    assert editor is not None
    assert editor.curves.shown.is_unfolded
    assert visible(editor.curves) == [*MAIN_CONTROLS, *OPTIONAL_CONTROLS]


def test_dragging_one_edits_it(
    window: MainWindow, panel: CurvesPanel, session: EditSession
) -> None:
    QTest.mouseClick(panel.group_head, LEFT)
    QApplication.processEvents()
    drag_curve(window, CONTROL_INDEX[JAW], 1.0, 20)
    assert session.edits[0].controls == (JAW,)
    assert session.changed_frames() > 0
    assert panel.group_head.note == "edited"
    window.actions_["undo"].trigger()
    assert session.changed_frames() == 0
    assert panel.group_head.note == ""


def test_focusing_one_unfolds_them(window: MainWindow, panel: CurvesPanel) -> None:
    window.actions_[f"curve_{CONTROL_INDEX[BROW] + 1}"].trigger()
    assert panel.plots[CONTROL_INDEX[BROW]].isVisible()
    assert window.focusWidget() is panel.plots[CONTROL_INDEX[BROW]]


def is_in_view(panel: CurvesPanel, control: str) -> bool:
    """Whether all of a row is inside the scrolled area."""
    plot, area = panel.plots[CONTROL_INDEX[control]], panel._rows.viewport()
    place = QRect(plot.mapTo(area, QPoint(0, 0)), plot.size())
    return bool(area.rect().contains(place))


@pytest.mark.parametrize("way", ["unfold_curves", f"curve_{CONTROL_INDEX[BROW] + 1}"])
def test_in_a_low_window_the_rows_that_appear_are_scrolled_into_view(
    window: MainWindow, panel: CurvesPanel, way: str
) -> None:
    window.resize(960, 510)
    QApplication.processEvents()
    window.actions_[way].trigger()
    assert panel._rows.verticalScrollBar().maximum() > 0, "the window is not low enough to tell"
    for control in OPTIONAL_CONTROLS if way == "unfold_curves" else (BROW,):
        assert is_in_view(panel, control)


def test_in_a_low_window_the_numbers_beside_the_handle_are_not_cut(
    window: MainWindow, panel: CurvesPanel
) -> None:
    window.resize(960, 510)
    QApplication.processEvents()
    window.actions_["unfold_curves"].trigger()
    QApplication.processEvents()
    plot = panel.plots[0]
    for seconds in (0.05, 1.5, 2.95):
        start = place(plot, seconds, 5.0)
        drag(plot, start, start - QPoint(0, 15), release=False, previews=True)
        numbers, handle, scale = plot._numbers, plot.handle, plot.current_scale
        assert handle is not None
        assert "asked" in numbers._lines[-1]
        box = numbers._box.translated(scale.x_of(handle.time), scale.y_of(handle.value))
        assert plot.view.rect().contains(box), seconds
        panel.cancel_drag()
        let_go(plot, start)


def test_folded_curves_are_not_read_and_catch_up(
    panel: CurvesPanel, session: EditSession, window: MainWindow
) -> None:
    plot = panel.plots[CONTROL_INDEX[BROW]]
    window.timeline.show_range(0.5, 1.5)
    window.timeline.go_to_time(1.0)
    QTest.mouseClick(panel.group_head, LEFT)
    QApplication.processEvents()
    assert plot.current_scale.view == (0.5, 1.5)
    frame = session.take.clip.frame_at(1.0)
    shown = panel.headers[CONTROL_INDEX[BROW]].value
    assert shown == f"{session.achieved[frame, CONTROL_INDEX[BROW]]:.1f} mm"
    low, high = plot.values
    assert low < session.achieved[frame, CONTROL_INDEX[BROW]] < high


def test_folding_after_only_a_brow_was_shown_shows_the_others(
    window: MainWindow, panel: CurvesPanel
) -> None:
    QTest.mouseClick(panel.group_head, LEFT)
    QTest.mouseClick(panel.headers[CONTROL_INDEX[JAW]], LEFT)
    window.actions_["show_only_curve"].trigger()
    assert visible(panel) == [JAW]
    assert window.actions_["show_all_curves"].isEnabled()
    QTest.mouseClick(panel.group_head, LEFT)
    assert visible(panel) == list(MAIN_CONTROLS)


def test_mirroring_leaves_folded_curves_alone(
    window: MainWindow, panel: CurvesPanel, session: EditSession
) -> None:
    window.timeline.select((0.5, 1.0))
    window.actions_["mirror"].trigger()
    assert not {c for edit in session.edits for c in edit.controls} & {*OPTIONAL_CONTROLS}
    window.actions_["undo"].trigger()
    QTest.mouseClick(panel.group_head, LEFT)
    window.actions_["mirror"].trigger()
    assert {c for edit in session.edits for c in edit.controls} >= {*OPTIONAL_CONTROLS}


def test_a_drag_of_a_brow_with_left_and_right_moves_both(
    window: MainWindow, panel: CurvesPanel, session: EditSession
) -> None:
    QTest.mouseClick(panel.group_head, LEFT)
    QApplication.processEvents()
    drag_curve(window, CONTROL_INDEX[BROW], 1.0, 10)
    assert session.edits[0].controls == OPTIONAL_CONTROLS[:2]


def test_the_head_is_no_window_of_its_own(window: MainWindow) -> None:
    """One would take the keyboard from the window."""
    assert window.isVisible()
    visible = [widget for widget in QApplication.topLevelWidgets() if widget.isVisible()]
    # The window of a test before this one may still be there.
    assert all(isinstance(widget, MainWindow) for widget in visible)


def test_a_value_below_zero_has_a_minus_sign_and_zero_has_none(
    window: MainWindow, panel: CurvesPanel, session: EditSession
) -> None:
    QTest.mouseClick(panel.group_head, LEFT)
    header = panel.headers[CONTROL_INDEX[JAW]]
    for asked, shown in ((-2.0, "−2.0 mm"), (-0.01, "0.0 mm"), (2.0, "2.0 mm")):
        session.put((Edit((JAW,), Op.SET, 0.0, 3.0, 0.0, asked),))
        assert header.value == shown
