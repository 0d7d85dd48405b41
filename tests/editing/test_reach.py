"""Reach on the shipped character: what can be met is met, within bounds, and nothing is torn."""

from __future__ import annotations

import numpy as np
import pytest
from support.faces import shipped_rig

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.controls import CONTROL_INDEX
from faceedit_app.core.regions import REGIONS, Region
from faceedit_app.editing.solving.reach import Goal, Reach

LOWER, _, EYELIDS = REGIONS
Asked = dict[str, np.ndarray | float]  # lengths in mm, by control


class Face:
    """One region of the shipped character, and short ways to reach on it."""

    def __init__(self, region: Region) -> None:
        whole = shipped_rig().arkit_distances
        rows = [CONTROL_INDEX[c] for c in region.controls]
        self.region = region
        self.distances = whole.select(rows)
        self.columns = np.array([ARKIT_INDEX[c] for c in region.channels])
        self.coupled = (
            (region.channels.index("mouthClose"), region.channels.index("jawOpen"))
            if region is LOWER
            else None
        )

    def lengths(self, weights: np.ndarray) -> np.ndarray:
        return self.distances.measure(weights.astype(np.float32)).astype(np.float64)

    def poses(self, frames: int, seed: int = 0, most: float = 0.5) -> np.ndarray:
        """Random moderate faces."""
        weights = np.zeros((frames, 52))
        random = np.random.default_rng(seed)
        weights[:, self.columns] = random.uniform(0, most, (frames, len(self.columns)))
        close, jaw = ARKIT_INDEX["mouthClose"], ARKIT_INDEX["jawOpen"]
        weights[:, close] = np.minimum(weights[:, close], 0.5 * weights[:, jaw])
        return weights

    def go(
        self,
        weights: np.ndarray,
        asked: Asked,
        strength: float = 1.0,
        naturalness: float = 0.0,
    ) -> np.ndarray:
        """Weights (N, 52) after asking for some lengths; the other controls are to stay."""
        targets = self.lengths(weights)
        mask = np.zeros(targets.shape, bool)
        for name, millimetres in asked.items():
            column = self.region.controls.index(name)
            targets[:, column] = millimetres
            mask[:, column] = True
        result = weights.copy()
        covariance = 0.04 * np.eye(len(self.columns))
        result[:, self.columns] = Reach(self.distances, self.columns, covariance, self.coupled)(
            weights,
            Goal(targets, np.full(targets.shape, strength), mask),
            np.ones((len(weights), len(self.columns))),
            naturalness,
        )
        return result

    def of(self, weights: np.ndarray, name: str) -> np.ndarray:
        return self.lengths(weights)[:, self.region.controls.index(name)]


@pytest.fixture(scope="module")
def lower() -> Face:
    return Face(LOWER)


@pytest.fixture(scope="module")
def lids() -> Face:
    return Face(EYELIDS)


def assert_in_bounds(weights: np.ndarray) -> None:
    assert np.isfinite(weights).all()
    assert weights.min() >= 0
    assert weights.max() <= 1
    assert (
        weights[:, ARKIT_INDEX["mouthClose"]] <= weights[:, ARKIT_INDEX["jawOpen"]] + 1e-9
    ).all()


@pytest.mark.parametrize(
    ("control", "change"),
    [
        ("mouth_opening", 6.0),
        ("mouth_opening", -1.5),
        ("mouth_width", 2.0),
        ("mouth_width", -3.0),
        ("left_corner", 1.5),
        ("upper_lip", 1.0),
        ("lower_lip", -1.0),
    ],
)
def test_reachable_length_is_met_to_a_tenth_of_a_millimetre(
    lower: Face, control: str, change: float
) -> None:
    weights = lower.poses(20)
    goal = lower.of(weights, control) + change
    result = lower.go(weights, {control: goal})
    np.testing.assert_allclose(lower.of(result, control), goal, atol=0.1)
    assert_in_bounds(result)


def test_lengths_of_a_real_pose_are_met_together(lower: Face) -> None:
    """What another face measures can be asked for, all six at once."""
    start, other = lower.poses(10, 1, 0.3), lower.poses(10, 2, 0.3)
    asked: Asked = {name: lower.of(other, name) for name in LOWER.controls}
    result = lower.go(start, asked)
    assert np.abs(lower.lengths(result) - lower.lengths(other)).max() < 0.3
    assert_in_bounds(result)


def test_controls_that_were_not_asked_for_stay_near(lower: Face) -> None:
    weights = lower.poses(20)
    result = lower.go(weights, {"mouth_opening": lower.of(weights, "mouth_opening") + 4})
    others = [i for i, name in enumerate(LOWER.controls) if name != "mouth_opening"]
    moved = np.abs(lower.lengths(result) - lower.lengths(weights))[:, others]
    assert np.median(moved) < 0.75
    assert moved.max() < 3.0


def test_nothing_asked_changes_nothing(lower: Face) -> None:
    weights = lower.poses(5)
    np.testing.assert_allclose(lower.go(weights, {}), weights, atol=1e-5)


def test_strength_goes_part_of_the_way(lower: Face) -> None:
    weights = lower.poses(8)
    before = lower.of(weights, "mouth_opening")
    result = lower.go(weights, {"mouth_opening": before + 8}, strength=0.25)
    np.testing.assert_allclose(lower.of(result, "mouth_opening"), before + 2, atol=0.1)


@pytest.mark.parametrize("millimetres", [-50.0, 0.0, 90.0, 400.0])
@pytest.mark.parametrize("control", LOWER.controls)
def test_what_cannot_be_reached_is_never_farther_than_at_the_start(
    lower: Face, control: str, millimetres: float
) -> None:
    weights = lower.poses(12, 3, 0.9)
    for naturalness in (0.0, 1.0):
        result = lower.go(weights, {control: millimetres}, naturalness=naturalness)
        before = np.abs(lower.of(weights, control) - millimetres)
        after = np.abs(lower.of(result, control) - millimetres)
        # The other controls have a say, so a little is allowed for the sake of them.
        assert (after <= before + 0.05).all()
        assert_in_bounds(result)


@pytest.mark.parametrize("millimetres", [0.0, 0.3])
def test_lids_close_and_hardly_pass_each_other(lids: Face, millimetres: float) -> None:
    weights = lids.poses(60, 4, 0.4)
    result = lids.go(weights, {"left_eyelid": millimetres, "right_eyelid": millimetres})
    assert np.median(lids.lengths(result)) < 0.4
    assert lids.lengths(result).max() < 1.0
    # Once they have passed, the distance by height has changed its sign.
    rest = np.sign(lids.distances.offsets[:, 1])
    apart = lids.distances.vectors(result.astype(np.float32))[:, :, 1] * rest
    assert np.percentile(apart, 5) > -0.5
    assert apart.min() > -2.0
    assert_in_bounds(result)


def test_lips_that_have_passed_each_other_open(lower: Face) -> None:
    weights = np.zeros((3, 52))
    weights[:, ARKIT_INDEX["mouthRollLower"]] = (0.1, 0.3, 0.5)
    weights[:, ARKIT_INDEX["mouthPressLeft"]] = weights[:, ARKIT_INDEX["mouthPressRight"]] = 0.5
    rest = np.sign(lower.distances.offsets[0, 1])
    heights = lower.distances.vectors(weights.astype(np.float32))[:, 0, 1] * rest
    assert heights.min() < -0.2, "these lips have not passed each other"
    result = lower.go(weights, {"mouth_opening": 12.0})
    np.testing.assert_allclose(lower.of(result, "mouth_opening"), 12.0, atol=0.1)


def test_one_lid_closes_alone(lids: Face) -> None:
    weights = lids.poses(6, 5, 0.2)
    result = lids.go(weights, {"left_eyelid": 0.2})
    # One lid lies behind the other by 0.3 mm, and they cannot be nearer.
    np.testing.assert_allclose(lids.of(result, "left_eyelid"), 0.2, atol=0.15)
    before, after = lids.of(weights, "right_eyelid"), lids.of(result, "right_eyelid")
    np.testing.assert_allclose(after, before, atol=0.3)


def test_channels_of_other_regions_are_kept(lids: Face) -> None:
    weights = Face(LOWER).poses(4)
    result = lids.go(weights, {"left_eyelid": 1.0})
    kept = np.setdiff1d(np.arange(52), lids.columns)
    np.testing.assert_array_equal(result[:, kept], weights[:, kept])


def test_naturalness_bounds_the_change(lower: Face) -> None:
    weights = lower.poses(10)
    goal: Asked = {"mouth_opening": 45.0}
    obeying = np.linalg.norm(lower.go(weights, goal) - weights, axis=1)
    natural = np.linalg.norm(lower.go(weights, goal, naturalness=1.0) - weights, axis=1)
    assert natural.max() <= 4 * 0.2 + 1e-4  # four standard deviations of 0.2
    assert (natural <= obeying + 1e-6).all()
    assert natural.mean() < obeying.mean()


def test_tracked_corrective_above_the_jaw_is_not_made_worse(lower: Face) -> None:
    weights = lower.poses(5)
    close, jaw = ARKIT_INDEX["mouthClose"], ARKIT_INDEX["jawOpen"]
    weights[:, jaw], weights[:, close] = 0.1, 0.3
    result = lower.go(weights, {"mouth_opening": 0.0})
    assert (result[:, close] - result[:, jaw] <= 0.2 + 1e-9).all()
