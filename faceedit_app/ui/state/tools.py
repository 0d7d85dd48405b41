"""The chosen tool, the brush strength, and whether left and right are linked."""

from __future__ import annotations

from enum import StrEnum

from PySide6.QtCore import QObject, Signal

SMOOTH_RANGE = (0.01, 0.5)  # seconds
DEFAULT_SMOOTH = 0.06


class Tool(StrEnum):
    """What a drag on a curve does."""

    MOVE = "move"
    DRAW = "draw"
    SMOOTH = "smooth"
    SCALE = "scale"
    FLATTEN = "flatten"
    RESTORE = "restore"
    RETIME = "retime"


class Tools(QObject):
    """The current choice, which views follow.

    Signals:
        changed(): tool, link or brush strength changed.
    """

    changed = Signal()

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.tool = Tool.MOVE
        self.linked = True
        self.smooth = DEFAULT_SMOOTH

    def choose(self, tool: Tool) -> None:
        """Choose a tool."""
        if tool != self.tool:
            self.tool = tool
            self.changed.emit()

    def link(self, linked: bool) -> None:
        """Link or unlink left and right."""
        if linked != self.linked:
            self.linked = linked
            self.changed.emit()

    def set_smooth(self, seconds: float) -> None:
        """Set the brush strength of the Smooth tool, in seconds."""
        seconds = min(max(seconds, SMOOTH_RANGE[0]), SMOOTH_RANGE[1])
        if seconds != self.smooth:
            self.smooth = seconds
            self.changed.emit()
