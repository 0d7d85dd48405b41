"""Curves that were not asked for: kept where the take is right, as around where it breaks off."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.completions import COUNT, Answering
from support.faces import shipped_rig, talking_clip
from support.sessions import engine, take_of

from faceedit_app.core.arrays import Bools, Doubles
from faceedit_app.core.controls import CONTROL_INDEX, LIP_OPENING
from faceedit_app.core.regions import LOWER
from faceedit_app.core.resample import Resampling
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.edits.settings import Mode
from faceedit_app.editing.opening import open_session
from faceedit_app.editing.session import EditSession
from faceedit_app.editing.solving.completing import FARTHEST, Completing, surroundings
from faceedit_app.editing.solving.expectation import Expectation
from faceedit_app.networks.engine import Engine

RATE, FRAMES = 25.0, 200
TIMES = np.arange(FRAMES) / RATE
WAY = Resampling(TIMES, 0, FRAMES)
EDITED = slice(90, 110)
OPENING = LOWER.own.index(LIP_OPENING)
OTHERS = [i for i in range(COUNT) if i != OPENING]


def curves(seed: int = 0) -> Doubles:
    """(T, C) mm, slow and all different."""
    random = np.random.default_rng(seed)
    speed, phase = random.uniform(0.1, 0.3, COUNT), random.uniform(0, 6, COUNT)
    waves: Doubles = 30.0 + 4.0 * np.sin(2 * np.pi * TIMES[:, None] * speed + phase)
    return waves


def known_curves(take: Doubles) -> Expectation:
    held = np.arange(COUNT) == OPENING
    return Expectation(take, 0.01 * np.eye(COUNT), np.arange(COUNT), held)


def request(by: float = 5.0) -> tuple[Doubles, Bools, Doubles]:
    """The opening changed by some mm: change, given, hold."""
    change, hold = np.zeros((FRAMES, COUNT)), np.zeros((FRAMES, COUNT))
    change[EDITED, OPENING], hold[EDITED, OPENING] = by, 1.0
    return change, hold > 0, hold


def further(take: Doubles, network: Answering, by: float = 5.0) -> Doubles:
    """What is added to a request of so many mm."""
    known = known_curves(curves())
    change, given, hold = request(by)
    filled = known.fill(change, given)
    completing = Completing(known, network)
    return completing.further(TIMES, WAY, take, filled, given, hold)


def broken() -> Doubles:
    """The take with a jump of all other curves where it is edited."""
    take = curves()
    take[EDITED, 1:] += 6.0
    return take


# --- what is around ----------------------------------------------------------------------------


def test_a_gap_is_filled_with_what_is_around() -> None:
    there = np.ones((FRAMES, 1))
    trusted = np.ones(FRAMES, np.bool_)
    there[EDITED], trusted[EDITED] = 9.0, False
    around, near = surroundings(there, trusted)
    assert np.abs(around[EDITED] - 1.0).max() < 0.3
    assert (near == 1.0).all()
    np.testing.assert_array_equal(around[trusted], there[trusted])


def test_nothing_is_taken_from_frames_that_are_far() -> None:
    trusted = np.ones(FRAMES, np.bool_)
    trusted[EDITED] = False
    one, two = np.ones((FRAMES, 1)), np.ones((FRAMES, 1))
    two[: EDITED.start - FARTHEST] = 50.0
    two[EDITED.stop + FARTHEST :] = -50.0
    mine, theirs = surroundings(one, trusted)[0], surroundings(two, trusted)[0]
    np.testing.assert_array_equal(mine[EDITED], theirs[EDITED])


def test_the_middle_of_a_long_edit_has_nothing_around() -> None:
    trusted = np.zeros(FRAMES, np.bool_)
    trusted[:10] = True
    near = surroundings(np.ones((FRAMES, 1)), trusted)[1]
    assert near[12] == 1.0
    assert (np.diff(near) <= 0).all()
    assert not near[10 + FARTHEST :].any()
    assert not surroundings(np.ones((9, 1)), np.zeros(9, np.bool_))[1].any()


# --- what is added -----------------------------------------------------------------------------


def test_a_take_that_is_right_is_kept() -> None:
    assert not further(broken(), Answering(0.0)).any()


def test_a_take_that_breaks_off_gives_way() -> None:
    added = further(broken(), Answering(1.0))
    inner = slice(EDITED.start + 2, EDITED.stop - 2)
    assert (added[inner][:, OTHERS] < -2.0).all()
    assert not added[:, OPENING].any()
    assert not added[: EDITED.start].any()
    assert not added[EDITED.stop :].any()


def test_a_request_for_what_is_there_changes_nothing() -> None:
    assert not further(broken(), Answering(1.0, 1.0), by=0.0).any()
    small = np.abs(further(broken(), Answering(1.0, 1.0), by=0.02)).max()
    assert small < 0.1


def test_curves_stay_within_the_take_whatever_a_network_says() -> None:
    take = curves()
    added = further(take, Answering(1.0, 1e6))
    change, given, _ = request()
    known = known_curves(take)
    reached = take + known.fill(change, given)
    low, high = np.minimum(known.low, reached), np.maximum(known.high, reached)
    assert added.any()
    assert ((reached + added >= low - 1e-9) & (reached + added <= high + 1e-9)).all()


def test_the_network_sees_the_take_in_its_own_measures() -> None:
    network, larger = Answering(0.5), Answering(0.5)
    further(broken(), network)
    take = 3.0 * curves()
    known = Expectation(take, 0.09 * np.eye(COUNT), np.arange(COUNT), known_curves(take).held)
    known.spread = 3.0 * known_curves(curves()).spread
    change, given, hold = request(15.0)
    completing = Completing(known, larger)
    completing.further(TIMES, WAY, 3.0 * broken(), known.fill(change, given), given, hold)
    np.testing.assert_allclose(network.seen[0], larger.seen[0], atol=0.05)


# --- in a session ------------------------------------------------------------------------------


def session(network: Answering, mode: Mode = Mode.PRESERVE) -> EditSession:
    networks = Engine(engine().models, {LOWER.id: network})
    opened = open_session(take_of(talking_clip(frames=600)), shipped_rig(), networks)
    opened.configure(replace(opened.settings, mode=mode))
    return opened


def weights(network: Answering, *edits: Edit, mode: Mode = Mode.PRESERVE) -> Doubles:
    opened = session(network, mode)
    opened.add(*edits)
    return opened.weights.astype(np.float64)


OPEN = Edit((LIP_OPENING,), Op.OFFSET, 4.0, 4.6, 0.1, 6.0)


def test_what_is_around_replaces_the_take_only_in_the_edit() -> None:
    kept, replaced = (weights(Answering(share, rig=shipped_rig()), OPEN) for share in (0.0, 1.0))
    differs = np.flatnonzero((kept != replaced).any(axis=1)) / 60.0
    first, last = OPEN.span
    assert len(differs)
    assert first - 0.3 < differs.min() < differs.max() < last + 0.3


def test_a_far_edit_changes_nothing_here() -> None:
    far = Edit((LIP_OPENING,), Op.OFFSET, 8.0, 8.4, 0.1, 6.0)
    alone = weights(Answering(1.0, rig=shipped_rig()), OPEN)
    both = weights(Answering(1.0, rig=shipped_rig()), OPEN, far)
    rows = slice(0, round(5.2 * 60))
    np.testing.assert_array_equal(alone[rows], both[rows])


@pytest.mark.parametrize(
    "edits",
    [
        (Edit(LOWER.own, Op.OFFSET, 4.0, 4.6, 0.1, 2.0),),  # every curve is asked for
        (Edit((LIP_OPENING,), Op.SMOOTH, 4.0, 4.6, 0.1, 0.1),),  # a calm take is a right one
        (Edit(("left_eyelid",), Op.OFFSET, 4.0, 4.6, 0.1, -4.0),),  # no network completes these
    ],
)
def test_other_edits_are_answered_as_without_the_network(edits: tuple[Edit, ...]) -> None:
    with_it, without = (weights(Answering(share, rig=shipped_rig()), *edits) for share in (1.0, 0))
    np.testing.assert_array_equal(with_it, without)


def test_resynthesized_takes_are_not_completed() -> None:
    network = Answering(1.0, rig=shipped_rig())
    weights(network, OPEN, mode=Mode.RESYNTHESIZE)
    assert not network.seen


def test_two_overlapping_edits_leave_no_step() -> None:
    width = Edit(("mouth_width",), Op.OFFSET, 4.4, 5.2, 0.1, -2.0)
    opened = session(Answering(1.0, rig=shipped_rig()))
    opened.add(OPEN, width)
    changed = (opened.achieved - opened.tracked)[:, CONTROL_INDEX["left_corner"]]
    assert np.abs(np.diff(changed)).max() < 1.0
