"""One-click fixes: apply presets to a take. The results are ordinary edits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from faceedit_app.core.controls import CONTROL_INDEX, LIDS, LIP_OPENING
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.help.events import (
    CLOSURE_WIDTH,
    HARDLY_APART,
    Dip,
    closed_lips,
    lip_dips,
    open_eyes,
)
from faceedit_app.editing.help.habits import habits_of, half_blinks, missed_closures
from faceedit_app.editing.help.presets import Alone, Find, Preset
from faceedit_app.editing.session import EditSession

TOUCHING = 0.5  # mm; the mouth opening of touching lips, for a take in which they never touch
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
    placed = [
        replace(_fit(session, edit, preset.find), name=edit.name or preset.name)
        for edit in _place(session, preset, selection, playhead, falloff)
    ]
    return (*placed, *([] if preset.own else _kept_closures(session, placed, preset.name)))


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


def _mend(
    session: EditSession,
    preset: Preset,
    selection: tuple[float, float] | None,
    playhead: float,
) -> list[Edit]:
    """Edits at the places that `preset.find` looks for; none if there are none nearby."""
    clip, usual = session.take.clip, habits_of(session)
    controls = session.achieved.astype(np.float64)
    if preset.find is Find.BLINK:
        half = dict(half_blinks(clip, controls, usual))
        return [complete_blink(dip, half[dip]) for dip in _near([*half], selection, playhead)]
    if preset.find is Find.LIPS:
        if selection is not None and selection[1] - selection[0] < CLOSURE_WIDTH:
            return []  # a selection this short is itself the closure
        dips = missed_closures(clip, controls, session.weights.astype(np.float64), usual)
        return [close_lips(dip, usual.closed) for dip in _near(dips, selection, playhead)]
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


def _kept_closures(session: EditSession, edits: Sequence[Edit], name: str) -> list[Edit]:
    """Edits that let lips meet where they do, although an expression drops the jaw."""
    spans = [
        edit.span
        for edit in edits
        if edit.op is Op.OFFSET and edit.value > 0 and LIP_OPENING in edit.controls
    ]
    if not spans:
        return []
    clip, least = session.take.clip, habits_of(session).closed + HARDLY_APART
    controls = session.achieved.astype(np.float64)
    closures = [
        dip
        for dip, _ in lip_dips(clip.times, controls, np.zeros(len(clip)), clip.rate)
        if dip.level <= least and any(first < dip.time < last for first, last in spans)
    ]
    return [
        replace(
            close_lips(dip, session.closed), value=round(dip.level, 2), name=f"{name}: lips meet"
        )
        for dip in closures
    ]


def _between(low: float, value: float, high: float) -> float:
    return round(min(max(value, low), high), 4)
