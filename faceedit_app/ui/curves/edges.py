"""The selection's four edges: which one is under the pointer, and what dragging it does."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum

from faceedit_app.ui.curves.gestures import FINE, Span, clamped
from faceedit_app.ui.curves.scale import Interval, Scale

GRASP = 5.0  # pixels on either side of an edge within which it is grabbed
_MIDDLE = 2.5  # pixels on either side of a short hold's middle within which it is moved


class Edge(Enum):
    """A part of the selection that can be dragged; `BODY` is all of it."""

    FADE_IN = "fade in"
    START = "start"
    END = "end"
    FADE_OUT = "fade out"
    BODY = "body"


def edge_times(span: Span) -> dict[Edge, float]:
    """The times of the four edges, in seconds."""
    return {
        Edge.START: span.start,
        Edge.END: span.end,
        Edge.FADE_IN: span.ends[0],
        Edge.FADE_OUT: span.ends[1],
    }


def edge_at(x: float, scale: Scale, span: Span) -> Edge | None:
    """The edge nearest to a pixel, if any; of equals, the one on the pixel's side.

    The edge of a falloff of 0 lies on the hold's; outside both, the falloff's is grabbed.
    """
    found = {edge: scale.x_of(at) - x for edge, at in edge_times(span).items()}
    near = {edge: apart for edge, apart in found.items() if abs(apart) <= GRASP}
    if not near:
        return None
    nearest = min(abs(apart) for apart in near.values())
    tied = [edge for edge, apart in near.items() if abs(apart) <= nearest + 0.5]
    outside = Edge.FADE_IN if x < scale.x_of(span.start) else Edge.FADE_OUT
    if outside in tied and (x < scale.x_of(span.start) or x > scale.x_of(span.end)):
        return outside
    if Edge.START in tied and Edge.END in tied:
        return Edge.END if near[Edge.END] <= 0 else Edge.START
    return tied[0]


def part_at(x: float, scale: Scale, span: Span) -> Edge | None:
    """What a press on a span that is drawn as a shape would grab: its middle, an edge, or nothing.

    A hold of a moment or two has no room between its handles: there the middle of the handles moves
    it, their sides make it longer, and the slopes of its falloffs move it as well.
    """
    first, last = scale.x_of(span.start), scale.x_of(span.end)
    is_short = last - first <= 2 * GRASP
    if is_short and abs(x - 0.5 * (first + last)) <= _MIDDLE:
        return Edge.BODY
    edge = edge_at(x, scale, span)
    if edge is not None:
        return edge
    begin, finish = span.ends if is_short else (span.start, span.end)
    return Edge.BODY if begin < scale.time_at(x) < finish else None


@dataclass(frozen=True)
class EdgeDrag:
    """An edge, or the whole selection, held by the mouse.

    Attributes:
        edge: what is held.
        before: the selection at the press, for Esc.
        limits: first and last second of the take.
        span: the selection now.
        at: seconds under the pointer.
        place: seconds of the edge; differs from the pointer after fine moves.
    """

    edge: Edge
    before: Span
    limits: Interval
    span: Span
    at: float
    place: float

    def moved(self, seconds: float, fine: bool, frame: float | None = None) -> EdgeDrag:
        """The pointer moved to a time; `frame` is the time of the nearest frame, to snap to."""
        place = self.place + (seconds - self.at) * (FINE if fine else 1.0)
        target = place if frame is None else frame
        span = _dragged(self.edge, self.before, self.limits, target, self.press)
        return replace(self, span=span, at=seconds, place=place)

    @property
    def press(self) -> float:
        """Seconds of the held edge, or of the selection's start, at the press."""
        return _place_of(self.edge, self.before)


def press_edge(edge: Edge, span: Span, seconds: float, limits: Interval) -> EdgeDrag:
    """Begin to drag an edge."""
    return EdgeDrag(edge, span, limits, span, seconds, _place_of(edge, span))


def _place_of(edge: Edge, span: Span) -> float:
    times = edge_times(span)
    return times.get(edge, span.start)


def _dragged(edge: Edge, span: Span, limits: Interval, to: float, was: float) -> Span:
    first, last = limits
    fade_out = span.fade_out
    # The handle of a falloff of 0 lies on the hold's: pulled inwards, it takes the hold along.
    if edge is Edge.FADE_IN and span.falloff == 0 and to > span.start:
        edge = Edge.START
    elif edge is Edge.FADE_OUT and fade_out == 0 and to < span.end:
        edge = Edge.END
    match edge:
        case Edge.START:
            return replace(span, start=clamped(to, (first, span.end)), falloff_out=fade_out)
        case Edge.END:
            return replace(span, end=clamped(to, (span.start, last)), falloff_out=fade_out)
        case Edge.FADE_IN:
            return replace(span, falloff=max(span.start - to, 0.0), falloff_out=fade_out)
        case Edge.FADE_OUT:
            return replace(span, falloff_out=max(to - span.end, 0.0))
        case Edge.BODY:
            shift = clamped(to - was, (first - span.start, last - span.end))
            return replace(span, start=span.start + shift, end=span.end + shift)
