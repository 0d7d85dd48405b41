"""Any sequence of what a user can do: undo all and redo all of it gives the same bytes."""

from __future__ import annotations

import random
from collections.abc import Callable

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtWidgets import QWidget
from support.curves import drag
from support.windows import Bench, drag_curve

from faceedit_app.core.controls import CONTROLS
from faceedit_app.core.resources import shipped
from faceedit_app.ui.commands import dialogs
from faceedit_app.ui.start.window import MainWindow
from faceedit_app.ui.state.tools import Tool

LEFT = Qt.MouseButton.LeftButton
STEPS = 200
COMMANDS = (
    *("fix_close_lips", "fix_blink", "fix_open_eyes", "fix_smile", "fix_sad_mouth", "fix_widen"),
    *("fix_pucker", "fix_calm_down", "fix_exaggerate", "copy", "copy_changes", "paste"),
    *("paste_mirrored", "mirror", "raise", "lower_fine", "reset_range", "reset_curve", "link"),
    *("toggle_edit", "delete_edit", "edit_up", "edit_down", "next_problem", "fix_problem"),
    *("accept_fix", "discard_fix", "deselect", "select_all", "mark_start", "mark_end"),
    *("undo", "undo", "redo", "second_forward", "forward", "second_back", "start"),
    *("show_both", "show_edited", "curve_3", "curve_7", "unit_frames", "unit_seconds"),
    *("show_difference", "show_difference", "show_tracked"),
)


class Monkey:
    """Uses the window at random, with a real mouse and by its commands."""

    def __init__(self, window: MainWindow, seed: int) -> None:
        assert window.editor is not None
        self.window, self.editor = window, window.editor
        self.random = random.Random(seed)

    def act(self) -> None:
        """One thing that a user can do."""
        doing: list[Callable[[], None]] = [self.command] * 6
        doing += [self.drag, self.drag, self.drag, self.band, self.choose, self.weaken]
        self.random.choice(doing)()

    def command(self) -> None:
        action = self.window.actions_[self.random.choice(COMMANDS)]
        if action.isEnabled():
            action.trigger()

    def drag(self) -> None:
        self.window.tools.choose(self.random.choice(list(Tool)))
        seconds = self.random.uniform(*self.window.timeline.view)
        drag_curve(
            self.window, self.random.randrange(len(CONTROLS)), seconds, self.random.randint(-25, 25)
        )

    def band(self) -> None:
        bar = self.editor.curves.range_bar
        start = QPoint(self.random.randrange(bar.width()), 8)
        stop = QPoint(self.random.randrange(bar.width()), 8)
        self._press_and_move(bar, start, stop)

    def _press_and_move(self, widget: QWidget, start: QPoint, stop: QPoint) -> None:
        drag(widget, start, stop)

    def choose(self) -> None:
        count = len(self.editor.edits.model.edits)
        if count:
            self.editor.edits.select(self.random.randrange(count))

    def weaken(self) -> None:
        slider = self.random.choice((self.editor.edits.strength, self.editor.settings_bar.natural))
        if slider.isEnabled():
            slider.setSliderDown(True)
            slider.setSliderPosition(self.random.randrange(slider.maximum()))
            slider.setSliderDown(False)


def exported(window: MainWindow) -> bytes:
    """What the take would be as a file; the window is not told."""
    session = window.document.session
    assert session is not None
    session.live.work(None)
    return session.clip_weights().tobytes()


@pytest.mark.timeout(400)
@pytest.mark.parametrize("seed", [1, 2])
def test_undo_all_and_redo_all(bench: Bench, monkeypatch: pytest.MonkeyPatch, seed: int) -> None:
    monkeypatch.setattr(dialogs, "ask_preset_name", lambda _w: None)
    window = bench.window(shipped("assets/demo_take.csv") if seed == 1 else bench.take)
    session = window.document.session
    assert session is not None
    untouched = exported(window)
    monkey = Monkey(window, seed)
    for _ in range(STEPS):
        monkey.act()
    window.workspace.end_gestures()
    reached, steps = exported(window), 0
    state = session.state
    while session.can_undo:
        window.actions_["undo"].trigger()
        steps += 1
        assert steps <= 2 * STEPS
    assert session.edits == ()
    assert exported(window) == untouched
    while session.can_redo:
        window.actions_["redo"].trigger()
    assert steps > 20
    assert exported(window) != untouched or not state.edits
    while session.can_redo:
        window.actions_["redo"].trigger()
    assert session.state == state
    assert exported(window) == reached
