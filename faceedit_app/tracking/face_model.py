"""Where the tracker's landmarks are on the character, and how its channels move them."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.arrays import Doubles, Indices
from faceedit_app.core.errors import FileError
from faceedit_app.core.resources import LANDMARKS_OF_CHARACTER, shipped
from faceedit_app.core.rig import MILLIMETRES, Distances, Rig
from faceedit_app.tracking.face_points import (
    INNER_LIPS,
    LIDS,
    OUTER_LIPS,
    OUTLINE,
    STEADY,
)
from faceedit_app.tracking.landmarker import LANDMARKS

# Weights: the outline slides as the head turns.
_WEIGHTS = ((OUTER_LIPS, 2.5), (INNER_LIPS, 1.5), (LIDS, 2.0), (OUTLINE, 0.3))


@dataclass(frozen=True)
class FaceModel:
    """The n landmarks that lie on the character.

    Attributes:
        numbers: (n,) numbers of the landmarks.
        rest: (n, 3) mm, on the neutral face; axes as in `Rig`.
        moves: (52, n, 3) mm at weight 1, in ARKit's order; 0 for channels that the rig lacks.
        weights: (n,) how much each counts.
        steady: (n,) the weights of those on bone, which show how the head is turned.
        controls: the controls as a function of weights in ARKit's order.
    """

    numbers: Indices
    rest: Doubles
    moves: Doubles
    weights: Doubles
    steady: Doubles
    controls: Distances

    @classmethod
    def of(cls, rig: Rig, path: Path | None = None) -> FaceModel:
        """The landmarks on the shipped character.

        Args:
            rig: the shipped character.
            path: where its landmarks are; None = the file that ships with it.

        Raises:
            FileError: the file is missing, damaged, or of another character.
        """
        path = path or shipped(LANDMARKS_OF_CHARACTER)
        numbers, vertices, shares = _read(path, len(rig.neutral))
        rest = np.einsum("lk,lkx->lx", shares, rig.neutral[vertices].astype(np.float64))
        moves = np.zeros((len(ARKIT_CHANNELS), len(numbers), 3))
        for i, channel in enumerate(ARKIT_CHANNELS):
            if channel in rig.channel_index:
                deltas = rig.deltas[rig.channel_index[channel]].astype(np.float64)
                moves[i] = np.einsum("lk,lkx->lx", shares, deltas[vertices])
        weights = np.ones(len(numbers))
        for some, weight in _WEIGHTS:
            weights[np.isin(numbers, some)] = weight
        steady = np.isin(numbers, STEADY).astype(np.float64)
        return cls(
            numbers,
            MILLIMETRES * rest,
            MILLIMETRES * moves,
            weights,
            steady,
            rig.arkit_distances,
        )

    def row(self, number: int) -> int:
        """The row of a landmark by its number."""
        return int(np.flatnonzero(self.numbers == number)[0])


def _read(path: Path, vertex_count: int) -> tuple[Indices, Indices, Doubles]:
    """The landmarks' numbers (n,), vertices (n, 3) and weights of these (n, 3)."""
    try:
        stored = json.loads(path.read_bytes())
        numbers = np.array([int(name) for name in stored], np.intp)
        vertices = np.array([entry[0] for entry in stored.values()], np.intp)
        shares = np.array([entry[1] for entry in stored.values()], np.float64)
        fits = vertices.shape == shares.shape == (len(numbers), 3) and len(numbers) > 100
        if not fits or vertices.min() < 0 or vertices.max() >= vertex_count:
            raise ValueError
        if numbers.min() < 0 or numbers.max() >= LANDMARKS or not np.isfinite(shares).all():
            raise ValueError
    except (OSError, ValueError, TypeError, IndexError, AttributeError, RecursionError) as error:
        raise FileError(path, "does not say where landmarks are", "reinstall FaceEdit") from error
    return numbers, vertices, shares
