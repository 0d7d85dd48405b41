"""The rig of a character: blendshapes, and the distances measured on it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from faceedit_app.core.arkit import ARKIT_CHANNELS
from faceedit_app.core.arrays import Bools, Floats, Indices
from faceedit_app.core.controls import CONTROL_IDS, CONTROLS, control_named
from faceedit_app.core.levels import Levels
from faceedit_app.core.regions import Region

MILLIMETRES = 1000.0


@dataclass(frozen=True)
class Material:
    """How a run of triangles is drawn: `faces[start:stop]` of the rig.

    Attributes:
        surface: what it is, such as `skin` or `teeth`, if the name does not say so.
        texture: the number of its texture in `Rig.textures`, if it has one.
        cutoff: pixels with less alpha are not drawn; 0 draws all.
    """

    name: str
    start: int
    stop: int
    roughness: float = 0.55
    metallic: float = 0.0
    surface: str = ""
    texture: int | None = None
    cutoff: float = 0.0


@dataclass(frozen=True)
class Rig:
    """The neutral shape, the blendshapes and the control points of a character.

    Conventions: metres, Y up, +Z towards the viewer, +X is the character's left.

    Attributes:
        neutral: (V, 3) float32, metres.
        faces: (F, 3) int32, counter-clockwise seen from outside.
        channels: the K blendshape names.
        deltas: (K, V, 3) float32, metres at weight 1.
        colors: (V, 4) float32 in 0..1, linear RGB and alpha.
        materials: runs of `faces`, in order, that cover all of them.
        control_pairs: (C, 2) int32 vertex indices of the control points, in the order of
            `controls.CONTROLS`; -1 if the character lacks a control.
        name, attribution: shown to the user.
        levels: how strongly it answers each channel; `from_arkit` applies them, and the distances
            are of weights that have them.
        uv: (V, 2) float32 texture coordinates; (0, 0) is the upper left corner.
        textures: (H, W, 4) uint8 each, sRGB and alpha, top row first.
        shading_groups: (V,) int32; vertices with the same number share a normal (texture seams).
        shade: (V,) float32 in 0..1, the share of the light from above that reaches each vertex;
            None = it is computed when a renderer is opened, which takes a fifth of a second.
    """

    neutral: Floats
    faces: NDArray[np.int32]
    channels: tuple[str, ...]
    deltas: Floats
    colors: Floats
    materials: tuple[Material, ...]
    control_pairs: NDArray[np.int32]
    name: str = "Character"
    attribution: str = ""
    uv: Floats | None = None
    textures: tuple[NDArray[np.uint8], ...] = ()
    shading_groups: NDArray[np.int32] | None = None
    levels: Levels = field(default_factory=Levels)
    shade: Floats | None = None
    channel_index: dict[str, int] = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "channel_index", {c: i for i, c in enumerate(self.channels)})

    @cached_property
    def _flat_deltas(self) -> Floats:
        return np.ascontiguousarray(self.deltas.reshape(len(self.channels), -1))

    @cached_property
    def farthest_moves(self) -> Floats:
        """(V,) metres: the farthest that a vertex moves along an axis, in any one blendshape."""
        farthest: Floats = np.abs(self.deltas).max(axis=(0, 2))
        return farthest

    def vertices(self, weights: Floats) -> Floats:
        """The vertices of one frame.

        Args:
            weights: (K,) float32, in the order of `channels`.

        Returns:
            (V, 3) float32, metres.
        """
        moved: Floats = (weights @ self._flat_deltas).reshape(-1, 3)
        return self.neutral + moved

    @cached_property
    def has_control(self) -> Bools:
        """(C,) whether each control can be measured and edited on this character."""
        has: Bools = self.control_pairs.min(axis=1) >= 0
        return has

    @property
    def missing_controls(self) -> tuple[str, ...]:
        """Ids of the controls that this character lacks: they are 0 in every frame."""
        return tuple(c for c, has in zip(CONTROL_IDS, self.has_control, strict=True) if not has)

    @property
    def missing_note(self) -> str:
        """One line for the user about the missing controls; empty if there are none."""
        names = [f"“{control_named(name).label}”" for name in self.missing_controls]
        if not names:
            return ""
        curves = f"the curve{'s' * (len(names) > 1)} {', '.join(names)}"
        return f"{self.name} lacks the control points of {curves}, which cannot be edited"

    def measures(self, region: Region) -> Region:
        """The region, limited to the controls that this character has."""
        missing = self.missing_controls
        return replace(region, controls=tuple(c for c in region.controls if c not in missing))

    @cached_property
    def distances(self) -> Distances:
        """The controls as a function of weights (K,) in the order of `channels`."""
        # A control that is missing joins a vertex to itself.
        a, b = np.where(self.has_control, self.control_pairs.T, 0)
        return Distances(
            offsets=MILLIMETRES * (self.neutral[b] - self.neutral[a]),
            gradients=MILLIMETRES * (self.deltas[:, b] - self.deltas[:, a]),
            shuts=np.array([control.shuts for control in CONTROLS]),
            sideways=np.array([control.sideways for control in CONTROLS]),
            apart=np.array([control.optional for control in CONTROLS]),
        )

    @cached_property
    def arkit_distances(self) -> Distances:
        """The controls as a function of weights (52,) in ARKit order."""
        gradients = np.zeros((len(ARKIT_CHANNELS), *self.distances.gradients.shape[1:]), np.float32)
        for i, channel in enumerate(ARKIT_CHANNELS):
            if channel in self.channel_index:
                gradients[i] = self.distances.gradients[self.channel_index[channel]]
        return replace(self.distances, gradients=gradients)

    def controls(self, weights: Floats) -> Floats:
        """The controls of a clip: weights (T, K) -> (T, C) float32, mm."""
        return self.distances.measure(weights)

    def from_arkit(self, weights: Floats) -> Floats:
        """Weights (..., 52) in ARKit order -> (..., K) of `channels`, with `levels`.

        Channels that ARKit lacks are 0.
        """
        if self.levels:
            weights = self.levels.applied(weights)
        out = np.zeros((*weights.shape[:-1], len(self.channels)), np.float32)
        theirs, ours = self._arkit_places
        out[..., ours] = weights[..., theirs]
        return out

    @cached_property
    def _arkit_places(self) -> tuple[list[int], list[int]]:
        """The places of the shared channels: in ARKit's order, and in the rig's."""
        index = self.channel_index
        theirs = [i for i, channel in enumerate(ARKIT_CHANNELS) if channel in index]
        return theirs, [index[ARKIT_CHANNELS[i]] for i in theirs]


@dataclass(frozen=True)
class Distances:
    """Distances between vertex pairs that move linearly with the weights.

    The two lids of an eye pass each other if a tracker closes them farther than they are apart.
    Such a distance counts as 0, although the length of the vector grows again. Of a pair that is
    measured sideways only the part along X counts, with its sign.

    Attributes:
        offsets: (C, 3) float32, mm: the vector from the first to the second vertex, neutral.
        gradients: (K, C, 3) float32, mm: how each weight changes that vector.
        shuts: (C,) bool: pairs that can pass each other, so that the lower vertex is above.
        sideways: (C,) bool: pairs that are measured along X; None = none of them.
        apart: (C,) bool: pairs that are measured in a matrix product of their own, whose size
            would change the last bits of the others; None = none of them.
    """

    offsets: Floats
    gradients: Floats
    shuts: Bools
    sideways: Bools | None = None
    apart: Bools | None = None

    def select(self, controls: Sequence[int] | Indices) -> Distances:
        """Some of the distances."""
        rows = np.asarray(controls, np.intp)
        sideways, apart = (
            None if flags is None else flags[rows] for flags in (self.sideways, self.apart)
        )
        return Distances(
            self.offsets[rows], self.gradients[:, rows], self.shuts[rows], sideways, apart
        )

    @cached_property
    def farthest(self) -> Floats:
        """(C,) mm: the largest distance that weights in 0..1 can reach."""
        moves = np.linalg.norm(self.gradients, axis=2).sum(axis=0)
        lengths: Floats = moves + np.linalg.norm(self.offsets, axis=1)
        return lengths

    def vectors(self, weights: NDArray[Any]) -> NDArray[Any]:
        """Weights (T, K) -> vectors (T, C, 3), mm, in the precision of the weights."""
        k, c, _ = self.gradients.shape
        if self._groups is None:
            moved: NDArray[Any] = weights @ self.gradients.reshape(k, c * 3)
            vectors: NDArray[Any] = self.offsets + moved.reshape(len(weights), c, 3)
            return vectors
        apart = np.empty((len(weights), c, 3), np.result_type(weights, self.gradients))
        for rows, gradients in self._groups:
            apart[:, rows] = (weights @ gradients).reshape(len(weights), -1, 3)
        apart += self.offsets
        return apart

    @cached_property
    def _groups(self) -> list[tuple[slice | Indices, Floats]] | None:
        """Of either group the pairs and the gradients (K, 3 C'); None if there is one group."""
        if self.apart is None or self.apart.all() or not self.apart.any():
            return None
        groups: list[tuple[slice | Indices, Floats]] = []
        for rows in (np.flatnonzero(~self.apart), np.flatnonzero(self.apart)):
            gradients = np.ascontiguousarray(self.gradients[:, rows]).reshape(
                len(self.gradients), -1
            )
            first, stop = int(rows[0]), int(rows[-1]) + 1
            groups.append((slice(first, stop) if stop - first == len(rows) else rows, gradients))
        return groups

    def signed(self, weights: Floats) -> Floats:
        """Weights (T, K) -> lengths (T, C) float32, mm; negative once a pair has passed."""
        return self.lengths(self.vectors(weights))

    def measure(self, weights: Floats) -> Floats:
        """Weights (T, K) -> distances (T, C) float32, mm, 0 or more unless sideways."""
        return np.maximum(self.signed(weights), self.least)

    @cached_property
    def least(self) -> Floats:
        """(C,) mm: 0, or minus infinity for pairs that are measured sideways."""
        least = np.zeros(len(self.offsets), np.float32)
        if self.measures_sideways:
            least[self.sideways] = -np.inf
        return least

    def jacobian(self, weights: Floats, passed: bool = False) -> tuple[Floats, Floats]:
        """`signed` (T, C), mm, and its derivative by each weight (T, C, K), mm per unit of weight.

        Args:
            passed: treat each pair as if its vertices had passed each other.
        """
        vectors = self.vectors(weights)
        lengths = self.lengths(vectors)
        directions = self.directions(vectors, lengths, passed)
        return lengths, np.einsum("tcx,kcx->tck", directions, self.gradients)

    def directions(
        self, vectors: NDArray[Any], lengths: NDArray[Any], passed: bool = False
    ) -> NDArray[Any]:
        """The gradient (..., C, 3) of the `lengths` (..., C) by the `vectors` (..., C, 3).

        Args:
            passed: treat each pair as if its vertices had passed each other.
        """
        if passed:
            vectors = vectors * np.array([1, -1, 1], vectors.dtype)
        directions: NDArray[Any] = vectors / _apart_from_zero(lengths)[..., None]
        if self.measures_sideways:
            directions[..., self.sideways, :] = (1, 0, 0)
        return directions

    def lengths(self, vectors: NDArray[Any]) -> NDArray[Any]:
        """Lengths (..., C), mm, of `vectors` (..., C, 3); negative once a pair has passed."""
        squares = vectors * vectors
        plain: NDArray[Any] = squares[..., 0] + squares[..., 1]
        plain += squares[..., 2]
        np.sqrt(plain, out=plain)
        if self.measures_sideways:
            plain[..., self.sideways] = vectors[..., self.sideways, 0]
        if not self.may_pass:
            return plain
        height = vectors[..., 1] * self.offsets[:, 1]
        lengths: NDArray[Any] = np.where(self.shuts & (height < 0), -plain, plain)
        return lengths

    @cached_property
    def may_pass(self) -> bool:
        """Whether any of the pairs can pass each other."""
        return bool(self.shuts.any())

    @cached_property
    def measures_sideways(self) -> bool:
        """Whether any of the pairs is measured along X."""
        return self.sideways is not None and bool(self.sideways.any())


def _apart_from_zero(lengths: NDArray[Any]) -> NDArray[Any]:
    return np.where(np.abs(lengths) > 1e-6, lengths, 1e-6)
