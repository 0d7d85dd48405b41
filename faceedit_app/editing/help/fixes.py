"""One-click fixes: apply presets to a take. The results are ordinary edits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from faceedit_app.core.arrays import Doubles, Times
from faceedit_app.core.controls import CONTROL_INDEX, LIDS, LIP_OPENING
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.help.events import (
    CLOSURE_WIDTH,
    LID_COLUMNS,
    SHUT,
    Dip,
    blinks,
    closed_lips,
    missed_closures,
    open_eyes,
)
from faceedit_app.editing.help.presets import Alone, Find, Preset
from faceedit_app.editing.session import EditSession

TOUCHING = 0.5  # mm; the mouth opening of touching lips, for a take in which they never touch
STILL = 0.8  # of the eye opening; a lid that stays above does not blink
NEAR = 0.3  # seconds around the playhead that a fix searches


def apply_preset(
    session: EditSession,
    preset: Preset,
    selection: tuple[float, float] | None,
    playhead: float,
    falloff: float | None = None,
) -> tuple[Edit, ...]:
    """The edits that a preset makes in a take; the session is not changed.

    Args:
        session: the take.
        preset: the preset.
        selection: first and last second, or None.
        playhead: seconds.
        falloff: seconds; replaces the falloff of shipped presets on a selection; None = theirs.
    """
    found = _mend(session, preset, selection, playhead)
    if found:
        return tuple(replace(edit, name=preset.name) for edit in found)
    placed = _place(session, preset, selection, playhead, falloff)
    return tuple(
        replace(_fit(session, edit, preset.find), name=edit.name or preset.name) for edit in placed
    )


def close_lips(dip: Dip, closed: float) -> Edit:
    """An edit that lets the lips meet where they nearly did.

    Args:
        dip: the dip of the mouth opening.
        closed: the mouth opening of closed lips in this take, mm.
    """
    return Edit(
        (LIP_OPENING,),
        Op.SET,
        round(dip.time - 0.015, 4),
        round(dip.time + 0.015, 4),
        falloff=_between(0.06, dip.time - dip.start, 0.15),
        value=round(min(closed, TOUCHING), 2),
        falloff_out=_between(0.06, dip.end - dip.time, 0.15),
        name="Close lips",
    )


def complete_blink(dip: Dip, controls: Sequence[str] = LIDS) -> Edit:
    """An edit that completes a blink in its own time."""
    return Edit(
        tuple(controls),
        Op.SET,
        round(dip.time, 4),
        round(dip.time + 0.02, 4),
        falloff=_between(0.07, dip.time - dip.start, 0.15),
        value=0.0,
        falloff_out=_between(0.15, dip.end - dip.time, 0.35),
        name="Complete blink",
    )


def half_blinks(times: Times, controls: Doubles, rate: float) -> list[tuple[Dip, tuple[str, ...]]]:
    """The blinks that left an eye open, and the ids of the eyelids that took part.

    Args:
        times: (T,) seconds.
        controls: (T, C) mm.
        rate: frames per second.
    """
    usual = [open_eyes(controls[:, column]) for column in LID_COLUMNS]
    found = []
    for dip in blinks(times, controls, rate):
        near = controls[max(dip.frame - 1, 0) : dip.frame + 2, LID_COLUMNS].min(axis=0)
        # If one lid stays up, it is a wink of the other.
        took_part = [low < STILL * high for low, high in zip(near, usual, strict=True)]
        shut = [low <= SHUT * high for low, high in zip(near, usual, strict=True)]
        lids = tuple(name for name, took in zip(LIDS, took_part, strict=True) if took)
        if any(took and not s for took, s in zip(took_part, shut, strict=True)):
            found.append((dip, lids))
    return found


def _mend(
    session: EditSession,
    preset: Preset,
    selection: tuple[float, float] | None,
    playhead: float,
) -> list[Edit]:
    """Edits at the places that `preset.find` looks for; none if there are none nearby."""
    times, rate = session.take.clip.times, session.take.clip.rate
    controls = session.achieved.astype(np.float64)
    if preset.find is Find.BLINK:
        half = dict(half_blinks(times, controls, rate))
        return [complete_blink(dip, half[dip]) for dip in _near([*half], selection, playhead)]
    if preset.find is Find.LIPS:
        if selection is not None and selection[1] - selection[0] < CLOSURE_WIDTH:
            return []  # a selection this short is itself the closure
        dips = missed_closures(times, controls, session.weights.astype(np.float64), rate)
        closed = closed_lips(controls)
        return [close_lips(dip, closed) for dip in _near(dips, selection, playhead)]
    return []


def _near(dips: list[Dip], selection: tuple[float, float] | None, playhead: float) -> list[Dip]:
    """All dips in the selection, else the one nearest to the playhead."""
    if selection is not None:
        return [dip for dip in dips if selection[0] <= dip.time <= selection[1]]
    dips = [dip for dip in dips if abs(dip.time - playhead) <= NEAR]
    return sorted(dips, key=lambda dip: abs(dip.time - playhead))[:1]


def _place(
    session: EditSession,
    preset: Preset,
    selection: tuple[float, float] | None,
    playhead: float,
    falloff: float | None,
) -> list[Edit]:
    """A preset's edits, moved to where they are wanted."""
    length, duration = preset.seconds, float(session.take.clip.times[-1])
    if selection is None and preset.alone is Alone.TAKE:
        selection, falloff = (0.0, duration), 0.0
    if selection is None:
        # One that begins at the playhead ends with the take: beyond it, edits would do nothing.
        start = max(min(playhead, duration - length), 0.0)
        if preset.alone is Alone.PLAYHEAD:
            start = playhead - 0.5 * length
        return [edit.shifted(start) for edit in preset.edits]
    if not preset.stretch or length <= 0:
        return [edit.shifted(0.5 * (sum(selection) - length)) for edit in preset.edits]
    factor = (selection[1] - selection[0]) / length
    placed = []
    for edit in preset.edits:
        ends = (selection[0] + factor * edit.start, selection[0] + factor * edit.end)
        edit = edit.stretched(*ends)
        if not preset.own and falloff is not None:
            edit = replace(edit, falloff=falloff, falloff_out=None)
        placed.append(edit)
    return placed


def _fit(session: EditSession, edit: Edit, find: Find | None) -> Edit:
    """The edit with amounts that depend on the take."""
    if find is Find.EYES:
        columns = [CONTROL_INDEX[control] for control in edit.controls]
        usual = open_eyes(session.tracked[:, columns].astype(np.float64))
        return replace(edit, value=round(usual, 2))
    if find is Find.LIPS:
        closed = closed_lips(session.tracked.astype(np.float64))
        return replace(edit, value=round(min(edit.value, closed), 2))
    return edit


def _between(low: float, value: float, high: float) -> float:
    return round(min(max(value, low), high), 4)
