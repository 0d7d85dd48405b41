"""The bar with the whole take: it moves the view and shows the edits that are out of it."""

from __future__ import annotations

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from support.curves import drag
from support.waiting import run_events
from support.windows import Bench, add_edit

from faceedit_app.core.controls import control_named
from faceedit_app.ui.page.overview import HEIGHT, Overview
from faceedit_app.ui.start.window import MainWindow

LEFT = Qt.MouseButton.LeftButton


@pytest.fixture
def window(bench: Bench) -> MainWindow:
    return bench.editing()


def overview_of(window: MainWindow) -> Overview:
    assert window.editor is not None
    return window.editor.overview


def at(bar: Overview, seconds: float, inside: int = 0) -> QPoint:
    return QPoint(round(bar.x_of(seconds)) + inside, HEIGHT // 2)


def test_the_part_in_view_is_moved_and_sized(window: MainWindow) -> None:
    bar, line = overview_of(window), window.timeline
    line.show_range(0.5, 1.5)
    drag(bar, at(bar, 1.0), at(bar, 1.5))
    assert line.view == pytest.approx((1.0, 2.0), abs=0.02)
    drag(bar, at(bar, 2.0), at(bar, 2.4))
    assert line.view == pytest.approx((1.0, 2.4), abs=0.02)
    drag(bar, at(bar, 1.0), at(bar, 1.8))
    assert line.view == pytest.approx((1.8, 2.4), abs=0.02)
    QTest.mouseClick(bar, LEFT, pos=at(bar, 0.7))
    assert line.view == pytest.approx((0.4, 1.0), abs=0.02)
    QTest.mouseDClick(bar, LEFT, pos=at(bar, 0.7))
    assert line.view == (0.0, line.duration)


def test_edits_out_of_view_are_on_it(window: MainWindow) -> None:
    bar = overview_of(window)
    window.timeline.show_range(2.0, 3.0)

    def blue() -> int:
        run_events()
        return bar.grab().toImage().pixelColor(at(bar, 1.2)).blue()

    before = blue()
    add_edit(window)
    assert blue() > before + 40
    assert control_named("mouth_opening").color == "#56b4e9"
    window.actions_["undo"].trigger()
    assert blue() == before


def test_edits_are_not_painted_again_as_the_playhead_moves(window: MainWindow) -> None:
    bar, session = overview_of(window), window.document.session
    assert session is not None
    add_edit(window)
    painted = bar.picture(session.edits)
    window.timeline.go_to_time(1.0)
    bar.grab()
    assert bar.picture(session.edits) is painted
    window.actions_["undo"].trigger()
    assert bar.picture(session.edits) is not painted


def test_it_stands_under_the_plots(window: MainWindow) -> None:
    bar = overview_of(window)
    assert window.editor is not None
    plot = window.editor.curves.plots[0]
    left = plot.mapTo(window, QPoint(0, 0)).x()
    assert abs(bar.mapTo(window, QPoint(0, 0)).x() - left) < 60
    assert bar.mapTo(window, QPoint(bar.width(), 0)).x() == pytest.approx(
        plot.mapTo(window, QPoint(plot.width(), 0)).x(), abs=2
    )
