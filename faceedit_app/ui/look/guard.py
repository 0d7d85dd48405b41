"""Keep the window alive if something cannot be painted."""

from __future__ import annotations

import functools
import logging
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, TypeVar

from PySide6.QtCore import QTimer
from PySide6.QtGui import QPainter

_log = logging.getLogger("faceedit")
_reported: set[str] = set()

PaintMethod = TypeVar("PaintMethod", bound=Callable[..., None])


class PaintError(Exception):
    """Something could not be painted; the text says what and why."""


def guarded(paint: PaintMethod) -> PaintMethod:
    """A paint method that leaves its place empty if it fails, and reports that once.

    An exception in a paint event would come back with every repaint. The report waits until the
    event is over, because a dialog must not open while a widget is being painted.
    """
    name = paint.__qualname__

    @functools.wraps(paint)
    def painted(*args: Any, **kwargs: Any) -> None:
        try:
            paint(*args, **kwargs)
        except Exception as error:
            if name in _reported:
                return
            _reported.add(name)
            _log.exception("%s failed", name)
            # Without the traceback, which would keep the painter open beyond the event.
            report = PaintError(f"{name}: {type(error).__name__}: {error}")
            QTimer.singleShot(0, lambda: sys.excepthook(PaintError, report, None))

    return painted  # type: ignore[return-value]


@contextmanager
def saved(painter: QPainter) -> Iterator[None]:
    """Restore the painter's state in the end, also if painting fails: other items share it."""
    painter.save()
    try:
        yield
    finally:
        painter.restore()
