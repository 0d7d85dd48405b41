"""Metrics on cases that can be worked out by hand."""

from __future__ import annotations

import math
import statistics

import numpy as np
import pytest
from support.faces import shipped_rig

from faceedit_app.core.regions import REGIONS
from faceedit_app.lab.evaluation.metrics import (
    Closures,
    boundary_jump,
    clipped_share,
    closures,
    energy_kept,
    high_energy,
    jerk,
    region_vertices,
    squared_errors,
    vertex_errors,
)

LOWER, UPPER, EYELIDS = REGIONS
ALL = np.ones(2, bool)


def test_error_counts_only_what_was_captured() -> None:
    truth = np.zeros((4, 2))
    answer = np.tile([0.1, 9.0], (4, 1))
    found = squared_errors(answer, truth, np.array([True, False]))
    np.testing.assert_allclose(found, 0.01)
    assert found.shape == (4,)


def test_closures_of_ten_frames_counted_by_hand() -> None:
    truth = np.array([5, 5, 0.5, 0.5, 5, 5, 0.5, 0.5, 5, 5.0])
    answer = np.array([5, 0.5, 0.5, 5, 5, 5, 0.5, 0.5, 5, 5.0])
    found = closures(answer, truth, (0.2, 1.0, 10.0))
    assert math.isnan(found.tpr[0])
    assert math.isnan(found.fpr[0])
    assert found.actual == (0, 4, 10)
    assert found.tpr[1:] == (0.75, 1.0)
    assert found.fpr[1:] == (0.25, 0.0)


def test_perfect_answer_keeps_all_closures_and_makes_up_none() -> None:
    truth = np.random.default_rng(0).uniform(0, 10, 500)
    found = closures(truth, truth, (1.0, 2.0))
    assert found.tpr == (1.0, 1.0)
    assert found.fpr == (0.0, 0.0)
    assert found.fpr_at(0.98) == (1.0, 0.0)


def test_no_threshold_may_reach_the_wanted_rate() -> None:
    found = closures(np.full(5, 9.0), np.full(5, 0.5), (1.0, 2.0))
    assert found.tpr == (0.0, 0.0)
    assert all(math.isnan(x) for x in found.fpr_at(0.98))
    nan = float("nan")
    up_and_down = Closures((1.0, 2.0, 3.0, 4.0), (1.0, 0.9, 0.99, 1.0), (0.4, 0.3, 0.2, 0.1), ())
    assert up_and_down.fpr_at(0.98) == (3.0, 0.2)
    unknown = Closures((1.0, 2.0), (nan, 1.0), (nan, 0.1), ())
    assert unknown.fpr_at(0.98) == (2.0, 0.1)


def test_energy_kept_is_that_of_the_fast_motion_that_is_really_there() -> None:
    time = np.arange(200) / 25.0
    slow = np.stack([np.sin(2 * np.pi * 1.0 * time), 0 * time], 1)
    fast = np.stack([np.sin(2 * np.pi * 6.0 * time), 0 * time], 1)
    jitter = np.stack([np.sin(2 * np.pi * 9.0 * time), 0 * time], 1)

    def kept(answer: np.ndarray, truth: np.ndarray, captured: np.ndarray = ALL) -> float:
        return energy_kept(*high_energy(answer, truth, captured))

    assert kept(slow + fast, slow + fast) == pytest.approx(1.0)
    assert kept(slow, slow + fast) == pytest.approx(0.0, abs=1e-4)
    assert kept(slow + 0.5 * fast, slow + fast) == pytest.approx(0.25, abs=1e-3)
    assert kept(slow + jitter, slow + fast) == pytest.approx(0.0, abs=1e-4)
    assert kept(fast + jitter, fast) == pytest.approx(1.0, abs=1e-4)
    assert kept(-fast, fast) == 0.0
    assert math.isnan(kept(fast, fast, ~ALL))
    assert math.isnan(kept(fast[:4], fast[:4]))


def test_jerk_of_a_cubic_is_its_third_difference() -> None:
    cubic = np.stack([np.arange(10.0) ** 3, np.arange(10.0) ** 2], 1)
    assert jerk(cubic, ALL) == pytest.approx(7 * 6.0)
    assert jerk(cubic[:3], ALL) == 0.0


def test_vertex_error_is_how_far_the_lips_are_off() -> None:
    rig = shipped_rig()
    truth = np.zeros((3, len(LOWER.channels)))
    answer = truth.copy()
    answer[1, LOWER.channels.index("jawOpen")] = 0.5
    errors = vertex_errors(rig, LOWER, answer, truth)
    rows = region_vertices(rig, LOWER)
    deltas = rig.deltas[rig.channel_index["jawOpen"]][rows]
    by_hand = statistics.fmean([1000.0 * 0.5 * math.dist((0, 0, 0), d) for d in deltas.tolist()])
    np.testing.assert_allclose(errors, [0.0, by_hand, 0.0], rtol=1e-5)
    assert 1.0 < by_hand < 20.0


def test_regions_have_vertices_of_their_own() -> None:
    rig = shipped_rig()
    rows = [set(region_vertices(rig, region).tolist()) for region in REGIONS]
    assert all(len(found) > 10 for found in rows)
    assert not rows[0] & rows[2]
    heights = [rig.neutral[sorted(found), 1].mean() for found in rows]
    assert heights[0] < heights[2] < heights[1], "lips below lids below brows"


def test_boundary_jump_is_the_kink_that_an_edit_adds() -> None:
    before = np.repeat(np.arange(10.0)[:, None], 2, axis=1)
    after = before.copy()
    after[5:, 1] += 0.3 * np.arange(5)
    assert boundary_jump(before, before, [5]) == 0.0
    assert boundary_jump(before, after, [5]) == pytest.approx(0.3)
    assert boundary_jump(before, after, [7]) == pytest.approx(0.0)
    assert boundary_jump(before, after, [0, 9]) == 0.0


def test_clipped_share_counts_changed_weights_at_their_limits() -> None:
    before = np.full((2, 2), 0.5)
    assert clipped_share(before, before) == 0.0
    assert clipped_share(before, np.array([[1.0, 0.5], [0.0, 0.7]])) == pytest.approx(2 / 3)
    resting = np.zeros((2, 2))
    assert clipped_share(resting, resting) == 0.0
