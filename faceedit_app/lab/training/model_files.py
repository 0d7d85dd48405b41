"""The networks of a region to and from their file, for training (torch)."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import torch
from safetensors.torch import save

from faceedit_app.core.arrays import Doubles
from faceedit_app.core.atomic import write_atomically
from faceedit_app.core.errors import FileError
from faceedit_app.lab.training.models import RegionNetworks
from faceedit_app.networks.files import (
    FORMAT,
    PREFIX,
    REMEDY,
    VERSION,
    Natural,
    RegionFile,
    read_region,
)


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
        natural: what natural motion looks like, for the evaluation; older files lack it.
    """

    region: str
    controls: tuple[str, ...]
    channels: tuple[str, ...]
    networks: RegionNetworks
    covariance: Doubles
    low: Doubles
    high: Doubles
    widths: tuple[int, ...]
    notes: str = ""
    natural: Natural | None = None


def save_model(path: Path | str, model: RegionModel) -> None:
    """Write a region's networks; the same model always gives the same bytes."""
    tensors = {f"{PREFIX}{k}": v.contiguous() for k, v in model.networks.state_dict().items()}
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
        "residual": model.networks.residual,
        "adapted": model.networks.adapted is not None,
    }
    if model.natural is not None:
        tensors["natural_mean"] = torch.from_numpy(model.natural.mean)
        tensors["natural_precision"] = torch.from_numpy(model.natural.precision)
        about["natural_limit"] = model.natural.limit
    # One entry only: safetensors writes several in an order of its own that changes by chance.
    write_atomically(path, save(tensors, {"about": json.dumps(about)}))


def as_file(model: RegionModel) -> RegionFile:
    """What the model's file would hold, so that it can answer without being written first."""
    state = model.networks.state_dict().items()
    return RegionFile(
        region=model.region,
        controls=model.controls,
        channels=model.channels,
        widths=model.widths,
        covariance=model.covariance,
        low=model.low,
        high=model.high,
        tensors={name: tensor.numpy() for name, tensor in state},
        notes=model.notes,
        residual=model.networks.residual,
        natural=model.natural,
    )


def load_model(path: Path | str) -> RegionModel:
    """Read a region's networks, ready to be trained further.

    Raises:
        FileError: missing, no model file, damaged, or of another version.
    """
    file = read_region(path)
    networks = RegionNetworks(
        len(file.controls), len(file.channels), file.widths, file.residual, file.adapted
    )
    try:
        networks.load_state_dict({k: torch.from_numpy(v.copy()) for k, v in file.tensors.items()})
    except RuntimeError as error:
        raise FileError(path, "is no FaceEdit model, or is damaged", REMEDY) from error
    return RegionModel(
        region=file.region,
        controls=file.controls,
        channels=file.channels,
        networks=networks.eval(),
        covariance=file.covariance,
        low=file.low,
        high=file.high,
        widths=file.widths,
        notes=file.notes,
        natural=file.natural,
    )
