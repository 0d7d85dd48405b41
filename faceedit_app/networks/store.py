"""The networks of a region as one safetensors file; nothing in it is ever executed."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray
from safetensors import SafetensorError, safe_open
from safetensors.torch import save

from faceedit_app.core.atomic import write_atomically
from faceedit_app.core.errors import FileError
from faceedit_app.core.regions import CONTROL_IDS, MODELLED_CHANNELS
from faceedit_app.networks.models import RegionNetworks

FORMAT = "faceedit-region"
VERSION = 1
_REMEDY = "choose a folder of models written by faceedit train, or reinstall FaceEdit"


@dataclass
class RegionModel:
    """The trained networks of one region and what the data said about it.

    Attributes:
        region: `Region.id`.
        controls: ids of the C controls in.
        channels: names of the K channels out.
        networks: regressor and autoencoder.
        covariance: (K, K) of the channels in the training data.
        low, high: (C,) mm, the range of each control in the training data.
        notes: free text for the model card (data, settings, figures).
    """

    region: str
    controls: tuple[str, ...]
    channels: tuple[str, ...]
    networks: RegionNetworks
    covariance: NDArray[np.float64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    widths: tuple[int, ...]
    notes: str = ""


def save_model(path: Path | str, model: RegionModel) -> None:
    """Write a region's networks; the same model always gives the same bytes."""
    tensors = {f"networks.{k}": v.contiguous() for k, v in model.networks.state_dict().items()}
    tensors["covariance"] = torch.from_numpy(model.covariance)
    tensors["low"], tensors["high"] = torch.from_numpy(model.low), torch.from_numpy(model.high)
    about = {
        "format": FORMAT,
        "version": VERSION,
        "region": model.region,
        "controls": model.controls,
        "channels": model.channels,
        "widths": model.widths,
        "notes": model.notes,
    }
    # One entry only: safetensors writes several in an order of its own that changes by chance.
    write_atomically(path, save(tensors, {"about": json.dumps(about)}))


def load_model(path: Path | str) -> RegionModel:
    """Read a region's networks, ready to answer.

    Raises:
        FileError: missing, no model file, damaged, or of another version.
    """
    path = Path(path)
    try:
        with safe_open(str(path), framework="pt") as file:
            about = json.loads((file.metadata() or {})["about"])
            tensors = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118
        if about["version"] != VERSION:
            raise FileError(
                path, f"has version {about['version']}, not {VERSION}", "update FaceEdit"
            )
        controls, channels = tuple(about["controls"]), tuple(about["channels"])
        if not set(controls) <= set(CONTROL_IDS) or not set(channels) <= set(MODELLED_CHANNELS):
            raise FileError(path, "names unknown controls or channels", _REMEDY)
        widths = tuple(int(w) for w in about["widths"])
        if not widths or min(widths) < 1:
            raise ValueError(f"widths {widths}")
        shapes = [tuple(tensors[name].shape) for name in ("covariance", "low", "high")]
        if shapes != [(len(channels),) * 2, (len(controls),), (len(controls),)]:
            raise ValueError(f"shapes {shapes}")
        if not all(bool(tensor.isfinite().all()) for tensor in tensors.values()):
            raise ValueError("numbers that are none")
        networks = RegionNetworks(len(controls), len(channels), widths)
        prefix = "networks."
        networks.load_state_dict(
            {k.removeprefix(prefix): v for k, v in tensors.items() if k.startswith(prefix)}
        )
        return RegionModel(
            region=str(about["region"]),
            controls=controls,
            channels=channels,
            networks=networks.eval(),
            covariance=tensors["covariance"].double().numpy(),
            low=tensors["low"].double().numpy(),
            high=tensors["high"].double().numpy(),
            widths=widths,
            notes=str(about["notes"]),
        )
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise FileError(path, f"cannot be read ({reason})", _REMEDY) from error
    except (SafetensorError, KeyError, ValueError, TypeError, RuntimeError) as error:
        raise FileError(path, "is no FaceEdit model, or is damaged", _REMEDY) from error
