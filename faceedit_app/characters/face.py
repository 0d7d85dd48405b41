"""A head as the rules that find its control points see it: places, moves, edges and skin."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import trimesh
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra

from faceedit_app.characters.assembly import Assembly
from faceedit_app.characters.welding import Weld
from faceedit_app.core.arrays import Bools, Doubles, Indices

Points = dict[str, int]  # by name, a vertex of a `WeldedFace`

_LIPS = (
    *("mouthPucker", "mouthFunnel", "mouthSmileLeft", "mouthSmileRight", "mouthRollUpper"),
    *("mouthRollLower", "mouthUpperUpLeft", "mouthLowerDownLeft"),
)
# Of these, those that move the middle of both lips, and of one.
_BOTH_LIPS = {"mouthPucker", "mouthFunnel"}
_UPPER_LIP = {"mouthRollUpper", "mouthUpperUpLeft"}
_LOWER_LIP = {"mouthRollLower", "mouthLowerDownLeft"}
# If only the jaw moves the middle of both: the share of its move that is all of it, the least such
# move in mm, the size of a mouth in mm, and the share below which a vertex weighs nothing.
_ALL_THE_WAY, _OPENED = 0.65, 3.0
_MOUTH_SIZE = np.array([25.0, 12.0, 20.0])
_FAR_FROM_IT = 0.02


class NotFound(Exception):
    """A control point cannot be found; the text says which one and why."""


@dataclass(frozen=True)
class WeldedFace:
    """A welded head in millimetres.

    Attributes:
        places: (N, 3), X the character's left, Y up, Z forward; the eyes are at 0.
        moves: by channel, (N, 3) at weight 1.
        faces: (F, 3).
    """

    places: Doubles
    moves: Mapping[str, Doubles]
    faces: Indices

    @classmethod
    def of(cls, assembly: Assembly, weld: Weld) -> WeldedFace:
        """The face of an assembly, with one vertex for each welded one."""
        deltas = 1000.0 * assembly.deltas[:, weld.first].astype(np.float64)
        places = 1000.0 * assembly.neutral[weld.first].astype(np.float64)
        return cls(places, dict(zip(assembly.channels, deltas, strict=True)), weld.faces)

    def move(self, channel: str) -> Doubles:
        """(N, 3) mm of a channel; zero where it has no shape."""
        found = self.moves.get(channel)
        return np.zeros_like(self.places) if found is None else found

    def amount(self, channel: str) -> Doubles:
        """(N,) mm that a channel moves each vertex."""
        amount: Doubles = np.linalg.norm(self.move(channel), axis=1)
        return amount

    @cached_property
    def edges(self) -> Indices:
        """(E, 2) each edge once."""
        edges = np.sort(self.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
        once: Indices = edges[trimesh.grouping.unique_rows(edges)[0]]
        return once

    @cached_property
    def lips(self) -> Doubles:
        """(N,) how much the shapes of the lips, which do not move teeth, move each vertex."""
        total = np.zeros(len(self.places))
        moved = set()
        for channel in _LIPS:
            amount = self.amount(channel)
            if amount.max(initial=0.0) > 1e-6:
                total += amount / amount.max()
                moved.add(channel)
        if moved & _BOTH_LIPS or (moved & _UPPER_LIP and moved & _LOWER_LIP):
            return total
        around = self._around_lower_lip()
        return around if around.any() else total

    def _around_lower_lip(self) -> Doubles:
        """(N,) 1 at the lower lip, and less around it, if only the jaw has a shape.

        The skin is what both jaw and lids move; the lower lip is the highest of what goes all the
        way down with the jaw.
        """
        drop = np.maximum(-self.move("jawOpen")[:, 1], 0.0)
        lids = self.amount("eyeBlinkLeft") + self.amount("eyeBlinkRight")
        labels = self._connected
        both = [np.bincount(labels, each[self.faces].sum(axis=1)) for each in (drop, lids)]
        skin = self.faces[labels == (both[0] * both[1]).argmax()].ravel()
        far = skin[drop[skin] > _ALL_THE_WAY * drop.max()]
        if drop.max() < _OPENED or not len(far):
            return np.zeros(len(self.places))
        middle = np.abs(self.places[far, 0] - np.median(self.places[far, 0]))
        lip = self.places[far[(self.places[far, 1] - middle).argmax()]]
        away = np.linalg.norm((self.places - lip) / _MOUTH_SIZE, axis=1)
        near: Doubles = np.exp(-np.square(away))
        near[near < _FAR_FROM_IT] = 0.0
        return near

    @cached_property
    def middle(self) -> float:
        """The x of the mouth's midline, mm; shapes are never quite symmetric."""
        amount = sum(
            (self.amount(channel) for channel in ("mouthPucker", "mouthFunnel", "jawOpen")),
            np.zeros(len(self.places)),
        )
        weight = np.where(self.skin, amount, 0.0)
        return float(weight @ self.places[:, 0] / max(weight.sum(), 1e-9))

    @cached_property
    def skin(self) -> Bools:
        """(N,) which vertices are on the connected surface with the lips.

        Lashes and eyeballs that touch it only in an edge or a vertex do not belong to it.
        """
        labels = self._connected
        weight = np.bincount(labels, self.lips[self.faces].sum(axis=1))
        skin = np.zeros(len(self.places), np.bool_)
        skin[self.faces[labels == weight.argmax()].ravel()] = True
        return skin

    @cached_property
    def _connected(self) -> Indices:
        """(F,) the connected surface of each triangle."""
        adjacency = trimesh.graph.face_adjacency(self.faces)
        labels: Indices = trimesh.graph.connected_component_labels(adjacency, len(self.faces))
        return labels

    def way(self, near: Bools, start: int, end: int, moves: Doubles) -> list[int] | None:
        """The shortest way along edges from `end` back to `start`; None if there is none.

        The rim of an opening is short at rest, and not much longer when the opening is shut or wide
        open.

        Args:
            near: (N,) the vertices that it may use.
            moves: (N, 3) mm, of the shape that opens or shuts.
        """
        moved = self.places + moves
        a, b = self.edges[near[self.edges].all(axis=1)].T
        cost = np.linalg.norm(self.places[a] - self.places[b], axis=1)
        cost = cost + 0.25 * np.linalg.norm(moved[a] - moved[b], axis=1)
        graph = coo_matrix((cost + 1e-9, (a, b)), (len(moved), len(moved))).tocsr()
        distances, before = dijkstra(graph, False, indices=start, return_predecessors=True)
        if not np.isfinite(distances[end]):
            return None
        way = [end]
        while way[-1] != start:
            way.append(int(before[way[-1]]))
        return way
