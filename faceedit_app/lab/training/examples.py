"""The windows that one region's networks learn from, epoch by epoch."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np

from faceedit_app.core.arkit import ARKIT_INDEX
from faceedit_app.core.arrays import Bools, Doubles, Floats
from faceedit_app.core.controls import CONTROL_INDEX
from faceedit_app.core.errors import FileError
from faceedit_app.core.regions import Region
from faceedit_app.core.resample import GRID_RATE
from faceedit_app.core.rig import Distances, Rig
from faceedit_app.lab.training.architectures import Architecture
from faceedit_app.lab.training.data import (
    Performance,
    Windows,
    cut_windows,
    mirrored,
    region_windows,
    stretches,
)
from faceedit_app.lab.training.settings import TrainingSettings
from faceedit_app.lab.training.variety import play, split_sides
from faceedit_app.networks.description import Description, Natural
from faceedit_app.networks.made_for import MadeFor

SYNTHETIC = "synthetic"
"""The source whose takes no person played: the folder that `faceedit synthesize` wrote."""
NATURAL_PERCENTILE = 99.9
VISIBLE = 0.05  # weights nearer than this look alike ...
CHANGE_SCALE = 2.0  # ... and so do changes per frame by a share 1 / CHANGE_SCALE of it


class Examples:
    """One region's training and held-out windows.

    Args:
        performances: takes; a share of their blocks is held out.
        rig: the character that the controls are measured on.

    Attributes:
        validation: held-out windows as recorded.

    Raises:
        FileError: the takes are too short, or lack the region's channels.
    """

    def __init__(
        self,
        region: Region,
        performances: Sequence[Performance],
        rig: Rig,
        settings: TrainingSettings,
    ) -> None:
        self.region, self.rig, self.settings = region, rig, settings
        self.distances = rig.arkit_distances
        self._train, held = stretches(performances, settings)
        self.validation = self._windows(*cut_windows(held, settings.window, settings.overlap))
        if not len(self.validation) or not len(self.epoch(0)):
            raise FileError(
                "training data",
                f"is too little for the {region.label.lower()}",
                f"add takes of more than {4 * settings.window / GRID_RATE:.0f} seconds",
            )

    def epoch(self, number: int) -> Windows:
        """The examples of an epoch; with variety, takes are altered for each."""
        variety = self.settings.variety
        if variety is None:
            return self._recorded
        random = np.random.default_rng([self.settings.seed, 7, number])
        frames, mirror = self.settings.window, self.settings.mirror
        played = [play(take, variety, frames, mirror, random) for take in self._train]
        windows = cut_windows(played, frames, self.settings.overlap)
        return self._windows(*split_sides(*windows, variety.split_sides, random))

    @cached_property
    def _recorded(self) -> Windows:
        weights, captured = cut_windows(self._train, self.settings.window, self.settings.overlap)
        if self.settings.mirror:
            flipped = mirrored(captured.astype(np.float32)).astype(bool)
            weights = np.concatenate([weights, mirrored(weights)])
            captured = np.concatenate([captured, flipped])
        return self._windows(weights, captured)

    def _windows(self, weights: Floats, captured: Bools) -> Windows:
        return region_windows(self.region, weights, captured, self.distances)

    @cached_property
    def count(self) -> tuple[int, int]:
        """Windows in an epoch, and held out."""
        return len(self.epoch(0)), len(self.validation)

    @cached_property
    def mean(self) -> Floats:
        """(C,) mm, of the controls."""
        mean: Floats = self._recorded.controls.mean((0, 2))
        return mean

    @cached_property
    def bounds(self) -> Doubles:
        """(2, C) mm: the range of each control in the takes as recorded."""
        controls = self._recorded.controls.transpose(0, 2, 1).reshape(-1, len(self.mean))
        bounds: Doubles = np.percentile(controls, self.settings.range_percentiles, axis=0)
        return bounds

    def describe(self, networks: Architecture, **more: Any) -> Description:
        """What the file of networks that learned from these examples says about them.

        Args:
            networks: they are that.
            more: fields of `Description` that are otherwise, or that examples know nothing of.
        """
        low, high = self.bounds
        known = Description(
            region=self.region.id,
            controls=self.region.controls,
            channels=self.region.channels,
            made_for=MadeFor.of(self.rig, self.region.controls),
            architecture={"name": networks.name, **networks.settings},
            scale=networks.scale,
            context=networks.radius,
            covariance=self.covariance,
            low=low,
            high=high,
        )
        return replace(known, **more)

    @cached_property
    def own_distances(self) -> Distances:
        """The region's controls as a function of its own channels alone."""
        mine = self.distances.select([CONTROL_INDEX[c] for c in self.region.controls])
        rows = [ARKIT_INDEX[c] for c in self.region.channels]
        return replace(mine, gradients=np.ascontiguousarray(mine.gradients[rows]))

    @cached_property
    def covariance(self) -> Doubles:
        """(K, K) of the channels, over the windows in which both of a pair are captured."""
        windows = self.epoch(0)
        weights = windows.weights.astype(np.float64)
        seen = windows.captured.astype(np.float64)[:, :, None]
        count = weights.shape[2]
        mean = (weights * seen).sum((0, 2)) / np.maximum(seen.sum((0, 2)) * count, 1)
        centred = (weights - mean[:, None]) * seen
        pairs = np.einsum("nk,nl->kl", seen[:, :, 0], seen[:, :, 0]) * count
        joint = np.einsum("nkt,nlt->kl", centred, centred) / np.maximum(pairs, 1)
        # Pairs were seen on different windows, which can leave slightly negative directions.
        return _widened(joint, 1e-3 * float(np.linalg.eigvalsh(joint)[-1]))

    @cached_property
    def natural(self) -> Natural:
        """The motion of the takes as recorded and mirrored, with the limit of real ones."""
        columns = [ARKIT_INDEX[c] for c in self.region.channels]
        takes = [t for t in self._train if t.captured[columns].any() and len(t.weights) > 1]
        both = [(t, w) for t in takes for w in (t.weights, mirrored(t.weights))]
        motions = [(t, _motion(w[:, columns].astype(np.float64))) for t, w in both]
        everything = np.concatenate([motion for _, motion in motions])
        mean: Doubles = everything.mean(axis=0)
        joint: Doubles = np.cov(everything.T)
        half = len(columns)
        joint[half:] *= CHANGE_SCALE
        joint[:, half:] *= CHANGE_SCALE
        joint = _widened(joint, VISIBLE**2)
        joint[half:] /= CHANGE_SCALE
        joint[:, half:] /= CHANGE_SCALE
        natural = Natural(mean, np.asarray(np.linalg.inv(joint), np.float64), 0.0)
        real = [motion for take, motion in motions if take.source != SYNTHETIC] or [everything]
        far = np.concatenate([natural.distance(motion[:, :half]) for motion in real])
        return replace(natural, limit=float(np.percentile(far, NATURAL_PERCENTILE)))


def _motion(weights: Doubles) -> Doubles:
    """Weights (T, K) -> weights and their change per frame (T, 2 K)."""
    return np.concatenate([weights, np.diff(weights, axis=0, prepend=weights[:1])], axis=1)


def _widened(joint: Doubles, least: float) -> Doubles:
    """A covariance without directions of less than a variance."""
    values, vectors = np.linalg.eigh(joint)
    wide: Doubles = (vectors * np.maximum(values, least)) @ vectors.T
    return wide
