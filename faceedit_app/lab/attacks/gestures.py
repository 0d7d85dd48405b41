"""What can be done on the curves, on the face and with the window, each as one random gesture."""

from __future__ import annotations

import time

from PySide6.QtCore import QCoreApplication, QPointF, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QMenu, QSplitter, QWidget

from faceedit_app.lab.attacks.hands import HELD, Hands
from faceedit_app.ui.state.tools import Tool

_KEYS = (
    *(Qt.Key.Key_Escape, Qt.Key.Key_Return, Qt.Key.Key_Tab, Qt.Key.Key_Space, Qt.Key.Key_Delete),
    *(Qt.Key.Key_Left, Qt.Key.Key_Right, Qt.Key.Key_Up, Qt.Key.Key_Down, Qt.Key.Key_F2),
    *(Qt.Key.Key_7, Qt.Key.Key_Period, Qt.Key.Key_B, Qt.Key.Key_Home, Qt.Key.Key_PageUp),
)
_WILD = 0.05  # of the drags leave the window far behind
_WATCHED = 0.15  # seconds of playback
_LEAST, _MOST = (1000, 600), (2200, 1300)  # pixels of the window


def drag_curve(hands: Hands) -> None:
    """Drag a curve with some tool, now and then far too far, or give up with Esc."""
    hands.window.tools.choose(hands.chance.choice(list(Tool)))
    plots = [plot for plot in hands.editor.curves.plots if plot.isVisible()]
    if not plots:
        return
    plot = hands.chance.choice(plots)
    seconds = hands.chance.uniform(*hands.window.timeline.view)
    x = plot.view.mapToScene(QPointF(plot.current_scale.x_of(seconds), 0.0)).x()
    hands.drag(plot, QPointF(x, hands.chance.uniform(0, plot.height())), _way(hands))


def drag_strip(hands: Hands) -> None:
    """Drag on the ruler, the range bar, the overview or the picture of the face."""
    strip = hands.chance.choice(_strips(hands))
    start, end = hands.place_on(strip), hands.place_on(strip)
    hands.drag(strip, start, end - start)


def drag_handle(hands: Hands) -> None:
    """Drag a lip, a mouth corner or a lid on the face."""
    face = hands.editor.face
    places = face.handles.places
    if places and face.viewport.isVisible():
        hands.drag(face.viewport, hands.chance.choice(list(places.values())), _way(hands))


def move_selection(hands: Hands) -> None:
    """Drag an edge of the selection, or its middle; it may be a chosen edit's."""
    line, bar = hands.window.timeline, hands.editor.curves.range_bar
    if line.selection is None:
        return
    (start, end), (before, after) = line.selection, (line.falloff, line.falloff_out)
    seconds = hands.chance.choice((start - before, start, (start + end) / 2, end, end + after))
    x = bar.view.mapToScene(QPointF(bar.current_scale.x_of(seconds), 0.0)).x()
    by = QPointF(hands.chance.uniform(-300, 300), 0.0)
    hands.drag(bar, QPointF(x, bar.height() / 2), by)


def turn_wheel(hands: Hands) -> None:
    """Turn the wheel over a curve, a strip or the face."""
    widget = _something(hands)
    hands.turn_wheel(widget, hands.place_on(widget))


def double_click(hands: Hands) -> None:
    """Click twice on a curve, a strip or the face."""
    widget = _something(hands)
    hands.double_click(widget, hands.place_on(widget))


def choose_from_menu(hands: Hands) -> None:
    """Choose something from a context menu."""
    widget = _something(hands)
    hands.choose_from_menu(widget, hands.place_on(widget))


def set_exactness(hands: Hands) -> None:
    """Move the slider from natural to exact."""
    slider = hands.editor.settings_bar.exactness
    if slider.isEnabled():
        slider.setSliderDown(True)
        slider.setSliderPosition(hands.chance.randint(slider.minimum(), slider.maximum()))
        slider.setSliderDown(False)


def press_key(hands: Hands) -> None:
    """Press a key where the focus is."""
    key, held = hands.chance.choice(_KEYS), hands.chance.choice(HELD)
    QTest.keyClick(QApplication.focusWidget() or hands.window, key, held)


def zoom(hands: Hands) -> None:
    """Show another part of the take."""
    end = hands.window.timeline.duration
    first, last = sorted(hands.chance.uniform(0, end) for _ in range(2))
    hands.window.timeline.show_range(first, last)


def travel(hands: Hands) -> None:
    """Choose a step in the history, before or after the present."""
    menu = QMenu()
    hands.window.commands.edit.fill_history(menu)
    steps = menu.actions()
    if steps:
        hands.chance.choice(steps).trigger()


def play(hands: Hands) -> None:
    """Play for a moment, at some speed and in some direction."""
    transport, playback = hands.editor.transport, hands.window.playback
    transport.speed.setCurrentIndex(hands.chance.randrange(transport.speed.count()))
    start = hands.chance.choice(("play", "play_around", "rewind", "fast_forward"))
    hands.window.actions_[start].trigger()
    until = time.monotonic() + _WATCHED
    while time.monotonic() < until and playback.playing:
        QCoreApplication.processEvents()
    if hands.chance.random() < 0.8:  # otherwise the next gestures are made while it plays
        playback.pause()


def resize(hands: Hands) -> None:
    """Make the window, or a part of it, larger or smaller."""
    window, chance = hands.window, hands.chance
    if chance.random() < 0.5:
        window.resize(chance.randint(_LEAST[0], _MOST[0]), chance.randint(_LEAST[1], _MOST[1]))
        return
    splitter = chance.choice(hands.editor.findChildren(QSplitter))
    splitter.setSizes([chance.randint(0, 1000) for _ in range(splitter.count())])


def lose_mouse(hands: Hands) -> None:
    """Drag a curve while another window comes in front, which ends the drag."""
    plots = [plot for plot in hands.editor.curves.plots if plot.isVisible()]
    if plots:
        plot = hands.chance.choice(plots)
        at = hands.place_on(plot)
        hands.press(plot, at)
        hands.move(plot, at + _way(hands))
        hands.window.mouse_lost()


def switch_character(hands: Hands) -> None:
    """Show the user's character instead of FaceEdit's own, or the other way round."""
    document = hands.window.document
    if hands.character is not None:
        hands.window.workspace.end_gestures()
        document.use_character(None if document.character is not None else hands.character)


def _way(hands: Hands) -> QPointF:
    """How far a drag goes."""
    far = 100_000 if hands.chance.random() < _WILD else 40
    return QPointF(hands.chance.randint(-far, far), hands.chance.randint(-far, far))


def _strips(hands: Hands) -> list[QWidget]:
    editor = hands.editor
    strips: list[QWidget] = [editor.curves.ruler, editor.curves.range_bar, editor.overview]
    return [*strips, editor.face.viewport]


def _something(hands: Hands) -> QWidget:
    """A curve, a strip, the face or the list of edits."""
    plots = [plot for plot in hands.editor.curves.plots if plot.isVisible()]
    every: list[QWidget] = [*plots, *_strips(hands), hands.editor.edits.list]
    return hands.chance.choice(every)
