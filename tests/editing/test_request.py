"""From edits to what is asked for: each operation, its falloff, and their order."""

from __future__ import annotations

import numpy as np
import pytest

from faceedit_app.core.controls import CONTROL_INDEX
from faceedit_app.editing.edits.channels import CHANNEL_OPS
from faceedit_app.editing.edits.edit import WITH_POINTS, Edit, Op
from faceedit_app.editing.solving.request import SPILL, Request, affected, request

RATE = 50.0
TIMES = np.arange(400) / RATE  # 8 s
MOUTH = CONTROL_INDEX["mouth_opening"]
WIDTH = CONTROL_INDEX["mouth_width"]
TRACKED = 10 + 4 * np.sin(2 * np.pi * (TIMES[:, None] * np.linspace(0.5, 2, 8) + 0.1))
MEDIANS = np.median(TRACKED, axis=0)


def ask(*edits: Edit, tracked: np.ndarray = TRACKED) -> Request:
    return request(TIMES, RATE, tracked, MEDIANS, edits)


def mouth(
    op: Op, value: float = 0.0, falloff: float = 0.5, start: float = 3, end: float = 4
) -> Edit:
    points = ((start, value), (end, value + 1)) if op in WITH_POINTS else ()
    return Edit(("mouth_opening",), op, start, end, falloff, value, points=points)


HELD = (TIMES >= 3) & (TIMES <= 4)
OUTSIDE = (TIMES <= 2.5) | (TIMES >= 4.5)


def test_no_edit_asks_for_the_take_as_tracked() -> None:
    asked = ask()
    np.testing.assert_array_equal(asked.curves, TRACKED)
    assert not asked.hold.any()
    assert not asked.influence.any()


@pytest.mark.parametrize("op", [op for op in Op if op.value not in (*CHANNEL_OPS, Op.RETIME)])
def test_only_the_named_control_changes_and_only_within_reach(op: Op) -> None:
    asked = ask(mouth(op, 0.3))
    np.testing.assert_array_equal(np.delete(asked.curves, MOUTH, 1), np.delete(TRACKED, MOUTH, 1))
    np.testing.assert_array_equal(asked.curves[OUTSIDE], TRACKED[OUTSIDE])
    assert not asked.hold[OUTSIDE].any()
    near = (affected(mouth(op))[0] < TIMES) & (affected(mouth(op))[1] > TIMES)
    assert not asked.influence[~near].any()


def test_offset_adds_millimetres() -> None:
    curve = ask(mouth(Op.OFFSET, 2.5)).curves[:, MOUTH]
    np.testing.assert_allclose(curve[HELD], TRACKED[HELD, MOUTH] + 2.5)


def test_set_goes_to_millimetres() -> None:
    np.testing.assert_allclose(ask(mouth(Op.SET, 7.0)).curves[HELD, MOUTH], 7.0)


def test_scale_multiplies_the_distance_from_the_median() -> None:
    curve = ask(mouth(Op.SCALE, 0.5)).curves[:, MOUTH]
    middle = MEDIANS[MOUTH]
    expected = middle + 0.5 * (TRACKED[HELD, MOUTH] - middle)
    np.testing.assert_allclose(curve[HELD], expected, atol=1e-12)


def test_reset_goes_back_to_the_take() -> None:
    asked = ask(mouth(Op.OFFSET, 5.0), mouth(Op.RESET, falloff=0.0))
    np.testing.assert_allclose(asked.curves[HELD, MOUTH], TRACKED[HELD, MOUTH])
    assert not asked.hold[HELD].any()
    assert not asked.influence[HELD].any()
    beside = (TIMES > 2.8) & (TIMES < 3)
    assert (asked.curves[beside, MOUTH] > TRACKED[beside, MOUTH] + 1).all()
    assert (asked.hold[beside, MOUTH] > 0).all()


def test_smooth_keeps_slow_movement_and_drops_jitter() -> None:
    noise = np.random.default_rng(0).normal(0, 1.0, TRACKED.shape)
    whole = mouth(Op.SMOOTH, 0.1, 0.0, start=0, end=8)
    curve = ask(whole, tracked=TRACKED + noise).curves[:, MOUTH]
    assert np.abs(curve - TRACKED[:, MOUTH])[40:-40].std() < 0.4


def test_smooth_is_zero_phase() -> None:
    """A symmetric peak stays where it is and stays symmetric."""
    peak = np.tile(5 + 8 * np.exp(-(((TIMES - 4) / 0.1) ** 2))[:, None], 8)
    curve = ask(mouth(Op.SMOOTH, 0.12, 0.0, start=2, end=6), tracked=peak).curves[:, MOUTH]
    middle = 200
    assert curve[1:-1].argmax() + 1 == middle
    assert curve[middle] < peak[middle, MOUTH] - 1
    np.testing.assert_allclose(
        curve[middle - 90 : middle], curve[middle + 90 : middle : -1], atol=1e-9
    )


def test_smooth_takes_seconds_whatever_the_rate() -> None:
    results = []
    for rate in (25.0, 100.0):
        times = np.arange(round(8 * rate)) / rate
        peak = np.tile(5 + 8 * np.exp(-(((times - 4) / 0.2) ** 2))[:, None], 8)
        edit = mouth(Op.SMOOTH, 0.2, 0.0, start=2, end=6)
        asked = request(times, rate, peak, np.zeros(8), [edit])
        results.append(asked.curves[times == 4.0, MOUTH].item())
    assert results[0] == pytest.approx(results[1], abs=0.02)


@pytest.mark.parametrize("seconds", [0.0, 1e-300, 1e-9])
def test_smooth_of_next_to_nothing_changes_nothing(seconds: float) -> None:
    np.testing.assert_allclose(ask(mouth(Op.SMOOTH, seconds)).curves, TRACKED, atol=1e-12)


def test_falloff_is_a_cosine_that_starts_and_ends_flat() -> None:
    mask = mouth(Op.OFFSET, 1.0).mask(TIMES)
    assert (mask[HELD] == 1).all()
    assert (mask[OUTSIDE] == 0).all()
    quarter = mouth(Op.OFFSET).mask(np.array([2.5, 2.625, 2.75, 2.875, 3.0]))
    np.testing.assert_allclose(quarter, 0.5 - 0.5 * np.cos(np.pi * np.arange(5) / 4), atol=1e-12)
    np.testing.assert_allclose(mask[125:226], mask[225:124:-1], atol=1e-9)
    rising = mask[(TIMES >= 2.5) & (TIMES <= 3)]
    assert (np.diff(rising) > 0).all()


def test_edit_without_falloff_includes_the_frames_at_its_ends() -> None:
    times = np.arange(600) / 60.0
    edit = Edit(("mouth_width",), Op.OFFSET, 60 / 60.0, 72 / 60.0, 0.0, 1.0)
    assert np.flatnonzero(edit.mask(times)).tolist() == list(range(60, 73))


def test_distance_is_never_asked_to_be_negative() -> None:
    for edit in (mouth(Op.OFFSET, -80.0), mouth(Op.SET, -5.0), mouth(Op.SCALE, 40.0)):
        curves = ask(edit).curves
        assert (curves >= 0).all()
        assert (curves[:, MOUTH] == 0).any()


def test_order_of_edits_matters() -> None:
    offset, fix = mouth(Op.OFFSET, 3.0), mouth(Op.SET, 7.0)
    np.testing.assert_allclose(ask(offset, fix).curves[HELD, MOUTH], 7.0)
    np.testing.assert_allclose(ask(fix, offset).curves[HELD, MOUTH], 10.0)


def test_edits_add_up_in_one_place_and_leave_each_other_alone_apart() -> None:
    here, there = mouth(Op.OFFSET, 3.0), mouth(Op.OFFSET, 2.0, start=6.5, end=7)
    together = ask(here, there).curves - TRACKED
    np.testing.assert_allclose(
        together, (ask(here).curves - TRACKED) + (ask(there).curves - TRACKED), atol=1e-12
    )
    twice = ask(here, here).curves - TRACKED
    np.testing.assert_allclose(twice, 2 * (ask(here).curves - TRACKED), atol=1e-12)


def test_edit_of_several_controls_changes_each() -> None:
    both = Edit(("mouth_opening", "mouth_width"), Op.OFFSET, 3, 4, 0.5, 2.0)
    change = ask(both).curves[HELD] - TRACKED[HELD]
    np.testing.assert_allclose(change[:, [MOUTH, WIDTH]], 2.0)
    assert not np.delete(change, [MOUTH, WIDTH], 1).any()


def test_influence_covers_the_edit_and_fades_beyond_it() -> None:
    asked = ask(mouth(Op.OFFSET, 2.0))
    influence = asked.influence[:, MOUTH]
    assert (influence[(TIMES >= 2.5) & (TIMES <= 4.5)] == 1).all()
    fading = influence[(TIMES > 2.5 - SPILL) & (TIMES < 2.5)]
    assert (np.diff(fading) > 0).all()
    assert not np.delete(asked.influence, MOUTH, axis=1).any()


def test_far_too_much_is_all_that_is_possible_before_strength_applies() -> None:
    limits = np.full(8, 5.0), np.full(8, 30.0)
    tracked = np.full((len(TIMES), 8), 20.0)

    def asked(value: float, strength: float) -> float:
        edit = Edit(("mouth_opening",), Op.OFFSET, 2.5, 4.5, 0.0, value, strength=strength)
        found = request(TIMES, RATE, tracked, MEDIANS, [edit], limits=limits)
        return float(found.curves[HELD, MOUTH].mean())

    assert asked(200.0, 1.0) == asked(200.0, 1.5) == 30.0
    assert asked(200.0, 0.5) == 25.0
    assert asked(-33.9, 1.0) == 5.0


def test_only_the_last_edit_says_whether_calm_is_asked_for() -> None:
    smooth = Edit(("mouth_opening",), Op.SMOOTH, 1.0, 5.0, 0.0, 0.05)
    assert (ask(smooth).calm[HELD, MOUTH] == 1).all()
    assert not np.delete(ask(smooth).calm, MOUTH, axis=1).any()
    assert not ask(smooth, mouth(Op.OFFSET, 2.0)).calm[HELD, MOUTH].any()


def test_edit_beyond_the_take_asks_for_nothing() -> None:
    for start in (-9.0, 12.0):
        asked = ask(mouth(Op.OFFSET, 5.0, start=start, end=start + 1))
        np.testing.assert_array_equal(asked.curves, TRACKED)


def test_an_edit_later_than_a_reset_counts_again() -> None:
    asked = ask(mouth(Op.OFFSET, 5.0), mouth(Op.RESET, falloff=0.0), mouth(Op.OFFSET, 1.0))
    np.testing.assert_allclose(asked.curves[HELD, MOUTH], TRACKED[HELD, MOUTH] + 1)
    assert (asked.hold[HELD, MOUTH] == 1).all()
    assert (asked.influence[HELD, MOUTH] == 1).all()
