"""Putting presets on a take: the one-click fixes. Each returns ordinary edits."""

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

TOUCHING = 0.5  # mm between inner lips that surely touch, in a take whose lips never do
STILL = 0.8  # of the open eye: a lid that stays above does not blink
NEAR = 0.3  # seconds from the playhead within which a fix looks for what it mends


def apply_preset(
    session: EditSession,
    preset: Preset,
    selection: tuple[float, float] | None,
    playhead: float,
    falloff: float | None = None,
) -> tuple[Edit, ...]:
    """The edits of a preset in a take; the session is only looked at.

    Args:
        session: the take as it is now.
        preset: what to apply.
        selection: seconds, or None.
        playhead: seconds.
        falloff: seconds for a selection's ends where the preset ships; None = its own.
    """
    found = _mend(session, preset, selection, playhead)
    if found:
        return tuple(replace(edit, name=preset.name) for edit in found)
    placed = _place(session, preset, selection, playhead, falloff)
    return tuple(
        replace(_fit(session, edit, preset.find), name=edit.name or preset.name) for edit in placed
    )


def close_lips(dip: Dip, closed: float) -> Edit:
    """Let the lips meet where they nearly did.

    Args:
        dip: the mouth opening there.
        closed: mm between the inner lips of a closed mouth in this take.
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
    """Let the lids that stopped half-way meet, in the blink's own time."""
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
    """The blinks that left an eye open, and the eyelids that took part in them.

    Args:
        times: (T,) seconds.
        controls: (T, C) mm.
        rate: frames per second.
    """
    usual = [open_eyes(controls[:, column]) for column in LID_COLUMNS]
    found = []
    for dip in blinks(times, controls, rate):
        near = controls[max(dip.frame - 1, 0) : dip.frame + 2, LID_COLUMNS].min(axis=0)
        # A lid that stays up leaves the other a wink.
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
    """Edits at the places that the take itself names; none if it names none nearby."""
    times, rate = session.take.clip.times, session.take.clip.rate
    controls = session.achieved.astype(np.float64)
    if preset.find is Find.BLINK:
        half = dict(half_blinks(times, controls, rate))
        return [complete_blink(dip, half[dip]) for dip in _near([*half], selection, playhead)]
    if preset.find is Find.LIPS:
        if selection is not None and selection[1] - selection[0] < CLOSURE_WIDTH:
            return []  # so short a selection is itself the closure that is wanted
        dips = missed_closures(times, controls, session.weights.astype(np.float64), rate)
        closed = closed_lips(controls)
        return [close_lips(dip, closed) for dip in _near(dips, selection, playhead)]
    return []


def _near(dips: list[Dip], selection: tuple[float, float] | None, playhead: float) -> list[Dip]:
    """All dips in the selection, else the one at the playhead."""
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
    """Bring a preset's edits from 0..seconds to where they are wanted."""
    length, duration = preset.seconds, float(session.take.clip.times[-1])
    if selection is None and preset.alone is Alone.TAKE:
        selection, falloff = (0.0, duration), 0.0
    if selection is None:
        start = playhead - (0.5 * length if preset.alone is Alone.PLAYHEAD else 0.0)
        return [edit.shifted(start) for edit in preset.edits]
    if not preset.stretch:
        return [edit.shifted(0.5 * (sum(selection) - length)) for edit in preset.edits]
    factor = (selection[1] - selection[0]) / length if length > 0 else 0.0
    placed = []
    for edit in preset.edits:
        ends = (selection[0] + factor * edit.start, selection[0] + factor * edit.end)
        edit = edit.stretched(*ends)
        if not preset.own and falloff is not None:
            edit = replace(edit, falloff=falloff, falloff_out=None)
        placed.append(edit)
    return placed


def _fit(session: EditSession, edit: Edit, find: Find | None) -> Edit:
    """Amounts that depend on the take."""
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
