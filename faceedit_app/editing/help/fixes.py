"""One-click fixes: apply presets to a take. The results are ordinary edits."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
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
from faceedit_app.editing.solving.filled_frames import AllFrames

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
    frames = session.all_frames()
    found = _mend(session, frames, preset, selection, playhead)
    if found:
        return tuple(replace(edit, name=preset.name) for edit in found)
    placed = [
        replace(_fit(session, edit, preset.find), name=edit.name or preset.name)
        for edit in _place(session, preset, selection, playhead, falloff)
    ]
    if preset.own:
        return tuple(placed)
    return tuple(part for edit in placed for part in _beside_closures(session, frames, edit))


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
    frames: AllFrames,
    preset: Preset,
    selection: tuple[float, float] | None,
    playhead: float,
) -> list[Edit]:
    """Edits at the places that `preset.find` looks for; none if there are none nearby."""
    clip, usual = frames.clip, habits_of(session)
    controls = frames.achieved.astype(np.float64)
    if preset.find is Find.BLINK:
        half = dict(half_blinks(clip, controls, usual))
        return [complete_blink(dip, half[dip]) for dip in _near([*half], selection, playhead)]
    if preset.find is Find.LIPS:
        if selection is not None and selection[1] - selection[0] < CLOSURE_WIDTH:
            return []  # a selection this short is itself the closure
        dips = missed_closures(clip, controls, frames.weights.astype(np.float64), usual)
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
    length, last = preset.seconds, float(session.take.clip.times[-1])
    if selection is None and preset.alone is Alone.TAKE:
        selection, falloff = (0.0, last), 0.0
    if selection is None:
        # One that begins at the playhead ends with the take: beyond it, edits would do nothing.
        start = max(min(playhead, last - length), 0.0)
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


def _beside_closures(session: EditSession, frames: AllFrames, edit: Edit) -> Iterator[Edit]:
    """The parts of an edit between closures, if it drops the jaw: lips meet where they do.

    At any strength: an edit that closes them again would be weaker with a weaker expression.
    """
    if not (edit.op is Op.OFFSET and edit.value > 0 and LIP_OPENING in edit.controls):
        yield edit
        return
    clip, least = frames.clip, habits_of(session).closed + HARDLY_APART
    controls = frames.achieved.astype(np.float64)
    dips = lip_dips(clip.times, controls, np.zeros(len(clip)), clip.rate)
    first, last = edit.span
    start, fade, shut = edit.start, edit.falloff, first
    for dip, _ in dips:
        if dip.level > least or not first < dip.time < last:
            continue
        closing = close_lips(dip, least)  # which says how long the lips take
        if closing.start > edit.start:
            end = closing.start - closing.falloff
            if end < start:  # closures that follow each other soon: half-way between them
                start = end = max((shut + closing.start) / 2, edit.start)
                fade = start - shut
            yield _part(edit, start, end, fade, closing.start - end)
        after = closing.falloff if closing.falloff_out is None else closing.falloff_out
        shut, start, fade = closing.end, closing.end + after, after
    if shut < edit.end:
        if start > edit.end:
            start, fade = edit.end, edit.end - shut
        yield _part(edit, start, edit.end, fade, last - edit.end)


def _part(edit: Edit, start: float, end: float, fade: float, fade_out: float) -> Edit:
    """A part of an edit, with the falloffs before and after it; all in seconds."""
    start, end, fade, fade_out = (round(value, 4) for value in (start, end, fade, fade_out))
    if (start, end, fade) == (edit.start, edit.end, edit.falloff):
        return edit
    out = None if fade == fade_out else fade_out
    return replace(edit, start=start, end=end, falloff=fade, falloff_out=out)


def _between(low: float, value: float, high: float) -> float:
    return round(min(max(value, low), high), 4)
