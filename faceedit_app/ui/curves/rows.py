"""The rows of the curves panel: they share the height, and scroll if it is too small."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from itertools import pairwise

from PySide6.QtCore import QCoreApplication, QEvent, QPoint, QPointF, QRect, QSize, Qt
from PySide6.QtGui import QMouseEvent
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


class _Content(QWidget):
    """The rows; a press on the line between two plots goes to the nearer one."""

    def __init__(self, plots: Sequence[CurvePlot]) -> None:
        super().__init__()
        self._plots = plots
        self._held: tuple[QWidget, QPointF] | None = None  # a plot's viewport, and how far it is

    def _nearer(self, at: QPoint) -> tuple[QWidget, QPointF] | None:
        """The plot beside a place between two, and the way to it."""
        if self.childAt(at) is not None:  # an event that a row did not want
            return None
        for way in (QPoint(0, -1), QPoint(0, 1)):
            beside = self.childAt(at + way)
            plots = [plot.viewport() for plot in self._plots if plot.isEnabled()]
            if beside is not None and beside in plots:
                return beside, QPointF(way)
        return None

    def _pass_on(self, event: QMouseEvent) -> None:
        """Let the plot have an event, as if it had happened on the plot's edge."""
        held, self._held = self._held, None  # what the plot does not want comes back here
        if held is None:
            event.ignore()
            return
        plot, way = held
        at, where = plot.mapFrom(self, event.position() + way), event.globalPosition() + way
        keys = event.button(), event.buttons(), event.modifiers()
        QCoreApplication.sendEvent(plot, QMouseEvent(event.type(), at, where, *keys))
        if event.buttons():
            self._held = held

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Find the plot for all that follows, unless another button is held already."""
        if event.buttons() == event.button():
            self._held = self._nearer(event.position().toPoint())
        self._pass_on(event)

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        """The second press."""
        self.mousePressEvent(event)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Go on with the plot's gesture."""
        self._pass_on(event)

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """End the plot's gesture."""
        self._pass_on(event)


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
        content = _Content(plots)
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

    def minimumSizeHint(self) -> QSize:
        """A whole row, and part of another, which shows that there are more."""
        height = 3 * style.ROW_HEIGHT // 2 + style.ROW_GAP
        return QSize(super().minimumSizeHint().width(), height)

    def show_rows(self, shown: Collection[str]) -> None:
        """Show the rows of these controls, which share the height, and hide the others."""
        for row, (header, plot) in self._pairs.items():
            is_shown = plot.control.id in shown
            self._grid.setRowStretch(row, int(is_shown))  # a hidden row keeps its share otherwise
            header.setVisible(is_shown)
            plot.setVisible(is_shown)

    @property
    def spare_height(self) -> int:
        """Pixels that the rows could do without and still all be seen; below 0: they scroll."""
        return self.viewport().height() - self._grid.totalMinimumSize().height()

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
