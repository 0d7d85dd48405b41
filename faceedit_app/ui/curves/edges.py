"""The time selection's four edges: which one the pointer is at, and what dragging it does."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum

from faceedit_app.ui.curves.axes import Scale, Span
from faceedit_app.ui.curves.gestures import FINE, Brush

GRASP = 5.0  # pixels to either side of an edge that grab it


class Edge(Enum):
    """What of the selection is dragged; `BODY` is all of it."""

    FADE_IN = "fade in"
    START = "start"
    END = "end"
    FADE_OUT = "fade out"
    BODY = "body"


def edge_times(band: Brush) -> dict[Edge, float]:
    """Where the four edges stand, in seconds."""
    return {
        Edge.START: band.start,
        Edge.END: band.end,
        Edge.FADE_IN: band.reach[0],
        Edge.FADE_OUT: band.reach[1],
    }


def edge_at(x: float, scale: Scale, band: Brush) -> Edge | None:
    """The edge under a pixel, the nearest if several are; of equals, the one to the pixel's side.

    Where a falloff is 0 its edge lies on the hold's; outside of both, the falloff is grabbed.
    """
    found = {edge: scale.x_of(at) - x for edge, at in edge_times(band).items()}
    near = {edge: apart for edge, apart in found.items() if abs(apart) <= GRASP}
    if not near:
        return None
    nearest = min(abs(apart) for apart in near.values())
    tied = [edge for edge, apart in near.items() if abs(apart) <= nearest + 0.5]
    outside = Edge.FADE_IN if x < scale.x_of(band.start) else Edge.FADE_OUT
    if outside in tied and (x < scale.x_of(band.start) or x > scale.x_of(band.end)):
        return outside
    if Edge.START in tied and Edge.END in tied:
        return Edge.END if near[Edge.END] <= 0 else Edge.START
    return tied[0]


@dataclass(frozen=True)
class EdgeDrag:
    """An edge, or the whole band, held by the mouse.

    Attributes:
        edge: what is held.
        before: the band at the press, for Esc.
        limits: first and last second of the take.
        band: the band now.
        at: seconds under the pointer now.
        place: seconds where the edge is: the pointer, but for fine moves.
    """

    edge: Edge
    before: Brush
    limits: Span
    band: Brush
    at: float
    place: float

    def moved(self, seconds: float, fine: bool, frame: float | None = None) -> EdgeDrag:
        """The pointer went to a time; `frame` is that of the nearest frame, to snap to."""
        place = self.place + (seconds - self.at) * (FINE if fine else 1.0)
        target = place if frame is None else frame
        band = _dragged(self.edge, self.before, self.limits, target, self.press)
        return replace(self, band=band, at=seconds, place=place)

    @property
    def press(self) -> float:
        """Seconds that the held edge, or the middle of the band, was at."""
        return _place_of(self.edge, self.before)


def press_edge(edge: Edge, band: Brush, seconds: float, limits: Span) -> EdgeDrag:
    """Begin to drag an edge."""
    return EdgeDrag(edge, band, limits, band, seconds, _place_of(edge, band))


def _place_of(edge: Edge, band: Brush) -> float:
    times = edge_times(band)
    return times.get(edge, band.start)


def _dragged(edge: Edge, band: Brush, limits: Span, to: float, was: float) -> Brush:
    first, last = limits
    fade_out = band.fade_out
    match edge:
        case Edge.START:
            return replace(band, start=min(max(to, first), band.end), falloff_out=fade_out)
        case Edge.END:
            return replace(band, end=max(min(to, last), band.start), falloff_out=fade_out)
        case Edge.FADE_IN:
            return replace(band, falloff=max(band.start - to, 0.0), falloff_out=fade_out)
        case Edge.FADE_OUT:
            return replace(band, falloff_out=max(to - band.end, 0.0))
        case Edge.BODY:
            shift = min(max(to - was, first - band.start), last - band.end)
            return replace(band, start=band.start + shift, end=band.end + shift)
