"""The gestures of the tools other than Move, without Qt; see `gestures`."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Protocol

from faceedit_app.core.clip import Clip
from faceedit_app.editing.edits.describe import one_decimal
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.ui.curves.gestures import (
    CLICK_SLOP,
    FINE,
    CurveDrag,
    Held,
    Span,
    VerticalDrag,
    clamped,
    moved_together,
)
from faceedit_app.ui.curves.retime_drag import begin_retime
from faceedit_app.ui.curves.scale import Interval, Scale
from faceedit_app.ui.state.tools import Tool

DOUBLING = 90.0  # pixels upwards that double a movement
LARGEST_SCALE = 4.0


class Gesture(Protocol):
    """A left press on a curve that may become an edit."""

    @property
    def time(self) -> float:
        """Seconds of the frame that the viewport shows during the gesture."""

    @property
    def moving(self) -> bool:
        """Whether it has become an edit."""

    @property
    def is_click(self) -> bool:
        """Whether a release now would be a click."""

    @property
    def controls(self) -> tuple[str, ...]:
        """Ids of the edited curves."""

    @property
    def words(self) -> str:
        """The amount, for the label beside the pointer."""

    def moved(self, x: float, y: float, fine: bool, snap: bool = False) -> Gesture:
        """The pointer moved to a pixel."""

    def span(self, falloff: float, falloff_out: float | None = None) -> Span:
        """The span of the edit."""

    def edit(self, falloff: float, falloff_out: float | None = None) -> Edit | None:
        """The edit so far, or None while it changes nothing."""


@dataclass(frozen=True)
class ScaleDrag(VerticalDrag):
    """Enlarges or reduces movements around the take's median, by dragging up or down.

    Attributes:
        controls: ids of the curves.
        time: seconds of the frame under the press.
        hold: first and last second of the hold.
        press, at: pixels of the press, and of the pointer.
        pixels: moved upwards so far, with fine moves scaled.
        moving: whether it has become an edit.
        snapping: whether the factor is rounded to tenths.
    """

    controls: tuple[str, ...]
    time: float
    hold: Interval
    press: tuple[float, float]
    at: tuple[float, float]
    pixels: float = 0.0
    moving: bool = False
    snapping: bool = False

    def moved(self, x: float, y: float, fine: bool, snap: bool = False) -> ScaleDrag:
        """The pointer moved to a pixel."""
        pixels = self.pixels + (self.at[1] - y) * (FINE if fine else 1.0)
        moving = self.moving or abs(y - self.press[1]) > CLICK_SLOP
        return replace(self, at=(x, y), pixels=pixels, moving=moving, snapping=snap)

    @property
    def factor(self) -> float:
        """Factor on distances from the median; 0 when dragged down far enough."""
        way = clamped(self.pixels / DOUBLING, (-1.0, math.log2(LARGEST_SCALE)))
        factor = 2.0**way if way > 0 else 1.0 + way
        return round(factor, 1) if self.snapping else factor

    @property
    def words(self) -> str:
        """The amount."""
        return f"× {self.factor:.2f}"

    def edit(self, falloff: float, falloff_out: float | None = None) -> Edit | None:
        """The edit so far, or None while it changes nothing."""
        if not self.moving or self.factor == 1.0:
            return None
        return self.span(falloff, falloff_out).edit(self.controls, Op.SCALE, self.factor)


@dataclass(frozen=True)
class PaintDrag(Held):
    """A brush that acts where it is drawn, or in the whole selection.

    Attributes:
        op: what the brush does.
        value: of the edit, see `Op`.
        controls: ids of the curves.
        time: seconds under the pointer; in a selection, of the press.
        hold: first and last second painted so far.
        scale: of the plot at the press.
        selected: whether it acts on the selection, wherever the pointer is.
    """

    op: Op
    value: float
    controls: tuple[str, ...]
    time: float
    hold: Interval
    scale: Scale
    selected: bool
    moving: bool = True
    is_click: bool = False

    def moved(self, x: float, y: float, fine: bool, snap: bool = False) -> PaintDrag:
        """The pointer moved to a pixel; what has been painted stays."""
        if self.selected:
            return self
        seconds = self.scale.time_at(min(max(x, 0.0), self.scale.width))
        hold = min(self.hold[0], seconds), max(self.hold[1], seconds)
        return replace(self, time=seconds, hold=hold)

    @property
    def words(self) -> str:
        """The amount."""
        match self.op:
            case Op.SMOOTH:
                return f"smooth {1000 * self.value:.0f} ms"
            case Op.SET:
                return f"held at {one_decimal(self.value)} mm"
            case _:
                return "as tracked"

    def edit(self, falloff: float, falloff_out: float | None = None) -> Edit | None:
        """The edit so far."""
        return self.span(falloff, falloff_out).edit(self.controls, self.op, self.value)


@dataclass(frozen=True)
class DrawDrag:
    """Freehand drawing: the curve follows the pointer.

    Attributes:
        controls: ids of the curves.
        time: seconds under the pointer.
        scale: of the plot at the press.
        limits: lowest and highest millimetre that a face can do.
        at: seconds and millimetres of the pointer.
        points: drawn so far, in order of time.
        moving: whether it has become an edit.
    """

    controls: tuple[str, ...]
    time: float
    scale: Scale
    limits: Interval
    at: tuple[float, float]
    points: tuple[tuple[float, float], ...]
    moving: bool = False

    def moved(self, x: float, y: float, fine: bool, snap: bool = False) -> DrawDrag:
        """The pointer moved to a pixel; draw over everything on the way."""
        step = 1.0 / max(self.scale.width, 1.0) * (self.scale.view[1] - self.scale.view[0])
        value = clamped(0.0 if snap else self.scale.value_at(y), self.limits)
        now = self.scale.time_at(min(max(x, 0.0), self.scale.width)), value
        if abs(now[0] - self.at[0]) < 0.5 * step and not self.moving:
            return self
        first, last = sorted((self.at[0], now[0]))
        kept = [p for p in self.points if not first - 0.5 * step <= p[0] <= last + 0.5 * step]
        new = [now] if abs(now[0] - self.at[0]) < 0.5 * step else [self.at, now]
        points = tuple(sorted([*kept, *new]))
        return replace(self, time=now[0], at=now, points=points, moving=True)

    @property
    def is_click(self) -> bool:
        """Whether a release now would be a click."""
        return not self.moving

    @property
    def words(self) -> str:
        """The value under the pen."""
        return f"{one_decimal(self.at[1])} mm"

    def span(self, falloff: float, falloff_out: float | None = None) -> Span:
        """The span of the edit."""
        return Span(self.points[0][0], self.points[-1][0], falloff, falloff_out)

    def edit(self, falloff: float, falloff_out: float | None = None) -> Edit | None:
        """The edit so far, or None while it changes nothing."""
        if not self.moving:
            return None
        span = self.span(falloff, falloff_out)
        return span.edit(self.controls, Op.DRAW, points=self.points)


@dataclass(frozen=True)
class Press:
    """A left press on a curve, with what a tool needs to begin a gesture.

    Attributes:
        control: id of the curve.
        controls: ids of all curves edited with it.
        at: pixels.
        time: seconds of the frame there.
        scale: of the plot.
        span: of the edit.
        asked, tracked: millimetres of the curve at that frame.
        limits: lowest and highest millimetre that a face can do with this control.
        clip: the take.
        retime: the chosen edit, if it is a retime and the press is on what it moves.
    """

    control: str
    controls: tuple[str, ...]
    at: tuple[float, float]
    time: float
    scale: Scale
    span: Span
    asked: float
    tracked: float
    limits: Interval
    clip: Clip
    retime: Edit | None = None


def begin(tool: Tool, press: Press, smooth: float) -> Gesture:
    """The tool's gesture for a press; `smooth` is the brush strength of Smooth, in seconds."""
    hold, time, scale = (press.span.start, press.span.end), press.time, press.scale
    selected = press.span.end > press.span.start
    # Values in mm suit a curve and its mirror, not curves of another kind.
    pair = moved_together(press.control, (), len(press.controls) > 1)
    pair = tuple(name for name in pair if name in press.controls)
    match tool:
        case Tool.SCALE:
            return ScaleDrag(press.controls, time, hold, press.at, press.at)
        case Tool.DRAW:
            x, y = press.at
            pen = scale.time_at(x), clamped(scale.value_at(y), press.limits)
            return DrawDrag(pair, time, scale, press.limits, pen, (pen,))
        case Tool.SMOOTH:
            return PaintDrag(Op.SMOOTH, smooth, press.controls, time, hold, scale, selected)
        case Tool.FLATTEN:
            return PaintDrag(Op.SET, press.asked, pair, time, hold, scale, selected)
        case Tool.RESTORE:
            return PaintDrag(Op.RESET, 0.0, press.controls, time, hold, scale, selected)
        case Tool.RETIME:
            at, span = press.at, press.span
            return begin_retime(press.controls, press.clip, scale, at, time, span, press.retime)
        case Tool.MOVE:
            return move(press)


def move(press: Press) -> CurveDrag:
    """Begin to drag a curve up or down."""
    return CurveDrag(
        control=press.control,
        time=press.time,
        hold=(press.span.start, press.span.end),
        press=press.at,
        at=press.at,
        mm_per_pixel=press.scale.mm_per_pixel,
        # A curve beyond what faces do may stay there or come back.
        limits=(min(press.limits[0] - press.asked, 0.0), max(press.limits[1] - press.asked, 0.0)),
        others=tuple(name for name in press.controls if name != press.control),
        magnets=(press.tracked - press.asked, -press.asked),
    )
