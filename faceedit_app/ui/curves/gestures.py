"""The gestures of the mouse, without Qt: small frozen objects.

A gesture begins with a press, returns its next state for each move, and finally gives its edit.
Widgets only translate events into these calls.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from enum import Enum

from faceedit_app.core.controls import CONTROL_IDS, MIRRORED_CONTROL
from faceedit_app.editing.edits.describe import signed
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.ui.curves.scale import Interval

CLICK_SLOP = 3.0  # pixels that the pointer may move during a click
FINE = 0.1  # factor on the pointer's movement, with Shift
MAGNET = 9.0  # pixels within which a value snaps
ZOOM_STEP = 0.85  # per notch of the wheel
PAN_STEP = 0.1  # of the view, per notch
FALLOFF_STEP = 1.2  # per notch
LEAST_FALLOFF = 0.02  # seconds; below, a falloff is 0


@dataclass(frozen=True)
class Pointer:
    """The pointer on a plot, in pixels, with the modifier keys.

    Attributes:
        fine: Shift: move ten times finer.
        snap: Ctrl: snap to frames, to the tracked curve, to touching.
        one_side: Alt, or Ctrl and Shift: only this side of the face, or only this falloff.
    """

    x: float
    y: float
    fine: bool = False
    snap: bool = False
    one_side: bool = False


@dataclass(frozen=True)
class Span:
    """The time range of an edit: a hold from `start` to `end` seconds, and the falloffs around it.

    Attributes:
        falloff: seconds of fading in.
        falloff_out: seconds of fading out; None: as long as fading in.
    """

    start: float
    end: float
    falloff: float
    falloff_out: float | None = None

    @property
    def fade_out(self) -> float:
        """Seconds of fading out."""
        return self.falloff if self.falloff_out is None else self.falloff_out

    @property
    def ends(self) -> Interval:
        """First and last second of the span."""
        return self.start - self.falloff, self.end + self.fade_out

    def edit(
        self,
        controls: tuple[str, ...],
        op: Op,
        value: float = 0.0,
        points: tuple[tuple[float, float], ...] = (),
    ) -> Edit:
        """An edit with this span."""
        fade_out = None if self.falloff_out == self.falloff else self.falloff_out
        times = self.start, self.end, self.falloff
        return Edit(controls, op, *times, value, falloff_out=fade_out, points=points)


def span_at(
    seconds: float, selection: Interval | None, falloff: float, falloff_out: float | None = None
) -> Span:
    """The span that a press edits: the selection if the press is inside it, else that frame."""
    if selection is not None:
        span = Span(*selection, falloff, falloff_out)
        if span.ends[0] <= seconds <= span.ends[1]:
            return span
    return Span(seconds, seconds, falloff, falloff_out)


def clamped(value: float, limits: Interval) -> float:
    """The value, clamped to the limits."""
    return min(max(value, limits[0]), limits[1])


class Held:
    """A gesture with a hold."""

    hold: Interval

    def span(self, falloff: float, falloff_out: float | None = None) -> Span:
        """The span of the edit."""
        return Span(*self.hold, falloff, falloff_out)


class VerticalDrag(Held):
    """A gesture that becomes an edit by moving up or down."""

    press: tuple[float, float]
    at: tuple[float, float]
    moving: bool

    @property
    def is_click(self) -> bool:
        """Whether a release now would be a click."""
        return not self.moving and abs(self.at[0] - self.press[0]) <= CLICK_SLOP


@dataclass(frozen=True)
class CurveDrag(VerticalDrag):
    """Left press on a curve: an edit once the pointer has moved up or down, until then a click.

    Attributes:
        control: id of the curve.
        time: seconds of the frame under the press.
        hold: first and last second of the hold.
        press: pixels of the press.
        at: pixels of the pointer.
        mm_per_pixel: fixed at the press, so that a stretching axis does not change it.
        limits: least and greatest move in millimetres, from what a face can do.
        others: ids of the curves that move with it.
        magnets: moves in millimetres that it snaps to: onto the tracked curve, to touching.
        value: millimetres moved so far, before limits and snapping.
        moving: whether it has become an edit.
        snapping: whether it snaps to the magnets.
    """

    control: str
    time: float
    hold: Interval
    press: tuple[float, float]
    at: tuple[float, float]
    mm_per_pixel: float
    limits: Interval = (-math.inf, math.inf)
    others: tuple[str, ...] = ()
    magnets: tuple[float, ...] = ()
    value: float = 0.0
    moving: bool = False
    snapping: bool = False

    def moved(self, x: float, y: float, fine: bool, snap: bool = False) -> CurveDrag:
        """The pointer moved to a pixel; `fine` applies to this move only, so nothing jumps."""
        step = (self.at[1] - y) * self.mm_per_pixel * (FINE if fine else 1.0)
        moving = self.moving or abs(y - self.press[1]) > CLICK_SLOP
        value = self.value + step
        return replace(self, at=(x, y), value=value, moving=moving, snapping=snap)

    @property
    def amount(self) -> float:
        """Millimetres that the edit moves the curves by, after limits and snapping."""
        value = self.value
        if self.snapping and self.magnets:
            nearest = min(self.magnets, key=lambda magnet: abs(magnet - value))
            if abs(nearest - value) <= MAGNET * self.mm_per_pixel:
                value = nearest
        return clamped(value, self.limits)

    @property
    def controls(self) -> tuple[str, ...]:
        """Ids of all curves that move, in plot order."""
        return tuple(c for c in CONTROL_IDS if c == self.control or c in self.others)

    def edit(self, falloff: float, falloff_out: float | None = None) -> Edit | None:
        """The edit so far, or None while it changes nothing."""
        if not self.moving or self.amount == 0.0:
            return None
        return self.span(falloff, falloff_out).edit(self.controls, Op.OFFSET, self.amount)

    @property
    def words(self) -> str:
        """The move, for the label beside the pointer."""
        return f"{signed(self.amount)} mm"


def moved_together(control: str, chosen: Iterable[str], linked: bool) -> tuple[str, ...]:
    """The curves that a gesture on one edits, in plot order: all chosen ones if it is among them,
    and their mirrors if left and right are linked."""
    mine = set(chosen) if control in chosen else {control}
    if linked:
        mine |= {MIRRORED_CONTROL[name] for name in mine}
    return tuple(name for name in CONTROL_IDS if name in mine)


@dataclass(frozen=True)
class Pan:
    """Middle press: pans, keeping the same time under the pointer."""

    press: float
    view: Interval
    seconds_per_pixel: float

    def moved(self, x: float) -> Interval:
        """The view when the pointer is at a pixel."""
        shift = (self.press - x) * self.seconds_per_pixel
        return self.view[0] + shift, self.view[1] + shift


@dataclass(frozen=True)
class RulerDrag:
    """Left press on the ruler: scrubs, or with Shift selects from `anchor` seconds."""

    anchor: float
    selecting: bool

    def selection(self, seconds: float) -> Interval:
        """The selection when the pointer is at a frame's time."""
        return min(self.anchor, seconds), max(self.anchor, seconds)


class WheelAction(Enum):
    """What a turn of the wheel does."""

    FALLOFF = "falloff"
    ZOOM_TIME = "zoom time"
    ZOOM_VALUES = "zoom values"
    PAN = "pan"


def wheel_action(dragging: bool, shift: bool, ctrl: bool) -> WheelAction:
    """The falloff during a drag; otherwise pan with Shift, zoom values with Ctrl, zoom time."""
    if dragging:
        return WheelAction.FALLOFF
    if shift:
        return WheelAction.PAN
    return WheelAction.ZOOM_VALUES if ctrl else WheelAction.ZOOM_TIME


def zoom_factor(notches: float) -> float:
    """Factor on the visible range; turning away from the user zooms in."""
    return float(ZOOM_STEP**notches)


def stepped_falloff(falloff: float, notches: float) -> float:
    """The falloff after a turn of the wheel; it can reach 0 and leave it."""
    if notches > 0:
        falloff = max(falloff, LEAST_FALLOFF / FALLOFF_STEP)
    stepped = falloff * float(FALLOFF_STEP**notches)
    return stepped if stepped >= LEAST_FALLOFF * (1 - 1e-9) else 0.0
