"""What Fill makes of a selection, with and without sound."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.sessions import demo_take, session_by_rig, take_of

from faceedit_app.core.clip import Gap
from faceedit_app.core.controls import CONTROL_INDEX, LIP_OPENING, MAIN_CONTROLS
from faceedit_app.editing.edits.edit import Op
from faceedit_app.editing.help.fill import (
    Heard,
    cannot_fill,
    fill_edit,
    filled_briefly,
    filled_message,
    opening_heard,
    variations,
)
from faceedit_app.media.loudness import loudness
from faceedit_app.media.sound import Sound, extremes_of

RATE = 16_000


def sound_of(level: np.ndarray[tuple[int], np.dtype[np.float64]], start: float = 0.0) -> Sound:
    """Noise with a level of 0..1 per sample."""
    noise = np.random.default_rng(3).normal(0.0, 3000.0, len(level))
    samples = (noise * level).astype(np.int16)[:, None]
    return Sound(Path("take.wav"), RATE, samples, start, extremes_of(samples))


def speaking() -> Sound:
    """A sound that is louder the wider the demo take's mouth is open."""
    session = session_by_rig(demo_take())
    opening = session.tracked[:, CONTROL_INDEX[LIP_OPENING]].astype(np.float64)
    times = np.arange(10 * RATE) / RATE
    level = np.interp(times, demo_take().clip.times, opening)
    level = (level - level.min()) / (level.max() - level.min())
    return sound_of(10.0 ** (-2.0 * (1.0 - level)))


def test_loudness_is_measured_in_decibels_and_is_silent_beyond_the_sound() -> None:
    sound = sound_of(np.repeat([1.0, 0.1], RATE), start=0.5)
    loud, quiet, beyond = loudness(sound, np.array([1.0, 2.0, 5.0]), 0.1)
    assert loud - quiet == pytest.approx(20.0, abs=1.0)
    assert beyond == pytest.approx(-100.0)


def test_loudness_says_how_far_the_mouth_opens() -> None:
    session = session_by_rig(demo_take())
    points = np.array(opening_heard(session, Heard(speaking()), 4.0, 5.5))
    curve = session.tracked[:, CONTROL_INDEX[LIP_OPENING]]
    true = np.interp(points[:, 0], demo_take().clip.times, curve)
    assert np.corrcoef(points[:, 1], true)[0, 1] > 0.7


def test_the_sound_may_begin_later_than_the_take() -> None:
    session = session_by_rig(demo_take())
    here = opening_heard(session, Heard(speaking()), 4.0, 5.5)
    moved = replace(speaking(), start=-2.0)
    assert opening_heard(session, Heard(moved, 2.0), 4.0, 5.5) == here


def test_a_sound_that_has_nothing_to_do_with_the_mouth_does_not_steer_it() -> None:
    session = session_by_rig(demo_take())
    hum = sound_of(np.ones(10 * RATE))
    assert fill_edit(session, 4.0, 5.5, Heard(hum)).points == ()


def test_a_fill_covers_all_curves_and_has_four_variations() -> None:
    session = session_by_rig(demo_take())
    edit = fill_edit(session, 4.0, 5.5)
    assert (edit.op, edit.controls) == (Op.FILL, MAIN_CONTROLS)
    assert [each.seed for each in variations(edit)] == [0, 1, 2, 3]


def test_the_sound_is_needed_only_once() -> None:
    """The edit keeps what it needs of it, so a project without its sound gives the same face."""
    one, other = (session_by_rig(demo_take()) for _ in range(2))
    one.add(fill_edit(one, 4.0, 5.5, Heard(speaking())))
    other.put(one.edits)
    assert one.edits[0].points
    assert np.array_equal(one.weights, other.weights)


@pytest.mark.parametrize(
    ("span", "why"),
    [((1.0, 5.5), "up to 4 s"), ((1.0, 1.0001), "no frame"), ((0.0, 3.0), "")],
)
def test_what_cannot_be_filled_is_said(span: tuple[float, float], why: str) -> None:
    clip = demo_take().clip
    start = float(clip.times[60]) + 1e-3 if why == "no frame" else span[0]
    found = cannot_fill(demo_take(), start, start + span[1] - span[0])
    assert why in found
    assert bool(found) == bool(why)


def test_rows_that_the_file_lacks_are_said_to_stay_missing() -> None:
    take = take_of(replace(demo_take().clip, gaps=(Gap(300, 12),)))
    assert "no row for 12 lost frames" in filled_message(take, 4.0, 6.0, heard=False)
    assert "no row" not in filled_message(take, 6.0, 7.0, heard=False)
    assert filled_briefly(take, 4.0, 6.0) == "No row for 12 lost frames"
    assert filled_briefly(take, 6.0, 7.0) == "Filled"
