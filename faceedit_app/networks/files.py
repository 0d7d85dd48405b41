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
    )
