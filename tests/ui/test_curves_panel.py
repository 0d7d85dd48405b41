"""The curves panel as a user meets it: a real mouse on real plots."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise, product

import pytest
from PySide6.QtCore import QPoint, QRect, Qt
from PySide6.QtGui import QFontMetricsF, QImage
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QLabel
from pytestqt.qtbot import QtBot
from support.curves import (
    CTRL,
    LEFT,
    MIDDLE,
    NONE,
    RIGHT,
    SHIFT,
    Strip,
    drag,
    open_panel,
    place,
    session_of,
    surface,
    turn,
)
from support.rigs import tiny_rig, tiny_session, tiny_take
from support.waiting import run_events

from faceedit_app.core.clip import Gap
from faceedit_app.core.controls import CONTROL_INDEX, CONTROLS, MOUTH_WIDTH
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.opening import open_session
from faceedit_app.ui.curves import CurvesPanel, style
from faceedit_app.ui.curves.header import UNIT, WIDEST, Layout
from faceedit_app.ui.curves.legend import Legend
from faceedit_app.ui.curves.words import CHOSEN_HINT, note_on
from faceedit_app.ui.state.timeline import Timeline

# --- the time axis -------------------------------------------------------------------------


def test_the_ruler_scrubs_selects_and_clears(panel: CurvesPanel) -> None:
    ruler, timeline = panel.ruler, panel.timeline
    drag(ruler, QPoint(20, 10), place(ruler, 3.0, 10))
    assert timeline.time == pytest.approx(3.0, abs=0.02)
    drag(ruler, place(ruler, 2.0, 10), place(ruler, 1.0, 10), SHIFT)
    assert timeline.selection == pytest.approx((1.0, 2.0), abs=0.02)
    assert timeline.time == pytest.approx(3.0, abs=0.02)
    QTest.mouseDClick(surface(ruler), LEFT, NONE, QPoint(30, 10))
    assert timeline.selection is None


def test_wheel_and_middle_button_move_about(panel: CurvesPanel) -> None:
    plot, timeline = panel.plots[1], panel.timeline
    at = place(plot, 1.0)
    turn(plot, at, 4)
    first, last = timeline.view
    assert last - first < 0.6 * timeline.duration
    assert place(plot, 1.0).x() == pytest.approx(at.x(), abs=1)
    turn(plot, at, -1, SHIFT)
    assert timeline.view[0] > first
    first, values = timeline.view[0], plot.values
    drag(plot, at, at + QPoint(50, 20), button=MIDDLE, previews=True)
    assert timeline.view[0] < first
    assert plot.values == values
    assert session_of(panel).edits == ()
    for other in panel.plots:
        assert other.current_scale.view == pytest.approx(timeline.view)


def test_the_view_never_leaves_the_take(panel: CurvesPanel) -> None:
    plot, timeline = panel.plots[1], panel.timeline
    turn(plot, place(plot, 1.0), 3)
    for _ in range(4):
        drag(plot, QPoint(100, 40), QPoint(400, 40), button=MIDDLE, previews=True)
    assert timeline.view[0] == pytest.approx(0.0, abs=1e-9)
    turn(plot, place(plot, timeline.view[0] + 0.1), -40)
    assert timeline.view == pytest.approx((0.0, timeline.duration))
    others: tuple[Strip, ...] = (*panel.plots, panel.ruler, panel.range_bar)
    for other in others:
        assert other.current_scale.view == pytest.approx(timeline.view)


@pytest.mark.parametrize("sideways", [True, False])
def test_a_right_drag_scales_the_way_it_goes_first(panel: CurvesPanel, sideways: bool) -> None:
    plot, timeline = panel.plots[1], panel.timeline
    values, view = plot.values, timeline.view
    start = place(plot, 2.0)
    way = QPoint(60, 8) if sideways else QPoint(8, -60)
    drag(plot, start, start + way, button=RIGHT, previews=True)
    scaled = plot.values[1] - plot.values[0] < 0.8 * (values[1] - values[0])
    zoomed = timeline.view[1] - timeline.view[0] < 0.8 * (view[1] - view[0])
    assert (zoomed, scaled) == (sideways, not sideways)
    assert session_of(panel).edits == ()
    panel.fit_values()
    timeline.show_range(*view)
    assert plot.values == pytest.approx(values)


def test_wheel_and_drag_on_the_numbers_are_for_the_values(panel: CurvesPanel) -> None:
    plot, view = panel.plots[1], panel.timeline.view
    numbers = QPoint(style.AXIS_WIDTH // 2, plot.height() // 2)
    values, other = plot.values, panel.plots[2].values
    turn(plot, numbers, 3)
    zoomed = plot.values
    assert zoomed[1] - zoomed[0] < 0.7 * (values[1] - values[0])
    drag(plot, numbers, numbers + QPoint(0, 20), button=MIDDLE, previews=True)
    assert plot.values[0] > zoomed[0]
    assert plot.values[1] - plot.values[0] == pytest.approx(zoomed[1] - zoomed[0])
    assert panel.plots[2].values == other
    assert panel.timeline.view == view
    panel.refresh()
    assert plot.values[1] - plot.values[0] == pytest.approx(zoomed[1] - zoomed[0])


def test_ctrl_wheel_zooms_one_value_axis(panel: CurvesPanel) -> None:
    plot, other = panel.plots[1], panel.plots[2].values
    view, span = panel.timeline.view, plot.values
    turn(plot, place(plot, 1.0), 3, CTRL)
    assert plot.values[1] - plot.values[0] < 0.7 * (span[1] - span[0])
    assert panel.plots[2].values == other
    assert panel.timeline.view == view
    panel.refresh()
    assert plot.values[1] - plot.values[0] < 0.7 * (span[1] - span[0])  # the user's choice stays
    QTest.mouseDClick(panel.headers[1], LEFT)
    assert plot.values == span


def test_a_double_click_on_the_header_shows_small_movements_large(panel: CurvesPanel) -> None:
    plot = panel.plots[0]
    panel.timeline.show_range(0.9, 1.1)  # the mouth hardly moves here
    span = plot.values
    QTest.mouseDClick(panel.headers[0], LEFT)
    assert plot.values[1] - plot.values[0] < 0.8 * (span[1] - span[0])
    QTest.mouseDClick(panel.headers[0], LEFT)
    assert plot.values == span


def test_plots_and_ruler_stand_over_each_other(panel: CurvesPanel) -> None:
    panel.resize(1003, 600)
    QApplication.processEvents()
    panel.shown.unfold(True)
    QApplication.processEvents()
    strips: tuple[Strip, ...] = (panel.ruler, panel.range_bar, *panel.plots)
    lefts = {surface(strip).mapTo(panel, place(strip, 0.0, 5)).x() for strip in strips}
    rights = {surface(strip).mapTo(panel, place(strip, 4.0, 5)).x() for strip in strips}
    assert (len(lefts), len(rights)) == (1, 1)


# --- what it says and shows ----------------------------------------------------------------


def test_values_at_the_playhead(panel: CurvesPanel) -> None:
    session = session_of(panel)
    panel.timeline.go_to_frame(25)
    assert panel.headers[0].value == f"{session.achieved[25, 0]:.1f} mm"
    assert panel.headers[0].note == ""
    session.preview(Edit(("mouth_opening",), Op.OFFSET, 0.5, 0.5, 0.1, 500.0))
    panel.refresh()
    # No mouth opens half a metre: what is asked for stops where faces stop.
    assert panel.headers[0].note == f"asked {session.limits[0][1]:.1f}"


def test_names_do_not_hop_when_there_is_more_to_say(panel: CurvesPanel) -> None:
    """In playback through edits they would hop again and again."""
    header = panel.headers[1]
    header.resize(header.width(), 60)

    def name() -> QImage:
        return header.grab(QRect(0, 0, 120, 22)).toImage()

    header.show_value("44.2 mm")
    bare = name()
    header.show_value("44.2 mm", "tracked 45.6")
    assert name() == bare


@pytest.mark.parametrize(
    ("tracked", "asked", "face", "note"),
    [
        (27.3, 27.3, 27.3, ""),
        (27.3, 30.3, 29.6, "asked 30.3"),
        (27.3, 30.3, 30.3, "tracked 27.3"),
        (27.3, 27.3, 27.6, "tracked 27.3"),
        (27.3, 30.3, 27.3, "asked 30.3"),
    ],
)
def test_a_row_says_what_the_face_misses_or_else_where_it_came_from(
    tracked: float, asked: float, face: float, note: str
) -> None:
    assert note_on(tracked, asked, face) == note


def test_names_stand_alike_in_rows_that_differ_by_a_pixel(panel: CurvesPanel) -> None:
    """A height that rows share leaves some of them a pixel more."""
    header = panel.headers[1]
    layouts = []
    for height in range(style.ROW_HEIGHT, 90):
        header.setFixedHeight(height)
        layouts.append((height, Layout.of(header, "Mouth width", height)))
    assert [layout.is_low for _, layout in layouts] == sorted(
        (layout.is_low for _, layout in layouts), reverse=True
    )
    with_note = [(height, layout) for height, layout in layouts if layout.note is not None]
    tops = [layout.name.top() for _, layout in with_note]
    assert all(0 <= below - above <= 1 for above, below in pairwise(tops))
    for height, layout in with_note:
        assert layout.note is not None
        assert layout.note.top() + QFontMetricsF(layout.name_font).height() < height + 1


def test_all_rows_have_the_layout_of_the_lowest(panel: CurvesPanel) -> None:
    shown = [header for header in panel.headers if not header.isHidden()]
    name = shown[0].control.label
    rules: tuple[Callable[[Layout], bool], ...] = (
        lambda at: not at.is_low,
        lambda at: at.note is not None,
    )
    for is_other in rules:
        height = next(h for h in range(20, 90) if is_other(Layout.of(shown[0], name, h)))
        total = len(shown) * height - len(shown) // 2
        panel.resize(panel.width(), panel.height() + total - sum(h.height() for h in shown))
        run_events()
        assert {header.height() for header in shown} == {height - 1, height}
        assert not any(is_other(header._layout()) for header in shown)


def test_what_a_header_says_is_neither_cut_nor_overlapping(panel: CurvesPanel) -> None:
    for height, header in product(range(style.ROW_HEIGHT, 90, 3), panel.headers):
        header.setFixedHeight(height)
        layout = Layout.of(header, header.control.label, height)
        metrics, bold = QFontMetricsF(layout.name_font), QFontMetricsF(layout.value_font)
        wrap = 0 if layout.is_low else int(Qt.TextFlag.TextWordWrap)
        name = metrics.boundingRect(layout.name, wrap, header.control.label)
        assert name.width() <= layout.name.width()
        assert name.height() <= height + 1
        value = WIDEST if layout.is_low else WIDEST + UNIT
        assert bold.horizontalAdvance(value) <= layout.value.width()
        if layout.is_low:
            assert layout.name.right() <= layout.value.left()
            assert name.height() < 1.5 * metrics.height(), "on one line"
        else:
            assert layout.value.top() >= layout.name.top() + name.height() - 4
            assert layout.value.top() + bold.height() <= height + 3


def test_what_reads_the_same_is_not_said_twice(panel: CurvesPanel) -> None:
    session = session_of(panel)
    panel.timeline.go_to_frame(25)
    tracked = float(session.tracked[25, 0])
    asked = round(tracked + 3.0, 1)
    session.asked[25, 0], session.achieved[25, 0] = asked - 0.04, asked + 0.04
    panel._show_state()
    assert panel.headers[0].note == f"tracked {tracked:.1f}"
    session.achieved[25, 0] = asked + 0.06
    panel._show_state()
    assert panel.headers[0].note == f"asked {asked:.1f}"


def test_lines_that_coincide_are_drawn_once(panel: CurvesPanel) -> None:
    plot = panel.plots[0]
    assert plot.lines is not None
    assert len(plot.lines.face.x) > 100
    assert len(plot.lines.tracked.x) == 0
    assert len(plot.lines.asked.x) == 0
    start = place(plot, 1.5)
    drag(plot, start, start + QPoint(0, -20))
    assert 0 < len(plot.lines.asked.x) < 40
    assert 0 < len(plot.lines.tracked.x) < 40


def test_without_a_take_it_says_what_to_do(qtbot: QtBot) -> None:
    panel = CurvesPanel(Timeline())
    qtbot.addWidget(panel)
    panel.resize(600, 500)
    panel.show()
    labels = [label for label in panel.findChildren(QLabel) if label.isVisible()]
    assert [label.text() for label in labels] == ["Open a take (Ctrl+O) or drop one here"]
    panel.refresh()
    panel.cancel_drag()


def test_the_keyboard_sees_where_it_is(panel: CurvesPanel) -> None:
    panel.activateWindow()
    panel.plots[2].setFocus(Qt.FocusReason.TabFocusReason)
    assert panel.focused_control == "left_corner"
    assert panel.plots[2].shows_focus
    panel.plots[4].setFocus(Qt.FocusReason.TabFocusReason)
    assert panel.focused_control == "upper_lip"
    assert not panel.plots[2].shows_focus
    panel.plots[5].setFocus(Qt.FocusReason.MouseFocusReason)
    assert not panel.plots[5].shows_focus


def test_names_for_screen_readers(panel: CurvesPanel) -> None:
    for control, plot, header in zip(CONTROLS, panel.plots, panel.headers, strict=True):
        assert plot.accessibleName() == f"{control.label} curve"
        assert plot.accessibleDescription() == control.hint
        assert header.accessibleName() == control.label
        assert control.hint in header.toolTip()
        assert header.accessibleDescription().startswith(header.value)
    assert "Dashed" in panel.legend.accessibleDescription()


def test_gaps_are_hatched(qtbot: QtBot) -> None:
    panel = open_panel(qtbot, tiny_session(gaps=(Gap(99, 40),)))
    plot = panel.plots[5]
    panel.timeline.go_to_frame(10)
    image = plot.grab().toImage()
    scale = plot.current_scale
    times = session_of(panel).take.clip.times
    middle = 0.5 * (times[99] + times[100])
    x, y = round(scale.x_of(middle)), 8
    inside = {image.pixel(x + dx, y + dy) for dx in range(12) for dy in range(12)}
    beside = {image.pixel(round(scale.x_of(0.6)) + dx, y + dy) for dx in range(6) for dy in (0, 1)}
    assert len(inside) >= 2
    assert len(beside) == 1
    assert not beside & inside


def test_a_long_take_is_drawn_from_few_points(qtbot: QtBot) -> None:
    panel = open_panel(qtbot, tiny_session(frames=36_000))
    for plot in panel.plots:
        assert plot.lines is not None
        for line in (plot.lines.tracked, plot.lines.face, plot.lines.asked):
            assert len(line.x) <= 3 * plot.width() + 4


def test_a_curve_that_the_character_lacks_is_disabled_and_says_why(qtbot: QtBot) -> None:
    rig = tiny_rig()
    pairs = rig.control_pairs.copy()
    pairs[CONTROL_INDEX[MOUTH_WIDTH]] = -1
    panel = CurvesPanel(Timeline())
    qtbot.addWidget(panel)
    panel.set_session(open_session(tiny_take(), replace(rig, control_pairs=pairs)))
    able = {plot.control.id: plot.isEnabled() for plot in panel.plots}
    assert able.pop(MOUTH_WIDTH) is False
    assert all(able.values())
    index = CONTROL_INDEX[MOUTH_WIDTH]
    plot, header = panel.plots[index], panel.headers[index]
    assert "lacks the control points" in header.toolTip()
    said: list[str] = []
    plot.refused.connect(said.append)
    QTest.mouseClick(plot.viewport(), Qt.MouseButton.LeftButton)
    assert said == [header.toolTip()]
    panel.set_session(open_session(tiny_take(), rig))
    assert plot.isEnabled()
    assert not plot.toolTip()
    QTest.mouseClick(plot.viewport(), Qt.MouseButton.LeftButton)
    assert len(said) == 1


@pytest.mark.parametrize(
    ("width", "words"),
    [
        (900, ["as tracked", "asked for", "the face", "your character"]),
        (700, ["tracked", "asked", "face", "yours"]),
        (400, []),
    ],
)
def test_the_hint_is_read_in_full_and_the_legend_gives_way(
    qtbot: QtBot, width: int, words: list[str]
) -> None:
    legend = Legend()
    qtbot.addWidget(legend)
    legend.resize(width, 24)
    legend.show_character(True)
    legend.show_hint(CHOSEN_HINT)
    metrics = QFontMetricsF(style.scaled_font(legend, 0.9))
    assert [text for _, text in legend._samples(metrics)] == words
    legend.grab()
