"""Close the lips of a head that was scanned with its mouth open.

Weights are measured from a closed mouth: a rest with open lips could never close them. The jaw is
raised until the middle of the lips meets; then both lips are drawn together along their length, as
far apart as on the template, and the skin around them follows smoothly.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.csgraph import dijkstra
from scipy.sparse.linalg import spsolve
from scipy.spatial import cKDTree

from faceedit_app.core.arrays import Doubles, Indices

_MOUTH = 35.0  # mm around the middle of the lips
_TOUCH = 2.2  # mm; lips of the template that are nearer to each other meet
_UPPER, _LOWER = 0.25, 0.3  # shares of the jaw's drop that tell one lip from the other
_FADES = 14.0  # mm along the skin over which it follows the lips
_PARTED = 1.0  # mm; lips that rest farther apart than the template's are open
_MOST_RAISED = 0.6  # of jawOpen
_STILL = 1e-4  # mm


@dataclass(frozen=True)
class LipSeam:
    """Where the lips of a template meet.

    Attributes:
        vertices: (W, 3) mm, of its skin.
        faces: (F, 3).
        pairs: (P, 2) vertices of the upper and the lower lip that touch, the middle ones first.
    """

    vertices: Doubles
    faces: NDArray[np.integer]
    pairs: Indices

    @classmethod
    def of(
        cls, vertices: Doubles, faces: NDArray[np.integer], jaw: Doubles, upper: int, lower: int
    ) -> LipSeam:
        """Find them: vertices that are together until the jaw parts them.

        Args:
            vertices, faces: of the skin, mm.
            jaw: (W, 3) mm, the displacements of jawOpen.
            upper, lower: the inner lips in the middle.
        """
        middle = (vertices[upper] + vertices[lower]) / 2
        near = np.linalg.norm(vertices - middle, axis=1) < _MOUTH
        drop = -jaw[:, 1] / max(-jaw[lower, 1], _STILL)
        above = np.flatnonzero(near & (drop < _UPPER))
        below = np.flatnonzero(near & (drop > _LOWER))
        far, nearest = cKDTree(vertices[below]).query(vertices[above])
        touching = far < _TOUCH
        found = np.stack((above[touching], below[nearest[touching]]), axis=1)
        return cls(vertices, faces, np.concatenate(([[upper, lower]], found)).astype(np.intp))

    def closed(self, skin: Doubles, jaw: Doubles) -> tuple[Doubles, float]:
        """Close the lips of a head with the template's mesh.

        Args:
            skin: (W, 3) mm, in the template's place and size.
            jaw: (W, 3) mm, its own displacements of jawOpen.

        Returns:
            (W, 3) mm, and by how many mm the lips were parted at most; 0 if they were closed.
        """
        rest = self._apart(self.vertices)
        parted = self._apart(skin) - rest
        widest = float(parted.max())
        if widest < _PARTED:
            return skin, 0.0
        upper, lower = self.pairs[0]
        drop = jaw[lower] - jaw[upper]
        length = float(np.linalg.norm(drop))
        raised = 0.0
        if length > _STILL and parted[0] > 0:
            gap = skin[lower] - skin[upper]
            raised = float(np.clip((gap @ drop / length - rest[0]) / length, 0.0, _MOST_RAISED))
        return self._drawn_together(skin - raised * jaw), widest

    def _apart(self, places: Doubles) -> Doubles:
        """(P,) mm between the lips."""
        apart: Doubles = np.linalg.norm(places[self.pairs[:, 1]] - places[self.pairs[:, 0]], axis=1)
        return apart

    def _drawn_together(self, skin: Doubles) -> Doubles:
        """The skin with both lips as far apart as the template's, each moved by half."""
        upper, lower = self.pairs.T
        wanted = self.vertices[lower] - self.vertices[upper]
        lack = wanted - (skin[lower] - skin[upper])
        count = len(skin)
        total, times = np.zeros((count, 3)), np.zeros(count)
        for rows, move in ((upper, -lack / 2), (lower, lack / 2)):
            np.add.at(total, rows, move)
            np.add.at(times, rows, 1.0)
        held = np.flatnonzero(times)
        return skin + self._spread(held, total[held] / times[held, None])

    def _spread(self, held: Indices, moves: Doubles) -> Doubles:
        """(W, 3) displacements of the whole skin, from those of some vertices.

        The smoothest field over the mesh (its Laplacian is smallest) that has these values and is 0
        beyond `_FADES`.
        """
        count = len(self.vertices)
        edges = np.sort(self.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
        a, b = np.unique(edges, axis=0).T
        length = np.linalg.norm(self.vertices[a] - self.vertices[b], axis=1) + _STILL
        away = dijkstra(
            sparse.csr_array((length, (a, b)), (count, count)),
            directed=False,
            indices=held,
            min_only=True,
            limit=_FADES,
        )
        free = np.flatnonzero((away > 0) & np.isfinite(away))
        joined = sparse.csr_array((1.0 / length, (a, b)), (count, count))
        joined = joined + joined.T
        degree = np.asarray(joined.sum(axis=1)).ravel()
        laplacian = sparse.diags_array(1.0 / degree.clip(_STILL)) @ (
            sparse.diags_array(degree) - joined
        )
        energy = (laplacian.T @ laplacian).tocsc()
        field = np.zeros((count, 3))
        field[held] = moves
        right = -(energy[free][:, held] @ moves)
        field[free] = spsolve(energy[free][:, free], right)
        return field
