"""The picture beside a film side by side: a few moments of it, with titles and times."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from faceedit_app.core.arrays import Bools, Doubles, Floats, Indices, Pixels, Times
from faceedit_app.core.clip import Clip
from faceedit_app.core.controls import CONTROL_INDEX, LIDS, LIP_OPENING
from faceedit_app.core.rig import Rig
from faceedit_app.formats.timing import format_time

_ROWS = 4  # of the picture
_VISIBLE = 0.5  # mm by which an edit changes a curve
_APART = 0.3  # seconds between two moments of edits
_NEAR = 0.15  # seconds from where an edit changes most to where the face shows it most
_TITLES = ("Film", "Tracked", "Edited")
_STRIP = 32  # pixels above the columns and under each row, for words
_TEXT = 20  # pixels
_INK, _PAPER = (0xE6, 0xE6, 0xE6), (0x1B, 0x1D, 0x22)


@dataclass(frozen=True)
class Column:
    """A face for each of the F pictures of a film.

    Attributes:
        weights: (T, 52) in ARKit's order, of a take's frames.
        rows: (F,) the frame that is nearest to each picture.
        is_there: (F,) whether it belongs to the picture; else the take has a gap there.
        turns: (T, 9) radians, how head and eyes are turned; None if the head stays straight.
    """

    weights: Floats
    rows: Indices
    is_there: Bools
    turns: Floats | None = None

    @classmethod
    def of(cls, clip: Clip, times: Times, follows_head: bool = False) -> Column:
        """The frames of a clip at times (F,) of its clock; the head turns if it is followed."""
        rows = np.array([clip.frame_at(seconds) for seconds in times.tolist()], np.intp)
        is_there = np.abs(clip.times[rows] - times) < 0.75 / clip.rate
        turns = clip.rotations if follows_head else None
        return cls(clip.arkit_weights(), rows, is_there, turns)


def moments(tracked: Column, edited: Column, times: Times, rig: Rig) -> list[int]:
    """The pictures of a film that say most about it, in order of time.

    These are moments at which edits change most, where the film shows a face: a gap has nothing
    to compare with. If too few are edited, others follow, among them the lips shut, the lips most
    open, and the lids shut.

    Args:
        tracked, edited: the faces of the F pictures.
        times: (F,) seconds.
        rig: the character.
    """
    pictures = np.flatnonzero(tracked.is_there & edited.is_there)
    found, after = _edited(tracked, edited, times, rig, pictures)
    if not found:  # unless only gaps were filled
        pictures = np.flatnonzero(edited.is_there)
        found, after = _edited(tracked, edited, times, rig, pictures)
    opening, lids = after[:, CONTROL_INDEX[LIP_OPENING]], [CONTROL_INDEX[lid] for lid in LIDS]
    order = np.argsort(opening, kind="stable")
    spread = order[np.linspace(0, len(order) - 1, _ROWS).astype(int)].tolist()
    others = [spread[0], spread[-1], int(after[:, lids].sum(axis=1).argmin()), *spread, *order]
    for other in others:
        if len(found) < _ROWS and other not in found:
            found.append(int(other))
    chosen: list[int] = pictures[sorted(found)].tolist()
    return chosen


def _edited(
    tracked: Column, edited: Column, times: Times, rig: Rig, pictures: Indices
) -> tuple[list[int], Doubles]:
    """Which of some pictures (N,) edits change most, and their curves (N, C) in mm."""
    before, after = (
        rig.arkit_distances.measure(face.weights[face.rows[pictures]]).astype(np.float64)
        for face in (tracked, edited)
    )
    return _most_changed(after - before, after, times[pictures]), after


def _most_changed(change: Doubles, after: Doubles, times: Times) -> list[int]:
    """Up to `_ROWS` frames, apart from each other, that edits change most.

    Each is where the curve that an edit changes shows it most, such as a blink where it is shut.

    Args:
        change, after: (T, C) mm.
        times: (T,) seconds.
    """
    found: list[int] = []
    amount = np.abs(change)
    while len(found) < _ROWS and amount.max(initial=0.0) > _VISIBLE:
        frame, curve = np.unravel_index(int(amount.argmax()), amount.shape)
        near = np.flatnonzero(np.abs(times - times[frame]) <= _NEAR)
        way = np.sign(change[frame, curve]) * after[near, curve]
        extreme = near[way >= way.max() - 1e-6]
        found.append(int(extreme[len(extreme) // 2]))
        amount[np.abs(times - times[found[-1]]) < _APART] = 0.0
        amount[np.abs(times - times[frame]) < _APART] = 0.0
    return list(dict.fromkeys(found))


def sheet(rows: Sequence[Pixels], times: Sequence[float]) -> Pixels:
    """(H, W, 3): rows of columns, with titles above them, and under each row its time.

    Args:
        rows: (h, n h, 3) each: film, tracked and, if there is one, edited face.
        times: seconds of the take.
    """
    high, wide = rows[0].shape[:2]
    image = Image.new("RGB", (wide, _STRIP + len(rows) * (high + _STRIP)), _PAPER)
    draw, font = ImageDraw.Draw(image), ImageFont.load_default(_TEXT)
    for column, title in enumerate(_TITLES[: wide // high]):
        draw.text(((column + 0.5) * high, _STRIP / 2), title, _INK, font, anchor="mm")
    for number, (row, seconds) in enumerate(zip(rows, times, strict=True)):
        top = _STRIP + number * (high + _STRIP)
        image.paste(Image.fromarray(row), (0, top))
        place = (wide / 2, top + high + _STRIP / 2)
        draw.text(place, format_time(seconds), _INK, font, anchor="mm")
    return np.asarray(image)
