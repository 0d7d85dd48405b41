"""Results that may be asked for again soon."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from typing import Generic, TypeVar

Value = TypeVar("Value")


class Recent(Generic[Value]):
    """Results that are kept until others have been asked for more recently.

    Args:
        most: how many are kept.
    """

    def __init__(self, most: int) -> None:
        self._most, self._kept = most, dict[Hashable, Value]()

    def __contains__(self, key: Hashable) -> bool:
        """Whether the result for a key is kept."""
        return key in self._kept

    def to(self, key: Hashable, make: Callable[[], Value]) -> Value:
        """The result for a key; it is made if it is not kept."""
        found = self._kept.pop(key, None)
        found = make() if found is None else found
        self._kept[key] = found
        while len(self._kept) > self._most:
            del self._kept[next(iter(self._kept))]
        return found
