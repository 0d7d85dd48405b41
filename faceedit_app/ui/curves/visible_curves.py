"""The visible part of a take's curves, reduced to the points that a screen can show."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from faceedit_app.characters.closure import CLOSING, Openings
from faceedit_app.core.arrays import Floats, Times
from faceedit_app.core.controls import CONTROL_INDEX
from faceedit_app.core.extremes import Extremes, highest, lowest
from faceedit_app.editing.session import EditSession
from faceedit_app.editing.solving.filled_frames import FilledFrames
from faceedit_app.ui.curves.scale import Interval
from faceedit_app.ui.state.gap_frames import Values, through_gaps
from faceedit_app.ui.state.timeline import Timeline

Mask = NDArray[np.bool_]

BASE = 16  # frames in the smallest bin
# With fewer frames per pixel column, all are drawn: thinning would cost more than it saves.
DENSE = 3
# Millimetres by which lines must differ to be drawn separately: less is not visible.
SAME = 0.005
WIDER = 0.5  # mm by which the user's character is open wider before a line shows it
CLOSING_COLUMNS = [CONTROL_INDEX[control] for control in CLOSING]
_SLACK = 0.1  # of what a face can do, beyond either end
_LINES, _FACE, _ASKED = 3, 1, 2  # tracked, face, asked


@dataclass(frozen=True, eq=False)
class Polyline:
    """Points to draw.

    Attributes:
        x, y: (N,) seconds and values.
        joined: (N,) whether a line goes from this point to the next; None if all are joined.
        thinned: whether each pixel column shows its extremes only.
    """

    x: Values
    y: Values
    joined: Mask | None = None
    thinned: bool = False

    def changed_from(self, before: Polyline, unseen: float = 0.0) -> Interval | None:
        """First and last second of the visible change; None if there is none.

        Args:
            unseen: how far values may move without being seen to.
        """
        if self is before:
            return None
        if self.x is before.x:
            moved = np.abs(self.y - before.y)
            if not len(moved) or moved.max() <= unseen:
                return None
            rows = moved.nonzero()[0]
            first, last = max(rows[0] - 1, 0), min(rows[-1] + 1, len(self.x) - 1)
            return float(self.x[first]), float(self.x[last])
        # If the start of a line moves, so do all its dashes.
        ends = [float(x[i]) for x in (self.x, before.x) for i in (0, -1) if len(x)]
        return (min(ends), max(ends)) if ends else None


EMPTY = Polyline(np.empty(0), np.empty(0))


@dataclass(frozen=True)
class Lines:
    """A curve's lines, as drawn; the last shows where the user's character is open wider."""

    tracked: Polyline = EMPTY
    face: Polyline = EMPTY
    asked: Polyline = EMPTY
    character: Polyline = EMPTY


class VisibleCurves:
    """The visible part of some of a session's curves.

    A line that has not changed stays the same object, so that it need not be drawn again.

    A few frames are drawn one by one; for many, each pixel column shows the lowest and highest
    value from `Extremes`, which are updated as edits change.

    Args:
        session: whose curves.
        columns: which of them, the C curves that are read; None = all.
        timeline: knows the frames that are filled within gaps; None = none are.

    Attributes:
        low, high: mm, of all curves of the take as tracked.
    """

    def __init__(
        self,
        session: EditSession,
        columns: Sequence[int] | None = None,
        timeline: Timeline | None = None,
    ) -> None:
        self._timeline = timeline
        self._filled: FilledFrames | None = None
        self._session, self._live, self._seen = session, session.live, 0
        self._times = session.take.clip.times
        self._shown_rig = session.rig
        self._gaps = (Openings.of(session.rig),) * 2  # on our character, and on the one shown
        every = range(session.tracked.shape[1])
        self._columns = list(every if columns is None else columns)
        self._places = {curve: place for place, curve in enumerate(self._columns)}
        self._curves = len(self._columns)
        self.low, self.high = session.tracked.min(axis=0), session.tracked.max(axis=0)
        self._extremes: Extremes | None = None
        self._known: dict[tuple[int, int], Polyline] = {}  # by line and curve
        self.look((0.0, 0.0), 1)

    def has(self, curve: int) -> bool:
        """Whether a curve is read."""
        return curve in self._places

    def look(self, view: Interval, columns: int) -> None:
        """Set the visible range.

        Args:
            view: first and last visible second.
            columns: number of pixel columns.
        """
        self._rows = visible_rows(self._times, *view)
        self._size = bin_size(self._rows, columns)
        if self._size >= BASE:
            self._size = self._pyramid().bin_size(self._size)
        self._known.clear()
        self._x = self._times[self._rows] if self._size == 1 else self._middles()
        self._read_again()

    def _pyramid(self) -> Extremes:
        if self._extremes is None:
            columns = (_LINES + 2) * self._curves
            self._extremes = Extremes(self._read, len(self._times), columns, base=BASE)
        return self._extremes

    def refresh(self) -> None:
        """Read the curves again."""
        y, near, filled = self._y, self._near, self._filled
        self._read_again()
        if self._filled is not filled:
            for place in range(self._curves):
                self._known.pop((_FACE, place), None)
                self._known.pop((_ASKED, place), None)
        new = (self._y != y).any(axis=2)
        new[::2] |= (self._near != near).any(axis=2)
        for line, place in np.argwhere(new).tolist():
            self._known.pop((line, place), None)

    def _read_again(self) -> None:
        if self._timeline is not None:
            self._filled = self._timeline.filled_frames
        self._read_curves()
        self._character = self._read_character()

    def _read_character(self) -> dict[int, Polyline]:
        """The lines of the user's character by curve, if single frames are drawn."""
        session = self._session
        if self._size > 1 or session.shown_rig is session.rig:
            return {}
        if self._shown_rig is not session.shown_rig:
            self._shown_rig = session.shown_rig
            self._gaps = Openings.of(session.rig), Openings.of(session.shown_rig)
        y, apart = self._on_character(session.weights[self._rows], self._live.achieved[self._rows])
        runs = [(self._x, y[:, i], shown) for i, shown in enumerate(_widened(apart.T))]
        if (filled := self._filled) is not None:
            y, apart = self._on_character(filled.weights, filled.controls)
            runs = [
                _shown_in_gaps(*run, filled.times, y[:, i], apart[:, i])
                for i, run in enumerate(runs)
            ]
        return {
            curve: run_of(*run, False) for curve, run in zip(CLOSING_COLUMNS, runs, strict=True)
        }

    def _on_character(self, weights: Floats, face: Floats) -> tuple[Values, Mask]:
        """(N, K) mm of the curves that close, on the user's character; whether it is open wider.

        Args:
            weights, face: (N, 52), and (N, C) mm on ours.
        """
        ours, theirs = (gaps.measure(weights) for gaps in self._gaps)
        wider = theirs - ours
        return face[:, CLOSING_COLUMNS] + wider, np.abs(wider) > WIDER

    def _read_curves(self) -> None:
        self._seen, changed = self._live.changes(self._seen)
        if self._extremes is not None:
            for rows in changed:
                self._extremes.update(*rows)
        if self._size == 1:
            self._y, apart = self._read_frames(self._rows)
            self._near = _widened(apart > SAME)
            return
        low, high = (values.T.reshape(_LINES + 2, self._curves, -1) for values in self._read_bins())
        # Each bin's lowest, then its highest.
        pairs = np.stack([low[:_LINES], high[:_LINES]], axis=-1)
        self._y = pairs.reshape(_LINES, self._curves, -1)
        self._near = _widened(high[_LINES:] > SAME).repeat(2, axis=-1)

    def lines(self, curve: int) -> Lines:
        """The lines of a curve; empty if it is not read."""
        if not self.has(curve):
            return Lines()
        tracked, face, asked = (self._line(line, curve) for line in range(_LINES))
        return Lines(tracked, face, asked, self._character.get(curve, EMPTY))

    def _line(self, line: int, curve: int) -> Polyline:
        place = self._places[curve]
        known = self._known.get((line, place))
        if known is None:
            y, thinned = self._y[line, place], self._size > 1
            if line == _FACE:
                known = self._through_gaps(curve, Polyline(self._x, y, None, thinned))
            else:
                # Where lines coincide, only the face is drawn: without edits, a single line.
                shown = self._near[line // 2, place]
                filled, x = self._filled, self._x
                if line == _ASKED and filled is not None:
                    asked = filled.asked[:, curve]
                    apart = np.abs(asked - filled.tracked[:, curve]) > SAME
                    x, y, shown = _shown_in_gaps(x, y, shown, filled.times, asked, apart)
                known = run_of(x, y, shown, thinned)
            self._known[line, place] = known
        return known

    def _through_gaps(self, curve: int, face: Polyline) -> Polyline:
        """The line of the face through the filled frames."""
        filled = self._filled
        if filled is None:
            return face
        x, y = through_gaps(face.x, face.y, filled.times, filled.controls[:, curve])
        return face if x is face.x else Polyline(x, y, None, face.thinned)

    def extent(self, curve: int) -> Interval:
        """Lowest and highest value in view of all lines, as far as a face can go."""
        drawn = [self._y[:, self._places[curve]]]
        if self._filled is not None:
            lines = self.lines(curve)
            drawn += [lines.face.y, lines.asked.y]
        drawn.append(self._character.get(curve, EMPTY).y)
        low = min(float(y.min()) for y in drawn if y.size)
        high = max(float(y.max()) for y in drawn if y.size)
        return self.bounded(curve, low), self.bounded(curve, high)

    def bounded(self, curve: int, value: float) -> float:
        """A value kept near what a face, or this take, can do: no axis goes further."""
        low, high = self._session.limits[curve]
        slack = _SLACK * (high - low)
        return min(max(value, low - slack), high + slack)

    def _read_frames(self, rows: slice) -> tuple[Values, Values]:
        """(3, C, N): the lines; (2, C, N): the differences of face and asked for from tracked."""
        live = self._live
        lines = np.stack(
            [array[rows].T[self._columns] for array in (live.tracked, live.achieved, live.asked)]
        )
        return lines, np.abs(lines[1:] - lines[0])

    def _read(self, rows: slice) -> Values:
        """(N, 5 C): the same, one after the other."""
        both = np.concatenate(self._read_frames(rows))
        return both.reshape(-1, both.shape[-1]).T

    @property
    def _bins(self) -> tuple[int, int]:
        """The first bin in view, and the one after the last.

        Bins start at multiples of their size in the take, not at the edge of the view, so that
        peaks do not flicker while panning.
        """
        return self._rows.start // self._size, -(-self._rows.stop // self._size)

    def _middles(self) -> Values:
        """(2 N,) seconds of each bin's two points."""
        starts = self._size * np.arange(*self._bins)
        last = len(self._times) - 1
        within = np.stack([starts, np.minimum(starts + self._size // 2, last)], axis=1)
        middles: Values = self._times[within.ravel()]
        return middles

    def _read_bins(self) -> tuple[Values, Values]:
        """Lowest and highest values (N, 5 C) of each bin."""
        size, frames, (first, last) = self._size, len(self._times), self._bins
        if size < BASE:
            values = self._read(slice(first * size, min(last * size, frames)))
            return lowest(values, size), highest(values, size)
        return self._pyramid().bins(first, last, size)


def visible_rows(times: Values, first: float, last: float) -> slice:
    """The frames from `first` to `last` seconds, and one beyond each edge."""
    start = int(np.searchsorted(times, first)) - 1
    stop = int(np.searchsorted(times, last, side="right")) + 1
    return slice(max(start, 0), min(stop, len(times)))


def bin_size(rows: slice, columns: int) -> int:
    """Frames per pixel column; 1 if all are drawn."""
    count = rows.stop - rows.start
    return 1 if count <= DENSE * max(columns, 1) else -(-count // max(columns, 1))


def run_of(x: Values, y: Values, shown: Mask, thinned: bool) -> Polyline:
    """The shown points (N,) of a curve, with neighbours joined."""
    if shown.all():
        return Polyline(x, y, None, thinned)
    if not shown.any():
        return EMPTY
    joined = np.append(shown[1:], False)[shown]
    every = bool(joined[:-1].all())
    return Polyline(x[shown], y[shown], None if every else joined, thinned)


def _shown_in_gaps(
    x: Values, y: Values, shown: Mask, seconds: Times, filled: Values, apart: Mask
) -> tuple[Values, Values, Mask]:
    """The points (N,) of a line, and which are shown, with those of the filled frames (M,).

    Args:
        x, y, shown: of the points, extended by neighbours already.
        seconds, filled, apart: of all filled frames; whether they differ from the other line.
    """
    joined, y = through_gaps(x, y, seconds, filled)
    if joined is x:
        return x, y, shown
    near = _widened(through_gaps(x, np.zeros_like(shown), seconds, apart)[1])
    return joined, y, near | through_gaps(x, shown, seconds, apart)[1]


def _widened(mask: Mask) -> Mask:
    """(..., N) mask, extended by neighbours in time.

    Neighbours of differing frames are drawn too, so that runs join the line beside them.
    """
    wide = mask.copy()
    wide[..., 1:] |= mask[..., :-1]
    wide[..., :-1] |= mask[..., 1:]
    return wide
