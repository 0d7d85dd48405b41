"""Closing: lips and lids shut on another character where they shut on ours."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.faces import shipped_rig
from support.leaky import JAW, leaky_rig, speech
from support.sessions import session_by_rig

from faceedit_app.characters.closure import Openings, closure
from faceedit_app.core.arkit import ARKIT_CHANNELS, ARKIT_INDEX
from faceedit_app.core.arrays import Floats
from faceedit_app.core.clip import Clip
from faceedit_app.core.controls import LIP_OPENING
from faceedit_app.core.levels import Level, Levels
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.solving.closing import Closing

CLOSE = ARKIT_INDEX["mouthClose"]


@pytest.fixture(scope="module")
def closing() -> Closing:
    return Closing(shipped_rig(), leaky_rig())


@pytest.fixture(scope="module")
def closed(closing: Closing) -> Floats:
    return closing(speech())


def test_what_was_open_is_shut(closing: Closing, closed: Floats) -> None:
    ours = closing.ours.measure(speech())
    before = closure(ours, closing.theirs.measure(speech()))
    after = closure(ours, closing.theirs.measure(closed))
    assert before.lips_open_share > 0.3
    assert before.lids_open_share > 0.5
    assert after.lips_open_share == after.lids_open_share == 0
    assert after.lips_within_share > 0.95
    assert after.lids_within_share > 0.95


def test_nothing_goes_through_anything(closing: Closing, closed: Floats) -> None:
    heights = -closing.theirs.distances.vectors(closed)[..., 1]
    before = -closing.theirs.distances.vectors(speech())[..., 1]
    assert (heights > np.minimum(before, -0.2)).all()


def test_the_smallest_change_is_a_small_one(closed: Floats) -> None:
    change = np.abs(closed - speech())
    assert change[:, JAW].max() < 0.2
    assert change.max() < 0.7


def test_other_channels_and_open_frames_keep_their_bits(closing: Closing, closed: Floats) -> None:
    wide = closing.ours.measure(speech())[:, 0] > 8
    awake = closing.ours.measure(speech())[:, 1:].min(axis=1) > 5
    rest = wide & awake
    assert rest.sum() > 10
    np.testing.assert_array_equal(closed[rest], speech()[rest])
    nose = ARKIT_INDEX["noseSneerLeft"]
    np.testing.assert_array_equal(closed[:, nose], speech()[:, nose])


def test_mouth_close_stays_below_jaw_open(closed: Floats) -> None:
    assert (closed[:, CLOSE] <= closed[:, JAW] + 1e-6).all()
    assert closed.min() >= 0
    assert closed.max() <= 1


@pytest.mark.parametrize(
    "levels",
    [
        {"jawOpen": (1.3, 0.02, 1.0)},
        {"eyeBlinkLeft": (0.85, 0.0, 1.0), "eyeBlinkRight": (1.0, -0.05, 1.0)},
        {"mouthFunnel": (1.0, 0.0, 0.3), "mouthLowerDownLeft": (1.5, 0.0, 0.4)},
    ],
)
def test_lips_and_lids_shut_at_the_strength_that_the_character_shows(
    levels: dict[str, Level],
) -> None:
    theirs = replace(leaky_rig(), levels=Levels(levels))
    closing = Closing(shipped_rig(), theirs)
    closed = closing(speech())
    after = closure(closing.ours.measure(speech()), closing.theirs.measure(closed))
    assert after.lips_open_share == after.lids_open_share == 0
    assert after.lips_within_share > 0.95
    assert after.lids_within_share > 0.9
    shown = theirs.arkit_distances.measure(theirs.levels.applied(closed))
    np.testing.assert_allclose(
        shown, theirs.distances.measure(theirs.from_arkit(closed)), atol=1e-4
    )


def test_each_frame_is_solved_by_itself(closing: Closing, closed: Floats) -> None:
    """Part and whole agree: within the last bits of a matrix product."""
    np.testing.assert_allclose(closing(speech()[40:60]), closed[40:60], atol=2e-3)


def test_lips_that_rest_together_close_without_a_jump_from_frame_to_frame(closing: Closing) -> None:
    """Weights that come to their bounds, and leave them, take no other way than those around."""
    time = np.arange(120) / 30.0
    weights = np.zeros((120, 52), np.float32)
    weights[:, JAW] = 0.12 + 0.05 * np.sin(3 * time)
    weights[:, CLOSE] = weights[:, JAW] * (0.9 + 0.1 * np.sin(5 * time))
    for name, moves in (
        ("mouthSmile{}", 0.2 + 0.2 * np.sin(time)),
        ("mouthUpperUp{}", np.maximum(0.1 * np.sin(2 * time), 0.0)),
        ("mouthRollUpper", np.maximum(0.05 * np.cos(2.3 * time), 0.0)),
        ("mouthRollLower", np.maximum(0.05 * np.cos(3.3 * time), 0.0)),
    ):
        for side in ("Left", "Right"):
            weights[:, ARKIT_INDEX[name.format(side)]] = moves
    change = closing(weights) - weights
    assert np.abs(change).max(axis=1).min() > 0.02
    assert np.abs(np.diff(change, 2, axis=0)).max() < 0.012


def test_a_character_that_closes_as_ours_does_keeps_its_weights_nearly() -> None:
    same = Closing(shipped_rig(), shipped_rig())
    assert np.abs(same(speech()) - speech()).max() < 0.25


def test_lips_far_apart_on_a_head_without_mouth_close_are_not_left_half_open() -> None:
    ours = shipped_rig()
    deltas = ours.deltas.copy()
    deltas[ours.channel_index["mouthClose"]] = 0.0
    closing = Closing(ours, replace(ours, deltas=deltas))
    weights = np.zeros((1, len(ARKIT_CHANNELS)), np.float32)
    weights[0, [JAW, CLOSE]] = 0.8
    assert closing.ours.measure(weights)[0, 0] < 1.0
    assert closing.theirs.measure(weights)[0, 0] > 20.0
    assert closing.theirs.measure(closing(weights))[0, 0] < 0.5


def test_what_a_take_has_no_column_for_stays(closing: Closing) -> None:
    without = frozenset(ARKIT_CHANNELS) - {"jawOpen", "eyeBlinkLeft"}
    part = Closing(shipped_rig(), leaky_rig(), without)(speech())
    for channel in ("jawOpen", "mouthClose", "eyeBlinkLeft"):
        column = ARKIT_INDEX[channel]
        np.testing.assert_array_equal(part[:, column], speech()[:, column])


def test_a_character_without_lids_closes_its_lips(closing: Closing) -> None:
    pairs = leaky_rig().control_pairs.copy()
    pairs[6:] = -1
    half = Closing(shipped_rig(), replace(leaky_rig(), control_pairs=pairs))
    after = half(speech())
    blink = ARKIT_INDEX["eyeBlinkLeft"]
    np.testing.assert_array_equal(after[:, blink], speech()[:, blink])
    gaps = Openings.of(leaky_rig()).measure(after)
    assert closure(closing.ours.measure(speech()), gaps).lips_open_share == 0


def test_frames_close_by_their_share_and_regions_left_out_not_at_all(closing: Closing) -> None:
    tracked = speech()
    share = np.clip((np.arange(len(tracked)) - 30) / 20.0, 0.0, 1.0)
    after = closing(tracked, {"lower": share})
    np.testing.assert_array_equal(after[:31], tracked[:31])
    np.testing.assert_array_equal(after[50:, JAW], closing(tracked)[50:, JAW])
    blink = ARKIT_INDEX["eyeBlinkLeft"]
    np.testing.assert_array_equal(after[:, blink], tracked[:, blink])


def test_a_session_closes_on_the_shown_character_where_edits_are() -> None:
    times = np.arange(120) / 30.0
    session = session_by_rig(Clip(speech(), ARKIT_CHANNELS, times, 30.0))
    session.add(Edit((LIP_OPENING,), Op.SET, 1.5, 1.6, 0.1, value=0.0))
    ours = session.weights.copy()
    session.use_character(leaky_rig())
    theirs = session.weights.copy()
    gaps = Openings.of(leaky_rig())
    assert gaps.measure(ours[45:49])[:, 0].max() > 1.0
    assert gaps.measure(theirs[45:49])[:, 0].max() < 0.5
    np.testing.assert_array_equal(theirs[:10], session.take.clip.arkit_weights()[:10])
    session.configure(replace(session.settings, closes=False))
    np.testing.assert_array_equal(session.weights, ours)
    session.undo()
    np.testing.assert_array_equal(session.weights, theirs)
    session.use_character(None)
    np.testing.assert_array_equal(session.weights, ours)
