"""Fitting: deterministic, resumable, stoppable; what is frozen stays frozen."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import numpy as np
import pytest
import torch
from support.performances import RIG, performance, smallest, tiny

from faceedit_app.core.regions import REGIONS
from faceedit_app.lab.training.fit import Epoch, FittedRegion, fit_region
from faceedit_app.lab.training.holden import fit_holden
from faceedit_app.lab.training.loop import rate
from faceedit_app.lab.training.model_files import TrainedRegion, load_trained, save_trained
from faceedit_app.networks.region import read_region

LOWER, UPPER, EYELIDS = REGIONS
TAKES = [performance(25.0, seed=s) for s in range(2)]


@lru_cache
def whole(recipe: str = "faceedit") -> FittedRegion:
    """Trained in one go, as `tiny` says."""
    return fit_region(EYELIDS, TAKES, RIG, tiny(recipe))


def state(model: TrainedRegion) -> dict[str, torch.Tensor]:
    """Parameters and statistics; how many batches made them is not kept, and changes nothing."""
    found = model.networks.state_dict().items()
    return {k: v.clone() for k, v in found if not k.endswith("num_batches_tracked")}


def same(a: TrainedRegion, b: TrainedRegion) -> bool:
    mine, theirs = state(a), state(b)
    return mine.keys() == theirs.keys() and all(torch.equal(mine[k], theirs[k]) for k in mine)


@pytest.mark.parametrize("recipe", ["faceedit", "paper"])
def test_same_seed_gives_the_same_networks(recipe: str) -> None:
    first, second = whole(recipe), fit_region(EYELIDS, TAKES, RIG, tiny(recipe))
    assert same(first.model, second.model)
    assert first.mse == second.mse
    one, two = first.model.description, second.model.description
    np.testing.assert_array_equal(one.covariance, two.covariance)
    other = fit_region(EYELIDS, TAKES, RIG, tiny(recipe, seed=2))
    assert not same(first.model, other.model)


class Interrupted(Exception):
    pass


@pytest.mark.parametrize("recipe", ["faceedit", "paper"])
@pytest.mark.parametrize("after", [1, 2, 4])
def test_interrupted_training_goes_on_to_the_same_networks(
    tmp_path: Path, recipe: str, after: int
) -> None:
    seen: list[Epoch] = []

    def cut(epoch: Epoch) -> None:
        seen.append(epoch)
        if len(seen) == after:
            raise Interrupted

    with pytest.raises(Interrupted):
        fit_region(EYELIDS, TAKES, RIG, tiny(recipe), cut, checkpoints=tmp_path)
    later: list[Epoch] = []
    resumed = fit_region(EYELIDS, TAKES, RIG, tiny(recipe), later.append, checkpoints=tmp_path)
    assert len(later) == 5 - after
    assert same(whole(recipe).model, resumed.model)
    assert whole(recipe).histories == resumed.histories


def test_checkpoint_of_another_training_is_not_used(tmp_path: Path) -> None:
    fit_region(EYELIDS, TAKES, RIG, tiny(), checkpoints=tmp_path)
    epochs: list[Epoch] = []
    other = tiny(learning_rate=2e-3)
    result = fit_region(EYELIDS, TAKES, RIG, other, epochs.append, checkpoints=tmp_path)
    assert len(epochs) == 5
    assert same(result.model, fit_region(EYELIDS, TAKES, RIG, other).model)


def test_damaged_checkpoint_means_starting_again(tmp_path: Path) -> None:
    fit_region(EYELIDS, TAKES, RIG, tiny(), checkpoints=tmp_path)
    kept = list(tmp_path.iterdir())
    assert kept
    for path in kept:
        path.write_bytes(path.read_bytes()[:200])
    again = fit_region(EYELIDS, TAKES, RIG, tiny(), checkpoints=tmp_path)
    assert same(whole().model, again.model)


def test_stop_keeps_the_best_epoch_so_far() -> None:
    epochs: list[Epoch] = []

    def stop(epoch: Epoch) -> None:
        epochs.append(epoch)
        if epoch.number == 2:
            raise KeyboardInterrupt

    settings = smallest(epochs_regressor=50)
    stopped = fit_region(EYELIDS, TAKES, RIG, settings, stop)
    assert stopped.stopped
    assert len(epochs) == 2, "the stop did not end the training"
    assert stopped.histories["regressor"].held == [e.validation for e in epochs]
    answer = stopped.model.answering()(np.full((8, 2), 9.0, np.float32), 1.0)
    assert np.isfinite(answer).all()


def test_autoencoder_leaves_the_regressor_as_it_was() -> None:
    before = fit_region(EYELIDS, TAKES, RIG, tiny(epochs_autoencoder=0)).model
    after = fit_region(EYELIDS, TAKES, RIG, tiny(epochs_autoencoder=3)).model
    first, last = state(before), state(after)
    for name in first:
        if name.startswith("regressor."):
            assert torch.equal(first[name], last[name]), name
    assert any(not torch.equal(first[n], last[n]) for n in first if n.startswith("autoencoder."))


def weights_of(network: object) -> dict[str, torch.Tensor]:
    assert isinstance(network, torch.nn.Module)
    return network.state_dict()


def test_papers_recipe_adapts_statistics_and_nothing_else_of_the_regressor() -> None:
    settings = tiny("paper", epochs_autoencoder=3)
    plain = fit_region(EYELIDS, TAKES, RIG, replace(settings, epochs_autoencoder=0)).model
    model = fit_region(EYELIDS, TAKES, RIG, settings).model
    regressor, adapted = (
        weights_of(network) for network in (model.networks.regressor, model.networks.adapted)
    )
    unadapted = weights_of(plain.networks.regressor)
    for name, value in regressor.items():
        statistic = "running" in name or "batches" in name
        assert torch.equal(value, adapted[name]) != statistic, name
        assert torch.equal(value, unadapted[name]), name


@pytest.mark.parametrize("recipe", ["faceedit", "paper"])
def test_fitted_networks_answer_from_their_file_as_in_torch(tmp_path: Path, recipe: str) -> None:
    model = fit_region(LOWER, TAKES, RIG, smallest(recipe)).model
    save_trained(tmp_path / "lower.onnx", model)
    answer = read_region(tmp_path / "lower.onnx")
    back = load_trained(tmp_path / "lower.onnx")
    assert same(model, back)
    natural, again = model.description.natural, back.description.natural
    assert natural is not None
    assert again is not None
    assert again.limit == natural.limit
    for frames in (2, 64, 202):
        controls = np.random.default_rng(1).uniform(0, 30, (frames, 6)).astype(np.float32)
        with torch.inference_mode():
            wanted = model.networks.answers(torch.from_numpy(controls.T[None]))
        for name, naturalness in (("regressor", 0.0), ("system", 1.0)):
            ours = wanted[name][0].T.numpy()
            np.testing.assert_allclose(answer(controls, naturalness), ours, rtol=1e-3, atol=1e-4)


def test_finetuning_starts_from_the_given_networks() -> None:
    base = whole().model
    weights, low = state(base), base.description.low.copy()
    other = [performance(25.0, seed=9)]
    idle = tiny(epochs_regressor=0, epochs_autoencoder=0)
    unmoved = fit_region(EYELIDS, other, RIG, idle, start=base).model
    assert all(torch.equal(v, weights[k]) for k, v in state(unmoved).items())
    tuned = fit_region(EYELIDS, other, RIG, tiny(widths=(9, 9)), start=base).model
    assert tuned.description.architecture["widths"] == [4, 6]
    assert not all(torch.equal(v, weights[k]) for k, v in state(tuned).items())
    assert np.all(tuned.description.low <= low)


def test_learning_rate_decays_after_five_epochs_without_improvement() -> None:
    paper = tiny("paper")
    falling = [1.0, 0.9, 0.8, 0.7, 0.6, 0.5]
    assert rate(paper, 100, falling) == pytest.approx(1e-3)
    flat = [*falling, *[0.6] * 4]
    assert rate(paper, 100, flat) == pytest.approx(1e-3)
    assert rate(paper, 100, [*flat, 0.6]) == pytest.approx(0.95e-3)
    assert rate(paper, 100, [*flat, *[0.6] * 6]) == pytest.approx(0.95**2 * 1e-3)


def test_learning_rate_falls_along_a_cosine() -> None:
    ours = tiny()
    rates = [rate(ours, 10, [1.0] * n) for n in range(11)]
    assert rates[0] == pytest.approx(1e-3)
    assert rates[-1] == pytest.approx(1e-3 * ours.final_rate)  # type: ignore[operator]
    assert rates == sorted(rates, reverse=True)


def test_baseline_answers_from_its_file_as_in_torch(tmp_path: Path) -> None:
    model, histories = fit_holden(EYELIDS, TAKES, RIG, smallest())
    assert [len(h.held) for h in histories.values()] == [2, 3]
    save_trained(tmp_path / "h.onnx", model)
    answer = read_region(tmp_path / "h.onnx")
    for frames in (2, 8, 50):
        controls = np.random.default_rng(frames).uniform(0, 30, (frames, 2)).astype(np.float32)
        with torch.inference_mode():
            wanted = model.networks.answers(torch.from_numpy(controls.T[None]))["system"]
        np.testing.assert_allclose(answer(controls, 1.0), wanted[0].T.numpy(), atol=1e-5)
        np.testing.assert_array_equal(answer(controls, 0.0), answer(controls, 1.0))
