"""What is measured on takes of people: restoration, gestures, events, and telling apart."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest
from support.faces import random_engine
from support.people import opened_on, source_with, take_with, talking
from support.performances import RIG, performance

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Floats
from faceedit_app.core.controls import CONTROL_INDEX, LIP_OPENING, MOUTH_CORNERS
from faceedit_app.core.regions import LOWER
from faceedit_app.editing.edits.edit import Edit
from faceedit_app.lab.evaluation.people import gestures, telling_apart
from faceedit_app.lab.evaluation.people.events import Events
from faceedit_app.lab.evaluation.people.opened import DAMAGED, FACEEDIT, REAL, SPLICE, Opened
from faceedit_app.lab.evaluation.people.references import References
from faceedit_app.lab.evaluation.people.restoration import halved, measure_restoration, swapped
from faceedit_app.lab.evaluation.people.tally import Tally
from faceedit_app.lab.evaluation.systems import Systems

OPENING = CONTROL_INDEX[LIP_OPENING]


@pytest.fixture(scope="module")
def learned() -> References:
    return References([performance(20.0, seed=5)], RIG)


@pytest.fixture(scope="module")
def systems() -> Systems:
    return Systems(random_engine())


# --- restoration -----------------------------------------------------------------------------


def test_a_system_that_returns_the_truth_restores_without_error(
    systems: Systems, learned: References, monkeypatch: pytest.MonkeyPatch
) -> None:
    truth = performance(12.0).weights

    def answer(self: Opened, system: str, edits: Sequence[Edit]) -> Floats:
        return truth if system == FACEEDIT else self.weights

    monkeypatch.setattr(Opened, "edited", answer)
    tally = Tally()
    measure_restoration(source_with(take_with(truth)), RIG, systems, learned, tally)
    for figure in ("six", "opening", "half", "lids"):
        name = f"restoration.{figure}"
        assert tally.of_source(name, FACEEDIT, "someone") == 0.0
        damaged = tally.of_source(name, DAMAGED, "someone")
        assert damaged > 0.001
        assert tally.of_source(name, "ridge", "someone") == damaged


def test_damage_is_what_it_says() -> None:
    weights = performance(8.0).weights
    times, rows = np.arange(len(weights)) / 25.0, slice(60, 81)
    half = halved(weights, rows, times)
    np.testing.assert_array_equal(half[[0, -1]], weights[[60, 80]])
    np.testing.assert_allclose(
        half[5:-5], 0.5 * (weights[65:76] + np.median(weights, axis=0)), atol=1e-6
    )
    other = swapped(weights, rows, times, np.random.default_rng(1))
    np.testing.assert_array_equal(other[[0, -1]], weights[[60, 80]])
    begins = [
        i for i in range(len(weights) - 21) if np.allclose(other[5:-5], weights[i + 5 : i + 16])
    ]
    assert len(begins) == 1
    assert begins[0] + 21 <= 60 or begins[0] >= 81


def test_restoration_draws_the_true_curves_through_the_session(
    systems: Systems, learned: References, monkeypatch: pytest.MonkeyPatch
) -> None:
    truth = performance(6.0).weights
    asked: list[tuple[Floats, Floats]] = []
    shown = Opened.edited

    def answer(self: Opened, system: str, edits: Sequence[Edit]) -> Floats:
        weights = shown(self, system, edits)
        if system == FACEEDIT:
            asked.append((self._session.asked.copy(), self.weights))
        return weights

    monkeypatch.setattr(Opened, "edited", answer)
    measure_restoration(source_with(take_with(truth)), RIG, systems, learned, Tally())
    curves = RIG.arkit_distances.measure(truth)
    six = [CONTROL_INDEX[c] for c in LOWER.own]
    np.testing.assert_allclose(asked[0][0][:, six], curves[:, six], atol=1e-3)
    np.testing.assert_allclose(asked[1][0][:, OPENING], curves[:, OPENING], atol=1e-3)
    assert (asked[0][1] != truth).any()


# --- gestures --------------------------------------------------------------------------------


def test_own_closure_is_the_median_of_a_takes_closures() -> None:
    shut = np.array([5.0, 1.8, 1.0, 5.0, 1.2, 5.0, 1.4, 1.5, 5.0, 1.2], np.float32)
    assert gestures.own_closure(shut) == pytest.approx(1.2)
    assert gestures.own_closure(np.full(50, 6.0, np.float32)) == gestures.OWN_MM


def test_closures_are_met_or_not_and_frowns_are_counted(
    systems: Systems, learned: References, monkeypatch: pytest.MonkeyPatch
) -> None:
    opened = opened_on(talking(), systems, learned)

    def answer(self: Opened, system: str, edits: Sequence[Edit]) -> Floats:
        weights = self.weights.copy()
        if system == FACEEDIT and edits:
            weights[:] = 0.0  # the neutral face, whose lips touch as in the take's own closures
            weights[:, ARKIT_INDEX["mouthFrownLeft"]] = 0.2
        return weights

    monkeypatch.setattr(Opened, "edited", answer)
    rest = float(RIG.arkit_distances.measure(np.zeros((1, 52), np.float32))[0, OPENING])
    assert rest < gestures.SHUT_MM
    tally = Tally()
    gestures.measure_closures(opened, "someone", tally)
    assert tally.of_source("closures.met", FACEEDIT, "someone") == 1.0
    assert tally.of_source("closures.met", "paper", "someone") == 0.0
    assert tally.of_source("closures.frown", FACEEDIT, "someone") == pytest.approx(0.1)
    assert tally.of_source("closures.frown", REAL, "someone") == pytest.approx(0.0)


def test_what_real_closures_do_is_measured_against_the_frames_around_them() -> None:
    shut = np.zeros(60, bool)
    shut[20:24] = shut[40:60] = True  # the second one is a pause, not speech
    found = gestures.short_closures(shut, 25.0)
    assert [rows for rows, _ in found] == [slice(20, 24)]
    assert found[0][1].tolist() == [*range(15, 20), *range(24, 29)]


def test_what_a_smile_adds_is_counted_for_captured_channels(
    systems: Systems, learned: References, monkeypatch: pytest.MonkeyPatch
) -> None:
    weights = np.zeros((500, 52), np.float32)
    for stem, size in (("mouthSmile", 0.6), ("cheekSquint", 0.3)):
        for side in ("Left", "Right"):
            weights[200:240, ARKIT_INDEX[stem + side]] = size
    opened = opened_on(weights, systems, learned)

    def answer(self: Opened, system: str, edits: Sequence[Edit]) -> Floats:
        return self.weights + np.float32(0.25 if system == FACEEDIT and edits else 0.0)

    monkeypatch.setattr(Opened, "edited", answer)
    tally = Tally()
    gestures.measure_smiles(
        opened, "someone", lambda *names: not names[0].startswith("mouthDimple"), tally
    )
    by = float(opened.tracked[220, [CONTROL_INDEX[c] for c in MOUTH_CORNERS]].mean())
    by -= float(opened.tracked[0, [CONTROL_INDEX[c] for c in MOUTH_CORNERS]].mean())
    assert tally.of_source("smile.cheekSquint", REAL, "someone") == pytest.approx(
        0.3 * gestures.SMILE_MM / by, rel=1e-3
    )
    assert tally.of_source("smile.mouthStretch", REAL, "someone") == pytest.approx(0.0)
    assert tally.of_source("smile.cheekSquint", FACEEDIT, "someone") == pytest.approx(0.25)
    assert tally.of_source("smile.cheekSquint", "bump", "someone") == 0.0
    assert np.isnan(tally.of_source("smile.mouthDimple", FACEEDIT, "someone"))


def test_asymmetry_is_what_one_side_has_more(
    systems: Systems, learned: References, monkeypatch: pytest.MonkeyPatch
) -> None:
    even = gestures.symmetric_weights(performance(6.0).weights)
    np.testing.assert_array_equal(even, gestures.symmetric_weights(even))
    opened = opened_on(even, systems, learned)

    def answer(self: Opened, system: str, edits: Sequence[Edit]) -> Floats:
        weights = self.weights.copy()
        if system == FACEEDIT:
            weights[:, ARKIT_INDEX["mouthFrownLeft"]] += 0.03
        return weights

    monkeypatch.setattr(Opened, "edited", answer)
    tally = Tally()
    gestures.measure_asymmetry(opened, opened, "someone", tally)
    assert tally.of_source("asymmetry", FACEEDIT, "someone") == pytest.approx(0.03, abs=1e-5)
    assert tally.of_source("asymmetry", "paper", "someone") == 0.0


def test_roughness_is_the_largest_rise_of_a_channel(
    systems: Systems, learned: References, monkeypatch: pytest.MonkeyPatch
) -> None:
    opened = opened_on(performance(6.0).weights, systems, learned)
    shaking = np.where(np.arange(150) % 2, 0.01, 0.0).astype(np.float32)

    def answer(self: Opened, system: str, edits: Sequence[Edit]) -> Floats:
        weights = np.zeros_like(self.weights) if system == "paper" else self.weights.copy()
        if system == FACEEDIT:
            weights[:, ARKIT_INDEX["mouthFrownLeft"]] = shaking
        return weights

    monkeypatch.setattr(Opened, "edited", answer)
    tally = Tally()
    gestures.measure_smooth(opened, "someone", tally)
    before = opened.weights[:, ARKIT_INDEX["mouthFrownLeft"]].astype(np.float64)
    rise = 0.02 - float(np.sqrt((np.diff(before, 2) ** 2).mean()))
    assert tally.of_source("smooth_roughness", FACEEDIT, "someone") == pytest.approx(rise, rel=1e-3)
    assert tally.of_source("smooth_roughness", "ridge", "someone") == 0.0
    assert tally.of_source("smooth_roughness", "paper", "someone") < 0.0


# --- events ----------------------------------------------------------------------------------


def test_events_are_counted_at_the_same_share_of_false_ones() -> None:
    shut = np.zeros(400, bool)
    shut[10:15] = shut[110:115] = shut[210:215] = shut[310:315] = True
    is_open = ~shut
    truth = np.where(shut, 1.0, 8.0)
    misses_one, always_shut = truth.copy(), np.ones(400)
    misses_one[210:215] = 8.0
    random = np.random.default_rng(0).uniform(0.0, 8.0, 400)
    events = Events()
    for name, answer in (
        ("truth", truth), ("misses", misses_one), ("shut", always_shut), ("random", random),
    ):  # fmt: skip
        events.add(name, answer, shut, is_open, 5)
    assert events.rate("truth") == 1.0
    assert events.rate("misses") == 0.75
    assert events.rate("shut") == 0.0
    assert events.rate("random") < 0.5
    events.add("few", truth[:50], shut[:50], is_open[:50], 5)
    assert np.isnan(events.rate("few"))


# --- real or edited --------------------------------------------------------------------------


def windows(random: np.random.Generator, moved: float, count: int = 150) -> telling_apart.Seen:
    real, edited = (random.normal(0.0, 1.0, (count, 8)) for _ in range(2))
    edited[:, 3] += moved
    return telling_apart.Seen(np.arange(count) // 30, real, {"system": edited})


@pytest.mark.parametrize(("moved", "low", "high"), [(0.0, 0.4, 0.6), (8.0, 0.99, 1.0)])
def test_classifier_is_at_chance_without_a_difference_and_sure_with_one(
    moved: float, low: float, high: float
) -> None:
    random = np.random.default_rng(0)
    one, other = windows(random, moved), windows(random, moved)
    found = telling_apart.accuracies({"one": one, "other": other})
    assert low <= found["one"]["system"] <= high
    alone = telling_apart.accuracies({"one": one})
    assert low <= alone["one"]["system"] <= high


def test_a_different_tracker_does_not_hide_edits() -> None:
    random = np.random.default_rng(0)
    one, other = windows(random, 8.0), windows(random, 8.0)
    shifted = telling_apart.Seen(
        other.take, other.real + 20.0, {"system": other.edited["system"] + 20.0}
    )
    assert telling_apart.accuracy(shifted, [one], "system") > 0.95


def test_a_splice_of_real_motion_is_at_chance_and_another_face_is_not(
    systems: Systems, learned: References, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(telling_apart, "WINDOWS", 100)

    def drifting(seed: int) -> Floats:
        random = np.random.default_rng(seed)
        noise = random.normal(0.0, 1.0, (2200, 52))
        kernel = np.hanning(25)[:, None] / 12.0
        smooth = np.stack([np.convolve(noise[:, k], kernel[:, 0], "same") for k in range(52)], 1)
        trembling = 0.02 * random.normal(0.0, 1.0, smooth.shape)  # as trackers do
        return np.clip(0.3 + 0.15 * smooth + trembling, 0.0, 1.0).astype(np.float32)

    seen = {
        name: telling_apart.see(
            source_with(take_with(drifting(seed), f"{name}.csv"), name=name), RIG, systems, learned
        )
        for name, seed in (("one", 1), ("other", 2))
    }
    found = telling_apart.accuracies(seen)
    assert abs(found["one"][SPLICE] - 0.5) < 0.2
    assert found["one"]["paper"] > 0.9  # random networks have a face of their own
