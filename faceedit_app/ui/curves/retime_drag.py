"""The gesture of the Retime tool, without Qt: dragging the take's content in time."""

from __future__ import annotations

from dataclasses import dataclass, replace

from faceedit_app.core.clip import Clip
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.help.retime import LEAST_PAD, Range, nearest, retime
from faceedit_app.ui.curves.edges import GRASP, Edge
from faceedit_app.ui.curves.gestures import CLICK_SLOP, FINE, Span
from faceedit_app.ui.curves.scale import Scale


@dataclass(frozen=True)
class RetimeDrag:
    """Moves content in time by dragging it sideways, or stretches it by dragging an end.

    Attributes:
        controls: ids of the curves under the press; a retime changes the whole face.
        clip: the take.
        was: where the content is in the take, seconds.
        begun: where it was shown at the press.
        grip: what is held: the content, or one end of it.
        press, at: pixels of the press, and of the pointer.
        pressed: seconds of the frame under the press.
        scale: of the plot at the press.
        seconds: moved so far, with fine moves scaled.
        moving: whether it has become an edit.
        snapping: whether what is held snaps to frames.
    """

    controls: tuple[str, ...]
    clip: Clip
    was: Range
    begun: Range
    grip: Edge
    press: tuple[float, float]
    at: tuple[float, float]
    pressed: float
    scale: Scale
    seconds: float = 0.0
    moving: bool = False
    snapping: bool = False

    def moved(self, x: float, y: float, fine: bool, snap: bool = False) -> RetimeDrag:
        """The pointer moved to a pixel."""
        seconds = (x - self.at[0]) * self.scale.seconds_per_pixel * (FINE if fine else 1.0)
        moving = self.moving or abs(x - self.press[0]) > CLICK_SLOP
        return replace(
            self, at=(x, y), seconds=self.seconds + seconds, moving=moving, snapping=snap
        )

    @property
    def is_click(self) -> bool:
        """Whether a release now would be a click."""
        return not self.moving and abs(self.at[1] - self.press[1]) <= CLICK_SLOP

    @property
    def goal(self) -> Range:
        """Where the content is shown now, as far as the take has room."""
        return nearest(self.clip, self.was, self._wanted) if self.moving else self.begun

    @property
    def is_blocked(self) -> bool:
        """Whether the pointer goes on, but the take has no more room."""
        apart = (abs(is_ - wanted) for is_, wanted in zip(self.goal, self._wanted, strict=True))
        return self.moving and max(apart) > 0.5 / self.clip.rate

    @property
    def _wanted(self) -> Range:
        start, end = self.begun
        match self.grip:
            case Edge.START:
                return self._snapped(start + self.seconds), end
            case Edge.END:
                return start, self._snapped(end + self.seconds)
            case _:
                by = self._snapped(start + self.seconds) - start
                return start + by, end + by

    def _snapped(self, seconds: float) -> float:
        if not self.snapping:
            return seconds
        return float(self.clip.times[self.clip.frame_at(seconds)])

    @property
    def time(self) -> float:
        """Seconds of the frame that the viewport shows: what is held, where it is now."""
        match self.grip:
            case Edge.START:
                return self.goal[0]
            case Edge.END:
                return self.goal[1]
            case _:
                return self.pressed + self.goal[0] - self.begun[0]

    @property
    def words(self) -> str:
        """The amount, for the label beside the pointer."""
        (start, end), (first, last) = self.was, self.goal
        if self.later is None:
            return f"{100 * (last - first) / (end - start):.0f} %"
        return f"{self.later:+.2f} s"

    @property
    def later(self) -> float | None:
        """Seconds by which it is moved; None if it is stretched."""
        (start, end), (first, _) = self.was, self.goal
        return None if self.grip in (Edge.START, Edge.END) and end > start else first - start

    def span(self, falloff: float, falloff_out: float | None = None) -> Span:
        """Where the content is now, and what makes up for it on both sides."""
        edit = self.edit(falloff, falloff_out)
        start, end = self.goal
        if edit is None:
            return Span(start, end, 0.0, 0.0)
        return Span(start, end, max(start - edit.start, 0.0), max(edit.end - end, 0.0))

    def edit(self, falloff: float, falloff_out: float | None = None) -> Edit | None:
        """The edit so far, or None while it changes nothing."""
        if not self.moving or self.goal == self.was:
            return None
        return retime(self.clip, self.was, self.goal, max(falloff, LEAST_PAD))


def _within(clip: Clip, part: Range) -> Range:
    """A range as far as it lies in the take."""
    first, last = float(clip.times[0]), float(clip.times[-1])
    return min(max(part[0], first), last), min(max(part[1], first), last)


def content_of(edit: Edit | None) -> tuple[Range, Range] | None:
    """Where the content of a retime was and is, if it moves or stretches one range; else None."""
    if edit is None or edit.op is not Op.RETIME or not 1 <= len(edit.pins) <= 2:
        return None
    (was, now), (then_was, then_now) = edit.pins[0], edit.pins[-1]
    if len(edit.pins) == 2 and (then_was <= was or then_now <= now):
        return None  # a cut or a pause
    return (was, then_was), (now, then_now)


def held_retime(chosen: tuple[int, Edit] | None, seconds: float, slack: float) -> Edit | None:
    """The chosen edit, if it is a retime and a press takes hold of what it moves.

    Args:
        chosen: row and edit; None if no edit is chosen.
        seconds: of the press, which may miss by `slack`.
    """
    content = content_of(chosen[1]) if chosen is not None else None
    if chosen is None or content is None:
        return None
    start, end = content[1]
    return chosen[1] if start - slack <= seconds <= end + slack else None


def begin_retime(
    controls: tuple[str, ...],
    clip: Clip,
    scale: Scale,
    press: tuple[float, float],
    seconds: float,
    span: Span,
    chosen: Edit | None,
) -> RetimeDrag:
    """Take hold of content: that of the chosen retime, else the selection or the frame.

    Args:
        press: pixels.
        seconds: of the frame there.
        span: what the press would edit.
        chosen: the chosen edit, if the press is on its content.
    """
    held = content_of(chosen) or ((span.start, span.end), (span.start, span.end))
    # A selection may end after the last frame, and an edit beyond the take: nothing is moved there.
    was, shown = (_within(clip, part) for part in held)
    grip = Edge.BODY
    if shown[1] > shown[0]:
        start, end = (abs(scale.x_of(at) - press[0]) for at in shown)
        if min(start, end) <= GRASP:
            grip = Edge.START if start < end else Edge.END
    return RetimeDrag(controls, clip, was, shown, grip, press, press, seconds, scale)
