"""Only what changed is painted again: the screen must look as if everything were."""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import QEvent, QObject, QPoint
from PySide6.QtGui import QImage
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QWidget
from pytestqt.qtbot import QtBot
from support.chance import TIMES
from support.curves import LEFT, move_with, open_panel, place, session_of, surface
from support.rigs import tiny_session
from support.waiting import wait_for_timers

from faceedit_app.ui.curves import CurvesPanel
from faceedit_app.ui.curves.visible_curves import EMPTY

STEPS = 3


def on_screen(panel: CurvesPanel) -> np.ndarray:
    """What the window has painted so far, (H, W, 4)."""
    QApplication.processEvents()
    picture = panel.screen().grabWindow(panel.winId()).toImage()
    picture = picture.convertToFormat(QImage.Format.Format_RGB32)
    shape = picture.height(), picture.width(), 4
    return np.frombuffer(picture.constBits(), np.uint8).reshape(shape).copy()


def assert_nothing_is_stale(panel: CurvesPanel, what: str) -> None:
    before = on_screen(panel)
    for widget in (panel, *panel.findChildren(QWidget)):
        widget.update()
    # A part of a gradient is painted by a level otherwise than the whole.
    apart = np.abs(on_screen(panel).astype(int) - before)
    differs = np.argwhere((apart > 2).any(axis=2))
    assert not len(differs), f"{what}: {len(differs)} pixels, {differs.min(0)} to {differs.max(0)}"


@pytest.fixture(autouse=True)
def still_cursor(qapp: QApplication) -> Iterator[None]:
    """The text cursor of a number field blinks, which no painting of ours does."""
    usual = qapp.cursorFlashTime()
    qapp.setCursorFlashTime(0)
    yield
    qapp.setCursorFlashTime(usual)


@pytest.mark.parametrize("frames", [250, 5_000])
def test_nothing_stale_stays_on_screen(qtbot: QtBot, frames: int) -> None:
    panel = open_panel(qtbot, tiny_session(frames))
    session, line, rng = session_of(panel), panel.timeline, random.Random(frames)
    duration = session.take.clip.duration
    for gesture in range(8 * TIMES):
        what = rng.choice(("zoom", "select", "select", "nothing", "undo", "redo", "plain"))
        start = rng.uniform(0.0, 0.8 * duration)
        if what == "zoom":
            line.show_range(start, start + rng.choice((2.0, 0.2 * duration)))
        elif what == "select":
            line.select((start, start + rng.uniform(0.3, 3.0)))
        elif what == "nothing":
            line.select(None)
        elif what == "undo" and session.can_undo:
            session.undo()
        elif what == "redo" and session.can_redo:
            session.redo()
        panel.refresh()
        line.go_to_time(rng.uniform(*line.view))
        assert_nothing_is_stale(panel, f"{gesture} {what}")
        plot = rng.choice(panel.plots)
        widget, at = surface(plot), place(plot, rng.uniform(*line.view))
        QTest.mouseMove(widget, at)
        QTest.mousePress(widget, LEFT, pos=at)
        for step in range(STEPS):
            at += QPoint(rng.randint(-2, 2), rng.randint(-25, 25))
            move_with(plot, at)
            wait_for_timers(panel)
            assert_nothing_is_stale(panel, f"{gesture} on {plot.control.id}, step {step}")
        if rng.random() < 0.3:
            panel.cancel_drag()
        QTest.mouseRelease(widget, LEFT, pos=at)
        assert_nothing_is_stale(panel, f"{gesture} on {plot.control.id}, let go of")
    assert session.edits


class Rounds(QObject):
    """Counts how often a window is painted."""

    count = 0

    def eventFilter(self, _watched: QObject, event: QEvent) -> bool:
        self.count += event.type() == QEvent.Type.UpdateRequest
        return False


def test_all_plots_are_painted_in_one_round(qtbot: QtBot) -> None:
    panel = open_panel(qtbot, tiny_session())
    panel.timeline.select((1.0, 2.0))
    QApplication.processEvents()
    rounds = Rounds(panel)
    panel.window().installEventFilter(rounds)
    panel.timeline.go_to_frame(panel.timeline.frame + 20)  # moves the playhead in each
    QApplication.processEvents()
    assert rounds.count == 1
    assert_nothing_is_stale(panel, "after one round")


def test_what_moves_less_than_can_be_seen_is_not_painted_until_it_can(qtbot: QtBot) -> None:
    panel = open_panel(qtbot, tiny_session())
    plot = panel.plots[0]
    QApplication.processEvents()
    painted = Painted(surface(plot))
    surface(plot).installEventFilter(painted)
    face, (low, high) = plot.lines.face, plot.values
    little = 0.004 * (high - low) / plot.view.height()
    for moved, expected in ((little, 0), (little, 0), (1.0, 1)):
        face = replace(face, y=face.y + moved)
        plot.show_lines(replace(plot.lines, face=face))
        QApplication.processEvents()
        assert painted.count == expected, moved
    plot.show_lines(replace(plot.lines, face=replace(face, y=face.y + little)))
    start = float(face.y[0])
    plot.show_values((start - 0.1, start + 0.1))
    shown = on_screen(panel)
    for line in (EMPTY, plot.lines.face):
        plot.show_lines(replace(plot.lines, face=line))
    assert np.array_equal(on_screen(panel), shown), "drawn where it is, closer up"


class Painted(QObject):
    """Counts how often a widget is painted."""

    count = 0

    def eventFilter(self, _watched: QObject, event: QEvent) -> bool:
        self.count += event.type() == QEvent.Type.Paint
        return False


def test_a_selection_is_as_high_as_its_plot_whatever_the_axis_does(qtbot: QtBot) -> None:
    panel = open_panel(qtbot, tiny_session())
    plot, line = panel.plots[0], panel.timeline
    line.select((1.0, 2.0))
    line.go_to_frame(0)
    start = place(plot, 1.5)
    QTest.mouseMove(surface(plot), start)
    QTest.mousePress(surface(plot), LEFT, pos=start)
    for up in (10, 60, 150):
        move_with(plot, start - QPoint(0, up))
        QTest.qWait(20)
    QTest.mouseRelease(surface(plot), LEFT, pos=start - QPoint(0, 150))
    for size in ((900, 700), (700, 500), (1000, 800)):
        panel.resize(*size)
        QApplication.processEvents()
        picture = plot.grab().toImage()
        x = place(plot, 1.02).x()
        column = [picture.pixelColor(x, y).blue() for y in range(plot.height())]
        beside = [picture.pixelColor(place(plot, 3.5).x(), y).blue() for y in (2, -3 % len(column))]
        assert min(column[1], column[-2]) > max(beside), "it is tinted from top to bottom"
