"""The mouse on the selection's edges, wherever they are drawn."""

from __future__ import annotations

from dataclasses import replace

from PySide6.QtCore import QObject, Signal

from faceedit_app.ui.curves.edges import GRASP, Edge, EdgeDrag, edge_at, press_edge
from faceedit_app.ui.curves.gestures import Pointer, Span, clamped, span_at
from faceedit_app.ui.curves.scale import Interval, Scale
from faceedit_app.ui.state.timeline import Timeline

_LEAST_WIDTH = 8 * GRASP  # pixels of an edit whose edges are grabbed on the plots


class SelectionMouse(QObject):
    """Drags the selection's edges: start and end of the hold, and the falloffs around it.

    Signals:
        taken(): an edge was grabbed.
        moved(): an edge moved.
        ended(): it was released, or the drag cancelled.
    """

    taken = Signal()
    moved = Signal()
    ended = Signal()

    def __init__(self, timeline: Timeline, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._timeline = timeline
        self._drag: EdgeDrag | None = None
        self._placing = False

    @property
    def span(self) -> Span | None:
        """The selection with its falloffs."""
        line = self._timeline
        if line.selection is None:
            return None
        return Span(*line.selection, line.falloff, line.falloff_out)

    @property
    def is_dragging(self) -> bool:
        """Whether an edge is held."""
        return self._drag is not None

    @property
    def is_changing(self) -> bool:
        """Whether an edge is held, or is just being set by numbers."""
        return self.is_dragging or self._placing

    def place(self, span: Span) -> None:
        """Set all edges by numbers."""
        self._placing = True
        self._show(self._softened(self.span, span))
        self.ended.emit()
        self._placing = False

    @property
    def held(self) -> Edge | None:
        """The edge that is held."""
        return self._drag.edge if self._drag is not None else None

    def edge_under(self, scale: Scale, x: float) -> Edge | None:
        """The edge that a press at a pixel would grab."""
        span = self.span
        return edge_at(x, scale, span) if span is not None else None

    def edge_on_plot(self, scale: Scale, x: float) -> Edge | None:
        """The edge that a press on a plot would grab; those of a short edit are on the bar only."""
        line = self._timeline
        if line.own_selection is None and line.selection is not None:
            width = (line.selection[1] - line.selection[0]) / scale.seconds_per_pixel
            if width < _LEAST_WIDTH:
                return None
        return self.edge_under(scale, x)

    def span_at(self, seconds: float, slack: float) -> Span:
        """The span that a press on a plot edits: of the selection, of the chosen edit, or new.

        Args:
            seconds: the time of the press.
            slack: seconds by which it may miss the chosen edit.
        """
        line = self._timeline
        if line.own_selection is None and not self._is_in_chosen(seconds, slack):
            return Span(seconds, seconds, *line.own_falloffs)
        return span_at(seconds, line.selection, line.falloff, line.falloff_out)

    def _is_in_chosen(self, seconds: float, slack: float) -> bool:
        """Whether a time is in the hold of the chosen edit, if that is a part of the take."""
        line = self._timeline
        if not line.shows_edit or line.selection is None:
            return False
        start, end = line.selection
        is_part = end - start < line.duration - 2 * slack
        return is_part and start - slack <= seconds <= end + slack

    def press(self, scale: Scale, x: float) -> bool:
        """Grab the edge at a pixel, if there is one."""
        edge = self.edge_under(scale, x)
        if edge is not None:
            self.grab(edge, scale.time_at(x))
        return edge is not None

    def grab(self, edge: Edge, seconds: float) -> None:
        """Grab an edge, or the whole selection, at a time."""
        span = self.span
        if span is not None:
            self._drag = press_edge(edge, span, seconds, self._limits)
            self.taken.emit()

    def move(self, scale: Scale, pointer: Pointer) -> None:
        """Move the edge; it may snap to frames."""
        if self._drag is None:
            return
        seconds = scale.time_at(clamped(pointer.x, (0.0, scale.width)))
        frame = self._timeline.snap_edge(seconds) if pointer.snap else None
        self._drag = self._drag.moved(seconds, pointer.fine, frame)
        self._show(self._softened(self._drag.before, self._drag.span))

    def release(self) -> None:
        """Release the edge where it is."""
        if self._drag is not None:
            self._drag = None
            self.ended.emit()

    def cancel(self) -> None:
        """Put the edge back."""
        if self._drag is not None:
            self._show(self._drag.before)
            self._drag = None
            self.ended.emit()

    @property
    def _limits(self) -> Interval:
        """First and last second of the take."""
        return 0.0, self._timeline.snap(self._timeline.duration)

    def _softened(self, before: Span | None, span: Span) -> Span:
        """A changed span; an end of the chosen edit that leaves the take's end fades."""
        line = self._timeline
        if before is None or not line.shows_edit or not line.can_fade:
            return span
        was, now = (before.start, before.end), (span.start, span.end)
        fade_in, fade_out = line.softened(was, now, (span.falloff, span.fade_out))
        return replace(span, falloff=fade_in, falloff_out=fade_out)

    def _show(self, span: Span) -> None:
        self._timeline.set_falloffs(span.falloff, span.fade_out)
        self._timeline.select((span.start, span.end))
        self.moved.emit()
