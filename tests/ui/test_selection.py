"""The time selection: its four edges by mouse, keyboard and numbers, and what it does to edits."""

from __future__ import annotations

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QWidget
from support.curves import (
    ALT,
    CTRL,
    LEFT,
    NONE,
    SHIFT,
    drag,
    let_go,
    move_with,
    place,
    session_of,
    surface,
    turn,
)

from faceedit_app.ui.curves import CurvesPanel
from faceedit_app.ui.curves.edges import Edge, edge_at, part_at, press_edge
from faceedit_app.ui.curves.gestures import Span
from faceedit_app.ui.curves.scale import Scale
from faceedit_app.ui.state.timeline import Timeline

SCALE = Scale(1000, 50, (0.0, 10.0), (0.0, 1.0))  # 100 pixels a second
SPAN = Span(2.0, 3.0, 0.5, 1.0)


@pytest.fixture
def panel(panel: CurvesPanel) -> CurvesPanel:
    panel.timeline.select((1.0, 2.0))
    panel.timeline.set_falloffs(0.3, 0.5)
    return panel


def at(panel: CurvesPanel, seconds: float) -> QPoint:
    return place(panel.range_bar, seconds, 8)


# --- the rules, without Qt ---------------------------------------------------------------------


@pytest.mark.parametrize(
    ("x", "edge"),
    [
        (200, Edge.START),
        (304, Edge.END),
        (150, Edge.FADE_IN),
        (398, Edge.FADE_OUT),
        (250, None),
        (10, None),
    ],
)
def test_the_edge_under_a_pixel(x: float, edge: Edge | None) -> None:
    assert edge_at(x, SCALE, SPAN) is edge


def test_without_falloff_the_outside_of_an_edge_is_the_falloff() -> None:
    span = Span(2.0, 3.0, 0.0)
    assert edge_at(198, SCALE, span) is Edge.FADE_IN
    assert edge_at(202, SCALE, span) is Edge.START
    assert edge_at(298, SCALE, span) is Edge.END
    assert edge_at(302, SCALE, span) is Edge.FADE_OUT


@pytest.mark.parametrize(
    ("x", "part"),
    [
        (200, Edge.BODY),
        (202, Edge.BODY),
        (196, Edge.START),
        (204, Edge.END),
        (150, Edge.FADE_IN),
        (298, Edge.FADE_OUT),
        (170, Edge.BODY),
        (250, Edge.BODY),
        (140, None),
        (310, None),
    ],
)
def test_an_edit_of_one_moment_is_moved_by_its_middle_and_its_slopes(
    x: float, part: Edge | None
) -> None:
    assert part_at(x, SCALE, Span(2.0, 2.0, 0.5, 1.0)) is part


@pytest.mark.parametrize(
    ("edge", "to", "expected"),
    [
        (Edge.START, 2.5, (2.5, 3.0, 0.5, 1.0)),
        (Edge.START, 9.0, (3.0, 3.0, 0.5, 1.0)),
        (Edge.END, 2.2, (2.0, 2.2, 0.5, 1.0)),
        (Edge.END, 99.0, (2.0, 10.0, 0.5, 1.0)),
        (Edge.FADE_IN, 1.0, (2.0, 3.0, 1.0, 1.0)),
        (Edge.FADE_IN, 2.8, (2.0, 3.0, 0.0, 1.0)),
        (Edge.FADE_OUT, 3.2, (2.0, 3.0, 0.5, 0.2)),
    ],
)
def test_dragging_an_edge(edge: Edge, to: float, expected: tuple[float, ...]) -> None:
    begin = {Edge.START: 2.0, Edge.END: 3.0, Edge.FADE_IN: 1.5, Edge.FADE_OUT: 4.0}
    drag = press_edge(edge, SPAN, begin[edge], (0.0, 10.0)).moved(to, fine=False)
    span = drag.span
    assert (span.start, span.end, span.falloff, span.fade_out) == pytest.approx(expected)


def test_the_whole_selection_stays_in_the_take() -> None:
    drag = press_edge(Edge.BODY, SPAN, 2.5, (0.0, 10.0))
    span = drag.moved(3.0, fine=False).span
    assert (span.start, span.end) == pytest.approx((2.5, 3.5))
    span = drag.moved(99.0, fine=False).span
    assert (span.start, span.end) == pytest.approx((9.0, 10.0))


def test_fine_moves_are_a_tenth_and_frames_attract() -> None:
    drag = press_edge(Edge.END, SPAN, 3.0, (0.0, 10.0))
    assert drag.moved(4.0, fine=True).span.end == pytest.approx(3.1)
    assert drag.moved(4.01, fine=False, frame=4.0).span.end == 4.0


# --- through the widgets -----------------------------------------------------------------------


def test_all_four_handles_of_the_bar(panel: CurvesPanel) -> None:
    bar, line = panel.range_bar, panel.timeline
    drag(bar, at(panel, 2.0), at(panel, 2.5))
    assert line.selection == pytest.approx((1.0, 2.5), abs=0.02)
    drag(bar, at(panel, 1.0), at(panel, 0.8))
    assert line.selection == pytest.approx((0.8, 2.5), abs=0.02)
    drag(bar, at(panel, 0.5), at(panel, 0.2))
    assert line.falloff == pytest.approx(0.6, abs=0.02)
    drag(bar, at(panel, 3.0), at(panel, 2.7))
    assert line.falloff_out == pytest.approx(0.2, abs=0.02)
    assert session_of(panel).edits == ()


def test_a_drag_in_the_empty_bar_selects_and_one_in_the_middle_moves(panel: CurvesPanel) -> None:
    bar, line = panel.range_bar, panel.timeline
    line.select(None)
    drag(bar, at(panel, 1.5), at(panel, 2.5))
    assert line.selection == pytest.approx((1.5, 2.5), abs=0.02)
    drag(bar, at(panel, 2.0), at(panel, 1.5))
    assert line.selection == pytest.approx((1.0, 2.0), abs=0.02)
    turn(bar, at(panel, 1.5), 2)
    assert line.falloff > 0.3
    QTest.mouseDClick(surface(bar), LEFT, NONE, at(panel, 1.5))
    assert line.selection is None


def test_edges_are_dragged_on_the_plots_too(panel: CurvesPanel) -> None:
    plot, line = panel.plots[3], panel.timeline
    drag(plot, place(plot, 2.0), place(plot, 2.4))
    assert line.selection == pytest.approx((1.0, 2.4), abs=0.02)
    for seconds, shape in (
        (1.0, Qt.CursorShape.SizeHorCursor),
        (1.5, Qt.CursorShape.SizeVerCursor),
    ):
        move_with(plot, place(plot, seconds), held=Qt.MouseButton.NoButton)
        assert plot.viewport().cursor().shape() is shape


def test_ctrl_snaps_an_edge_to_a_frame(panel: CurvesPanel) -> None:
    bar, line = panel.range_bar, panel.timeline
    drag(bar, at(panel, 2.0), at(panel, 2.41), CTRL)
    assert line.selection is not None
    assert line.selection[1] == line.snap(line.selection[1])
    drag(bar, at(panel, 1.0), at(panel, 1.5), SHIFT)
    assert line.selection[0] == pytest.approx(1.05, abs=0.02)


def test_esc_puts_an_edge_back(panel: CurvesPanel) -> None:
    plot, line = panel.plots[3], panel.timeline
    drag(plot, place(plot, 2.0), place(plot, 2.4), release=False)
    assert panel.is_dragging
    QTest.keyClick(plot, Qt.Key.Key_Escape)
    assert line.selection == pytest.approx((1.0, 2.0))
    assert not panel.is_dragging
    let_go(plot, place(plot, 2.4))
    assert session_of(panel).edits == ()


def test_numbers_are_typed(panel: CurvesPanel) -> None:
    fields, line = panel.fields, panel.timeline
    for box, text in (
        (fields.start, "0.50"),
        (fields.end, "2.25"),
        (fields.fade_in, "0.10"),
        (fields.fade_out, "0.75"),
    ):
        box.setFocus()
        box.selectAll()
        QTest.keyClicks(box, text)
        QTest.keyClick(box, Qt.Key.Key_Return)
    assert line.selection == pytest.approx((0.5, 2.25))
    assert (line.falloff, line.falloff_out) == pytest.approx((0.1, 0.75))
    line.select(None)
    assert fields.start.text() == "–"
    assert Timeline().falloff == Timeline().falloff_out


def type_in(box: QWidget, text: str) -> None:
    box.setFocus()
    QTest.keyClick(box, Qt.Key.Key_A, CTRL)
    QTest.keyClicks(box, text)
    QTest.keyClick(box, Qt.Key.Key_Return)


@pytest.mark.parametrize(
    ("before", "typed", "after"),
    [
        (None, ("start 3.00", "end 0.50"), (0.5, 3.0)),
        (None, ("end 0.50", "start 3.00"), (0.5, 3.0)),
        ((1.0, 2.0), ("start 3.00", "end 3.50"), (3.0, 3.5)),
        ((2.0, 3.0), ("end 1.00", "start 0.50"), (0.5, 1.0)),
        ((1.0, 2.0), ("end 0.50",), (0.5, 0.5)),
    ],
)
def test_two_typed_times_are_a_range_in_either_order(
    panel: CurvesPanel,
    before: tuple[float, float] | None,
    typed: tuple[str, ...],
    after: tuple[float, float],
) -> None:
    """An end that was not typed comes along with the other one."""
    panel.timeline.select(before)
    for text in typed:
        which, number = text.split()
        type_in(panel.fields.start if which == "start" else panel.fields.end, number)
    assert panel.timeline.selection == pytest.approx(after)
    assert float(panel.fields.start.text()) == pytest.approx(after[0])
    assert float(panel.fields.end.text()) == pytest.approx(after[1])


def test_a_typed_range_scrolls_into_view(panel: CurvesPanel) -> None:
    line = panel.timeline
    line.select(None)
    line.show_range(0.0, 1.0)
    type_in(panel.fields.start, "2.80")
    type_in(panel.fields.end, "3.20")
    assert line.view[0] <= 2.8 < 3.2 <= line.view[1]
    assert line.view[1] - line.view[0] == pytest.approx(1.0)


def test_an_edit_of_the_selection_has_both_falloffs(panel: CurvesPanel) -> None:
    plot, session = panel.plots[0], session_of(panel)
    start = place(plot, 1.5)
    drag(plot, start, start - QPoint(0, 15))
    (edit,) = session.edits
    assert (edit.start, edit.end, edit.falloff, edit.fade_out) == pytest.approx((1, 2, 0.3, 0.5))


def test_alt_and_wheel_change_the_falloff_of_one_side(panel: CurvesPanel) -> None:
    plot, line = panel.plots[0], panel.timeline
    start = place(plot, 1.7)
    drag(plot, start, start - QPoint(0, 15), release=False)
    turn(plot, start, 2, ALT)
    assert line.falloff == 0.3
    assert line.falloff_out > 0.5
    let_go(plot, start)


def test_esc_brings_back_what_was_selected(panel: CurvesPanel) -> None:
    bar, line = panel.range_bar, panel.timeline
    drag(bar, at(panel, 2.7), at(panel, 3.2), release=False)
    assert line.selection == pytest.approx((2.7, 3.2), abs=0.03)
    assert panel.is_dragging
    panel.cancel_drag()
    assert line.selection == pytest.approx((1.0, 2.0))
    let_go(bar, at(panel, 3.2))
    assert line.selection == pytest.approx((1.0, 2.0))


def test_the_wheel_passes_over_the_numbers_and_changes_none(panel: CurvesPanel) -> None:
    """A selection that nobody made would limit the next fix to it."""
    panel.plots[0].setFocus()
    line = panel.timeline
    before = line.selection, line.falloff, line.falloff_out
    for field in (panel.fields.start, panel.fields.end, panel.fields.fade_in):
        assert not field.hasFocus()
        turn(field, field.rect().center(), 1)
    assert (line.selection, line.falloff, line.falloff_out) == before
