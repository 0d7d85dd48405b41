"""Fitting: deterministic, resumable, stoppable; what is frozen stays frozen."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from support.performances import DISTANCES, performance, tiny

from faceedit_app.core.regions import REGIONS
from faceedit_app.lab.training.fit import Epoch, fit_region
from faceedit_app.lab.training.holden import fit_holden, load_holden, save_holden
from faceedit_app.lab.training.loop import rate
from faceedit_app.lab.training.model_files import RegionModel, as_file, load_model, save_model
from faceedit_app.networks.inference import RegionAnswer

LOWER, UPPER, EYELIDS = REGIONS
TAKES = [performance(25.0, seed=s) for s in range(2)]


def state(model: RegionModel) -> dict[str, torch.Tensor]:
    return {k: v.clone() for k, v in model.networks.state_dict().items()}


def same(a: RegionModel, b: RegionModel) -> bool:
    mine, theirs = state(a), state(b)
    return mine.keys() == theirs.keys() and all(torch.equal(mine[k], theirs[k]) for k in mine)


@pytest.mark.parametrize("recipe", ["faceedit", "paper"])
def test_same_seed_gives_the_same_networks(recipe: str) -> None:
    first, second = (fit_region(EYELIDS, TAKES, DISTANCES, tiny(recipe)) for _ in range(2))
    assert same(first.model, second.model)
    assert first.mse == second.mse
    np.testing.assert_array_equal(first.model.covariance, second.model.covariance)
    other = fit_region(EYELIDS, TAKES, DISTANCES, tiny(recipe, seed=2))
    assert not same(first.model, other.model)


class Interrupted(Exception):
    pass


@pytest.mark.parametrize("recipe", ["faceedit", "paper"])
@pytest.mark.parametrize("after", [1, 2, 4])
def test_interrupted_training_goes_on_to_the_same_networks(
    tmp_path: Path, recipe: str, after: int
) -> None:
    whole = fit_region(EYELIDS, TAKES, DISTANCES, tiny(recipe))
    seen: list[Epoch] = []

    def cut(epoch: Epoch) -> None:
        seen.append(epoch)
        if len(seen) == after:
            raise Interrupted

    with pytest.raises(Interrupted):
        fit_region(EYELIDS, TAKES, DISTANCES, tiny(recipe), cut, checkpoints=tmp_path)
    later: list[Epoch] = []
    resumed = fit_region(
        EYELIDS, TAKES, DISTANCES, tiny(recipe), later.append, checkpoints=tmp_path
    )
    assert len(later) == 5 - after
    assert same(whole.model, resumed.model)
    assert whole.histories == resumed.histories


def test_checkpoint_of_another_training_is_not_used(tmp_path: Path) -> None:
    fit_region(EYELIDS, TAKES, DISTANCES, tiny(), checkpoints=tmp_path)
    epochs: list[Epoch] = []
    other = tiny(learning_rate=2e-3)
    result = fit_region(EYELIDS, TAKES, DISTANCES, other, epochs.append, checkpoints=tmp_path)
    assert len(epochs) == 5
    assert same(result.model, fit_region(EYELIDS, TAKES, DISTANCES, other).model)


def test_damaged_checkpoint_means_starting_anew(tmp_path: Path) -> None:
    whole = fit_region(EYELIDS, TAKES, DISTANCES, tiny(), checkpoints=tmp_path)
    for path in tmp_path.iterdir():
        path.write_bytes(path.read_bytes()[:200])
    again = fit_region(EYELIDS, TAKES, DISTANCES, tiny(), checkpoints=tmp_path)
    assert same(whole.model, again.model)


def test_stop_keeps_the_best_epoch_so_far() -> None:
    epochs: list[Epoch] = []

    def stop(epoch: Epoch) -> None:
        epochs.append(epoch)
        if epoch.number == 2:
            raise KeyboardInterrupt

    settings = tiny(epochs_regressor=50)
    stopped = fit_region(EYELIDS, TAKES, DISTANCES, settings, stop)
    assert stopped.stopped
    assert len(epochs) == 2, "the stop did not end the training"
    assert stopped.histories["regressor"].held == [e.validation for e in epochs]
    answer = RegionAnswer(as_file(stopped.model))(np.full((1, 8, 2), 9.0, np.float32), 1.0)
    assert np.isfinite(answer).all()


def test_autoencoder_leaves_the_regressor_as_it_was() -> None:
    before = fit_region(EYELIDS, TAKES, DISTANCES, tiny(epochs_autoencoder=0)).model
    after = fit_region(EYELIDS, TAKES, DISTANCES, tiny(epochs_autoencoder=3)).model
    first, last = state(before), state(after)
    for name in first:
        if name.startswith("regressor."):
            assert torch.equal(first[name], last[name]), name
    assert any(not torch.equal(first[n], last[n]) for n in first if n.startswith("autoencoder."))


def test_papers_recipe_adapts_statistics_and_nothing_else_of_the_regressor() -> None:
    settings = tiny("paper", epochs_autoencoder=3)
    plain = fit_region(EYELIDS, TAKES, DISTANCES, replace(settings, epochs_autoencoder=0)).model
    model = fit_region(EYELIDS, TAKES, DISTANCES, settings).model
    assert model.networks.adapted is not None
    regressor, adapted = model.networks.regressor.state_dict(), model.networks.adapted.state_dict()
    for name, value in regressor.items():
        statistic = "running" in name or "batches" in name
        assert torch.equal(value, adapted[name]) != statistic, name
        assert torch.equal(value, plain.networks.regressor.state_dict()[name]), name


@pytest.mark.parametrize("recipe", ["faceedit", "paper"])
@pytest.mark.parametrize("frames", [2, 64, 202])
def test_fitted_networks_answer_in_numpy_as_in_torch_after_a_file(
    tmp_path: Path, recipe: str, frames: int
) -> None:
    model = fit_region(LOWER, TAKES, DISTANCES, tiny(recipe)).model
    save_model(tmp_path / "m.safetensors", model)
    back = load_model(tmp_path / "m.safetensors")
    assert same(model, back)
    assert back.natural is not None
    assert model.natural is not None
    assert back.natural.limit == model.natural.limit
    controls = np.random.default_rng(1).uniform(0, 30, (1, frames, 6)).astype(np.float32)
    for naturalness in (0.0, 0.5, 1.0):
        with torch.inference_mode():
            wanted = model.networks(torch.from_numpy(controls).transpose(1, 2), naturalness)
        got = RegionAnswer(as_file(back))(controls, naturalness)
        np.testing.assert_allclose(got, wanted.transpose(1, 2).numpy(), rtol=1e-3, atol=1e-4)


def test_finetuning_starts_from_the_given_networks() -> None:
    base = fit_region(EYELIDS, TAKES, DISTANCES, tiny()).model
    weights, low = state(base), base.low.copy()
    other = [performance(25.0, seed=9)]
    idle = tiny(epochs_regressor=0, epochs_autoencoder=0)
    unmoved = fit_region(EYELIDS, other, DISTANCES, idle, start=base).model
    assert all(torch.equal(v, weights[k]) for k, v in unmoved.networks.state_dict().items())
    tuned = fit_region(EYELIDS, other, DISTANCES, tiny(widths=(9, 9)), start=base).model
    assert tuned.widths == (4, 6)
    assert not all(torch.equal(v, weights[k]) for k, v in tuned.networks.state_dict().items())
    assert np.all(tuned.low <= low)


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


def test_baseline_answers_any_length_and_comes_back_from_its_file(tmp_path: Path) -> None:
    model, histories = fit_holden(EYELIDS, TAKES, DISTANCES, tiny())
    assert [len(h.held) for h in histories.values()] == [2, 3]
    save_holden(tmp_path / "h.safetensors", model)
    back = load_holden(tmp_path / "h.safetensors")
    for frames in (1, 2, 7, 50):
        curves = np.random.default_rng(frames).uniform(0, 30, (frames, 8))
        answer = model.answer(curves)
        assert answer.shape == (frames, 6)
        np.testing.assert_array_equal(answer, back.answer(curves))
