"""What a pose has beyond its curves: kept for small changes, exchanged for large ones."""

from __future__ import annotations

import numpy as np
import pytest
from support.sessions import demo_take, session_by_networks, shipped_engine

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Doubles
from faceedit_app.editing.edits.edit import Edit, Op
from faceedit_app.editing.solving.chunks import ChunkTask
from faceedit_app.editing.solving.last_layer import LastLayer
from faceedit_app.editing.solving.residual import Residuals, exchange, kept
from faceedit_app.editing.solving.start import Start

MIRROR = np.array([0, 2, 1])  # of three curves, and of three channels


def curves(frames: int = 300, seed: int = 0) -> Doubles:
    """(T, 3) mm: a curve in the middle, and one on either side."""
    return np.random.default_rng(seed).normal([20.0, 30.0, 30.0], [4.0, 2.0, 2.0], (frames, 3))


def bump(of: Doubles) -> Doubles:
    """(T, 3) weights that no quadratic function of the curves gives."""
    away = (of[:, :1] - 24.0) / 4.0
    weights: Doubles = np.exp(-(away**2)) * np.array([0.4, 0.2, 0.2])
    return weights


def test_the_last_layer_learns_single_gestures_of_the_take() -> None:
    seen, asked = curves(), curves(seed=1)
    layer = LastLayer.fit(seen, bump(seen), MIRROR, MIRROR)
    error = ((layer(asked) - bump(asked)) ** 2).mean()
    assert error < 0.2 * bump(asked).var()


def test_half_a_second_of_a_take_hardly_changes_the_networks_answer() -> None:
    few, many = curves(frames=12), curves()
    answers = [LastLayer.fit(some, bump(some), MIRROR, MIRROR) for some in (few, many)]
    shares = [
        np.abs(layer.change(many[:-1], many[1:], layer(many[:-1]))).mean()
        / np.abs(np.diff(bump(many), axis=0)).mean()
        for layer in answers
    ]
    assert shares[0] < 0.7 * shares[1]


def test_the_last_layer_is_even() -> None:
    seen, asked = curves(), curves(seed=1)
    layer = LastLayer.fit(seen, bump(seen[:, [1, 0, 2]]), MIRROR, MIRROR)
    np.testing.assert_allclose(layer(asked)[:, MIRROR], layer(asked[:, MIRROR]), atol=1e-9)


def test_curves_that_do_not_change_have_no_change() -> None:
    seen = curves()
    layer = LastLayer.fit(seen, bump(seen), MIRROR, MIRROR)
    asked = seen.copy()
    asked[40] += 1.0
    change = layer.change(seen, asked, layer(seen))
    assert np.flatnonzero(change.any(axis=1)).tolist() == [40]


def test_a_residual_is_kept_the_less_the_farther_the_curves_move() -> None:
    share = kept(np.array([0.0, 0.3, 1.0, 2.0, 8.0]))
    assert share[0] == 1.0
    assert (np.diff(share) < 0).all()
    assert share[1] > 0.95
    assert share[-1] < 1e-6


def test_a_far_edit_takes_the_residual_from_around_it() -> None:
    residual = np.full((100, 2), [0.3, -0.1])
    residual[40:60] = [-0.2, 0.4]  # of a pose that is not there any more
    share = np.ones(100)
    share[40:60] = 0.0
    now = residual + exchange(residual, share)
    np.testing.assert_array_equal(now[:40], residual[:40])
    np.testing.assert_array_equal(now[60:], residual[60:])
    np.testing.assert_allclose(now[40:60], np.tile([0.3, -0.1], (20, 1)), atol=0.1)


def test_where_everything_is_edited_the_residual_fades() -> None:
    now = np.full((200, 1), 0.3)
    now += exchange(now, np.zeros(200))
    assert np.abs(now).max() < 1e-9


def test_residuals_are_measured_once_for_each_place() -> None:
    seen = curves(frames=50)
    layer = LastLayer.fit(seen, bump(seen), MIRROR, MIRROR)
    residuals, measured = Residuals(), []

    def lacking() -> Doubles:
        measured.append(1)
        return bump(seen)

    far, key = np.full_like(seen, 9.0), (0, "lower", 1.0)
    first = residuals.exchange(key, layer, lacking, seen, far)
    again = residuals.exchange(key, layer, lacking, seen, far)
    np.testing.assert_array_equal(first, again)
    assert len(measured) == 1
    residuals.exchange(None, layer, lacking, seen, far)
    assert len(measured) == 2
    assert not residuals.exchange(key, layer, lacking, seen, np.zeros_like(seen)).any()


def test_residuals_have_the_same_bits_whatever_was_asked_for_before() -> None:
    session = session_by_networks(demo_take(), shipped_engine())
    solver = session._solver
    networks, settings, regions = solver._regions._networks, session.state.settings, ("lower",)

    def exchanged(first: int) -> Doubles:
        near = first, len(solver.tracked)
        curves = solver.controls[first:].astype(np.float64, order="F")
        start = Start(solver.tracked[first:], curves, as_tracked=True)
        task = ChunkTask(1, near, settings, (), ())
        begun = networks.begin(task, regions, start, np.full_like(curves, 9.0))
        return begun.exchanges["lower"]

    # A smooth reads more frames around a chunk, whose sums are then rounded in another way.
    near, far = solver.chunks.slice(1).start - 100, 0
    fresh = exchanged(far)
    networks._residuals = Residuals()
    assert (exchanged(near) != fresh).any()
    np.testing.assert_array_equal(exchanged(far), fresh)


@pytest.mark.parametrize("mm", [0.2, 0.5])
def test_channels_at_rest_stay_there_for_small_edits(mm: float) -> None:
    session = session_by_networks(demo_take(), shipped_engine())
    session.add(Edit(("mouth_opening",), Op.OFFSET, 2.0, 4.0, 0.3, mm))
    tracked = demo_take().clip.arkit_weights()
    resting = [
        column
        for name, column in ARKIT_INDEX.items()
        if (tracked[:, column] <= tracked[:, column].min() + 1e-3).mean() > 0.5
    ]
    at_rest = tracked[:, resting] == tracked[:, resting].min(axis=0)
    assert at_rest.sum() > 1000
    stirred = (session.weights != tracked)[:, resting][at_rest]
    assert stirred.mean() < 0.02
