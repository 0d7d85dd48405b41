"""Losses and noise against slow, obvious reference code."""

from __future__ import annotations

import numpy as np
import pytest
import torch
from support.performances import DISTANCES, RIG, performance, tiny

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.controls import CONTROL_INDEX
from faceedit_app.core.regions import REGIONS
from faceedit_app.lab.training.data import cut_windows, region_windows
from faceedit_app.lab.training.examples import Examples
from faceedit_app.lab.training.losses import Losses, WindowBatch, salt_and_pepper

LOWER = REGIONS[0]


@pytest.fixture(scope="module")
def batch() -> WindowBatch:
    windows, captured = cut_windows([performance(6.0)], 16, 0.0)
    captured[1, [ARKIT_INDEX[c] for c in LOWER.channels[:7]]] = False
    return WindowBatch.of(region_windows(LOWER, windows, captured, DISTANCES), np.arange(3))


@pytest.fixture(scope="module")
def losses() -> Losses:
    examples = Examples(LOWER, [performance(30.0)], RIG, tiny())
    return Losses(examples.own_distances, tiny())


def wrong(batch: WindowBatch) -> torch.Tensor:
    torch.manual_seed(0)
    return batch.weights + 0.1 * torch.randn_like(batch.weights)


def slow_terms(answer: np.ndarray, batch: WindowBatch) -> tuple[float, float, float]:
    """MSE, velocity and distance terms, entry by entry."""
    settings = tiny()
    truth, seen = batch.weights.numpy(), batch.captured.numpy()
    squares, changes, distances = [], [], []
    windows, channels, frames = truth.shape
    columns = [ARKIT_INDEX[c] for c in LOWER.channels]
    for n in range(windows):
        for k in range(channels):
            if not seen[n, k]:
                continue
            for t in range(frames):
                squares.append((answer[n, k, t] - truth[n, k, t]) ** 2)
                if t:
                    mine = answer[n, k, t] - answer[n, k, t - 1]
                    theirs = truth[n, k, t] - truth[n, k, t - 1]
                    changes.append((mine - theirs) ** 2)
        for t in range(frames):
            for c, control in enumerate(LOWER.controls):
                vector = batch.still[n, c, :, t].numpy().astype(np.float64)
                gradient = DISTANCES.gradients[columns, CONTROL_INDEX[control]]
                length = np.linalg.norm(vector + answer[n, :, t] @ gradient)
                wanted = float(batch.controls[n, c, t])
                near = 1 + settings.near_weight * np.exp(-wanted / settings.near_mm)
                distances.append(near * ((length - wanted) / settings.distance_unit_mm) ** 2)
    return float(np.mean(squares)), float(np.mean(changes)), float(np.mean(distances))


def test_terms_are_those_of_the_slow_reference(batch: WindowBatch, losses: Losses) -> None:
    answer = wrong(batch)
    mse, velocity, distance = slow_terms(answer.numpy().astype(np.float64), batch)
    assert float(losses.mse(answer, batch)) == pytest.approx(mse, rel=1e-4)
    assert float(losses.velocity(answer, batch)) == pytest.approx(velocity, rel=1e-4)
    assert float(losses.distance(answer, batch)) == pytest.approx(distance, rel=1e-3)


def test_gradient_of_the_whole_loss_is_that_of_the_slow_reference(
    batch: WindowBatch, losses: Losses
) -> None:
    answer = wrong(batch).requires_grad_()
    losses.system(answer, batch).backward()
    settings, step = tiny(), 1e-4
    assert answer.grad is not None

    def slow(values: np.ndarray) -> float:
        mse, velocity, distance = slow_terms(values, batch)
        return mse + settings.velocity_loss * velocity + settings.distance_loss * distance

    for place in [(0, 0, 3), (1, 3, 5), (1, 12, 0), (2, 17, 15)]:
        up, down = (answer.detach().numpy().astype(np.float64) for _ in range(2))
        up, down = up.copy(), down.copy()
        up[place] += step
        down[place] -= step
        slope = (slow(up) - slow(down)) / (2 * step)
        assert float(answer.grad[place]) == pytest.approx(slope, rel=2e-2, abs=2e-6)


def test_true_weights_cost_nothing(batch: WindowBatch, losses: Losses) -> None:
    assert float(losses.mse(batch.weights, batch)) == 0.0
    assert float(losses.system(batch.weights, batch)) < 1e-6


def test_channels_that_were_not_captured_are_not_learned_from(
    batch: WindowBatch, losses: Losses
) -> None:
    answer = batch.weights.clone()
    answer[1, :7] += 0.5
    assert float(losses.mse(answer, batch)) == 0.0


def test_salt_and_pepper_hits_its_share_with_the_ends_of_the_range() -> None:
    controls = torch.full((400, 3, 64), 5.0)
    low, high = torch.tensor([0.0, 1.0, 2.0]), torch.tensor([10.0, 11.0, 12.0])
    random = torch.Generator().manual_seed(1)
    noisy = salt_and_pepper(controls, low, high, tiny(noise=0.2, noisy_windows=0.5), random)
    hit = noisy != 5.0
    assert float(hit.any(2).any(1).float().mean()) == pytest.approx(0.5, abs=0.08)
    assert float(hit.float().mean()) == pytest.approx(0.1, abs=0.02)
    for c in range(3):
        assert set(noisy[:, c].unique().tolist()) == {float(low[c]), 5.0, float(high[c])}


def test_lids_that_pass_each_other_count_as_shut() -> None:
    examples = Examples(REGIONS[2], [performance(30.0)], RIG, tiny())
    losses = Losses(examples.own_distances, tiny())
    weights = np.zeros((1, 16, 52), np.float32)
    shut = [ARKIT_INDEX[c] for c in ("eyeBlinkLeft", "eyeBlinkRight")]
    weights[:, :, shut] = np.linspace(0, 3, 16)[:, None]
    captured = np.ones((1, 52), bool)
    batch = WindowBatch.of(region_windows(REGIONS[2], weights, captured, DISTANCES), np.arange(1))
    assert batch.controls.min() == 0  # passed
    assert losses.control_error(batch.weights, batch).abs().max() < 1e-2
