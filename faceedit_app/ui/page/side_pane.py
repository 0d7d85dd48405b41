"""What is beside the curves: the face, and under it the lists, which can be folded."""

from __future__ import annotations

from PySide6.QtCore import Qt
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QSplitter, QTabWidget, QWidget

_LEAST_FACE = 280  # pixels; with less, folded lists leave their height to the face


class SidePane(QSplitter):
    """Face above lists; on request, lists fold to their tabs where the face has little height.

    A click on a tab unfolds them.

    Args:
        stage: the face, with its film.
        lists: the tabs under it.
    """

    def __init__(self, stage: QWidget, lists: QTabWidget) -> None:
        super().__init__(Qt.Orientation.Vertical)
        self.setChildrenCollapsible(False)
        self.setHandleWidth(6)
        self.addWidget(stage)
        self.addWidget(lists)
        self.setStretchFactor(0, 1)
        self._lists = lists
        lists.tabBarClicked.connect(self.unfold)
        self._may_fold = self.is_folded = False
        self._height = 0  # of the unfolded lists

    def let_fold(self, may_fold: bool) -> None:
        """Fold the lists as soon as the face has little height, or never."""
        if may_fold and not self._may_fold:
            self._height = self.sizes()[1]
        self._may_fold = may_fold

    def unfold(self) -> None:
        """Show the lists again."""
        self._may_fold = False
        self._arrange()

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Fold or unfold as the height allows."""
        super().resizeEvent(event)
        self._arrange()

    def _arrange(self) -> None:
        total = sum(self.sizes())
        folds = self._may_fold and total - self._height < _LEAST_FACE
        if folds != self.is_folded:
            self.is_folded = folds
            tabs = self._lists.tabBar().sizeHint().height()
            self._lists.setMinimumHeight(tabs if folds else 0)  # 0: as high as the lists need
            self.setSizes([total, 0] if folds else [total - self._height, self._height])
