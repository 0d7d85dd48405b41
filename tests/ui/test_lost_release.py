"""A button that goes up where the window does not see it ends the drag; nothing stays afloat."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from PySide6.QtCore import QEvent, QPoint, QPointF, Qt, QTimer
from PySide6.QtGui import QMouseEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QMessageBox, QWidget
from support.curves import surface
from support.films import make_wav
from support.waiting import wait_for_timers
from support.windows import Bench, add_edit

from faceedit_app.ui.page.editor import Editor
from faceedit_app.ui.start.window import MainWindow
from faceedit_app.ui.state.tools import Tool

LEFT, NONE = Qt.MouseButton.LeftButton, Qt.MouseButton.NoButton


def move(widget: QWidget, to: QPoint, held: Qt.MouseButton, keys: Qt.KeyboardModifier) -> None:
    on = surface(widget)
    at, everywhere = QPointF(to), QPointF(on.mapToGlobal(to))
    event = QMouseEvent(QEvent.Type.MouseMove, at, everywhere, NONE, held, keys)
    QApplication.sendEvent(on, event)


def hold(
    widget: QWidget,
    by: QPoint,
    keys: Qt.KeyboardModifier = Qt.KeyboardModifier.NoModifier,
    start: QPoint | None = None,
) -> None:
    """Press and drag, and do not let go."""
    on = surface(widget)
    start = start or on.rect().center()
    QTest.mousePress(on, LEFT, keys, start)
    for step in (1, 2, 3):
        move(widget, start + by * step / 3, LEFT, keys)


def hover(window: MainWindow, widget: QWidget) -> None:
    """The pointer comes back, without a button."""
    move(widget, QPoint(5, 5), NONE, Qt.KeyboardModifier.NoModifier)


def switch_away(window: MainWindow, _widget: QWidget) -> None:
    """Alt+Tab."""
    QApplication.sendEvent(window, QEvent(QEvent.Type.WindowDeactivate))


def dialog_opens(window: MainWindow, _widget: QWidget) -> None:
    """A message that nobody asked for."""
    box = QMessageBox(window)
    QTimer.singleShot(0, box.reject)
    box.exec()


WAYS = (hover, switch_away, dialog_opens)
LOSSES = pytest.mark.parametrize("lose", WAYS)
Lose = Callable[[MainWindow, QWidget], None]


def opened(bench: Bench) -> tuple[MainWindow, Editor]:
    window = bench.editing()
    assert window.editor is not None
    return window, window.editor


@pytest.mark.parametrize(
    ("lose", "tool"),
    [
        (lose, tool)
        for number, tool in enumerate(Tool)
        for place, lose in enumerate(WAYS)
        if tool is Tool.MOVE or number % len(WAYS) == place  # all of one tool, one of each other
    ],
)
def test_a_drag_on_a_curve_is_kept_as_one_step(bench: Bench, lose: Lose, tool: Tool) -> None:
    window, editor = opened(bench)
    add_edit(window)
    window.tools.choose(tool)
    plot, session = editor.curves.plots[0], window.document.session
    assert session is not None
    hold(plot, QPoint(30, -30))
    assert editor.curves.is_dragging
    bench.qtbot.waitUntil(lambda: session.is_previewing)
    shown = session.live.asked.copy()
    lose(window, plot)
    assert not editor.curves.is_dragging
    assert not session.is_previewing
    assert len(session.edits) == 2
    assert (session.live.asked == shown).all(), "the stray move did not drag"
    QTest.mouseRelease(surface(plot), LEFT, pos=QPoint(9, 9))  # it comes after all
    assert len(session.edits) == 2
    session.undo()
    assert len(session.edits) == 1


@LOSSES
def test_a_press_that_never_moved_is_forgotten(bench: Bench, lose: Lose) -> None:
    window, editor = opened(bench)
    plot, session = editor.curves.plots[0], window.document.session
    assert session is not None
    QTest.mousePress(surface(plot), LEFT, pos=QPoint(200, 20))
    lose(window, plot)
    move(plot, QPoint(200, 70), NONE, Qt.KeyboardModifier.NoModifier)
    assert not editor.curves.is_dragging
    assert not session.can_undo
    assert window.timeline.frame == 0, "it is no click either"


def test_a_selection_stays_as_far_as_it_was_dragged(bench: Bench) -> None:
    window, editor = opened(bench)
    for lose in WAYS:
        bar, ruler = editor.curves.range_bar, editor.curves.ruler
        shift = Qt.KeyboardModifier.ShiftModifier
        for widget, keys in ((bar, Qt.KeyboardModifier.NoModifier), (ruler, shift)):
            window.timeline.select(None)
            hold(widget, QPoint(90, 0), keys)
            selection = window.timeline.selection
            assert selection is not None
            lose(window, widget)
            assert not widget.is_selecting
            move(widget, QPoint(20, 5), NONE, keys)
            assert window.timeline.selection == selection


def test_an_edge_of_the_selection_stays_where_it_was_dragged(bench: Bench) -> None:
    window, editor = opened(bench)
    for lose in WAYS:
        window.timeline.select((1.0, 2.0))
        bar = editor.curves.range_bar
        edge = QPoint(round(bar.current_scale.x_of(2.0)), bar.height() // 2)
        hold(bar, QPoint(60, 0), start=edge)
        moved = window.timeline.selection
        assert moved is not None
        assert moved[1] > 2.05
        lose(window, bar)
        assert not editor.curves.is_dragging
        move(bar, QPoint(20, 5), NONE, Qt.KeyboardModifier.NoModifier)
        assert window.timeline.selection == moved


def test_the_playhead_and_the_view_stay(bench: Bench) -> None:
    window, editor = opened(bench)
    for lose in WAYS:
        ruler, viewport = editor.curves.ruler, editor.face.viewport
        hold(ruler, QPoint(90, 0))
        frame = window.timeline.frame
        lose(window, ruler)
        move(ruler, QPoint(20, 5), NONE, Qt.KeyboardModifier.NoModifier)
        assert window.timeline.frame == frame
        hold(viewport, QPoint(40, 20))
        camera = viewport.camera
        lose(window, viewport)
        move(viewport, QPoint(3, 3), LEFT, Qt.KeyboardModifier.NoModifier)
        assert viewport.camera == camera


@LOSSES
def test_the_sound_stays_where_it_was_dragged_as_one_step(bench: Bench, lose: Lose) -> None:
    window, editor = opened(bench)
    window.media.add(make_wav(bench.folder / "voice.wav"))
    bench.qtbot.waitUntil(lambda: window.media.sound is not None, timeout=10_000)
    wave, session = editor.sound.waveform, window.document.session
    assert session is not None
    hold(wave, QPoint(60, 0), Qt.KeyboardModifier.AltModifier)
    offset = window.media.placement.sound
    lose(window, wave)
    assert not window.media.is_held
    assert session.state.media == window.media.placement
    assert window.media.placement.sound == offset
    window.actions_["undo"].trigger()
    assert window.media.sound is not None
    assert window.media.sound.offset == 0


@pytest.mark.parametrize("lose", [switch_away, dialog_opens])
def test_a_slider_is_let_go_of(bench: Bench, lose: Lose) -> None:
    window, editor = opened(bench)
    add_edit(window)
    session = window.document.session
    assert session is not None
    for slider in (editor.settings_bar.exactness, editor.edits.strength):
        editor.edits.select(0)
        slider.setSliderDown(True)
        slider.setSliderPosition(40)
        lose(window, slider)
        assert not slider.isSliderDown()
        assert not session.is_previewing
    assert session.settings.exactness == pytest.approx(0.4)
    assert session.edits[0].strength == pytest.approx(0.4)


def test_hovering_does_not_take_part_in_nudges_by_keys(bench: Bench) -> None:
    window, editor = opened(bench)
    session = window.document.session
    assert session is not None
    editor.curves.focus_curve(0)
    window.actions_["raise"].trigger()
    shown = session.live.asked.copy()
    plot = editor.curves.plots[0]
    for x in (100, 200, 300):
        move(plot, QPoint(x, 10), NONE, Qt.KeyboardModifier.NoModifier)
    wait_for_timers(editor.curves)  # no preview is due
    assert (session.live.asked == shown).all()
    window.actions_["raise"].trigger()
    assert [edit.value for edit in session.edits] == [1.0]
