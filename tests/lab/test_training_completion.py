"""Training what completes requests: from damage, deterministic, resumable."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from support.performances import DISTANCES, RIG, performance, tiny

from faceedit_app.core.regions import EYELIDS, LOWER, UPPER
from faceedit_app.lab.training.completion import (
    TrainedCompletion,
    fit_completion,
    save_completion,
)
from faceedit_app.lab.training.damage import Curves, Requests, requests
from faceedit_app.lab.training.fit import Epoch
from faceedit_app.lab.training.settings import TrainingSettings
from faceedit_app.networks.completion import read_completion

TAKES = [performance(25.0, seed=s) for s in range(3)]
WINDOW = 64


def small(**changes: object) -> TrainingSettings:
    return replace(tiny(epochs_completion=3, completion_widths=(4,)), **changes)  # type: ignore[arg-type]


def examples(seed: int = 0) -> Requests:
    curves = Curves.of(LOWER, TAKES, DISTANCES)
    return requests(TAKES, curves, DISTANCES, WINDOW, np.random.default_rng(seed))


def fitted(settings: TrainingSettings, **more: object) -> TrainedCompletion:
    trained = fit_completion(LOWER, TAKES, RIG, settings, **more)  # type: ignore[arg-type]
    assert trained is not None
    return trained


@pytest.fixture(scope="module")
def whole() -> TrainedCompletion:
    """Trained by `small()` in one go."""
    return fitted(small())


def test_what_is_right_has_to_stay_in_about_half_of_the_examples() -> None:
    made = examples()
    wrong = np.abs(made.truth * made.share).max(axis=(1, 2)) > 0.05
    assert 0.3 < wrong.mean() < 0.7


def test_the_truth_is_about_curves_that_are_not_asked_for() -> None:
    made = examples()
    assert not (made.truth * (1 - made.other)).any()
    assert not (made.away * (1 - made.other)).any()
    count = len(LOWER.own)
    holds = made.features[:, 3 * count : 4 * count]
    assert not (holds * made.other).any()
    assert (holds.max(axis=(1, 2)) == 1).all()
    assert (holds[:, :, [0, -1]].min(axis=(1, 2)) == 0).all()


def test_what_is_around_is_nearer_to_the_truth_where_content_was_swapped() -> None:
    made = examples()
    wrong = np.abs(made.truth * made.share).max(axis=(1, 2)) > 0.5
    where = (made.share * made.other)[wrong]
    kept = (made.truth[wrong] ** 2 * where).sum()
    around = ((made.truth - made.away)[wrong] ** 2 * where).sum()
    assert around < kept


def test_chance_comes_from_the_seed_alone() -> None:
    one, two, other = examples(), examples(), examples(1)
    np.testing.assert_array_equal(one.features, two.features)
    assert len(one) != len(other) or (one.features != other.features).any()


def test_same_seed_gives_the_same_file(whole: TrainedCompletion) -> None:
    assert fitted(small()).content() == whole.content()
    assert fitted(small(seed=2)).content() != whole.content()


class Interrupted(Exception):
    pass


def test_interrupted_training_goes_on_to_the_same_network(
    tmp_path: Path, whole: TrainedCompletion
) -> None:
    def cut(epoch: Epoch) -> None:
        raise Interrupted

    with pytest.raises(Interrupted):
        fit_completion(LOWER, TAKES, RIG, small(), cut, tmp_path)
    again = fitted(small(), checkpoints=tmp_path)
    assert again.content() == whole.content()
    assert again.history == whole.history


def test_the_file_answers_as_the_network(tmp_path: Path, whole: TrainedCompletion) -> None:
    save_completion(tmp_path / "lower.onnx", whole)
    seen = examples().features[0]
    share, further = read_completion(tmp_path / "lower.onnx")(seen.T.astype(np.float64))
    with torch.inference_mode():
        wanted = whole.network(torch.from_numpy(seen)[None])[0].T.numpy()
    np.testing.assert_allclose(share, wanted[:, 0], atol=1e-4)
    np.testing.assert_allclose(further, wanted[:, 1:], atol=1e-4)


def test_training_beats_keeping_every_take_and_replacing_every_take() -> None:
    trained = fitted(tiny(epochs_completion=12, completion_widths=(8, 12)))
    errors = trained.errors
    assert errors["network"] < 0.95 * min(errors["kept"], errors["around"])
    assert errors["network"] < 0.98 * trained.history.held[0]  # even half of each is better


@pytest.mark.parametrize("region", [UPPER, EYELIDS])
def test_regions_whose_curves_are_all_held_have_none(region: object) -> None:
    assert fit_completion(region, TAKES, RIG, small()) is None  # type: ignore[arg-type]


def test_the_papers_recipe_has_none() -> None:
    assert fit_completion(LOWER, TAKES, RIG, tiny("paper")) is None
