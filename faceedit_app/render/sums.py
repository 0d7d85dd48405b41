"""Sums over many small groups of values, for each picture.

scipy's sparse matrices do it with one compiled function. Here that is called directly: importing
all of them takes a twentieth of a second, which the first picture would wait for.
"""

from __future__ import annotations

from importlib import import_module
from types import ModuleType

import numpy as np
from numpy.typing import NDArray

from faceedit_app.core.arrays import Floats, Indices
from faceedit_app.render.lazy import lazily

_NAME = "scipy.sparse._sparsetools"


def _compiled() -> ModuleType:
    """scipy's compiled functions for sparse matrices."""
    try:
        with lazily("scipy", "scipy.sparse"):
            return import_module(_NAME)
    except ImportError:  # on some systems scipy itself has to say where its libraries are
        return import_module(_NAME)


_tools = _compiled()


class GroupSums:
    """Sums values by group: a sparse matrix of ones, in compressed rows.

    Args:
        groups: (M,) the number of a group, from 0.
        members: (M,) which value belongs to it; a value may belong to several groups.
        count: the number of groups.
        wanted: (N,) the groups to sum; None = all, and N is their number.
    """

    def __init__(
        self,
        groups: NDArray[np.int32],
        members: NDArray[np.int32],
        count: int,
        wanted: Indices | None = None,
    ) -> None:
        self._members = members[np.argsort(groups, kind="stable")]
        sizes = np.bincount(groups, minlength=count)
        starts = np.cumsum(sizes) - sizes
        if wanted is not None:
            starts, sizes = starts[wanted], sizes[wanted]
        ends = np.cumsum(sizes)
        if wanted is not None:
            away = np.repeat(starts - (ends - sizes), sizes)
            self._members = self._members[away + np.arange(len(away))]
        self._ends = np.append(0, ends).astype(np.int32)
        self._ones = np.ones(len(self._members), np.float32)

    def __len__(self) -> int:
        return len(self._ends) - 1

    def add_to(self, sums: Floats, values: Floats) -> None:
        """Add the sums of values (V,) float32 to `sums` (N,) float32, in place."""
        shape = len(self), len(values)
        _tools.csr_matvec(*shape, self._ends, self._members, self._ones, values, sums)
