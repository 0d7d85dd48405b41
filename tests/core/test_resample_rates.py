"""A clip at another frame rate: nothing is lost between frames, nothing overshoots."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import PchipInterpolator

from faceedit_app.core.resample import at_rate

RATES = st.sampled_from([24.0, 25.0, 30000 / 1001, 30.0, 50.0, 60.0, 120.0])


def signal(frames: int, seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).random((frames, 3))


def test_the_same_rate_gives_the_same_values() -> None:
    values = signal(90)
    assert np.array_equal(at_rate(np.arange(90) / 30, values, 30, 30), values)


def test_a_faster_rate_passes_through_every_frame() -> None:
    values = signal(90)
    faster = at_rate(np.arange(90) / 30, values, 60, 30)
    assert len(faster) == 180
    assert np.allclose(faster[::2], values, rtol=0, atol=1e-9)


def test_the_curve_between_frames_is_the_monotone_cubic() -> None:
    times = np.cumsum(np.random.default_rng(1).uniform(0.02, 0.05, 60))
    times -= times[0]
    values = signal(60)
    found = at_rate(times, values, 120, 30)
    moments = np.arange(len(found)) / 120
    inner = (moments > times[1]) & (moments < times[-2])  # its ends are drawn in another way
    assert np.allclose(found[inner], PchipInterpolator(times, values)(moments[inner]), atol=1e-6)


@settings(deadline=None, derandomize=True)
@given(rate=RATES, own=RATES, frames=st.integers(1, 200), seed=st.integers(0, 99))
def test_no_rate_overshoots_or_changes_the_length(
    rate: float, own: float, frames: int, seed: int
) -> None:
    values = signal(frames, seed)
    found = at_rate(np.arange(frames) / own, values, rate, own)
    assert found.min() >= values.min() - 1e-9
    assert found.max() <= values.max() + 1e-9
    assert len(found) / rate == pytest.approx(max(frames / own, 1 / rate), abs=0.51 / rate)


@pytest.mark.parametrize("frame", range(30, 40))
def test_a_blink_of_one_frame_survives_a_slower_rate(frame: int) -> None:
    values = np.zeros((120, 1))
    values[frame] = 1.0
    slower = at_rate(np.arange(120) / 60, values, 24, 60)
    assert slower.sum() / 24 == pytest.approx(1 / 60)
    assert slower.max() > 0.25
