"""Peaks and smoothing by numpy against scipy's, which the installed application leaves out."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d, uniform_filter1d
from scipy.signal import find_peaks

from faceedit_app.editing.solving.filters import gaussian, moving_mean, peaks


def curve(kind: str, rng: np.random.Generator) -> NDArray[np.float64]:
    noise = rng.normal(size=int(rng.integers(3, 1500)))
    kinds: dict[str, NDArray[np.float64]] = {
        "noise": noise,
        "wandering": np.cumsum(noise),
        "steps": np.rint(np.cumsum(noise)),
        "cut off": np.clip(np.cumsum(noise), -1.0, 1.0),  # long level tops
        "level": np.zeros_like(noise),
    }
    return kinds[kind]


@pytest.mark.filterwarnings("ignore:some peaks have a prominence of 0")
@pytest.mark.parametrize("kind", ["noise", "wandering", "steps", "cut off", "level"])
def test_peaks_are_scipys(kind: str) -> None:
    rng = np.random.default_rng(7)
    for _ in range(40):
        x, reach = curve(kind, rng), int(rng.integers(1, 100))
        prominence, width = rng.uniform(0.05, 3.0), rng.uniform(1.0, 40.0)
        frames, found = find_peaks(x, prominence=prominence, width=(0, width), wlen=2 * reach + 1)
        ours = list(peaks(x, prominence, width, reach))
        assert [frame for frame, _ in ours] == frames.tolist()
        np.testing.assert_array_equal([deep for _, deep in ours], found["prominences"])


@pytest.mark.parametrize("sigma", [0.4, 1.0, 3.7, 40.0])
@pytest.mark.parametrize("frames", [1, 2, 50, 700])
def test_smoothing_is_scipys(sigma: float, frames: int) -> None:
    x = np.random.default_rng(3).normal(size=frames)
    np.testing.assert_allclose(
        gaussian(x, sigma), gaussian_filter1d(x, sigma, mode="nearest"), rtol=0, atol=1e-12
    )


@pytest.mark.parametrize("window", [1, 2, 5, 30, 31])
@pytest.mark.parametrize("frames", [1, 20, 700])
def test_moving_mean_is_scipys(window: int, frames: int) -> None:
    x = np.random.default_rng(4).normal(size=(frames, 8))
    np.testing.assert_allclose(
        moving_mean(x, window),
        uniform_filter1d(x, window, axis=0, mode="nearest"),
        rtol=0,
        atol=1e-12,
    )
