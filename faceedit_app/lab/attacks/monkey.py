"""Uses the window at random, with mouse and keys and by its commands, as no user would."""

from __future__ import annotations

import random
from collections import deque
from collections.abc import Callable

from faceedit_app.lab.attacks import gestures as on
from faceedit_app.lab.attacks import list_gestures as lists
from faceedit_app.lab.attacks.hands import Hands
from faceedit_app.ui.start.window import MainWindow

_REMEMBERED = 10  # gestures, for messages
_OFTEN = 3  # times as often as others
_FIRST = 0.5  # of the gestures are commands that have not been used yet, while there are any
# Each gesture, and how often it is made.
_GESTURES: tuple[tuple[Callable[[Hands], object], int], ...] = (
    (Hands.run_command, 4 * _OFTEN),
    (on.drag_curve, 3 * _OFTEN),
    (on.drag_strip, _OFTEN),
    (on.drag_handle, _OFTEN),
    (on.move_selection, _OFTEN),
    (on.press_key, _OFTEN),
    (on.travel, 1),
    (on.turn_wheel, 2),
    (on.double_click, 1),
    (on.choose_from_menu, 1),
    (on.set_exactness, 1),
    (on.zoom, 2),
    (on.play, 1),
    (on.resize, 1),
    (on.lose_mouse, 1),
    (on.switch_character, 1),
    (lists.choose_edit, _OFTEN),
    (lists.set_strength, 2),
    (lists.type_in_list, 2),
    (lists.drag_row, 1),
    (lists.click_in_list, 1),
    (lists.open_tab, 2),
    (lists.edit_channels, _OFTEN),
    (lists.use_settings, 1),
)


class Monkey:
    """Acts on a window with an open take.

    Attributes:
        done: what it did last, for messages, the newest at the end.
    """

    def __init__(self, window: MainWindow, chance: random.Random) -> None:
        self._hands, self._chance = Hands(window, chance), chance
        self.done: deque[str] = deque(maxlen=_REMEMBERED)

    @property
    def said(self) -> str:
        """What it did last, for messages."""
        return f"“{', '.join(self.done)}”"

    def act(self) -> None:
        """Do one thing that a user can do."""
        gesture = self._chosen()
        self.done.append(gesture.__name__)
        name = gesture(self._hands)
        if isinstance(name, str):
            self.done[-1] = f"{gesture.__name__} {name}"
        lists.use_dialogs(self._hands)

    def _chosen(self) -> Callable[[Hands], object]:
        """A gesture; at first, every other one is a command that has not been used yet.

        So all that is loaded when it is first used is there after some hundred gestures, and what
        grows later is a leak.
        """
        if self._hands.unused and self._chance.random() < _FIRST:
            return Hands.run_unused_command
        kinds = [gesture for gesture, _ in _GESTURES]
        return self._chance.choices(kinds, [often for _, often in _GESTURES])[0]
