"""The toolbar: the tool, the brush strength, the link of left and right, and fixes."""

from __future__ import annotations

from PySide6.QtCore import QSignalBlocker, QSize, Qt, QTimer
from PySide6.QtGui import QAction, QCursor, QResizeEvent
from PySide6.QtWidgets import QLayout, QMenu, QToolButton, QWidget

from faceedit_app.editing.help.presets import shipped_presets
from faceedit_app.ui.look.gesture_slider import Slider
from faceedit_app.ui.look.widgets import bar_row, caption, divider, icon_button
from faceedit_app.ui.state.actions import Actions
from faceedit_app.ui.state.tools import DEFAULT_SMOOTH, SMOOTH_RANGE, Tool, Tools


class ToolBar(QWidget):
    """Buttons for the tools and fixes, and the brush strength of the Smooth tool."""

    def __init__(self, actions: Actions, tools: Tools) -> None:
        super().__init__()
        self._tools = tools
        self.smooth = self._slider()
        self._row = row = bar_row(self, "tools")
        self.tool_buttons = [_spelled(actions[f"tool_{tool}"]) for tool in Tool]
        for button in self.tool_buttons:
            row.addWidget(button)
        self._strength = caption("Smoothing", self.smooth)
        row.addWidget(divider())
        row.addWidget(_spelled(actions["link"]))
        row.addWidget(divider())
        self.fix_buttons = [
            _spelled(actions[f"fix_{preset.id}"])
            for preset in shipped_presets()
            if preset.has_button
        ]
        for button in self.fix_buttons:
            row.addWidget(button)
        row.addWidget(self._more(actions))
        row.addStretch()
        # At the end, where it pushes no other button about when it appears.
        row.addWidget(self._strength)
        row.addWidget(self.smooth)
        # In a narrow window, labels give way to icons.
        row.setSizeConstraint(QLayout.SizeConstraint.SetNoConstraint)
        tools.changed.connect(self.sync)
        self.sync()

    def _slider(self) -> Slider:
        low, high, start = (round(1000 * seconds) for seconds in (*SMOOTH_RANGE, DEFAULT_SMOOTH))
        slider = Slider(low, high, start=start, page=50)
        slider.setFixedWidth(80)
        slider.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        slider.setToolTip("Smoothing: over how many milliseconds the Smooth tool smooths")
        slider.valueChanged.connect(lambda value: self._tools.set_smooth(value / 1000))
        return slider

    @staticmethod
    def _more(actions: Actions) -> QToolButton:
        """A menu of the fixes without a button, and of the user's presets."""
        menu = QMenu()
        for fix in shipped_presets():
            if not fix.has_button:
                menu.addAction(actions[f"fix_{fix.id}"])
        menu.addAction(actions["expression"])
        menu.addAction(actions["fill"])
        menu.addSeparator()
        menu.addMenu(actions.submenu("presets"))
        menu.addAction(actions["save_preset"])
        button = QToolButton()
        button.setObjectName("tool")
        button.setText("More ▾")
        button.setToolTip("More fixes, and your own presets")
        button.setMenu(menu)
        menu.setParent(button, menu.windowFlags())

        def unlight() -> None:
            """Qt gives the button no leave event while a menu is open."""
            under = button.rect().contains(button.mapFromGlobal(QCursor.pos()))
            button.setAttribute(Qt.WidgetAttribute.WA_UnderMouse, under)
            button.setDown(False)
            button.update()

        menu.aboutToHide.connect(lambda: QTimer.singleShot(0, button, unlight))
        button.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        button.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        return button

    def minimumSizeHint(self) -> QSize:
        """Room for the icons; labels need more."""
        return QSize(600, super().minimumSizeHint().height())

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Show labels if there is room, those of the fixes first."""
        super().resizeEvent(event)
        self._fit()

    def _fit(self) -> None:
        style = Qt.ToolButtonStyle
        for words in ((True, True), (False, True), (False, False)):
            for buttons, spelled in zip((self.tool_buttons, self.fix_buttons), words, strict=True):
                for button in buttons:
                    button.setToolButtonStyle(
                        style.ToolButtonTextBesideIcon if spelled else style.ToolButtonIconOnly
                    )
            if self._row.sizeHint().width() <= self.width():
                return

    def sync(self) -> None:
        """Show what is chosen."""
        smooths = self._tools.tool is Tool.SMOOTH
        self._strength.setVisible(smooths)
        self.smooth.setVisible(smooths)
        self._fit()
        with QSignalBlocker(self.smooth):
            self.smooth.setValue(round(1000 * self._tools.smooth))
        self.smooth.setToolTip(f"Smoothing: over {1000 * self._tools.smooth:.0f} ms")


def _spelled(action: QAction) -> QToolButton:
    """A button with the label of its menu entry."""
    return icon_button(action, "tool", action.text().replace("&", ""))
