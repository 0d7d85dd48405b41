"""The road between a clip's own times and the networks' 25 frames per second."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from faceedit_app.core.resample import GRID_RATE, OffGrid, Resampling, grid_length, to_grid

RATES = (12.0, 24.0, 25.0, 30.0, 59.94, 60.0, 120.0)


def uneven_times(seed: int, frames: int = 80) -> np.ndarray:
    """Times as a tracker gives them: jitter, and a gap."""
    random = np.random.default_rng(seed)
    steps = random.uniform(0.005, 0.05, frames - 1)
    steps[frames // 2] = 0.4
    return np.concatenate([[0.0], np.cumsum(steps)])


def mean_by_brute_force(times: np.ndarray, values: np.ndarray, frame: int) -> float:
    """The mean of the interpolated signal over a grid frame's 40 ms."""
    around = (frame + (np.arange(40_000) + 0.5) / 40_000 - 0.5) / GRID_RATE
    return float(np.interp(around, times, values).mean())


@pytest.mark.parametrize("rate", RATES)
def test_grid_reaches_the_last_frame_and_not_a_frame_more(rate: float) -> None:
    for frames in range(1, 200):
        last = (frames - 1) / rate
        covered = (grid_length(np.arange(frames) / rate) - 1) / GRID_RATE
        assert last - 1e-6 <= covered < last + 1 / GRID_RATE


@pytest.mark.parametrize("seed", range(3))
def test_grid_value_is_the_mean_over_its_own_forty_milliseconds(seed: int) -> None:
    times = uneven_times(seed)
    values = np.random.default_rng(seed).normal(size=(len(times), 2))
    grid = to_grid(times, values, 0, grid_length(times))
    for frame in (0, 1, 7, len(grid) - 2, len(grid) - 1):
        expected = mean_by_brute_force(times, values[:, 1], frame)
        assert grid[frame, 1] == pytest.approx(expected, abs=2e-5)


@pytest.mark.parametrize("rate", RATES)
def test_to_grid_keeps_the_integral(rate: float) -> None:
    times = np.arange(150) / rate
    values = np.random.default_rng(1).normal(size=(150, 3))
    values[[0, -1]] = 0.0  # what is held beyond the ends then adds nothing
    area = np.trapezoid(values, times, axis=0)
    grid = to_grid(times, values, -2, grid_length(times) + 2)
    np.testing.assert_allclose(grid.sum(axis=0) / GRID_RATE, area, atol=1e-12)


@pytest.mark.parametrize("rate", [59.94, 60.0, 120.0])
def test_spike_of_one_frame_is_never_lost(rate: float) -> None:
    times = np.arange(120) / rate
    for frame in range(5, 115):
        values = np.zeros((120, 1))
        values[frame] = 1.0
        grid = to_grid(times, values, 0, grid_length(times))
        assert grid.sum() / GRID_RATE == pytest.approx(1 / rate)
        assert np.count_nonzero(grid) <= 3


@given(first=st.integers(1, 60), length=st.integers(1, 18), seed=st.integers(0, 99))
@settings(deadline=None, derandomize=True, max_examples=60)
def test_to_grid_is_exactly_zero_where_the_signal_is(first: int, length: int, seed: int) -> None:
    times = uneven_times(seed)
    values = np.zeros((80, 1))
    values[first : first + length] = np.random.default_rng(seed).normal(size=(length, 1))
    grid = to_grid(times, values, 0, grid_length(times))[:, 0]
    starts = (np.arange(len(grid)) - 0.5) / GRID_RATE
    begins, ends = times[first - 1], times[min(first + length, 79)]
    outside = (starts + 1 / GRID_RATE < begins - 1e-9) | (starts > ends + 1e-9)
    assert outside.any()
    assert (grid[outside] == 0.0).all()


def test_part_of_the_grid_equals_the_whole() -> None:
    times = uneven_times(4)
    values = np.random.default_rng(4).normal(size=(80, 2))
    whole = to_grid(times, values, 0, grid_length(times))
    np.testing.assert_array_equal(to_grid(times, values, 9, 20), whole[9:20])


def test_single_frame_is_held_everywhere() -> None:
    grid = to_grid(np.zeros(1), np.array([[2.0, 3.0]], np.float32), -1, 4)
    np.testing.assert_array_equal(grid, np.tile([2.0, 3.0], (5, 1)))
    np.testing.assert_array_equal(OffGrid(1, 0, np.zeros(1))(grid[:1]), [[2.0, 3.0]])


def test_from_grid_passes_through_the_grid_values() -> None:
    values = np.random.default_rng(2).normal(size=(30, 4))
    read = OffGrid(len(values), 7, (7 + np.arange(30)) / GRID_RATE)(values)
    np.testing.assert_allclose(read, values, atol=1e-12)


def test_from_grid_shows_a_value_within_two_grid_frames_only() -> None:
    values = np.zeros((40, 1))
    values[20] = 1.0
    times = np.arange(0, 39 / GRID_RATE, 1 / 240)
    shown = OffGrid(len(values), 0, times)(values)[:, 0]
    far = np.abs(times * GRID_RATE - 20) >= 2
    assert (shown[far] == 0.0).all()
    assert np.abs(shown[~far]).max() == pytest.approx(1.0, abs=0.01)


def test_from_grid_follows_a_straight_line_and_holds_its_ends() -> None:
    values = np.arange(10.0)[:, None]
    inside = np.linspace(1, 8, 50) / GRID_RATE
    shown = OffGrid(len(values), 0, inside)(values)[:, 0]
    np.testing.assert_allclose(shown, inside * GRID_RATE, atol=1e-12)
    beyond = OffGrid(len(values), 0, np.array([-3.0, 9.0]))(values)[:, 0]
    np.testing.assert_array_equal(beyond, [0.0, 9.0])


@pytest.mark.parametrize("rate", RATES)
def test_two_movements_a_second_survive_the_round_trip(rate: float) -> None:
    times = np.arange(round(4 * rate)) / rate
    signal = np.sin(2 * np.pi * 2.0 * times)[:, None]
    way = Resampling(times, 0, grid_length(times))
    back = way.from_grid(way.to_grid(signal))
    inner = (times > 0.2) & (times < times[-1] - 0.2)
    # The straight lines between 12 frames a second cut the corners by 0.07 themselves.
    assert np.abs(back - signal)[inner].max() < (0.08 if rate < 20 else 0.04)
