"""The bar of tools: what a drag does, and whether left and right go together."""

from __future__ import annotations

from PySide6.QtCore import QSignalBlocker, Qt
from PySide6.QtWidgets import QSlider, QWidget

from faceedit_app.ui.actions import Actions
from faceedit_app.ui.tooling import SMOOTH_RANGE, Tool, Tooling
from faceedit_app.ui.widgets import bar_row, caption, divider, icon_button

TOOL_COMMANDS = {f"tool_{tool}": tool for tool in Tool}


class ToolBar(QWidget):
    """Tools, the smoothing tool's strength, and the link of left and right."""

    def __init__(self, actions: Actions, tooling: Tooling) -> None:
        super().__init__()
        self._actions, self._tooling = actions, tooling
        self.smooth = self._slider()
        row = bar_row(self, "tools")
        for name in TOOL_COMMANDS:
            row.addWidget(icon_button(actions[name], "tool", _SHORT[name]))
        self._strength = caption("Strength", self.smooth)
        row.addWidget(self._strength)
        row.addWidget(self.smooth)
        row.addWidget(divider())
        row.addWidget(icon_button(actions["link"], "tool", "Left = right"))
        row.addWidget(divider())
        self.row = row
        tooling.changed.connect(self.sync)
        self.sync()

    def _slider(self) -> QSlider:
        slider = QSlider(Qt.Orientation.Horizontal)
        slider.setRange(*(round(1000 * seconds) for seconds in SMOOTH_RANGE))
        slider.setPageStep(50)
        slider.setFixedWidth(80)
        slider.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        slider.setToolTip("How strongly the smoothing tool smooths, in thousandths of a second")
        slider.valueChanged.connect(lambda value: self._tooling.set_smooth(value / 1000))
        return slider

    def sync(self) -> None:
        """Show what is chosen."""
        for name, tool in TOOL_COMMANDS.items():
            self._actions[name].setChecked(tool is self._tooling.tool)
        self._actions["link"].setChecked(self._tooling.linked)
        smooths = self._tooling.tool is Tool.SMOOTH
        self._strength.setVisible(smooths)
        self.smooth.setVisible(smooths)
        with QSignalBlocker(self.smooth):
            self.smooth.setValue(round(1000 * self._tooling.smooth))
        self.smooth.setToolTip(f"Smooths over {1000 * self._tooling.smooth:.0f} ms")


_SHORT = {
    "tool_move": "Move",
    "tool_draw": "Draw",
    "tool_smooth": "Smooth",
    "tool_scale": "Scale",
    "tool_flatten": "Flatten",
    "tool_restore": "Back to tracked",
}
