"""The numbers on the axes, as pyqtgraph draws them: round, whole, and none over another."""

from __future__ import annotations

from itertools import pairwise, product

import pytest
from PySide6.QtCore import QPoint, QRectF
from PySide6.QtGui import QPainter, QPicture
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot
from support.curves import drag, open_panel, session_of
from support.rigs import tiny_session

from faceedit_app.editing.session import EditSession
from faceedit_app.ui.curves import CurvesPanel
from faceedit_app.ui.curves.axes import FrameAxis, TimeAxis, ValueAxis
from faceedit_app.ui.state.time_display import Unit

Drawn = list[tuple[QRectF, str]]


@pytest.fixture(scope="module")
def session() -> EditSession:
    """A long take, which no test here edits."""
    return tiny_session(36_000)


@pytest.fixture
def panel(qtbot: QtBot, session: EditSession) -> CurvesPanel:
    return open_panel(qtbot, session)


def drawn(axis: ValueAxis | TimeAxis | FrameAxis) -> Drawn:
    """Where it writes what."""
    picture = QPicture()
    with QPainter(picture) as painter:
        specs = axis.generateDrawSpecs(painter)
    return [] if specs is None else [(rect, text) for rect, _, text in specs[2]]


def assert_readable(numbers: Drawn, room: QRectF) -> None:
    rects = [rect for rect, _ in numbers]
    for rect in rects:
        assert room.left() <= rect.left()
        assert rect.right() <= room.right() + 0.5
        assert room.top() <= rect.top()
        assert rect.bottom() <= room.bottom() + 0.5
    for i, one in enumerate(rects):
        for other in rects[i + 1 :]:
            assert not one.adjusted(-2.0, 0.0, 2.0, 0.0).intersects(other)


def assert_apart_at_the_ends(numbers: Drawn, width: float) -> None:
    """One that was moved in from an end has no less room than others."""
    (first, _), (second, _), *_ = numbers
    (before, _), (last, _) = numbers[-2:]
    if first.left() < 5:
        assert second.left() - first.right() > 10
    if last.right() > width - 5:
        assert last.left() - before.right() > 10


def test_the_playhead_at_the_start_leaves_the_first_time_readable(panel: CurvesPanel) -> None:
    panel.timeline.show_range(0.0, 10.0)
    QApplication.processEvents()
    rect, text = drawn(panel.ruler.times)[0]
    assert (text, rect.left() > 2) == ("0 s", True)


@pytest.mark.parametrize("unit", list(Unit))
def test_times_are_whole_and_apart(panel: CurvesPanel, unit: Unit) -> None:
    line, axis = panel.timeline, panel.ruler.times
    line.display.choose(unit)
    lengths, starts = (0.2, 0.7, 3.0, 11.0, 90.0, 720.0), (0.0, 0.31, 200.0)
    for width, seconds, start in product((600, 1003, 1600), lengths, starts):
        panel.resize(width, 600)
        line.show_range(start, start + seconds)
        QApplication.processEvents()
        numbers = drawn(axis)
        assert len(numbers) >= 2
        assert_readable(numbers, axis.rect())
        assert_apart_at_the_ends(numbers, axis.width())
        if panel.ruler.frames.isVisible():
            below = drawn(panel.ruler.frames)
            assert_readable([*numbers, *below], axis.rect())


@pytest.mark.parametrize("frames", [1, 2])
def test_the_frames_of_a_tiny_take_are_whole_and_can_be_dragged(qtbot: QtBot, frames: int) -> None:
    panel = open_panel(qtbot, tiny_session(frames))
    assert panel.timeline.view[0] < 0
    assert drawn(panel.ruler.times)[0][1].strip("0. s") == "", "no time is before the take"
    plot, session = panel.plots[0], session_of(panel)
    panel.timeline.zoom(0.5, 0.0)
    scale, times = plot.current_scale, session.take.clip.times
    for time in times:
        assert 20 < scale.x_of(time) < scale.width - 20
    start = QPoint(round(scale.x_of(times[-1])) + 30, 20)
    drag(plot, start, start + QPoint(0, -12))
    (edit,) = session.edits
    assert (edit.start, edit.end) == (times[-1], times[-1])


def test_frames_are_counted_in_round_numbers(panel: CurvesPanel) -> None:
    panel.timeline.display.choose(Unit.FRAMES)
    for last in (4.0, 60.0, 720.0):
        panel.timeline.show_range(0.0, last)
        numbers = [int(text) for _, text in drawn(panel.ruler.times)]
        steps = {b - a for a, b in pairwise(numbers)}
        assert len(steps) == 1
        assert all(number % steps.copy().pop() == 0 for number in numbers)


def test_frames_are_numbered_where_they_have_room(panel: CurvesPanel) -> None:
    panel.timeline.show_range(0.0, 60.0)
    assert not panel.ruler.frames.isVisible()
    panel.timeline.show_range(1.0, 1.5)
    assert panel.ruler.frames.isVisible()
    numbers = [int(text) for _, text in drawn(panel.ruler.frames)]
    assert numbers[0] >= 51
    assert numbers[-1] <= 77
    assert len(numbers) >= 8
    panel.timeline.display.choose(Unit.FRAMES)  # then they are what the ruler counts anyway
    assert not panel.ruler.frames.isVisible()


def test_values_are_whole_and_apart(panel: CurvesPanel) -> None:
    plot = panel.plots[0]
    axis = plot.axis
    ranges = ((0.0, 0.3), (-3.0, 17.0), (4.9, 5.3), (0.0, 999.0), (-0.4, 1.7))
    for height, (low, high) in product((500, 620, 900), ranges):
        panel.resize(900, height)
        QApplication.processEvents()
        plot.show_values((low, high))
        numbers = drawn(axis)
        assert_readable(numbers, axis.rect())
        assert not any(text.startswith("-0") and float(text) == 0.0 for _, text in numbers)
        values = [float(text) for _, text in numbers]
        assert all(low <= value <= high for value in values)


def test_every_value_axis_has_a_number(panel: CurvesPanel) -> None:
    """0 to 46 mm in a low plot has no room for 0, nor for 50."""
    plot = panel.plots[0]
    spans = (2.3, 5.9, 11.0, 23.0, 46.0, 57.0, 99.0)
    for height, low, span in product((30, 34, 40, 48, 60), (-5.1, 0.3, 26.7), spans):
        plot.setFixedHeight(height)
        plot.show_values((low, low + span))
        QApplication.processEvents()
        numbers = drawn(plot.axis)
        assert numbers, height
        assert_readable(numbers, plot.axis.rect())
        for _, text in numbers:
            assert low < float(text.replace("−", "-")) < low + span
