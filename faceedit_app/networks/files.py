"""A region's model file, read without torch; nothing in it is ever executed."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from safetensors import SafetensorError, safe_open

from faceedit_app.core.errors import FileError
from faceedit_app.core.regions import CONTROL_IDS, MODELLED_CHANNELS

FORMAT = "faceedit-region"
VERSION = 1
PREFIX = "networks."
REMEDY = "choose a folder of models written by faceedit train, or reinstall FaceEdit"


@dataclass(frozen=True)
class Natural:
    """Natural motion of a region's channels: a Gaussian over weights and their change per frame.

    Attributes:
        mean: (2 K,) of the K weights and their K changes from the frame before, at 25 fps.
        precision: (2 K, 2 K) the inverse of their covariance.
        limit: the 99.9th percentile of the distances of recorded frames.
    """

    mean: NDArray[np.float64]
    precision: NDArray[np.float64]
    limit: float

    def distance(self, weights: NDArray[np.float64]) -> NDArray[np.float64]:
        """How far each frame is from natural motion (Mahalanobis): weights (T, K) -> (T,)."""
        change = np.diff(weights, axis=0, prepend=weights[:1])
        away = np.concatenate([weights, change], axis=1) - self.mean
        square = np.einsum("tk,kl,tl->t", away, self.precision, away)
        result: NDArray[np.float64] = np.sqrt(np.maximum(square, 0.0))
        return result


@dataclass(frozen=True)
class RegionFile:
    """What a model file holds.

    Attributes:
        region: `Region.id`.
        controls: ids of the C controls in.
        channels: names of the K channels out.
        widths: features of the U-Nets at each time scale.
        covariance: (K, K) of the channels in the training data.
        low, high: (C,) mm, the range of each control in the training data.
        tensors: parameters of the networks by their name in `models.RegionNetworks`.
        notes: free text for the model card.
        residual: the autoencoder adds to its input instead of replacing it.
        natural: what natural motion looks like, for the evaluation; older files lack it.
    """

    region: str
    controls: tuple[str, ...]
    channels: tuple[str, ...]
    widths: tuple[int, ...]
    covariance: NDArray[np.float64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    tensors: dict[str, NDArray[Any]]
    notes: str
    residual: bool = True
    natural: Natural | None = None

    @property
    def adapted(self) -> bool:
        """Whether the full system reads the regressor with statistics of its own."""
        return any(name.startswith("adapted.") for name in self.tensors)


def read_region(path: Path | str) -> RegionFile:
    """Read a region's model file.

    Raises:
        FileError: missing, no model file, damaged, or of another version.
    """
    path = Path(path)
    try:
        with safe_open(str(path), framework="numpy") as file:
            about = json.loads((file.metadata() or {})["about"])
            tensors = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118
        return _checked(path, about, tensors)
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise FileError(path, f"cannot be read ({reason})", REMEDY) from error
    except (SafetensorError, KeyError, ValueError, TypeError) as error:
        raise FileError(path, "is no FaceEdit model, or is damaged", REMEDY) from error


def _checked(path: Path, about: dict[str, Any], tensors: dict[str, NDArray[Any]]) -> RegionFile:
    if about["version"] != VERSION:
        raise FileError(path, f"has version {about['version']}, not {VERSION}", "update FaceEdit")
    controls, channels = tuple(about["controls"]), tuple(about["channels"])
    if not set(controls) <= set(CONTROL_IDS) or not set(channels) <= set(MODELLED_CHANNELS):
        raise FileError(path, "names unknown controls or channels", REMEDY)
    widths = tuple(int(w) for w in about["widths"])
    if not widths or min(widths) < 1:
        raise ValueError(f"widths {widths}")
    shapes = [tensors[name].shape for name in ("covariance", "low", "high")]
    if shapes != [(len(channels),) * 2, (len(controls),), (len(controls),)]:
        raise ValueError(f"shapes {shapes}")
    if not all(np.isfinite(tensor).all() for tensor in tensors.values()):
        raise ValueError("numbers that are none")
    return RegionFile(
        region=str(about["region"]),
        controls=controls,
        channels=channels,
        widths=widths,
        covariance=tensors["covariance"].astype(np.float64),
        low=tensors["low"].astype(np.float64),
        high=tensors["high"].astype(np.float64),
        tensors={k.removeprefix(PREFIX): v for k, v in tensors.items() if k.startswith(PREFIX)},
        notes=str(about["notes"]),
        residual=bool(about.get("residual", True)),
        natural=_natural(about, tensors, 2 * len(channels)),
    )


def _natural(about: dict[str, Any], tensors: dict[str, NDArray[Any]], size: int) -> Natural | None:
    if "natural_limit" not in about:
        return None
    mean, precision = tensors["natural_mean"], tensors["natural_precision"]
    if mean.shape != (size,) or precision.shape != (size, size):
        raise ValueError(f"shapes {mean.shape} {precision.shape}")
    limit = float(about["natural_limit"])
    return Natural(mean.astype(np.float64), precision.astype(np.float64), limit)
