"""The shared state of the time axis: playhead, visible range, selection, falloff."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from PySide6.QtCore import QObject, Signal

from faceedit_app.core.arrays import Times
from faceedit_app.core.clip import Clip, nearest
from faceedit_app.formats.take import LostRows
from faceedit_app.ui.state.time_display import TimeDisplay
from faceedit_app.ui.state.timed_rows import TimedRows

if TYPE_CHECKING:  # the window is there before the solver
    from faceedit_app.editing.solving.filled_frames import FilledFrames

NO_TIMES: Times = np.empty(0)
SHORTEST_VIEW = 0.1
DEFAULT_FALLOFF = 0.2
FALLOFF_RANGE = (0.0, 5.0)
_ROOM = 0.05  # of the view, on either side of what the user goes to


class Stop(NamedTuple):
    """A frame at which the playhead can stand.

    Attributes:
        frame: of the clip; the nearest one if it is a filled frame.
        filled: which of the filled frames it is; None if it is a frame of the clip.
    """

    frame: int
    filled: int | None = None


class Timeline(QObject):
    """The time axis of the open take. Times are seconds from the first frame.

    Attributes:
        frame: on screen; if that is a filled frame, one beside it.
        filled_frames: what fills gaps of the take, if anything does.
        filled: which of these is on screen; None if a frame of the clip is.

    Signals:
        playhead_moved(int): another frame is on screen.
        view_changed(): the visible range `view`.
        selection_changed(): the time selection `selection`, or None.
        range_toggled(): more than a moment is selected now, or no longer; see `has_range`.
        falloff_changed(float): seconds over which an edit fades in (`falloff`) or out
            (`falloff_out`).
    """

    playhead_moved = Signal(int)
    view_changed = Signal()
    selection_changed = Signal()
    range_toggled = Signal()
    falloff_changed = Signal(float)

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._clip: Clip | None = None
        self._rows: TimedRows | None = None
        self.frame = 0
        self.filled: int | None = None
        self.filled_frames: FilledFrames | None = None
        self.view = (0.0, 1.0)
        self.selection: tuple[float, float] | None = None
        self.falloff = self.falloff_out = DEFAULT_FALLOFF
        self.shows_edit = False  # selection and falloffs are those of the chosen edit
        self.can_fade = True  # the chosen edit
        self._own: tuple[float, float] | None = None  # the user's falloffs meanwhile
        self._edits_falloffs = (0.0, 0.0)  # of the chosen edit, before they are changed
        self._is_own = False  # the user had selected the edit's hold
        self._before: tuple[float, float] | None = None  # the user's selection before the edit
        self.display = TimeDisplay(self)

    @property
    def clip(self) -> Clip | None:
        """The open clip, whose times these are."""
        return self._clip

    @property
    def rows(self) -> TimedRows | None:
        """The rows of the open take by which times are shown and typed."""
        return self._rows

    @property
    def duration(self) -> float:
        """Seconds of the open take."""
        return self._clip.duration if self._clip is not None else 1.0

    @property
    def frames(self) -> int:
        """Number of frames of the open take."""
        return len(self._clip) if self._clip is not None else 0

    @property
    def time(self) -> float:
        """Seconds of the frame on screen, which may be a filled one."""
        return self._time_of(self.stop)

    @property
    def stop(self) -> Stop:
        """Where the playhead stands."""
        return Stop(self.frame, self.filled)

    def _time_of(self, stop: Stop) -> float:
        if stop.filled is not None:
            return float(self._filled[stop.filled])
        return float(self._clip.times[stop.frame]) if self._clip is not None else 0.0

    def open(self, clip: Clip, lost: LostRows | None = None) -> None:
        """Open another clip, at its start, all of it visible, nothing selected.

        Args:
            lost: the rows in its gaps to which a fill can give a face.
        """
        self._clip, self.frame = clip, 0
        self.filled_frames = self.filled = None
        self._rows = TimedRows.of(clip, lost)
        self.display.follow(clip)
        self.leave_edit()
        self.select(None)
        self.show_range(0.0, self.duration)
        self.frame = -1
        self.go_to_frame(0)

    def go_to_frame(self, frame: int, turns_page: bool = True) -> None:
        """Move the playhead to a frame; the view follows to keep it visible if it `turns_page`."""
        if self._clip is None:
            return
        self._go_to(Stop(min(max(frame, 0), self.frames - 1)), turns_page)

    def _go_to(self, stop: Stop, turns_page: bool) -> None:
        if stop == self.stop:
            return
        self.frame, self.filled = stop
        if turns_page:
            self._keep_in_view(self.time)
        self.playhead_moved.emit(self.frame)

    def go_to_time(self, seconds: float, turns_page: bool = True) -> None:
        """Move the playhead to the nearest frame, also a filled one; see `go_to_frame`."""
        if self._clip is not None:
            self._go_to(self.stop_at(seconds), turns_page)

    def visit(self, seconds: float) -> None:
        """Go to a time that the user has named, with what is before and after it in view."""
        self.go_to_time(seconds, turns_page=False)
        first, last = self.view
        room = _ROOM * (last - first)
        if not first + room <= self.time <= last - room:
            middle, width = self.time, last - first
            self.show_range(middle - width / 2, middle + width / 2)

    def stop_at(self, seconds: float) -> Stop:
        """The frame nearest to a time, also a filled one."""
        if self._clip is None:
            return Stop(0)
        frame, times = self._clip.frame_at(seconds), self._filled
        if not len(times):
            return Stop(frame)
        filled = nearest(times, seconds)
        is_nearer = abs(times[filled] - seconds) < abs(self._clip.times[frame] - seconds)
        return Stop(frame, filled if is_nearer else None)

    def step(self, frames: int) -> None:
        """Move the playhead by frames, also filled ones."""
        if not len(self._filled) or self._clip is None:
            self.go_to_frame(self.frame + frames)
            return
        stops = np.sort(np.concatenate([self._clip.times, self._filled]))
        at = int(np.searchsorted(stops, self.time - 1e-9)) + frames
        self.go_to_time(float(stops[min(max(at, 0), len(stops) - 1)]))

    @property
    def _filled(self) -> Times:
        """(M,) seconds of the filled frames."""
        return NO_TIMES if self.filled_frames is None else self.filled_frames.times

    def fill_gaps(self, frames: FilledFrames | None) -> None:
        """Let the playhead stand on filled frames as well; if its own is gone, it stays nearby."""
        now, before = self.time, self._filled
        self.filled_frames = frames
        if self.filled is not None and not np.array_equal(self._filled, before):
            self.frame, self.filled = -1, None  # so that the move is announced
            self.go_to_time(now, turns_page=False)

    def point_at(self, seconds: float) -> None:
        """Move the playhead to the frame under the pointer.

        The view stays: under a hand that holds something, it must not turn a page, not even for a
        frame that lies just beyond its edge.
        """
        self.go_to_time(seconds, turns_page=False)

    def snap(self, seconds: float) -> float:
        """The time of the frame nearest to `seconds`, also of a filled one; see `stop_at`."""
        return self._time_of(self.stop_at(seconds)) if self._clip is not None else seconds

    def snap_edge(self, seconds: float) -> float:
        """The nearest time at which an end of a selection can lie.

        In a gap, these are the times of its rows, filled or not, so that a part of it can be
        filled.
        """
        return (
            float(self._rows.times[self._rows.at(seconds)]) if self._rows is not None else seconds
        )

    def _keep_in_view(self, seconds: float) -> None:
        first, last = self.view
        if not first <= seconds <= last:
            width = last - first
            # The view turns a page rather than scrolls, so that curves stay readable.
            start = seconds - (0.05 if seconds > last else 0.95) * width
            self.show_range(start, start + width)

    def bring_into_view(self, first: float, last: float) -> None:
        """Scroll to a range of seconds, unless all of it is in view or it is too long for that."""
        (start, end), middle = self.view, 0.5 * (first + last)
        width = end - start
        if not (start <= first and last <= end) and last - first <= width:
            self.show_range(middle - width / 2, middle + width / 2)

    def show_range(self, first: float, last: float) -> None:
        """Make a range of seconds visible, kept within the take.

        The frames of a take that cannot fill the view are in its middle, away from the edges.
        """
        width = min(max(last - first, SHORTEST_VIEW), max(self.duration, SHORTEST_VIEW))
        first = min(max(first, 0.0), max(self.duration - width, 0.0))
        if self._clip is not None and (self.frames == 1 or self.duration < SHORTEST_VIEW):
            first = (float(self._clip.times[-1]) - width) / 2
        if (first, first + width) != self.view:
            self.view = (first, first + width)
            self.view_changed.emit()

    def zoom(self, factor: float, around: float) -> None:
        """Scale the visible range; `around` (seconds) stays in place on the screen."""
        first, last = self.view
        self.show_range(around - (around - first) * factor, around + (last - around) * factor)

    def pan(self, seconds: float) -> None:
        """Move the visible range."""
        self.show_range(self.view[0] + seconds, self.view[1] + seconds)

    def select(self, selection: tuple[float, float] | None) -> None:
        """Select a range of seconds, in either order, or None."""
        if selection is not None:
            selection = (min(selection), max(selection))
        if selection != self.selection:
            had_range, self.selection = self.has_range, selection
            self.selection_changed.emit()
            if self.has_range is not had_range:
                self.range_toggled.emit()

    @property
    def has_range(self) -> bool:
        """Whether more than a moment is selected."""
        return self.selection is not None and self.selection[0] < self.selection[1]

    # --- the chosen edit ---------------------------------------------------------------------

    @property
    def own_selection(self) -> tuple[float, float] | None:
        """The selection, if the user made it rather than an edit's hold; it may be resized since.

        Commands that act in the selection or the whole take act in this one.
        """
        return self.selection if self._is_own or not self.shows_edit else None

    @property
    def own_falloffs(self) -> tuple[float, float]:
        """The falloffs of the next edit."""
        return self._own or (self.falloff, self.falloff_out)

    def softened(
        self, was: tuple[float, float], now: tuple[float, float], falloffs: tuple[float, float]
    ) -> tuple[float, float]:
        """The falloffs of an edit with another hold, in which an end that leaves the take's fades.

        An edit of the whole take needs no falloff; limited to a part of it, it would begin with a
        jump.

        Args:
            was, now: first and last second of its hold, before and after.
            falloffs: seconds over which it fades in and out so far.
        """
        (fade_in, fade_out), own = falloffs, self.own_falloffs
        if fade_in == 0 and was[0] <= 0.0 < now[0]:
            fade_in = own[0]
        if fade_out == 0 and was[1] >= self.snap(self.duration) > now[1]:
            fade_out = own[1]
        return fade_in, fade_out

    def show_edit(
        self, hold: tuple[float, float], fade_in: float, fade_out: float, can_fade: bool = True
    ) -> None:
        """Show the hold and falloffs of the chosen edit in place of the user's."""
        self.can_fade = can_fade
        if not self.shows_edit:
            self._own, self._before = (self.falloff, self.falloff_out), self.selection
            self._is_own = self.selection == hold
        elif self.selection != hold:
            self._is_own = False
        self.shows_edit = True
        self.set_falloffs(fade_in, fade_out)
        self._edits_falloffs = self.falloff, self.falloff_out
        self.select(hold)

    def leave_edit(self, is_undone: bool = False) -> None:
        """Show the user's falloffs again, and the selection if the user made it.

        Args:
            is_undone: the edit is gone, so that the selection from before it is shown.
        """
        selection, own = self.own_selection, self._own
        if is_undone and self.shows_edit:
            selection = self._before
        self.shows_edit, self._own, self._is_own = False, None, False
        if own is not None:
            self.set_falloffs(*own)
        self.select(selection)

    def restore_falloffs(self) -> None:
        """Set both falloffs as they are at first."""
        self.set_falloffs(DEFAULT_FALLOFF, DEFAULT_FALLOFF)

    def keep_falloffs(self) -> None:
        """Make a falloff of the chosen edit that the user has changed that of the next edit."""
        if self._own is not None:
            (fade_in, fade_out), (was_in, was_out) = self._own, self._edits_falloffs
            self._own = (
                self.falloff if self.falloff != was_in else fade_in,
                self.falloff_out if self.falloff_out != was_out else fade_out,
            )

    def set_falloffs(self, fade_in: float, fade_out: float) -> None:
        """Set each falloff."""
        low, high = FALLOFF_RANGE
        fades = min(max(fade_in, low), high), min(max(fade_out, low), high)
        if fades != (self.falloff, self.falloff_out):
            self.falloff, self.falloff_out = fades
            self.falloff_changed.emit(self.falloff)
