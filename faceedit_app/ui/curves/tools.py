"""What the tools besides Move do with the mouse, without Qt; see `gestures`."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol

from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.ui.curves.axes import Scale, Span
from faceedit_app.ui.curves.gestures import (
    CLICK_SLOP,
    FINE,
    Brush,
    Held,
    VerticalDrag,
    moved_together,
    press_curve,
)
from faceedit_app.ui.state.tools import Tool

DOUBLING = 90.0  # pixels upwards that double a scale
LARGEST_SCALE = 4.0


class Gesture(Protocol):
    """A left press on a curve that may become an edit."""

    @property
    def time(self) -> float:
        """Seconds of the frame that the face shows meanwhile."""

    @property
    def moving(self) -> bool:
        """Whether it has become an edit."""

    @property
    def is_click(self) -> bool:
        """Whether a release now is a click."""

    @property
    def controls(self) -> tuple[str, ...]:
        """Ids of the curves that it edits."""

    @property
    def words(self) -> str:
        """How much it does, beside the pointer."""

    def moved(self, x: float, y: float, fine: bool, snap: bool = False) -> Gesture:
        """The pointer went to a pixel."""

    def brush(self, falloff: float, falloff_out: float | None = None) -> Brush:
        """Where the edit acts."""

    def edit(self, falloff: float, falloff_out: float | None = None) -> Edit | None:
        """The edit as it stands, or None while there is nothing to do."""


@dataclass(frozen=True)
class ScaleDrag(VerticalDrag):
    """Up makes a movement larger, down smaller: about the take's median.

    Attributes:
        controls: ids of the curves.
        time: seconds of the frame under the press.
        hold: first and last second of the edit's full strength.
        press, at: pixels of the press, and of the pointer now.
        pixels: upwards so far, fine moves counted as such.
        moving: whether it has become an edit.
        snapping: whether the factor goes in tenths.
    """

    controls: tuple[str, ...]
    time: float
    hold: Span
    press: tuple[float, float]
    at: tuple[float, float]
    pixels: float = 0.0
    moving: bool = False
    snapping: bool = False

    def moved(self, x: float, y: float, fine: bool, snap: bool = False) -> ScaleDrag:
        """The pointer went to a pixel."""
        pixels = self.pixels + (self.at[1] - y) * (FINE if fine else 1.0)
        moving = self.moving or abs(y - self.press[1]) > CLICK_SLOP
        return replace(self, at=(x, y), pixels=pixels, moving=moving, snapping=snap)

    @property
    def factor(self) -> float:
        """What distances from the median are multiplied by: 0 when dragged down far enough."""
        raw = 2.0 ** (self.pixels / DOUBLING) if self.pixels > 0 else 1 + self.pixels / DOUBLING
        factor = min(max(raw, 0.0), LARGEST_SCALE)
        return round(factor, 1) if self.snapping else factor

    @property
    def words(self) -> str:
        """How much it does."""
        return f"× {self.factor:.2f}"

    def edit(self, falloff: float, falloff_out: float | None = None) -> Edit | None:
        """The edit as it stands, or None while there is nothing to do."""
        if not self.moving or self.factor == 1.0:
            return None
        return self.brush(falloff, falloff_out).edit(self.controls, Op.SCALE, self.factor)


@dataclass(frozen=True)
class PaintDrag(Held):
    """A brush that acts where it passes: from the press to the pointer, or in the selection.

    Attributes:
        op: what it does there.
        value: how strongly, see `Op`.
        controls: ids of the curves.
        time: seconds under the pointer; in a selection those of the press.
        hold: first and last second painted so far.
        scale: of the plot at the press.
        selected: it acts on the selection, wherever the pointer goes.
    """

    op: Op
    value: float
    controls: tuple[str, ...]
    time: float
    hold: Span
    scale: Scale
    selected: bool
    moving: bool = True
    is_click: bool = False

    def moved(self, x: float, y: float, fine: bool, snap: bool = False) -> PaintDrag:
        """The pointer went to a pixel; what was painted stays painted."""
        if self.selected:
            return self
        seconds = self.scale.time_at(min(max(x, 0.0), self.scale.width))
        hold = min(self.hold[0], seconds), max(self.hold[1], seconds)
        return replace(self, time=seconds, hold=hold)

    @property
    def words(self) -> str:
        """How much it does."""
        match self.op:
            case Op.SMOOTH:
                return f"smooth {1000 * self.value:.0f} ms"
            case Op.SET:
                return f"held at {self.value:.1f} mm"
            case _:
                return "as tracked"

    def edit(self, falloff: float, falloff_out: float | None = None) -> Edit | None:
        """The edit as it stands."""
        return self.brush(falloff, falloff_out).edit(self.controls, self.op, self.value)


@dataclass(frozen=True)
class DrawDrag:
    """Freehand: the curve goes where the pointer went.

    Attributes:
        controls: ids of the curves.
        time: seconds under the pointer.
        scale: of the plot at the press.
        at: seconds and millimetres of the pointer now.
        points: what was drawn, in order of time.
        moving: whether it has become an edit.
    """

    controls: tuple[str, ...]
    time: float
    scale: Scale
    at: tuple[float, float]
    points: tuple[tuple[float, float], ...]
    moving: bool = False

    def moved(self, x: float, y: float, fine: bool, snap: bool = False) -> DrawDrag:
        """The pointer went to a pixel; what lies between there and before is drawn over."""
        step = 1.0 / max(self.scale.width, 1.0) * (self.scale.view[1] - self.scale.view[0])
        value = 0.0 if snap else max(self.scale.value_at(y), 0.0)
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
        """Whether a release now is a click."""
        return not self.moving

    @property
    def words(self) -> str:
        """Where the pen is."""
        return f"{self.at[1]:.1f} mm"

    def brush(self, falloff: float, falloff_out: float | None = None) -> Brush:
        """Where the edit acts."""
        return Brush(self.points[0][0], self.points[-1][0], falloff, falloff_out)

    def edit(self, falloff: float, falloff_out: float | None = None) -> Edit | None:
        """The edit as it stands, or None while there is nothing to do."""
        if not self.moving:
            return None
        brush = self.brush(falloff, falloff_out)
        return brush.edit(self.controls, Op.DRAW, points=self.points)


def press_draw(
    controls: tuple[str, ...], x: float, y: float, time: float, scale: Scale
) -> DrawDrag:
    """Put the pen down."""
    at = scale.time_at(x), max(scale.value_at(y), 0.0)
    return DrawDrag(controls, time, scale, at, (at,))


@dataclass(frozen=True)
class Press:
    """A left press on a curve, and what it needs to become a tool's gesture.

    Attributes:
        control: id of the curve.
        controls: ids of all curves that are edited with it.
        at: pixels.
        time: seconds of the frame there.
        scale: of the plot.
        brush: what would be edited.
        asked, tracked: millimetres of the curve at that frame.
    """

    control: str
    controls: tuple[str, ...]
    at: tuple[float, float]
    time: float
    scale: Scale
    brush: Brush
    asked: float
    tracked: float


def begin(tool: Tool, press: Press, smooth: float) -> Gesture:
    """The tool's gesture that a press begins; `smooth` is the strength of smoothing, seconds."""
    hold, time, scale = (press.brush.start, press.brush.end), press.time, press.scale
    selected = press.brush.end > press.brush.start
    # Values in mm suit a curve and its mirror, not curves of another kind.
    pair = moved_together(press.control, (), len(press.controls) > 1)
    pair = tuple(name for name in pair if name in press.controls)
    match tool:
        case Tool.SCALE:
            return ScaleDrag(press.controls, time, hold, press.at, press.at)
        case Tool.DRAW:
            return press_draw(pair, *press.at, time, scale)
        case Tool.SMOOTH:
            return PaintDrag(Op.SMOOTH, smooth, press.controls, time, hold, scale, selected)
        case Tool.FLATTEN:
            return PaintDrag(Op.SET, press.asked, pair, time, hold, scale, selected)
        case Tool.RESTORE:
            return PaintDrag(Op.RESET, 0.0, press.controls, time, hold, scale, selected)
        case _:
            others = tuple(name for name in press.controls if name != press.control)
            magnets = press.tracked - press.asked, -press.asked
            return press_curve(press.control, *press.at, scale, time, press.brush, others, magnets)
