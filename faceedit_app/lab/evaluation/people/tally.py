"""Measured values by figure, system and source."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Collection, Iterable

import numpy as np

_LARGEST = ("smooth_roughness",)
"""Figures whose largest value counts; of all others the mean."""


class Tally:
    """Collects values; a figure of a source is their mean, that of several sources the median."""

    def __init__(self) -> None:
        self._values: dict[tuple[str, str], dict[str, list[float]]] = defaultdict(
            lambda: defaultdict(list)
        )

    def add(self, figure: str, system: str, source: str, values: float | Iterable[float]) -> None:
        """Add one value or several; those that are not finite are ignored."""
        found = np.atleast_1d(np.asarray(values, np.float64))
        self._values[figure, system][source] += found[np.isfinite(found)].tolist()

    @property
    def figures(self) -> list[str]:
        """The figures that have a value."""
        return list(dict.fromkeys(figure for figure, _ in self._values))

    def systems(self, figure: str) -> list[str]:
        """The systems that a figure was measured for."""
        return [system for name, system in self._values if name == figure]

    def of_source(self, figure: str, system: str, source: str) -> float:
        """One source's value; NaN without any."""
        values = self._values.get((figure, system), {}).get(source, [])
        if not values:
            return float("nan")
        reduce: Callable[[list[float]], float] = max if figure in _LARGEST else np.mean
        return float(reduce(values))

    def median(self, figure: str, system: str, sources: Collection[str]) -> float:
        """The median over some sources; NaN without any value."""
        found = [self.of_source(figure, system, source) for source in sources]
        known = [value for value in found if np.isfinite(value)]
        return float(np.median(known)) if known else float("nan")

    def count(self, figure: str, system: str, source: str) -> int:
        """The number of values behind one."""
        return len(self._values.get((figure, system), {}).get(source, []))
