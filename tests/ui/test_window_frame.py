"""The frame that the window system adds to the window stays on the screen."""

from __future__ import annotations

import pytest
from PySide6.QtCore import QRect

from faceedit_app.ui.start.window_base import framed_within

ROOM = QRect(0, 30, 1280, 770)  # below a panel
SIDE, TITLE, FOOT = 1, 20, 5


@pytest.mark.parametrize(
    ("before", "after"),
    [
        (QRect(101, 150, 1000, 600), QRect(101, 150, 1000, 600)),
        # As large as the screen: smaller by the frame.
        (QRect(1, 50, 1280, 766), QRect(1, 50, 1278, 745)),
        # Restored a few pixels lower than it was.
        (QRect(1, 55, 1278, 745), QRect(1, 50, 1278, 745)),
        (QRect(280, 150, 1000, 600), QRect(279, 150, 1000, 600)),
        # Moved away by the user, on a screen at the left, and on both.
        (QRect(700, 400, 1000, 600), QRect(700, 400, 1000, 600)),
        (QRect(-600, 150, 1000, 600), QRect(-600, 150, 1000, 600)),
        (QRect(-600, 150, 1800, 600), QRect(-600, 150, 1800, 600)),
    ],
)
def test_a_window_moves_only_as_far_as_its_frame_leaves_the_screen(
    before: QRect, after: QRect
) -> None:
    frame = before.adjusted(-SIDE, -TITLE, SIDE, FOOT)
    assert framed_within(before, frame, ROOM) == after
