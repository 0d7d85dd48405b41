"""Edits and words that stay on what they were made on when a retime changes.

A retime moves the take's content in time. What was edited there moves along, and back when the
retime is switched off or deleted; edits below it in the list were made on the retimed take, and
stay. Fills, other retimes, and neutral rests of the take stay too: they act before all others, in
their own order.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from faceedit_app.core.arrays import Times
from faceedit_app.editing.edits.clock import Clock, clock_of
from faceedit_app.editing.edits.dividing import are_late
from faceedit_app.editing.edits.edit import OF_THE_TAKE, Edit, Op, at_times
from faceedit_app.words.transcript import Transcript

DIGITS = 6  # of the seconds of an edit that was moved
_SAME = 1e-6  # seconds


def following(before: Sequence[Edit], after: Sequence[Edit]) -> tuple[Edit, ...]:
    """A changed list of edits, in which those that did not change follow the retimes that did.

    Args:
        before, after: the lists, oldest edit first.
    """
    found = list(after)
    # How many edits above a retime were there before it changed.
    kept: Counter[Edit] | None = None
    for place, old, new in _changes(before, after):
        kept = kept or Counter(before) & Counter(after)
        left = kept.copy()
        late = are_late(after)
        for i, edit in enumerate(after[:place]):
            if left[edit] > 0:
                left[edit] -= 1
                if late[i] or edit.op not in OF_THE_TAKE:
                    found[i] = _moved(found[i], _clock(old), _clock(new))
    return tuple(found)


def words_following(words: Transcript, before: Sequence[Edit], after: Sequence[Edit]) -> Transcript:
    """Words that belong to the face, and follow the retimes that changed; a cut removes them."""
    for _, old, new in _changes(before, after):
        words = words.at_times(partial(_times, before=_clock(old), after=_clock(new)))
    return words


def _changes(
    before: Sequence[Edit], after: Sequence[Edit]
) -> Iterator[tuple[int, Edit | None, Edit | None]]:
    """Each retime that changed: its place in `after`, and it before and after; None if absent."""
    if not any(edit.op is Op.RETIME for edit in (*before, *after)):
        return
    if Counter(before) == Counter(after):  # a list that was only reordered
        return
    if len(before) == len(after):
        for i, (old, new) in enumerate(zip(before, after, strict=True)):
            if old != new and Op.RETIME in (old.op, new.op):
                yield i, old, new
        return
    new_ones, gone = Counter(after) - Counter(before), Counter(before) - Counter(after)
    passed = 0  # edits of `before` that are still there, up to the one at hand
    for edit in before:
        if gone[edit] > 0:
            gone[edit] -= 1
            if edit.op is Op.RETIME:
                yield passed, edit, None
        else:
            passed += 1
    for i, edit in enumerate(after):
        if new_ones[edit] > 0 and edit.op is Op.RETIME:
            new_ones[edit] -= 1
            yield i, None, edit


def _clock(edit: Edit | None) -> Clock | None:
    if edit is None or edit.op is not Op.RETIME or edit.effect is None:
        return None
    return clock_of(edit.effect)


def _times(old: Times, before: Clock | None, after: Clock | None) -> Times:
    """(N,) when what was shown at `old` (N,) is shown now."""
    moments = old if before is None else before.moments(old)
    return moments if after is None else after.shown(moments)


def _moved(edit: Edit, before: Clock | None, after: Clock | None) -> Edit:
    """An edit on the same moments of the take; one whose moments are cut is switched off."""
    if before is after:
        return edit
    first, last = edit.span
    old = np.array([first, edit.start, edit.end, last, *(time for time, _ in edit.points)])
    moments = old if before is None else before.moments(old)
    if after is not None and after.cuts_out(moments[1:3]).all():
        return replace(edit, enabled=False)
    new = _times(old, before, after)
    if np.abs(new - old).max() < _SAME:
        return edit
    first, start, end, last, *times = new.round(DIGITS).tolist()
    fades = max(start - first, 0.0), max(last - end, 0.0)
    return replace(
        edit,
        start=start,
        end=end,
        falloff=fades[0],
        falloff_out=None if fades[0] == fades[1] else fades[1],
        points=at_times(times, edit.points),  # those that are cut fall together
    )
