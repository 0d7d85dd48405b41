"""A curves panel on the screen, and a real mouse on its plots."""

from __future__ import annotations

import pyqtgraph as pg
from PySide6.QtCore import QEvent, QPoint, QPointF, Qt
from PySide6.QtGui import QMouseEvent, QWheelEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QAbstractScrollArea, QApplication, QWidget
from pytestqt.qtbot import QtBot

from faceedit_app.editing.session import EditSession
from faceedit_app.ui.curves import CurvesPanel
from faceedit_app.ui.curves.interaction import Interaction
from faceedit_app.ui.curves.plot import CurvePlot
from faceedit_app.ui.curves.range_bar import RangeBar
from faceedit_app.ui.curves.ruler import Ruler
from faceedit_app.ui.state.timeline import Timeline
from support.theme import themed
from support.waiting import wait_for_timers

# pyqtgraph drops moves that come faster than 100 a second, as those of tests do.
pg.setConfigOption("mouseRateLimit", -1)

Strip = CurvePlot | Ruler | RangeBar  # what lies along the time axis
NONE, SHIFT, CTRL, ALT = (
    Qt.KeyboardModifier.NoModifier,
    Qt.KeyboardModifier.ShiftModifier,
    Qt.KeyboardModifier.ControlModifier,
    Qt.KeyboardModifier.AltModifier,
)
LEFT, MIDDLE, RIGHT = (
    Qt.MouseButton.LeftButton,
    Qt.MouseButton.MiddleButton,
    Qt.MouseButton.RightButton,
)


def open_panel(qtbot: QtBot, session: EditSession, width: int = 900) -> CurvesPanel:
    """A new panel on the screen that shows a session; the end of the test closes it."""
    panel = new_panel()
    qtbot.addWidget(panel)
    show_session(qtbot, panel, session, width)
    return panel


def new_panel() -> CurvesPanel:
    """A panel with a timeline of its own."""
    themed()
    timeline = Timeline()
    panel = CurvesPanel(timeline)
    timeline.setParent(panel)
    return panel


def show_session(qtbot: QtBot, panel: CurvesPanel, session: EditSession, width: int = 900) -> None:
    """Show a panel on the screen, and a session in it."""
    panel.resize(width, 700)
    panel.show()
    qtbot.waitExposed(panel)
    panel.timeline.open(session.take.clip)
    panel.set_session(session)
    session.previewed.connect(panel.refresh)
    session.changed.connect(panel.refresh)
    QApplication.processEvents()


def session_of(panel: CurvesPanel) -> EditSession:
    """The session that it shows."""
    assert panel.session is not None
    return panel.session


def surface(widget: QWidget) -> QWidget:
    """The widget that the mouse is on: of a plot, what is inside its frame."""
    return widget.viewport() if isinstance(widget, QAbstractScrollArea) else widget


def place(plot: Strip, seconds: float, y: float = 40.0) -> QPoint:
    """Where a time is on the surface of a plot, some pixels below its top."""
    x = plot.current_scale.x_of(seconds)
    at: QPoint = plot.mapFromScene(plot.view.mapToScene(QPointF(x, y)))
    return at


def drag(
    widget: QWidget,
    start: QPoint,
    stop: QPoint,
    modifiers: Qt.KeyboardModifier = NONE,
    release: bool = True,
    button: Qt.MouseButton = LEFT,
    previews: bool = False,
) -> None:
    """Press, move in five steps, and release; with `previews`, each step is shown."""
    on = surface(widget)
    QTest.mouseMove(on, start)
    QTest.mousePress(on, button, modifiers, start)
    for i in range(1, 6):
        move_with(on, start + (stop - start) * i / 5, modifiers, button)
        if previews:  # the search for problems, which has a timer too, waits until the end
            hand = widget.window().findChild(Interaction)
            wait_for_timers(hand if hand is not None else widget.window())
    if release:
        QTest.mouseRelease(on, button, modifiers, stop)


def let_go(widget: QWidget, at: QPoint, modifiers: Qt.KeyboardModifier = NONE) -> None:
    """Release the left button."""
    QTest.mouseRelease(surface(widget), LEFT, modifiers, at)


def move_with(
    widget: QWidget,
    at: QPoint,
    modifiers: Qt.KeyboardModifier = NONE,
    held: Qt.MouseButton = LEFT,
) -> None:
    """Move the mouse with keys and a button held, which QTest forgets."""
    on = surface(widget)
    where = QPointF(on.mapToGlobal(at))
    kind, none = QEvent.Type.MouseMove, Qt.MouseButton.NoButton
    QApplication.sendEvent(on, QMouseEvent(kind, QPointF(at), where, none, held, modifiers))


def turn(
    widget: QWidget, at: QPoint, notches: float, modifiers: Qt.KeyboardModifier = NONE
) -> None:
    """Turn the wheel."""
    on = surface(widget)
    QApplication.sendEvent(
        on,
        QWheelEvent(
            QPointF(at),
            QPointF(on.mapToGlobal(at)),
            QPoint(),
            QPoint(0, round(120 * notches)),
            Qt.MouseButton.NoButton,
            modifiers,
            Qt.ScrollPhase.NoScrollPhase,
            False,
        ),
    )
