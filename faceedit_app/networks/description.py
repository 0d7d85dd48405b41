"""What the file of a region's networks says about them."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from faceedit_app.core.arrays import Doubles
from faceedit_app.core.controls import CONTROL_IDS
from faceedit_app.core.errors import FileError
from faceedit_app.core.regions import MODELLED_CHANNELS
from faceedit_app.core.resample import GRID_RATE
from faceedit_app.networks.made_for import MadeFor

KEY = "faceedit"
"""Where the description stands among the texts of an ONNX file."""
VERSION = 2
REMEDY = "choose a folder of models written by faceedit train, or reinstall FaceEdit"
_LONGEST = 2_000_000  # characters
_LARGEST_SCALE, _LARGEST_CONTEXT = 64, 1_024  # frames
_LARGEST_NUMBER = 1e9


@dataclass(frozen=True)
class Natural:
    """Natural motion of a region's channels: a Gaussian over weights and their change per frame.

    Attributes:
        mean: (2 K,) of the K weights and their K changes from the frame before, at 25 fps.
        precision: (2 K, 2 K) the inverse of their covariance.
        limit: the 99.9th percentile of the distances of recorded frames.
    """

    mean: Doubles
    precision: Doubles
    limit: float

    def distance(self, weights: Doubles) -> Doubles:
        """How far each frame is from natural motion (Mahalanobis): weights (T, K) -> (T,)."""
        change = np.diff(weights, axis=0, prepend=weights[:1])
        away = np.concatenate([weights, change], axis=1) - self.mean
        square = np.einsum("tk,kl,tl->t", away, self.precision, away)
        result: Doubles = np.sqrt(np.maximum(square, 0.0))
        return result


@dataclass(frozen=True)
class Description:
    """What a file says about the networks in it.

    Attributes:
        region: `Region.id`.
        controls: ids of the C controls in.
        channels: names of the K channels out.
        made_for: the character whose controls they are.
        architecture: its name, and the settings that it was built with.
        scale: sequence lengths must be a multiple of this.
        context: frames on either side that can influence a frame of the answer.
        covariance: (K, K) of the channels in the training data.
        low, high: (C,) mm, the range of each control in the training data.
        notes: free text for the model card.
        natural: what natural motion looks like, for the evaluation; a baseline has none.
    """

    region: str
    controls: tuple[str, ...]
    channels: tuple[str, ...]
    made_for: MadeFor
    architecture: dict[str, Any]
    scale: int
    context: int
    covariance: Doubles
    low: Doubles
    high: Doubles
    notes: str = ""
    natural: Natural | None = field(default=None, repr=False)

    def to_json(self) -> str:
        """Text for the file."""
        natural = self.natural and {
            "mean": self.natural.mean.tolist(),
            "precision": self.natural.precision.tolist(),
            "limit": self.natural.limit,
        }
        return json.dumps(
            {
                "version": VERSION,
                "region": self.region,
                "controls": self.controls,
                "channels": self.channels,
                "made_for": self.made_for.to_json(),
                "architecture": self.architecture,
                "rate": GRID_RATE,
                "scale": self.scale,
                "context": self.context,
                "covariance": self.covariance.tolist(),
                "low": self.low.tolist(),
                "high": self.high.tolist(),
                "notes": self.notes,
                "natural": natural,
            }
        )

    @classmethod
    def from_json(cls, text: str, path: Path) -> Description:
        """Back from the text in a file.

        Raises:
            FileError: it describes networks that this FaceEdit cannot use.
            KeyError, TypeError, ValueError, RecursionError: it does not come from `to_json`.
        """
        if len(text) > _LONGEST:
            raise ValueError(f"{len(text)} characters")
        entry = json.loads(text)
        if entry["version"] != VERSION:
            version = str(entry["version"])[:20]
            raise FileError(path, f"has version {version}, not {VERSION}", "update FaceEdit")
        if entry["rate"] != GRID_RATE:
            rate = float(entry["rate"])
            raise FileError(path, f"answers {rate:g} frames a second, not {GRID_RATE:g}", REMEDY)
        controls, channels = _names(entry["controls"]), _names(entry["channels"])
        for name, known in ((controls, CONTROL_IDS), (channels, MODELLED_CHANNELS)):
            if unknown := sorted(set(name) - set(known)):
                raise FileError(path, f"names the unknown {unknown[0][:40]!r}", "update FaceEdit")
        made_for = MadeFor.from_json(entry["made_for"])
        if set(made_for.controls) != set(controls):
            raise ValueError("measured other controls")
        count, inputs = len(channels), len(controls)
        covariance = _numbers(entry["covariance"], count, count)
        if not np.allclose(covariance, covariance.T) or np.linalg.eigvalsh(covariance)[0] < -1e-6:
            raise ValueError("no covariance")
        natural = entry["natural"] and Natural(
            _numbers(entry["natural"]["mean"], 2 * count),
            _numbers(entry["natural"]["precision"], 2 * count, 2 * count),
            float(_numbers(entry["natural"]["limit"])),
        )
        return cls(
            region=_text(entry["region"]),
            controls=controls,
            channels=channels,
            made_for=made_for,
            architecture={**entry["architecture"], "name": _text(entry["architecture"]["name"])},
            scale=_whole(entry["scale"], 1, _LARGEST_SCALE),
            context=_whole(entry["context"], 0, _LARGEST_CONTEXT),
            covariance=covariance,
            low=_numbers(entry["low"], inputs),
            high=_numbers(entry["high"], inputs),
            notes=_text(entry["notes"]),
            natural=natural or None,
        )


def _text(value: Any) -> str:
    if not isinstance(value, str):
        raise TypeError(f"{type(value).__name__} instead of a text")
    return value


def _names(values: Any) -> tuple[str, ...]:
    names = tuple(_text(value) for value in values)
    if not names or len(set(names)) != len(names):
        raise ValueError(f"{len(names)} names, {len(set(names))} of them different")
    return names


def _whole(value: Any, least: int, most: int) -> int:
    if type(value) is not int or not least <= value <= most:
        raise ValueError("no whole number, or out of bounds")
    return value


def _numbers(values: Any, *shape: int) -> Doubles:
    numbers = np.asarray(values, np.float64)
    if numbers.shape != shape or not (np.abs(numbers) < _LARGEST_NUMBER).all():
        raise ValueError(f"numbers {numbers.shape}, not {shape}, or out of bounds")
    return numbers
