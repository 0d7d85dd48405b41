"""Answering edits: the networks of all regions, in process, on the CPU."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from faceedit_app.core.errors import FileError
from faceedit_app.core.regions import CONTROL_INDEX, REGIONS
from faceedit_app.networks.files import REMEDY, read_region
from faceedit_app.networks.inference import RegionAnswer, RegionGroup

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Engine:
    """Trained networks for each region, keyed by `Region.id`."""

    models: dict[str, RegionAnswer]
    _groups: dict[tuple[str, ...], RegionGroup] = field(
        default_factory=dict, init=False, compare=False
    )

    @classmethod
    def load(cls, folder: Path | str) -> Engine:
        """Read `REGION.safetensors` for each region from a folder.

        Raises:
            FileError: a file is missing or no model.
        """
        models = {}
        for region in REGIONS:
            path = Path(folder) / f"{region.id}.safetensors"
            try:
                model = RegionAnswer(read_region(path))
            except (KeyError, ValueError) as error:
                raise FileError(path, "is no FaceEdit model, or is damaged", REMEDY) from error
            if model.region != region.id:
                raise FileError(path, f"holds the region {model.region!r}", "restore the models")
            if model.channels != region.channels:  # the order counts
                raise FileError(path, "answers other channels", "train the models again")
            models[region.id] = model
        return cls(models)

    @property
    def scale(self) -> int:
        """Windows start and end on multiples of this many grid frames."""
        return max(model.scale for model in self.models.values())

    @property
    def context(self) -> int:
        """Grid frames on either side of a window that its answer can depend on."""
        radius = max(model.radius for model in self.models.values())
        return -(-radius // self.scale) * self.scale

    def answer(self, region: str, curves: Array, naturalness: float) -> Array:
        """The networks' weights for one or several versions of the curves.

        Args:
            region: `Region.id`.
            curves: (B, N, 8) mm at 25 fps; N any length.
            naturalness: 0 = regressor alone, 1 = full system.

        Returns:
            (B, N, K) weights of the region's channels, not bounded.
        """
        return np.stack([self.answer_all((region,), x, naturalness)[region] for x in curves])

    def answer_all(
        self, regions: Sequence[str], curves: Array, naturalness: float
    ) -> dict[str, Array]:
        """The same for one version (N, 8) of the curves, several regions in one go.

        What a region answers does not depend on which others do.
        """
        length = len(curves)
        heard = curves.astype(np.float32)
        if missing := -length % self.scale:
            heard = np.concatenate([heard, np.repeat(heard[-1:], missing, axis=0)])
        found: dict[str, Array] = {}
        for kind in {self.models[region].kind for region in regions}:
            mine = tuple(region for region in regions if self.models[region].kind == kind)
            inputs = [heard[:, self.columns(region)] for region in mine]
            answers = self._group(mine)(inputs, naturalness)
            for region, answer in zip(mine, answers, strict=True):
                found[region] = answer[:length].astype(np.float64)
        return found

    def _group(self, regions: tuple[str, ...]) -> RegionGroup:
        if regions not in self._groups:
            models = self.models.values()
            least = max(len(m.controls) for m in models), max(len(m.channels) for m in models)
            files = [self.models[region].file for region in regions]
            self._groups[regions] = RegionGroup(files, least)
        return self._groups[regions]

    def columns(self, region: str) -> list[int]:
        """Of the eight controls, those that a region listens to, in the order of its input."""
        return [CONTROL_INDEX[control] for control in self.models[region].controls]
