"""The bar of tools: what a drag does, and whether left and right go together."""

from __future__ import annotations

from PySide6.QtCore import QSignalBlocker, QSize, Qt
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QLayout, QMenu, QSlider, QToolButton, QWidget

from faceedit_app.editing.help.presets import shipped_presets
from faceedit_app.ui.look.widgets import bar_row, caption, divider, icon_button
from faceedit_app.ui.state.actions import Actions
from faceedit_app.ui.state.tools import SMOOTH_RANGE, Tool, Tooling

TOOL_COMMANDS = {f"tool_{tool}": tool for tool in Tool}


class ToolBar(QWidget):
    """Tools, the smoothing tool's strength, and the link of left and right."""

    def __init__(self, actions: Actions, tooling: Tooling) -> None:
        super().__init__()
        self._actions, self._tooling = actions, tooling
        self.smooth = self._slider()
        self._row = row = bar_row(self, "tools")
        self.tools = [icon_button(actions[name], "tool", _SHORT[name]) for name in TOOL_COMMANDS]
        for button in self.tools:
            row.addWidget(button)
        self._strength = caption("Strength", self.smooth)
        row.addWidget(self._strength)
        row.addWidget(self.smooth)
        row.addWidget(divider())
        row.addWidget(icon_button(actions["link"], "tool", "Left = right"))
        row.addWidget(divider())
        self.fixes = [
            icon_button(actions[f"fix_{fix.id}"], "tool", fix.name)
            for fix in shipped_presets()
            if fix.has_button
        ]
        for button in self.fixes:
            row.addWidget(button)
        row.addWidget(self._more(actions))
        row.addStretch()
        # In a narrow window words give way to icons, rather than the window being widened.
        row.setSizeConstraint(QLayout.SizeConstraint.SetNoConstraint)
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

    @staticmethod
    def _more(actions: Actions) -> QToolButton:
        """The fixes that have no button of their own, and the user's presets."""
        menu = QMenu()
        for fix in shipped_presets():
            if not fix.has_button:
                menu.addAction(actions[f"fix_{fix.id}"])
        menu.addAction(actions["mood"])
        menu.addSeparator()
        menu.addMenu(actions.presets_menu)
        menu.addAction(actions["save_preset"])
        button = QToolButton()
        button.setObjectName("tool")
        button.setText("More ▾")
        button.setToolTip("More fixes, and your own presets")
        button.setMenu(menu)
        menu.setParent(button, menu.windowFlags())
        button.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        button.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        return button

    def minimumSizeHint(self) -> QSize:
        """Room for the icons; words are added where there is more."""
        return QSize(600, super().minimumSizeHint().height())

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Words where there is room for them: of the fixes first."""
        super().resizeEvent(event)
        self._fit()

    def _fit(self) -> None:
        style = Qt.ToolButtonStyle
        for words in ((True, True), (False, True), (False, False)):
            for buttons, spelled in zip((self.tools, self.fixes), words, strict=True):
                for button in buttons:
                    button.setToolButtonStyle(
                        style.ToolButtonTextBesideIcon if spelled else style.ToolButtonIconOnly
                    )
            if self._row.sizeHint().width() <= self.width():
                return

    def sync(self) -> None:
        """Show what is chosen."""
        for name, tool in TOOL_COMMANDS.items():
            self._actions[name].setChecked(tool is self._tooling.tool)
        self._actions["link"].setChecked(self._tooling.linked)
        smooths = self._tooling.tool is Tool.SMOOTH
        self._strength.setVisible(smooths)
        self.smooth.setVisible(smooths)
        self._fit()
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
