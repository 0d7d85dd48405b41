"""A smooth of all curves of a region is one of its channels, and takes nothing else along."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d
from support.sessions import demo_take, session_by_networks, shipped_engine

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Doubles, Floats
from faceedit_app.core.controls import CONTROL_IDS, CONTROL_INDEX, LIDS
from faceedit_app.core.regions import EYELIDS, LOWER, MODELLED_CHANNELS
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.session import EditSession
from faceedit_app.editing.solving.calming import Calmed

DURATION = demo_take().clip.duration
MOUTH = [ARKIT_INDEX[c] for c in LOWER.channels]
MODELLED = [ARKIT_INDEX[c] for c in MODELLED_CHANNELS]


def session_on_demo() -> EditSession:
    return session_by_networks(demo_take(), shipped_engine())


def smooth(*controls: str, seconds: float = 0.1, start: float = 0.0, end: float = DURATION) -> Edit:
    return Edit(controls, Op.SMOOTH, start, end, 0.0, seconds)


def reset(*controls: str) -> Edit:
    return Edit(controls, Op.RESET, 0.0, DURATION, 0.0)


def roughness(weights: Floats) -> Doubles:
    rough: Doubles = np.sqrt((np.diff(weights[:, MODELLED].astype(np.float64), 2, 0) ** 2).mean(0))
    return rough


@pytest.mark.parametrize("seconds", [0.04, 0.1, 0.3])
def test_no_channel_is_rougher_after_a_smooth_of_all_curves(seconds: float) -> None:
    session = session_on_demo()
    before = roughness(session.weights)
    session.add(smooth(*CONTROL_IDS, seconds=seconds))
    assert (roughness(session.weights) - before).max() < 0.001
    assert roughness(session.weights).sum() < 0.8 * before.sum()


def test_a_smooth_of_the_lids_leaves_brows_and_mouth_as_they_are() -> None:
    session = session_on_demo()
    session.add(smooth(*LIDS))
    others = [i for c, i in ARKIT_INDEX.items() if c not in EYELIDS.channels]
    change = np.abs(session.weights - demo_take().clip.arkit_weights())
    assert change[:, others].max() < 0.01
    assert change.max() > 0.1


def test_smoothed_curves_are_where_they_are_asked_to_be() -> None:
    session = session_on_demo()
    session.add(smooth(*LOWER.own))
    own = [CONTROL_INDEX[c] for c in LOWER.own]
    missed = np.abs(session.achieved - session.asked)[:, own]
    assert np.percentile(missed, 95) < 0.6


def test_an_edit_before_a_smooth_is_smoothed_with_the_take() -> None:
    session = session_on_demo()
    lift = Edit(("mouth_opening",), Op.OFFSET, 4.0, 5.0, 0.1, 6.0)
    session.put([lift, smooth(*LOWER.own, seconds=0.04)])
    both = session.achieved[:, CONTROL_INDEX["mouth_opening"]].copy()
    session.put([smooth(*LOWER.own, seconds=0.04)])
    alone = session.achieved[:, CONTROL_INDEX["mouth_opening"]]
    times = demo_take().clip.times
    inside = (times > 4.2) & (times < 4.8)
    np.testing.assert_allclose((both - alone)[inside].mean(), 6.0, atol=0.5)


@pytest.mark.parametrize("one_by_one", [False, True])
def test_a_reset_of_all_curves_gives_the_take_s_bytes_back(one_by_one: bool) -> None:
    session = session_on_demo()
    resets = [reset(c) for c in CONTROL_IDS] if one_by_one else [reset(*CONTROL_IDS)]
    session.put([smooth(*CONTROL_IDS), *resets])
    np.testing.assert_array_equal(session.weights, demo_take().clip.arkit_weights())


def test_a_smooth_after_a_reset_counts_again() -> None:
    session = session_on_demo()
    session.put([smooth(*LOWER.own)])
    once = session.weights.copy()
    session.put([smooth(*LOWER.own, seconds=0.3), reset(*LOWER.own), smooth(*LOWER.own)])
    np.testing.assert_allclose(session.weights, once, atol=0.02)


def test_channels_are_smoothed_by_the_kernel_of_the_curves() -> None:
    random = np.random.default_rng(3)
    weights = random.uniform(0.0, 1.0, (200, 52)).astype(np.float32)
    curves = random.uniform(0.0, 30.0, (200, len(CONTROL_IDS)))
    times = np.arange(200) / 50.0
    region = Calmed(LOWER.own, np.array(MOUTH))
    edit = smooth(*LOWER.own, end=4.0)
    calm, calm_curves = region([edit], times, 50.0, weights, curves)
    others = np.setdiff1d(np.arange(52), MOUTH)
    np.testing.assert_array_equal(calm[:, others], weights[:, others])
    expected = gaussian_filter1d(weights[:, MOUTH].astype(np.float64), 5.0, axis=0, mode="nearest")
    np.testing.assert_allclose(calm[:, MOUTH], expected, atol=1e-5)
    own = [CONTROL_INDEX[c] for c in LOWER.own]
    expected = gaussian_filter1d(curves[:, own], 5.0, axis=0, mode="nearest")
    np.testing.assert_allclose(calm_curves[:, own], expected, atol=1e-4)


@pytest.mark.parametrize(
    "edit",
    [
        smooth("mouth_opening"),
        replace(smooth(*LOWER.own), op=Op.OFFSET),
        smooth(*LOWER.own, seconds=0.0),
    ],
)
def test_other_edits_change_nothing_here(edit: Edit) -> None:
    weights, curves = np.zeros((20, 52), np.float32), np.ones((20, len(CONTROL_IDS)))
    region = Calmed(LOWER.own, np.array(MOUTH))
    calm, calm_curves = region([edit], np.arange(20) / 25.0, 25.0, weights, curves)
    np.testing.assert_array_equal(calm, weights)
    np.testing.assert_array_equal(calm_curves, curves)
