"""The rows of the curves panel: they share the height, and scroll if it is too small."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from itertools import pairwise

from PySide6.QtCore import QCoreApplication, QEvent, QRect, Qt
from PySide6.QtWidgets import QFrame, QGridLayout, QScrollArea, QWidget

from faceedit_app.ui.curves import style
from faceedit_app.ui.curves.group_head import GroupHead
from faceedit_app.ui.curves.header import Header
from faceedit_app.ui.curves.plot import CurvePlot


class _Grid(QGridLayout):
    """Rows of nearly the same height, whose headers are laid out alike."""

    def __init__(self, content: QWidget, headers: Sequence[Header]) -> None:
        super().__init__(content)
        self._headers = headers

    def setGeometry(self, rect: QRect) -> None:
        """Place the rows, and tell their headers how high the lowest one is."""
        super().setGeometry(rect)
        shown = [header for header in self._headers if not header.isHidden()]
        for header in shown:
            header.match_rows(min(other.height() for other in shown))


class CurveRows(QScrollArea):
    """A header and a plot for each control; any of them may be hidden.

    Optional controls come last, under the head of their group.

    The scroll bar, if there is one, replaces the margin on the right, so that plots stay as wide
    as the ruler.
    """

    def __init__(
        self,
        headers: Sequence[Header],
        plots: Sequence[CurvePlot],
        head: GroupHead,
        parent: QWidget | None = None,
    ) -> None:
        super().__init__(parent)
        # Optional ones last; the head of the group is the row between.
        pairs = sorted(zip(headers, plots, strict=True), key=lambda pair: pair[1].control.optional)
        main = sum(not plot.control.optional for plot in plots)
        self._pairs = {row + (row >= main): pair for row, pair in enumerate(pairs)}
        content = QWidget()
        self.setWidget(content)
        self._grid = _Grid(content, headers)
        self._grid.setHorizontalSpacing(0)
        self._grid.setVerticalSpacing(style.ROW_GAP)
        self._grid.addWidget(head, main, 0, 1, 2)
        for row, (header, plot) in self._pairs.items():
            self._grid.addWidget(header, row, 0)
            self._grid.addWidget(plot, row, 1)
            self._grid.setRowStretch(row, 1)
        self._grid.setColumnStretch(1, 1)
        stops: list[QWidget] = [plot for _, plot in pairs]
        stops.insert(main, head)
        for one, following in pairwise(stops):
            QWidget.setTabOrder(one, following)
        self.setWidgetResizable(True)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        bar = self.verticalScrollBar()
        bar.setStyleSheet(f"QScrollBar {{ width: {style.RIGHT_MARGIN}px; }}")
        bar.rangeChanged.connect(self._keep_width)
        self._keep_width(0, 0)

    def show_rows(self, shown: Collection[str]) -> None:
        """Show the rows of these controls, which share the height, and hide the others."""
        for row, (header, plot) in self._pairs.items():
            is_shown = plot.control.id in shown
            self._grid.setRowStretch(row, int(is_shown))  # a hidden row keeps its share otherwise
            header.setVisible(is_shown)
            plot.setVisible(is_shown)

    def scroll_to(self, controls: Collection[str]) -> None:
        """Scroll the rows of these controls into view, the first of them at least."""
        if not self.isVisible():  # a window that opens shows its first rows
            return
        # Rows that have just been shown have no place yet: measure them now.
        QCoreApplication.sendEvent(self, QEvent(QEvent.Type.LayoutRequest))
        self._grid.activate()
        rows = [plot for _, plot in self._pairs.values() if plot.control.id in controls]
        for plot in reversed(rows):  # `ensureWidgetVisible` looks only at a view's text cursor
            self.ensureVisible(0, plot.geometry().bottom() + 1, 0, 0)
            self.ensureVisible(0, plot.geometry().top(), 0, 0)

    def _keep_width(self, _first: int, last: int) -> None:
        self._grid.setContentsMargins(0, 0, 0 if last else style.RIGHT_MARGIN, 0)
