"""What networks learn from: stretches, windows, and takes that are played in other ways."""

from __future__ import annotations

import numpy as np
import pytest
from support.performances import DISTANCES, RIG, performance, tiny

from faceedit_app.core.arkit import ARKIT_CHANNELS, ARKIT_INDEX
from faceedit_app.core.controls import CONTROL_INDEX
from faceedit_app.core.errors import FileError
from faceedit_app.core.regions import REGIONS
from faceedit_app.lab.training.data import cut_windows, mirrored, region_windows, stretches
from faceedit_app.lab.training.examples import Examples
from faceedit_app.lab.training.settings import RECIPES, Variety
from faceedit_app.lab.training.variety import at_tempo, play, split_sides

LOWER, UPPER, EYELIDS = REGIONS


def numbered(frames: int, name: str = "a") -> object:
    from dataclasses import replace

    take = performance(frames / 25.0, source=name)
    weights = np.repeat(np.arange(frames, dtype=np.float32)[:, None], 52, axis=1)
    return replace(take, weights=weights)


@pytest.mark.parametrize("frames", [64, 128, 130, 700, 2000])
def test_no_frame_is_both_learned_from_and_held_out(frames: int) -> None:
    train, held = stretches([numbered(frames)], tiny())  # type: ignore[list-item]
    learned = [x for part in train for x in part.weights[:, 0]]
    kept = [x for part in held for x in part.weights[:, 0]]
    assert sorted(learned + kept) == list(range(frames))
    assert kept
    assert all(np.all(np.diff(part.weights[:, 0]) == 1) for part in train + held)


def test_stretches_do_not_join_takes() -> None:
    train, _ = stretches([numbered(300, "a"), numbered(300, "b")], tiny())  # type: ignore[list-item]
    assert all(np.all(np.diff(part.weights[:, 0]) == 1) for part in train)


def test_windows_overlap_by_three_quarters() -> None:
    windows, captured = cut_windows([numbered(128)], 64, 0.75)  # type: ignore[list-item]
    assert windows[:, 0, 0].tolist() == [0, 16, 32, 48, 64]
    assert captured.shape == (5, 52)


def test_controls_of_windows_are_those_of_the_rig() -> None:
    take = performance(6.0)
    windows, captured = cut_windows([take], 64, 0.75)
    found = region_windows(LOWER, windows, captured, DISTANCES)
    measured = DISTANCES.measure(windows[1])
    columns = [CONTROL_INDEX[c] for c in LOWER.controls]
    np.testing.assert_allclose(found.controls[1].T, measured[:, columns], rtol=1e-6)
    channels = [ARKIT_INDEX[c] for c in LOWER.channels]
    np.testing.assert_array_equal(found.weights[1].T, windows[1][:, channels])


def test_source_without_a_regions_channels_is_left_out_of_it() -> None:
    from dataclasses import replace

    lids = [ARKIT_INDEX[c] for c in EYELIDS.channels]
    captured = np.ones(52, bool)
    captured[lids] = False
    blind = replace(performance(6.0), captured=captured)
    windows = cut_windows([blind, performance(6.0, seed=1)], 64, 0.75)
    assert len(region_windows(EYELIDS, *windows, DISTANCES)) == len(windows[0]) // 2
    assert len(region_windows(LOWER, *windows, DISTANCES)) == len(windows[0])


@pytest.mark.parametrize("tempo", [0.5, 0.8, 1.0, 1.3, 2.0])
def test_tempo_keeps_ends_and_changes_length(tempo: float) -> None:
    weights = performance(4.0).weights
    played = at_tempo(weights, tempo)
    assert len(played) == round((len(weights) - 1) / tempo) + 1
    np.testing.assert_allclose(played[[0, -1]], weights[[0, -1]], atol=1e-6)


def test_take_played_again_is_still_a_face() -> None:
    from dataclasses import replace

    captured = np.ones(52, bool)
    captured[ARKIT_INDEX["mouthSmileLeft"]] = captured[ARKIT_INDEX["cheekPuff"]] = False
    take = replace(performance(10.0), captured=captured)
    random = np.random.default_rng(3)
    for mirror in (False, True):
        for _ in range(10):
            anew = play(take, Variety(share=1.0), 64, mirror, random)
            assert len(anew.weights) >= 64
            assert anew.weights.dtype == np.float32
            assert anew.weights.min() >= 0.0
            assert anew.weights.max() <= 1.0
            assert np.all(anew.weights[:, ~anew.captured] == 0.0)
            assert anew.captured.sum() == captured.sum()
            close, jaw = ARKIT_INDEX["mouthClose"], ARKIT_INDEX["jawOpen"]
            assert np.all(anew.weights[:, close] <= anew.weights[:, jaw])


def test_take_played_without_variety_is_the_take() -> None:
    nothing = Variety(1.0, (1.0, 1.0), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    take = performance(6.0)
    same = play(take, nothing, 64, False, np.random.default_rng(0))
    np.testing.assert_allclose(same.weights, take.weights, atol=1e-6)


def test_split_sides_takes_only_the_left_from_elsewhere() -> None:
    windows = np.arange(4, dtype=np.float32)[:, None, None] * np.ones((4, 5, 52), np.float32)
    captured = np.ones((4, 52), bool)
    out, _ = split_sides(windows, captured, 1.0, np.random.default_rng(1))
    left = np.array([c.endswith("Left") for c in ARKIT_CHANNELS])
    assert np.all(out[:, :, ~left] == windows[:, :, ~left])
    assert np.any(out[:, :, left] != windows[:, :, left])


def test_mirroring_twice_is_the_same() -> None:
    weights = performance(3.0).weights
    np.testing.assert_array_equal(mirrored(mirrored(weights)), weights)
    assert not np.array_equal(mirrored(weights), weights)


def test_epochs_differ_with_variety_and_repeat_with_their_number() -> None:
    takes = [performance(30.0, seed=s) for s in range(2)]
    ours = Examples(LOWER, takes, RIG, tiny())
    again = Examples(LOWER, takes, RIG, tiny())
    np.testing.assert_array_equal(ours.epoch(3).weights, again.epoch(3).weights)
    assert not np.array_equal(ours.epoch(3).weights[:4], ours.epoch(4).weights[:4])
    plain = Examples(LOWER, takes, RIG, tiny("paper"))
    np.testing.assert_array_equal(plain.epoch(1).weights, plain.epoch(2).weights)


def test_recorded_takes_are_natural_and_wild_ones_are_not() -> None:
    takes = [performance(30.0, seed=s) for s in range(2)]
    natural = Examples(LOWER, takes, RIG, tiny("paper")).natural
    columns = [ARKIT_INDEX[c] for c in LOWER.channels]
    own = takes[0].weights[:, columns].astype(np.float64)
    assert np.mean(natural.distance(own) <= natural.limit) >= 0.99
    wild = own.copy()
    wild[100] = 3.0
    assert natural.distance(wild)[100] > natural.limit


def test_too_little_data_is_reported_in_one_line() -> None:
    with pytest.raises(FileError, match="too little for the lower face"):
        Examples(LOWER, [performance(3.0)], RIG, tiny())


def test_papers_recipe_is_the_papers() -> None:
    paper = RECIPES["paper"]
    assert (paper.window, paper.overlap, paper.batch, paper.held_out) == (64, 0.75, 128, 0.05)
    assert (paper.learning_rate, paper.decay, paper.patience) == (1e-3, 0.95, 5)
    assert (paper.noise, paper.noisy_windows, paper.distance_loss, paper.l2) == (0.2, 1, 1, 1)
    assert not paper.residual
    assert paper.adapt_statistics
    assert paper.variety is None
    assert paper.velocity_loss == paper.distance_loss_regressor == 0
