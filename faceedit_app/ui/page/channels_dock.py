"""Where all channels are shown: below the page, or in a window of their own."""

from __future__ import annotations

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QDockWidget, QMainWindow

from faceedit_app.ui.page.channels_panel import ChannelsPanel
from faceedit_app.ui.page.editor import Editor

_MOST = 0.36  # of the window's height, at first
_HEIGHT = 300  # pixels
_LEAST = 200  # pixels, at first, to let all curves above be seen
_EDGE = 6  # pixels, at most, between the page and the channels


class ChannelsDock(QDockWidget):
    """All channels. While they lie below the page, its lists leave their height to the face.

    Args:
        window: to which it is added, at its lower edge.
        page: the page above it.
        panel: the channels.
    """

    def __init__(self, window: QMainWindow, page: Editor, panel: ChannelsPanel) -> None:
        super().__init__("All channels", window)
        self.setObjectName("channels")
        self.setWidget(panel)
        self._side, self._search = page.side, panel.search
        page.side.let_fold(True)  # before it takes their height
        self.visibilityChanged.connect(self._share)
        self.topLevelChanged.connect(self._share)
        window.addDockWidget(Qt.DockWidgetArea.BottomDockWidgetArea, self)
        height = min(_HEIGHT, round(_MOST * window.height()))
        spare = page.curves.shown.spare_height - _EDGE
        height = min(height, spare) if spare >= _LEAST else height
        window.resizeDocks([self], [height], Qt.Orientation.Vertical)
        self.show()  # at once: what is not visible cannot have the focus

    def switch(self) -> None:
        """Show or hide them."""
        is_shown = self.isHidden()
        self._side.let_fold(is_shown and not self.isFloating())
        self.setVisible(is_shown)

    def focus_search(self) -> None:
        """Let what is typed next find a channel, rather than be a shortcut."""
        self.activateWindow()  # they may be in a window of their own
        self._search.setFocus(Qt.FocusReason.ShortcutFocusReason)

    def _share(self) -> None:
        self._side.let_fold(not self.isHidden() and not self.isFloating())
