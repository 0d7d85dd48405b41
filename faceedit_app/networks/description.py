"""The description of a region's networks, stored in their file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from faceedit_app.core.arrays import Doubles
from faceedit_app.core.controls import CONTROL_IDS
from faceedit_app.core.errors import FileError
from faceedit_app.core.fields import FieldError, Fields, parse, to_text
from faceedit_app.core.regions import MODELLED_CHANNELS
from faceedit_app.core.resample import GRID_RATE
from faceedit_app.networks.made_for import MadeFor

KEY = "faceedit"
"""The key of the description in an ONNX file's metadata."""
VERSION = 2
_LONGEST = 2_000_000  # characters
_LONGEST_NAME = 40
_LARGEST_SCALE, _LARGEST_CONTEXT = 64, 1_024  # frames
_LARGEST_NUMBER = 1e9


class UnusableModel(FileError):
    """A model's file that is damaged, or holds something else.

    Args:
        path: the file.
        problem: what is wrong with it.
    """

    def __init__(self, path: Path | str, problem: str) -> None:
        remedy = "reinstall FaceEdit"  # the window uses the model that ships
        training = f"choose a folder of models written by faceedit train, or {remedy}"
        super().__init__(path, problem, remedy, command_remedy=training)


@dataclass(frozen=True)
class Natural:
    """A Gaussian model of natural motion: a region's weights and their change per frame.

    Attributes:
        mean: (2 K,) mean of the K weights and their K changes since the last frame, at 25 fps.
        precision: (2 K, 2 K) the inverse of their covariance.
        limit: the 99.9th percentile of the distance of recorded frames.
    """

    mean: Doubles
    precision: Doubles
    limit: float

    def distance(self, weights: Doubles) -> Doubles:
        """The Mahalanobis distance of each frame from natural motion: weights (T, K) -> (T,)."""
        change = np.diff(weights, axis=0, prepend=weights[:1])
        away = np.concatenate([weights, change], axis=1) - self.mean
        square = np.einsum("tk,kl,tl->t", away, self.precision, away)
        result: Doubles = np.sqrt(np.maximum(square, 0.0))
        return result


@dataclass(frozen=True)
class Description:
    """The description of the networks in a file.

    Attributes:
        region: `Region.id`.
        controls: ids of the C input controls.
        channels: names of the K output channels.
        made_for: the character that the controls were measured on.
        architecture: its name and settings.
        scale: input lengths must be a multiple of this.
        context: frames on either side that a frame of the answer depends on.
        covariance: (K, K) of the channels in the training data.
        low, high: (C,) mm, the range of each control in the training data.
        notes: free text for the model card.
        natural: natural motion, for evaluation; None for a baseline.
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
        """The description as JSON text."""
        natural = self.natural and {
            "mean": self.natural.mean.tolist(),
            "precision": self.natural.precision.tolist(),
            "limit": self.natural.limit,
        }
        return to_text(
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
        """Parse the text from a file.

        Raises:
            FileError: this FaceEdit cannot use the networks.
            ValueError: the text is not from `to_json`; a `FieldError` names the field.
        """
        if len(text) > _LONGEST:
            raise ValueError(f"{len(text)} characters")
        entry = Fields(parse(text))
        if (version := entry.whole("version")) != VERSION:
            raise FileError(path, f"has version {version}, not {VERSION}", "update FaceEdit")
        if (rate := entry.number("rate")) != GRID_RATE:
            raise UnusableModel(path, f"answers {rate:g} frames a second, not {GRID_RATE:g}")
        controls = _names(entry, "controls", CONTROL_IDS, path)
        channels = _names(entry, "channels", MODELLED_CHANNELS, path)
        architecture = entry.fields("architecture")
        count, inputs = len(channels), len(controls)
        return cls(
            region=entry.text("region", longest=_LONGEST_NAME),
            controls=controls,
            channels=channels,
            made_for=MadeFor.from_json(entry.fields("made_for"), controls),
            architecture=entry.plain("architecture")
            | {"name": architecture.text("name", longest=_LONGEST_NAME)},
            scale=entry.whole("scale", 1, _LARGEST_SCALE),
            context=entry.whole("context", 0, _LARGEST_CONTEXT),
            covariance=_covariance(entry, count),
            low=_numbers(entry, "low", inputs),
            high=_numbers(entry, "high", inputs),
            notes=entry.text("notes", longest=_LONGEST),
            natural=_natural(entry.fields_or_none("natural"), 2 * count),
        )


def _names(entry: Fields, name: str, known: Sequence[str], path: Path) -> tuple[str, ...]:
    names = entry.texts(name)
    if not names or len(set(names)) != len(names):
        raise FieldError(f'"{name}" is empty, or names something twice')
    if unknown := sorted(set(names) - set(known)):
        what = unknown[0][:_LONGEST_NAME]
        raise FileError(path, f"names the unknown {name[:-1]} {what!r}", "update FaceEdit")
    return names


def _numbers(entry: Fields, name: str, *shape: int) -> Doubles:
    values = entry.items(name)
    try:
        numbers = np.asarray(values, np.float64)
    except (OverflowError, TypeError, ValueError) as error:
        raise FieldError(f'"{name}" is not a list of numbers') from error
    if numbers.shape != shape or not (np.abs(numbers) < _LARGEST_NUMBER).all():
        raise FieldError(f'"{name}" has the wrong shape, or is out of range')
    return numbers


def _covariance(entry: Fields, size: int) -> Doubles:
    covariance = _numbers(entry, "covariance", size, size)
    if not np.allclose(covariance, covariance.T) or np.linalg.eigvalsh(covariance)[0] < -1e-6:
        raise FieldError('"covariance" is not a covariance')
    return covariance


def _natural(entry: Fields | None, size: int) -> Natural | None:
    if entry is None:
        return None
    mean, precision = _numbers(entry, "mean", size), _numbers(entry, "precision", size, size)
    return Natural(mean, precision, entry.number("limit", low=0.0))
