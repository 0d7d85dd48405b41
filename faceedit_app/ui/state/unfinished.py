"""The files that are being written in the background."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QObject, Signal


class Unfinished(QObject):
    """Closing the window asks about these files, and stops those that are writing them.

    Signals:
        changed(): a file was begun, or is written or given up.
    """

    changed = Signal()

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._stops: dict[object, tuple[str, Callable[[], None]]] = {}

    @property
    def names(self) -> list[str]:
        """The files, in the order in which they were begun."""
        return [name for name, _ in self._stops.values()]

    def begin(self, name: str, stop: Callable[[], None]) -> Callable[[], None]:
        """Remember that a file is being written.

        Args:
            name: of the file.
            stop: gives up, and keeps nothing of it.

        Returns:
            What to call when it is written or given up.
        """
        key = object()
        self._stops[key] = name, stop
        self.changed.emit()
        return lambda: self._forget(key)

    def _forget(self, key: object) -> None:
        if self._stops.pop(key, None) is not None:
            self.changed.emit()

    def stop(self) -> None:
        """Give up all of them."""
        for _, stop in list(self._stops.values()):
            stop()
