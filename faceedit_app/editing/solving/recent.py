"""Results that may be asked for again soon."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from typing import Generic, TypeVar

Value = TypeVar("Value")


class Recent(Generic[Value]):
    """Results that are kept until others have been asked for more recently.

    Args:
        most: how many are kept.
        room: bytes that they may take in all; the last one is kept in any case. None = any, for
            results that are small in every take.
    """

    def __init__(self, most: int, room: int | None = None) -> None:
        self._most, self._room = most, room
        self._kept = dict[Hashable, Value]()
        self.bytes = 0  # that the results take, if there is a limit

    def __contains__(self, key: Hashable) -> bool:
        """Whether the result for a key is kept."""
        return key in self._kept

    def __len__(self) -> int:
        """How many are kept."""
        return len(self._kept)

    def to(self, key: Hashable, make: Callable[[], Value]) -> Value:
        """The result for a key; it is made if it is not kept."""
        found = self._kept.pop(key, None)
        if found is None:
            found = make()
            self.bytes += self._size(found)
        self._kept[key] = found
        while len(self._kept) > self._most or self._is_full():
            self.bytes -= self._size(self._kept.pop(next(iter(self._kept))))
        return found

    def _is_full(self) -> bool:
        return self._room is not None and self.bytes > self._room and len(self._kept) > 1

    def _size(self, kept: Value) -> int:
        """The bytes of an array; 0 if nobody counts them."""
        return 0 if self._room is None else int(getattr(kept, "nbytes", 0))
