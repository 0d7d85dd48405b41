"""Fill: edits that replace a stretch of the take by other motion of it, in four variations."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from faceedit_app.core.arrays import Doubles, Times
from faceedit_app.core.controls import CONTROL_INDEX, LIP_OPENING, MAIN_CONTROLS
from faceedit_app.editing.edits.edit import LONGEST_FILL, Edit, Op
from faceedit_app.editing.session import EditSession
from faceedit_app.formats.take import Take
from faceedit_app.formats.timing import counted
from faceedit_app.media.loudness import loudness

if TYPE_CHECKING:  # imports PyAV, which is loaded with the first file
    from faceedit_app.media.sound import Sound

VARIATIONS = 4
_LEARNED = 30.0  # seconds on either side from which loudness and opening are compared
_STEP = 0.04  # seconds between two points of a guide
_LAGS = np.arange(-3, 4)  # of a guide: lips move before and after their sound
_RIDGE = 1.0
_RELATED = 0.3  # correlation below which the loudness says nothing about the opening
_ENOUGH = 50  # points to learn from
_SLACK = 1e-6  # seconds by which an end may miss a row
_MOST_GAIN = 2.0  # a prediction moves less than what it predicts; by so much it is widened


@dataclass(frozen=True)
class Heard:
    """A sound, and the second of the take at which its file begins."""

    sound: Sound
    offset: float = 0.0


def cannot_fill(take: Take, start: float, end: float) -> str:
    """Why a range cannot be filled, in a sentence for the user; empty if it can."""
    clip = take.clip
    inside = (clip.times >= start - 1e-9) & (clip.times <= end + 1e-9)
    if end - start > LONGEST_FILL + 1e-6:
        return f"Fill makes up to {LONGEST_FILL:.0f} s; select a shorter range"
    if not inside.any() and not _rows_filled(take, start, end):
        return "There is no frame in the selection to fill; select a longer range"
    if inside.all():
        return "The selection is the whole take; leave some motion on one side of it"
    return ""


def fill_edit(session: EditSession, start: float, end: float, heard: Heard | None = None) -> Edit:
    """An edit that fills a range, as its first variation.

    Args:
        start, end: seconds.
        heard: the sound of the take, which steers the mouth; what is needed of it is kept in the
            edit, so that the result is the same without the sound.
    """
    rows = _lost_within(session.take, start, end).tolist()
    start, end = round(start, 4), round(end, 4)
    if rows:  # an end at a row without a face gives it one, to whichever side it is rounded
        start, end = min(start, rows[0]), max(end, rows[-1])
    points = () if heard is None else opening_heard(session, heard, start, end)
    return Edit(MAIN_CONTROLS, Op.FILL, start, end, 0.0, points=points)


def variations(edit: Edit) -> tuple[Edit, ...]:
    """The variations of a fill, its own first."""
    return tuple(replace(edit, seed=edit.seed + number) for number in range(VARIATIONS))


def filled_message(take: Take, start: float, end: float, heard: bool) -> str:
    """What a fill did, for the user."""
    text = "Filled with other motion of the take"
    if heard:
        text += ", as loud as the sound"
    found, left = _faces_given(_rows_filled(take, start, end)), _left(take, start, end)
    return "; ".join([text, *filter(None, (found, left and f"the file has no row for {left}"))])


def filled_briefly(take: Take, start: float, end: float) -> str:
    """The same in a few words, for a narrow window."""
    found, left = _rows_filled(take, start, end), _left(take, start, end)
    given = f"{counted(found, 'row')} {'gets' if found == 1 else 'get'} a face" if found else ""
    said = "; ".join(filter(None, (given, left and f"no row for {left}"))) or "Filled"
    return f"{said[:1].upper()}{said[1:]}"


def _left(take: Take, start: float, end: float) -> str:
    """The lost frames in a range for which the file has no row, such as `3 lost frames`."""
    clip = take.clip
    lost = sum(g.missing for g in clip.gaps if start <= clip.times[g.frame] < end)
    left = lost - _rows_filled(take, start, end)
    return counted(left, "lost frame") if left > 0 else ""


def variations_of(fix: Sequence[Edit]) -> list[tuple[Edit, ...]]:
    """A fix of fills in its variations; none of another fix."""
    if any(edit.op is not Op.FILL for edit in fix):
        return []
    return list(zip(*map(variations, fix), strict=True))


def faces_given(take: Take, fix: Sequence[Edit]) -> str:
    """What is said of a fix that fills rows without a face; else nothing."""
    fills = [edit.span for edit in fix if edit.op is Op.FILL]
    said = _faces_given(sum(_rows_filled(take, *span) for span in fills))
    return f"{said[:1].upper()}{said[1:]}"


def _rows_filled(take: Take, start: float, end: float) -> int:
    """How many rows without a face a fill of a range, in seconds, gives one."""
    return len(_lost_within(take, start, end))


def _faces_given(rows: int) -> str:
    if not rows:
        return ""
    verb = "gets" if rows == 1 else "get"
    return f"{counted(rows, 'row')} without a face {verb} one, as shown in the gap"


def _lost_within(take: Take, start: float, end: float) -> Times:
    """(N,) seconds of the rows without a face in a range, to which a fill can give one."""
    if take.lost_rows is None:
        return np.empty(0)
    seconds = take.lost_rows.times(take.clip)
    return seconds[(seconds >= start - _SLACK) & (seconds <= end + _SLACK)]


def opening_heard(
    session: EditSession, heard: Heard, start: float, end: float
) -> tuple[tuple[float, float], ...]:
    """The mouth opening that goes with the loudness of a range, as (seconds, mm).

    A linear regression of the take's own opening on the loudness around it, from the motion on
    both sides. Empty if the two are not related in this take.
    """
    clip = session.take.clip
    first, last = max(start - _LEARNED, 0.0), min(end + _LEARNED, float(clip.times[-1]))
    grid = np.arange(round(first / _STEP), round(last / _STEP) + 1).astype(np.float64) * _STEP
    curve = session.tracked[:, CONTROL_INDEX[LIP_OPENING]].astype(np.float64)
    opening = np.interp(grid, clip.times, curve)
    features = _features(grid, heard)
    known = (grid < start - _STEP) | (grid > end + _STEP)
    known &= np.abs(np.gradient(opening)) > 0  # a lost face does not move
    if known.sum() < _ENOUGH:
        return ()
    mean, middle = opening[known].mean(), features[known].mean(axis=0)
    x, y = features[known] - middle, opening[known] - mean
    slopes = np.linalg.solve(x.T @ x + _RIDGE * np.eye(x.shape[1]), x.T @ y)
    spread = float(y.std() * (x @ slopes).std())
    related = float((y * (x @ slopes)).mean()) / spread if spread > 0 else 0.0
    if not related >= _RELATED:
        return ()
    inside = (grid >= start - _STEP) & (grid <= end + _STEP)
    gain = min(1.0 / related, _MOST_GAIN)
    wanted = mean + gain * ((features[inside] - middle) @ slopes)
    wanted = np.clip(wanted, opening[known].min(), opening[known].max())
    times = grid[inside].round(4).tolist()
    return tuple(zip(times, wanted.round(2).tolist(), strict=True))


def _features(grid: Times, heard: Heard) -> Doubles:
    """(N, L) the loudness around each time of a grid, 0 in silence to 1."""
    level = loudness(heard.sound, grid - heard.offset, 2 * _STEP)
    low, high = np.percentile(level, (5.0, 95.0))
    share = ((level - low) / max(float(high - low), 1.0)).clip(0.0, 1.0)
    places = np.clip(np.arange(len(grid))[:, None] + _LAGS, 0, len(grid) - 1)
    features: Doubles = share[places]
    return features
