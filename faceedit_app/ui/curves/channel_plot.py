"""The plot of one channel: its weight or rotation over time, to read, select and draw on."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pyqtgraph as pg
from PySide6.QtCore import QPointF
from PySide6.QtGui import QMouseEvent

from faceedit_app.editing.edits.channels import is_rotation
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.session import EditSession
from faceedit_app.ui.curves import style
from faceedit_app.ui.curves.axes import ValueAxis
from faceedit_app.ui.curves.gestures import Pointer, Span, clamped
from faceedit_app.ui.curves.marks import Playhead, selection_region
from faceedit_app.ui.curves.time_view import Mouse, TimeView
from faceedit_app.ui.curves.tools import DrawDrag
from faceedit_app.ui.state.gap_frames import Values
from faceedit_app.ui.state.timeline import Timeline

_ROOM = 0.06  # of the values, above and below
_DOT = 5.0  # pixels across the dot of a take of a single frame, which has no line
_LEAST_TURN = 5.0  # degrees either way: less would look like movement


class ChannelPlot(pg.PlotItem, Mouse):
    """Draws a channel as tracked and as edited; a drag selects a range, or draws.

    Args:
        timeline: the time axis that it shares.
        channel: its name.
        session: answers whose take it is from.
        draws: whether a drag draws.
    """

    def __init__(
        self,
        timeline: Timeline,
        channel: str,
        session: Callable[[], EditSession | None],
        draws: Callable[[], bool],
    ) -> None:
        self.channel = channel
        self.shown = ""  # its name and the value at the playhead
        self._timeline, self._session, self._draws = timeline, session, draws
        self._drawn: DrawDrag | None = None
        self._selecting: float | None = None  # seconds of the press
        self.view = TimeView(timeline, self)
        super().__init__(viewBox=self.view, axisItems={"left": ValueAxis()}, enableMenu=False)
        self.hideButtons()
        self.hideAxis("bottom")
        self.layout.setContentsMargins(0, 0, 0, 0)  # nothing is dragged beside the plots
        self.view.setLimits(minYRange=0.02)
        self._selection, self._playhead = selection_region(), Playhead()
        self._tracked, self._edited = pg.PlotDataItem(), pg.PlotDataItem()
        self._ratio = 0.0  # dots of the screen in a pixel, for which the pens were made
        self._name = pg.LabelItem(justify="left", color=style.LABEL)
        self._name.setParentItem(self.view)
        self.view.addItem(self._selection, ignoreBounds=True)
        self._edited.setSymbolSize(_DOT)
        self._edited.setSymbolPen(None)
        self._edited.setSymbolBrush(style.color(style.FOCUS))
        for line in (self._tracked, self._edited):
            line.setClipToView(True)
            line.setDownsampling(auto=True, method="peak")
            self.view.addItem(line)
        self.view.addItem(self._playhead, ignoreBounds=True)

    @property
    def is_drawing(self) -> bool:
        """Whether something is being drawn."""
        return self._drawn is not None

    # --- what is shown -----------------------------------------------------------------------

    def show_values(
        self, tracked: tuple[Values, Values], edited: tuple[Values, Values], ratio: float = 1.0
    ) -> None:
        """Show the channel as tracked and as edited.

        Args:
            tracked, edited: times and values of the points, (N,) each.
            ratio: dots of the screen in a pixel.
        """
        if ratio != self._ratio:
            self._ratio = ratio
            self._tracked.setPen(style.in_dots(style.tracked_pen(), ratio))
            self._edited.setPen(style.in_dots(style.face_pen(style.FOCUS), ratio))
        self._tracked.setData(*tracked)
        self._edited.setData(*edited, symbol="o" if len(edited[0]) == 1 else None)
        if self._drawn is None:
            values = tracked[1], edited[1]
            self._fit(float(min(v.min() for v in values)), float(max(v.max() for v in values)))

    def _fit(self, low: float, high: float) -> None:
        if is_rotation(self.channel):
            low, high = min(low, -_LEAST_TURN), max(high, _LEAST_TURN)
        else:
            low, high = min(low, 0.0), max(high, 1.0)
        room = _ROOM * (high - low)
        self.view.setYRange(low - room, high + room, padding=0)

    def show_marks(self, value: float, playhead: float, selection: Span | None) -> None:
        """Show the value at the playhead, the playhead and the selection."""
        shown = f"{value:+.1f}°" if is_rotation(self.channel) else f"{value:.2f}"
        self.shown = f"{self.channel}  {shown}".replace("-", "−")
        self._name.setText(self.shown)
        self._playhead.setValue(playhead)
        self._selection.show_span(selection, style.SELECTED)

    # --- mouse -------------------------------------------------------------------------------

    def _seconds(self, pointer: Pointer) -> float:
        """Where a selection begins or ends at the pointer."""
        scale = self.view.scale_now
        return self._timeline.snap_edge(scale.time_at(clamped(pointer.x, (0.0, scale.width))))

    def pressed(self, pointer: Pointer) -> None:
        """Begin to draw or to select."""
        if not self._draws():
            self._selecting = self._seconds(pointer)
            self._timeline.go_to_time(self._selecting)
            return
        scale = self.view.scale_now
        at = scale.time_at(pointer.x), scale.value_at(pointer.y)
        limits = (-180.0, 180.0) if is_rotation(self.channel) else (0.0, 1.0)
        self._drawn = DrawDrag((), at[0], scale, limits, at, ())

    def dragged(self, pointer: Pointer) -> None:
        """Draw on, or select up to the pointer."""
        if self._selecting is not None:
            now = self._seconds(pointer)
            if now != self._selecting:
                self._timeline.select((self._selecting, now))
            return
        session = self._session()
        if self._drawn is not None and session is not None:
            self._drawn = self._drawn.moved(pointer.x, pointer.y, False)
            if self._drawn.moving:
                session.preview(self._edit(self._drawn))

    def released(self, pointer: Pointer) -> None:
        """Keep what was drawn or selected."""
        self.dragged(pointer)
        self.mouse_lost()

    def double_clicked(self, pointer: Pointer) -> None:
        """Clear the selection."""
        if self._draws():
            self.pressed(pointer)
        else:
            self._timeline.select(None)

    def mouse_lost(self) -> None:
        """End the gesture and keep its result."""
        drawn, self._drawn, self._selecting = self._drawn, None, None
        session = self._session()
        if drawn is not None and drawn.moving and session is not None:
            session.commit()

    def cancel(self) -> None:
        """Drop what is being drawn."""
        drawn, self._drawn, self._selecting = self._drawn, None, None
        session = self._session()
        if drawn is not None and session is not None:
            session.cancel()

    def _edit(self, drawn: DrawDrag) -> Edit:
        fade_in, fade_out = self._timeline.own_falloffs
        points = tuple(zip(*np.round(np.array(drawn.points).T, 5).tolist(), strict=True))
        first, last = points[0][0], points[-1][0]
        return Edit(
            (),
            Op.DRAW,
            first,
            last,
            fade_in,
            falloff_out=None if fade_out == fade_in else fade_out,
            points=points,
            channels=(self.channel,),
        )


class ChannelArea(pg.GraphicsLayoutWidget):
    """Plots one above the other; a press on the line between two is one on the nearer."""

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Begin what the plot does."""
        super().mousePressEvent(self._on_a_plot(event))

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        """The second press."""
        super().mouseDoubleClickEvent(self._on_a_plot(event))

    def _on_a_plot(self, event: QMouseEvent) -> QMouseEvent:
        for pixels in (0, -1, 1):  # the line has two
            way = QPointF(0.0, pixels)
            at = event.position() + way
            if any(isinstance(item, ChannelPlot) for item in self.items(at.toPoint())):
                where, keys = event.globalPosition() + way, event.modifiers()
                return QMouseEvent(event.type(), at, where, event.button(), event.buttons(), keys)
        return event
