"""What the mouse means, without Qt: small frozen objects that say what should happen.

A gesture begins with a press, takes each move by returning its next self, and is asked at the
end what came of it. Widgets translate events into these calls and do as they are told.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from enum import Enum

from faceedit_app.core.controls import CONTROL_IDS, MIRRORED_CONTROL
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.ui.curves.scale import Interval

CLICK_SLOP = 3.0  # pixels that a hand moves while it only means to click
FINE = 0.1  # Shift makes the hand ten times as steady
MAGNET = 9.0  # pixels from which a value snaps
ZOOM_STEP = 0.85  # per notch of the wheel
PAN_STEP = 0.1  # of the view, per notch
FALLOFF_STEP = 1.2  # per notch
LEAST_FALLOFF = 0.02  # seconds; below, a falloff is 0


@dataclass(frozen=True)
class Pointer:
    """Where the mouse is on a plot, in pixels, and what the keys held with it mean.

    Attributes:
        fine: Shift: ten times as steady.
        snap: Ctrl: to frames, to the tracked curve, to touching.
        one_side: Alt: this side only, of the face or of the falloffs.
    """

    x: float
    y: float
    fine: bool = False
    snap: bool = False
    one_side: bool = False


@dataclass(frozen=True)
class Span:
    """Where an edit acts: in full from `start` to `end` seconds, fading before and after.

    Attributes:
        falloff: seconds of fading in.
        falloff_out: seconds of fading out; as long as fading in if it is None.
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
        """First and last second that the edit changes."""
        return self.start - self.falloff, self.end + self.fade_out

    def edit(
        self,
        controls: tuple[str, ...],
        op: Op,
        value: float = 0.0,
        points: tuple[tuple[float, float], ...] = (),
    ) -> Edit:
        """The edit that acts here."""
        fade_out = None if self.falloff_out == self.falloff else self.falloff_out
        times = self.start, self.end, self.falloff
        return Edit(controls, op, *times, value, falloff_out=fade_out, points=points)


def span_at(
    seconds: float, selection: Interval | None, falloff: float, falloff_out: float | None = None
) -> Span:
    """What a press at a frame's time would edit: the selection it lies in, else that frame."""
    if selection is not None:
        span = Span(*selection, falloff, falloff_out)
        if span.ends[0] <= seconds <= span.ends[1]:
            return span
    return Span(seconds, seconds, falloff, falloff_out)


def clamped(value: float, limits: Interval) -> float:
    """The value, or the limit that it is beyond."""
    return min(max(value, limits[0]), limits[1])


class Held:
    """A gesture that acts from the first to the last second of its hold."""

    hold: Interval

    def span(self, falloff: float, falloff_out: float | None = None) -> Span:
        """Where the edit acts."""
        return Span(*self.hold, falloff, falloff_out)


class VerticalDrag(Held):
    """One that becomes an edit by going up or down."""

    press: tuple[float, float]
    at: tuple[float, float]
    moving: bool

    @property
    def is_click(self) -> bool:
        """Whether a release now is a click."""
        return not self.moving and abs(self.at[0] - self.press[0]) <= CLICK_SLOP


@dataclass(frozen=True)
class CurveDrag(VerticalDrag):
    """Left press on a curve: an edit once the mouse has moved up or down, else a click.

    Attributes:
        control: id of the curve.
        time: seconds of the frame under the press.
        hold: first and last second of the edit's full strength.
        press: pixels of the press.
        at: pixels of the pointer now.
        mm_per_pixel: fixed at the press: the hand counts alike while an axis stretches.
        limits: millimetres that it may move at most, down and up: what a face can do.
        others: ids of the curves that move along.
        magnets: millimetres of moving at which it snaps: back on the tracked curve, touching.
        value: millimetres moved so far, by the hand.
        moving: whether it has become an edit.
        snapping: whether the magnets attract.
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
        """The pointer went to a pixel. Fine counts from here on only, so nothing jumps."""
        step = (self.at[1] - y) * self.mm_per_pixel * (FINE if fine else 1.0)
        moving = self.moving or abs(y - self.press[1]) > CLICK_SLOP
        value = self.value + step
        return replace(self, at=(x, y), value=value, moving=moving, snapping=snap)

    @property
    def amount(self) -> float:
        """Millimetres that the edit moves the curves: within limits, snapped if wanted."""
        value = self.value
        if self.snapping and self.magnets:
            nearest = min(self.magnets, key=lambda magnet: abs(magnet - value))
            if abs(nearest - value) <= MAGNET * self.mm_per_pixel:
                value = nearest
        return clamped(value, self.limits)

    @property
    def controls(self) -> tuple[str, ...]:
        """Ids of all curves that move, in the order of the plots."""
        return tuple(c for c in CONTROL_IDS if c == self.control or c in self.others)

    def edit(self, falloff: float, falloff_out: float | None = None) -> Edit | None:
        """The edit as it stands, or None while there is nothing to do."""
        if not self.moving or self.amount == 0.0:
            return None
        return self.span(falloff, falloff_out).edit(self.controls, Op.OFFSET, self.amount)

    @property
    def words(self) -> str:
        """How far it is."""
        return f"{self.amount:+.1f} mm"


def moved_together(control: str, chosen: Iterable[str], linked: bool) -> tuple[str, ...]:
    """The curves that a gesture on one edits: all chosen ones if it is one of them, and, where
    left and right are linked, their mirrors; in the order of the plots."""
    mine = set(chosen) if control in chosen else {control}
    if linked:
        mine |= {MIRRORED_CONTROL[name] for name in mine}
    return tuple(name for name in CONTROL_IDS if name in mine)


@dataclass(frozen=True)
class Pan:
    """Middle press: the time under the pointer stays under it."""

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


class WheelMeans(Enum):
    """What a turn of the wheel is for."""

    FALLOFF = "falloff"
    ZOOM_TIME = "zoom time"
    ZOOM_VALUES = "zoom values"
    PAN = "pan"


def wheel_means(dragging: bool, shift: bool, ctrl: bool) -> WheelMeans:
    """During a drag the wheel sets the falloff; Shift pans, Ctrl zooms the values, else time."""
    if dragging:
        return WheelMeans.FALLOFF
    if shift:
        return WheelMeans.PAN
    return WheelMeans.ZOOM_VALUES if ctrl else WheelMeans.ZOOM_TIME


def zoom_factor(notches: float) -> float:
    """How the visible range scales; away from the user is closer."""
    return float(ZOOM_STEP**notches)


def stepped_falloff(falloff: float, notches: float) -> float:
    """The falloff after a turn of the wheel; it gets down to 0 and up from it."""
    if notches > 0:
        falloff = max(falloff, LEAST_FALLOFF / FALLOFF_STEP)
    stepped = falloff * float(FALLOFF_STEP**notches)
    return stepped if stepped >= LEAST_FALLOFF * (1 - 1e-9) else 0.0
