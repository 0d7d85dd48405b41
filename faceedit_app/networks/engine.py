"""Answering edits: the networks of all regions, in process, on the CPU."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from faceedit_app.core.errors import FileError
from faceedit_app.core.regions import CONTROL_INDEX, REGIONS
from faceedit_app.networks.files import REMEDY, read_region
from faceedit_app.networks.inference import RegionAnswer

Array = NDArray[np.float64]

# On matrices this small a second thread gains nothing, and when the machine has other work the
# two wait for each other for a hundred milliseconds.
THREADS = 1


@dataclass(frozen=True)
class Engine:
    """Trained networks for each region, keyed by `Region.id`."""

    models: dict[str, RegionAnswer]

    @classmethod
    def load(cls, folder: Path | str) -> Engine:
        """Read `REGION.safetensors` for each region from a folder.

        Raises:
            FileError: a file is missing or no model.
        """
        threadpool_limits(THREADS, user_api="blas")
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
        length = curves.shape[1]
        inputs = curves[:, :, self.columns(region)].astype(np.float32)
        if missing := -length % self.scale:
            inputs = np.concatenate([inputs, np.repeat(inputs[:, -1:], missing, axis=1)], axis=1)
        return self.models[region](inputs, naturalness)[:, :length].astype(np.float64)

    def columns(self, region: str) -> list[int]:
        """Of the eight controls, those that a region listens to, in the order of its input."""
        return [CONTROL_INDEX[control] for control in self.models[region].controls]
